//! The GLSL sources: where they lie, and what each kernel includes.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The folder `glsl/` of the checkout that this crate was built in.
#[must_use]
pub fn glsl_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../glsl")
}

/// The folder of the committed modules and their manifest.
#[must_use]
pub fn spirv_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("spirv")
}

/// The text of a kernel's source and of every file it includes, directly or not, by the name it is included by.
///
/// # Errors
/// A file that is missing or cannot be read, by its path.
pub fn with_includes(kernel: &str) -> Result<BTreeMap<String, String>, String> {
    let folder = glsl_folder();
    let file = format!("{kernel}.comp");
    let mut found = BTreeMap::new();
    let mut pending = vec![(file.clone(), folder.join("kernels").join(file))];
    while let Some((name, path)) = pending.pop() {
        let text = std::fs::read_to_string(&path)
            .map_err(|e| format!("{}: cannot read: {e}", path.display()))?;
        for included in text.lines().filter_map(included_file) {
            if !found.contains_key(included) {
                let inside = if included.starts_with("stages/") { "." } else { "shared" };
                pending.push((included.to_owned(), folder.join(inside).join(included)));
            }
        }
        found.insert(name, text);
    }
    Ok(found)
}

fn included_file(line: &str) -> Option<&str> {
    line.trim_start().strip_prefix("#include \"")?.split('"').next()
}

/// A line without its comment and the space around it: what a compiler makes of it is the same.
#[cfg(any(test, feature = "compile"))]
fn code(line: &str) -> &str {
    line.split("//").next().unwrap_or_default().trim()
}

/// SHA-256 over a module's macros and the names and texts of its kernel and includes, without comments and blank lines,
/// in hexadecimal.
///
/// # Errors
/// As [`with_includes`].
#[cfg(any(test, feature = "compile"))]
pub fn hash(module: &crate::spirv::Module) -> Result<String, String> {
    use sha2::Digest;
    let mut hasher = sha2::Sha256::new();
    hasher.update(module.macros().join(",").as_bytes());
    for (name, text) in with_includes(module.kernel())? {
        hasher.update(name.as_bytes());
        hasher.update([0]);
        for line in text.lines().map(code).filter(|line| !line.is_empty()) {
            hasher.update(line.as_bytes());
            hasher.update([b'\n']);
        }
        hasher.update([0]);
    }
    Ok(hasher.finalize().iter().map(|byte| format!("{byte:02x}")).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spirv::{KERNELS, modules};

    /// The manifest has one line a module: its name and the hash of its source.
    #[test]
    fn spirv_is_up_to_date() {
        let path = spirv_folder().join("manifest.txt");
        let manifest = std::fs::read_to_string(&path).expect("spirv/manifest.txt");
        let mut listed: Vec<&str> = Vec::new();
        for line in manifest.lines().filter(|line| !line.starts_with('#')) {
            let (name, expected) = line.split_once(' ').expect("name and hash");
            let module = modules().get(name).expect("a module of the table");
            let actual = hash(module).expect("source of a kernel in the manifest");
            assert_eq!(
                actual, expected,
                "{name}.spv is older than its source; mend it with\n    cargo run --release \
                 -p pointillist-kernels --features compile --bin compile-kernels"
            );
            listed.push(name);
        }
        let modules: Vec<&str> = modules().keys().map(String::as_str).collect();
        assert_eq!(listed, modules, "modules of the manifest and of spirv.rs");
    }

    #[test]
    fn every_kernel_file_is_listed() {
        let folder = glsl_folder().join("kernels");
        let mut stems: Vec<String> = std::fs::read_dir(folder)
            .expect("glsl/kernels")
            .map(|entry| entry.expect("entry").path())
            .map(|path| path.file_stem().expect("stem").to_string_lossy().into_owned())
            .collect();
        stems.sort();
        let listed: Vec<&str> = KERNELS.iter().map(|kernel| kernel.name).collect();
        assert_eq!(stems, listed);
    }

    #[test]
    fn a_changed_comment_is_no_change() {
        assert_eq!(code("    vec3 x = y; // because"), "vec3 x = y;");
        assert_eq!(code("// nothing else"), "");
    }
}
