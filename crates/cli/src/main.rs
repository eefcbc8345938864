//! The `pointillist` binary: the only place that prints or exits.
//!
//! [`args`] says what may be typed, `commands` has one module a command, [`errors`] maps whatever
//! goes wrong to one of the documented exit codes, and [`console`] is the only module that writes to
//! stdout or stderr, but for the bars of [`progress`].
#![forbid(unsafe_code)]

mod ahead;
mod args;
mod bench;
mod camera;
mod commands;
mod console;
mod engine;
mod errors;
mod files;
mod input;
mod interrupt;
mod legend;
mod memory;
mod point_file;
mod progress;
mod provenance;
mod stats;

use errors::{Exit, Failure};
use std::process::ExitCode;

fn main() -> ExitCode {
    console::announce_panics();
    let finished = std::panic::catch_unwind(|| interrupt::install().and_then(|()| run()));
    let exit = match finished {
        Ok(Ok(exit)) => exit,
        Ok(Err(failure)) => {
            console::errors(&failure);
            failure.exit
        }
        // The hook has said what happened.
        Err(_) => Exit::Exhausted,
    };
    ExitCode::from(exit.code())
}

fn run() -> Result<Exit, Failure> {
    match args::parse() {
        Ok(arguments) => commands::run(&arguments),
        // Also how clap answers --help and --version, which are no errors.
        Err(answer) => Ok(console::clap_answer(&answer)),
    }
}
