//! Lists the committed modules, so that each of them is in the program once.

use std::fmt::Write as _;
use std::path::Path;
use std::{env, fs, io};

fn main() -> io::Result<()> {
    let folder =
        Path::new(&env::var("CARGO_MANIFEST_DIR").map_err(io::Error::other)?).join("spirv");
    let mut files: Vec<_> =
        fs::read_dir(&folder)?.map(|entry| Ok(entry?.path())).collect::<io::Result<_>>()?;
    files.sort();
    let mut list = String::from("&[\n");
    for file in files.iter().filter(|file| file.extension().is_some_and(|end| end == "spv")) {
        let stem = file.file_stem().unwrap_or_default();
        let _ = writeln!(list, "({stem:?}, include_bytes!({file:?})),");
    }
    println!("cargo:rerun-if-changed={}", folder.display());
    fs::write(
        Path::new(&env::var("OUT_DIR").map_err(io::Error::other)?).join("modules.rs"),
        list + "]\n",
    )
}
