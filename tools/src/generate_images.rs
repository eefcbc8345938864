//! `generate-images`: writes the pictures that scenes need into a folder.
#![forbid(unsafe_code)]

use clap::Parser;
use pointillist_tools::{files, scenery};
use std::io::{self, Write};
use std::path::PathBuf;
use std::process::ExitCode;

/// Write the images of the scenes: sky.hdr, an environment; dunes.png and tiles.png, textures.
#[derive(Debug, Parser)]
#[command(version)]
struct Arguments {
    /// The folder to write them to.
    #[arg(value_name = "FOLDER")]
    folder: PathBuf,
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            // Where stderr is closed, there is nobody to tell.
            let _ = writeln!(io::stderr(), "error: {error}");
            ExitCode::from(2)
        }
    }
}

fn run(arguments: &Arguments) -> Result<(), Box<dyn std::error::Error>> {
    let write = |name: &str, bytes: Vec<u8>| files::write(&arguments.folder.join(name), &bytes);
    write("sky.hdr", scenery::sky().hdr()?)?;
    write("dunes.png", scenery::dunes_map().png()?)?;
    write("tiles.png", scenery::tiles().png()?)?;
    Ok(())
}
