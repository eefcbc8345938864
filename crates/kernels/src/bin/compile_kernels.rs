//! Regenerates `crates/kernels/spirv/` from `glsl/`.
#![forbid(unsafe_code)]

use kernels::{compile, source, spirv};
use std::process::ExitCode;

fn main() -> ExitCode {
    let mut failed = false;
    for name in spirv::NAMES {
        let path = source::spirv_folder().join(format!("{name}.spv"));
        let written = compile::compile(name)
            .and_then(|bytes| std::fs::write(&path, bytes).map_err(|e| e.to_string()));
        failed |= report(name, written);
    }
    let manifest = compile::manifest().and_then(|text| {
        std::fs::write(source::spirv_folder().join("manifest.txt"), text).map_err(|e| e.to_string())
    });
    failed |= report("manifest.txt", manifest);
    if failed { ExitCode::FAILURE } else { ExitCode::SUCCESS }
}

/// Prints what went wrong; says whether anything did.
#[expect(clippy::print_stderr, reason = "a developer's tool reports on its terminal")]
fn report(what: &str, result: Result<(), String>) -> bool {
    if let Err(error) = &result {
        eprintln!("{what}: {error}");
    }
    result.is_err()
}
