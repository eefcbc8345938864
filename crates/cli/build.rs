//! Tells the binary which commit it was built from, where git knows.

use std::process::Command;

fn main() {
    // HEAD's log grows with every commit, checkout and reset; HEAD alone only names a branch.
    for watched in ["HEAD", "logs/HEAD"] {
        if let Some(path) = git(&["rev-parse", "--path-format=absolute", "--git-path", watched]) {
            emit(&format!("rerun-if-changed={path}"));
        }
    }
    emit("rerun-if-changed=build.rs");
    if let Some(commit) = git(&["rev-parse", "--short=12", "HEAD"]) {
        emit(&format!("rustc-env=POINTILLIST_COMMIT={commit}"));
    }
}

fn emit(line: &str) {
    println!("cargo::{line}");
}

/// What git prints, or nothing without git or outside of a repository.
fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    let line = text.trim();
    (output.status.success() && !line.is_empty()).then(|| line.to_owned())
}
