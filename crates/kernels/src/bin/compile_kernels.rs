//! Regenerates `crates/kernels/spirv/` and `glsl/stages/` from `glsl/` and the stages in `src/layout/`: what is older than its source.
#![forbid(unsafe_code)]

use kernels::layout::STAGES;
use kernels::{compile, glsl, source, spirv};
use std::collections::BTreeMap;
use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let mut failed = false;
    for stage in STAGES {
        let path = source::glsl_folder().join(format!("stages/{}.glsl", stage.name));
        failed |= report(stage.name, write_changed(&path, glsl::stage_text(stage).as_bytes()));
    }
    let manifest = source::spirv_folder().join("manifest.txt");
    let listed = std::fs::read_to_string(&manifest).unwrap_or_default();
    let same_compiler = listed.lines().next() == Some(&compile::first_line());
    let listed: BTreeMap<&str, &str> =
        listed.lines().filter_map(|line| line.split_once(' ')).collect();
    for (name, module) in spirv::modules() {
        let path = source::spirv_folder().join(format!("{name}.spv"));
        let is_new = source::hash(module)
            .is_ok_and(|hash| listed.get(name.as_str()) == Some(&hash.as_str()));
        if same_compiler && is_new && path.exists() {
            continue;
        }
        let written = compile::compile(module).and_then(|bytes| write_changed(&path, &bytes));
        failed |= report(name, written);
    }
    let files = std::fs::read_dir(source::spirv_folder()).into_iter().flatten().flatten();
    for path in files
        .map(|entry| entry.path())
        .filter(|path| path.extension().is_some_and(|end| end == "spv"))
    {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        if !spirv::modules().contains_key(&*stem) {
            failed |= report(&stem, std::fs::remove_file(&path).map_err(|e| e.to_string()));
        }
    }
    if !failed {
        let written =
            compile::manifest().and_then(|text| write_changed(&manifest, text.as_bytes()));
        failed = report("manifest.txt", written);
    }
    if failed { ExitCode::FAILURE } else { ExitCode::SUCCESS }
}

/// Writes a file unless it has these bytes.
fn write_changed(path: &Path, bytes: &[u8]) -> Result<(), String> {
    if std::fs::read(path).is_ok_and(|found| found == bytes) {
        return Ok(());
    }
    let folder = path.parent().unwrap_or(path);
    std::fs::create_dir_all(folder)
        .and_then(|()| std::fs::write(path, bytes))
        .map_err(|e| e.to_string())
}

/// Prints what went wrong; says whether anything did.
#[expect(clippy::print_stderr, reason = "a developer's tool reports on its terminal")]
fn report(what: &str, result: Result<(), String>) -> bool {
    if let Err(error) = &result {
        eprintln!("{what}: {error}");
    }
    result.is_err()
}
