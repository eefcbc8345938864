//! `fill-points`: fills the surface of a point file with points that carry scalars.
#![forbid(unsafe_code)]

use clap::Parser;
use pointillist_tools::files;
use pointillist_tools::filling;
use pointillist_tools::ply;
use std::io::{self, Write};
use std::path::PathBuf;
use std::process::ExitCode;

/// Write a point file's points and as many as asked for inside of them, with `boundary` (1 on the surface, 0
/// inside), `depth` (0 on the surface, 1 at the deepest point) and `density` (whirls, 0 to 1), as binary PLY.
#[derive(Debug, Parser)]
#[command(version)]
struct Arguments {
    /// The points of a surface, in any format that pointillist reads
    input: PathBuf,
    /// The PLY file to write
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Points inside
    #[arg(long, value_name = "N", default_value_t = 40_000, value_parser = clap::value_parser!(u32).range(1..=10_000_000))]
    count: u32,
    /// Half the width of the widest hole that is closed, over the longest side of the box
    #[arg(long, value_name = "PART", default_value_t = 0.06)]
    reach: f64,
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
    if !(arguments.reach > 0.0 && arguments.reach <= 0.5) {
        let found = arguments.reach;
        return Err(format!("--reach: found {found}, expected more than 0 and at most 0.5").into());
    }
    let set = points::read(&arguments.input, &mut |_, _| {})?;
    let filled = filling::filled(&set.positions, arguments.count, arguments.reach).ok_or_else(|| {
        format!(
            "{}: found no inside, expected points that enclose one; raise --reach where their surface has \
             wide holes",
            arguments.input.display()
        )
    })?;
    files::write(&arguments.output, &ply::encode("fill-points", &filled))?;
    Ok(())
}
