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

/// The text of a module's kernel and of every file it includes, directly or not, by file name.
///
/// # Errors
/// A file that is missing or cannot be read, by its path.
pub fn with_includes(module: &str) -> Result<BTreeMap<String, String>, String> {
    let (kernel, _) = crate::spirv::source_of(module);
    let folder = glsl_folder();
    let file = format!("{kernel}.comp");
    let mut found = BTreeMap::new();
    let mut pending = vec![(file.clone(), folder.join("kernels").join(file))];
    while let Some((name, path)) = pending.pop() {
        let text = std::fs::read_to_string(&path)
            .map_err(|e| format!("{}: cannot read: {e}", path.display()))?;
        for included in text.lines().filter_map(included_file) {
            if !found.contains_key(included) {
                pending.push((included.to_owned(), folder.join("shared").join(included)));
            }
        }
        found.insert(name, text);
    }
    Ok(found)
}

fn included_file(line: &str) -> Option<&str> {
    line.trim_start().strip_prefix("#include \"")?.split('"').next()
}

/// SHA-256 over a module's macros and the names and texts of its kernel and includes, in hexadecimal.
///
/// # Errors
/// As [`with_includes`].
#[cfg(any(test, feature = "compile"))]
pub fn hash(module: &str) -> Result<String, String> {
    use sha2::Digest;
    let mut hasher = sha2::Sha256::new();
    hasher.update(crate::spirv::source_of(module).1.join(",").as_bytes());
    for (name, text) in with_includes(module)? {
        hasher.update(name.as_bytes());
        hasher.update([0]);
        hasher.update(text.as_bytes());
        hasher.update([0]);
    }
    Ok(hasher.finalize().iter().map(|byte| format!("{byte:02x}")).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The manifest has one line a kernel: its name and the hash of its source.
    #[test]
    fn spirv_is_up_to_date() {
        let path = spirv_folder().join("manifest.txt");
        let manifest = std::fs::read_to_string(&path).expect("spirv/manifest.txt");
        let mut listed: Vec<&str> = Vec::new();
        for line in manifest.lines().filter(|line| !line.starts_with('#')) {
            let (name, expected) = line.split_once(' ').expect("name and hash");
            let actual = hash(name).expect("source of a kernel in the manifest");
            assert_eq!(
                actual, expected,
                "{name}.spv is older than its source; mend it with\n    cargo run --release \
                 -p pointillist-kernels --features compile --bin compile-kernels"
            );
            listed.push(name);
        }
        assert_eq!(listed, crate::spirv::NAMES, "kernels of the manifest and of spirv.rs");
    }

    #[test]
    fn every_kernel_file_is_listed() {
        let folder = glsl_folder().join("kernels");
        let mut stems: Vec<String> = std::fs::read_dir(folder)
            .expect("glsl/kernels")
            .map(|entry| entry.expect("entry").path())
            .map(|path| path.file_stem().expect("stem").to_string_lossy().into_owned())
            .collect();
        stems.extend(crate::spirv::VARIANTS.iter().map(|variant| variant.0.to_owned()));
        stems.sort();
        assert_eq!(stems, crate::spirv::NAMES);
    }
}
