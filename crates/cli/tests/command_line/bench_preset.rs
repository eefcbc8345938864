//! `bench` beside the paper's own method, and models that it fills.

use crate::{Folder, Ran, pointillist, run_in, sphere};
use serde_json::Value;
use std::path::Path;

const QUICK: [&str; 6] = ["--device", "reference", "--size", "32x24", "--runs", "1"];

fn report(folder: &Folder) -> Value {
    let text = std::fs::read_to_string(folder.path().join("b.json")).expect("a report");
    serde_json::from_str(&text).expect("JSON")
}

#[test]
fn a_preset_is_shown_beside_the_same_without() {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(500));
    let arguments = ["bench", "ball.ply", "--preset", "paper", "--json", "b.json"];
    let ran = run_in(folder.path(), &[&arguments[..], &QUICK].concat()).succeeds();
    let report = report(&folder);
    let [ours, paper] = report["rows"].as_array().expect("rows").as_slice() else {
        panic!("{report}")
    };
    assert_eq!((&ours["name"], &ours["beside"]), (&"ball".into(), &Value::Null));
    assert_eq!(paper["name"], "ball, preset paper");
    assert_eq!((&paper["secondary"], &paper["cells_per_pass"]), (&"grid".into(), &1.into()));
    assert_ne!(ours["pixels"], paper["pixels"]);
    let beside = &paper["beside"];
    assert_eq!(beside["name"], "ball");
    let number = |key: &str| beside[key].as_f64().unwrap_or_else(|| panic!("{key}: {beside}"));
    assert!(number("trace_ratio") > 0.0 && number("build_ratio") > 0.0, "{beside}");
    assert!(number("flip") > 0.0 && number("flip") < 0.2, "{beside}");
    assert!(number("differing") > 0.01 && number("differing") < 1.0, "{beside}");
    for title in ["trace ×", "build ×", "FLIP", "pixels differ"] {
        assert!(ran.stdout.contains(title), "{title}: {}", ran.stdout);
    }
    run_in(folder.path(), &["bench", "ball.ply", "--preset", "papr"])
        .fails_with(2, &["--preset papr", "\"paper\""]);
    run_in(folder.path(), &["check", "ball.ply", "--preset", "paper"]).succeeds();
}

fn filled(folder: &Folder, cache: &Path) -> Ran {
    let mut command = pointillist();
    command.env("XDG_CACHE_HOME", cache).env_remove("POINTILLIST_MODELS");
    let arguments = ["bench", "suite.toml", "--json", "b.json"];
    Ran::of(command.current_dir(folder.path()).args(arguments).args(QUICK)).succeeds()
}

#[test]
fn a_model_is_filled_once_and_kept_where_it_can_be() {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(800));
    folder.write(
        "ball.toml",
        "[[objects]]\npoints = 'models/ball-filled.ply'\nmaterial = { kind = 'glass', ior = 1.1 }\n\
         [objects.volume]\nscalar = 'density'\nboundary = 'boundary'\n\
         transfer = [{ value = 0.0, color = [1, 1, 1], extinction = 1.0 }]\n",
    );
    folder.write(
        "suite.toml",
        "about = 'a volume'\n[[rows]]\nname = 'ball'\nscene = 'ball.toml'\nfill = 'ball.ply'\n",
    );
    let cache = folder.path().join("cache");
    let ran = filled(&folder, &cache);
    assert!(ran.stderr.contains("ball.ply: filled, and kept as"), "{}", ran.stderr);
    let first = report(&folder)["rows"][0].clone();
    assert_eq!(first["points"], 40_800);
    let names = || -> Vec<_> {
        let entries = std::fs::read_dir(cache.join("pointillist")).expect("the cache");
        entries.map(|entry| entry.expect("an entry").file_name()).collect()
    };
    assert_eq!(names().len(), 1, "whole, and nothing beside it: {:?}", names());
    let ran = filled(&folder, &cache);
    assert!(!ran.stderr.contains("filled"), "made once: {}", ran.stderr);

    // A file that was cut off, as by a full disk, or changed is made anew.
    let file = cache.join("pointillist").join(&names()[0]);
    let whole = std::fs::read(&file).expect("the filled model");
    let mut changed = whole.clone();
    changed[whole.len() / 2] ^= 1;
    for damaged in [&whole[..whole.len() / 2], &changed, &[]] {
        std::fs::write(&file, damaged).expect("the cache can be written to");
        let ran = filled(&folder, &cache);
        assert!(ran.stderr.contains("damaged"), "{}", ran.stderr);
        assert!(std::fs::read(&file).expect("the filled model") == whole);
    }

    // Another model is another file.
    folder.write("ball.ply", &sphere(801));
    filled(&folder, &cache);
    assert_eq!((names().len(), &report(&folder)["rows"][0]["points"]), (2, &40_801.into()));

    // A file stands where the folder should.
    let taken = folder.write("taken", "");
    let ran = filled(&folder, &taken);
    assert!(ran.stderr.contains("for this run only"), "{}", ran.stderr);
    assert!(ran.stderr.contains("XDG_CACHE_HOME"), "{}", ran.stderr);
    assert_eq!(report(&folder)["rows"][0]["points"], 40_801);

    std::fs::remove_file(folder.path().join("ball.ply")).expect("a file");
    let ran = filled(&folder, &cache);
    assert!(ran.stderr.contains("skipped 'ball'"), "{}", ran.stderr);
}
