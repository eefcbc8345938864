//! The suite `smoke` on the device that a user gets, from a folder that knows nothing of the repository.
#![allow(clippy::expect_used, reason = "a test fails by panicking")]

use std::process::Command;

#[test]
fn smoke_runs_anywhere_and_has_all_kinds_of_rays() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = Command::new(env!("CARGO_BIN_EXE_pointillist"))
        .current_dir(folder.path())
        .args(["bench", "--size", "48x32", "--runs", "1", "--json", "b.json"])
        .env("POINTILLIST_VALIDATION", "1")
        .env_remove("POINTILLIST_MODELS")
        .output()
        .expect("runs");
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{errors}");
    let text = std::fs::read_to_string(folder.path().join("b.json")).expect("a report");
    let report: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!(report["skipped"], serde_json::json!([]));
    let rows = report["rows"].as_array().expect("rows");
    for kind in ["camera", "shadow", "reflected", "refracted"] {
        let any = rows.iter().any(|row| row["rays"][kind].as_u64() > Some(0));
        assert!(any, "no row has {kind} rays");
    }
    for kind in ["camera", "shadow", "scattered"] {
        let any = rows.iter().any(|row| row["rays_per_second"][kind].as_f64() > Some(0.0));
        assert!(any, "no row times {kind} rays: {text}");
    }
    let marched = |row: &serde_json::Value| row["kernels"]["march"].as_f64() > Some(0.0);
    assert!(rows.iter().any(marched), "no row has a volume");
    // A device keeps its pipelines: rows after the first need few new ones.
    assert!(rows[0]["pipelines_ms"].as_f64() > Some(0.0), "{}", rows[0]);
    for row in rows {
        assert!(row["gpu_ms"]["median"].as_f64() > Some(0.0), "{row}");
    }
}
