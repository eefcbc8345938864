//! `generate-points`: writes the point sets of the scenes.
//!
//! Most sets are spread evenly over their surface by a golden-angle lattice: point i lies at the i-th
//! step of one parameter, turned by the golden angle in the other. That is even whatever the ratio of
//! the two, needs no random numbers, and gives the same points on every run. Sine and cosine come
//! from the platform, so two platforms may differ in a coordinate's last bit.
#![forbid(unsafe_code)]

use clap::Parser;
use pointillist_tools::files::{self, WriteError};
use pointillist_tools::sets::{self, Set};
use std::io::{self, Write};
use std::path::PathBuf;
use std::process::ExitCode;

/// Write a set of points, evenly spread over a surface, as binary PLY.
#[derive(Debug, Parser)]
#[command(version)]
struct Arguments {
    /// List the sets, with their usual numbers of points.
    #[arg(long)]
    list: bool,
    /// Which set.
    #[arg(value_enum, required_unless_present = "list")]
    name: Option<Set>,
    /// The PLY file to write.
    #[arg(short, long, value_name = "FILE", required_unless_present = "list")]
    output: Option<PathBuf>,
    /// How many points; each set has its usual number.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(16..=10_000_000))]
    count: Option<u32>,
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

fn run(arguments: &Arguments) -> Result<(), WriteError> {
    if arguments.list {
        let _ = io::stdout().write_all(sets::listing().as_bytes());
    }
    let (Some(set), Some(path)) = (arguments.name, &arguments.output) else { return Ok(()) };
    let count = arguments.count.unwrap_or(set.usual_count());
    files::write(path, &points::encode_ply(&set.comment(), &set.points(count)))
}
