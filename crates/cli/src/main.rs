//! The `pointillist` binary: the only place that prints or exits.
//!
//! [`args`] says what may be typed, `commands` has one module a command, [`errors`] maps whatever
//! goes wrong to one of the documented exit codes, and [`console`] is the only module that writes to
//! stdout or stderr, but for the bars of [`progress`].
#![forbid(unsafe_code)]

mod again;
mod ahead;
mod args;
mod bench;
mod camera;
mod commands;
mod console;
mod ending;
mod engine;
mod errors;
mod files;
mod input;
mod interrupt;
mod legend;
mod limits;
mod log;
mod memory;
mod point_file;
mod progress;
mod provenance;
mod source;
mod stats;
mod temporary;
mod threads;

use errors::{Exit, Failure};
use std::process::ExitCode;

/// Ends the process in good order where there is no memory.
#[global_allocator]
static ALLOCATOR: gpu::process::Allocator = gpu::process::Allocator;

fn main() -> ExitCode {
    log::follow(std::env::args_os());
    ending::prepare();
    console::announce_panics();
    let finished = std::panic::catch_unwind(run);
    let exit = match finished {
        Ok(Ok(exit)) => exit,
        Ok(Err(failure)) => {
            if failure.exit != Exit::Interrupted || interrupt::is_to_be_said() {
                console::errors(&failure);
            }
            failure.exit
        }
        // The hook has said what happened.
        Err(_) => Exit::Exhausted,
    };
    temporary::remove_all();
    ExitCode::from(exit.code())
}

fn run() -> Result<Exit, Failure> {
    match args::parse() {
        Ok(mut arguments) => {
            // Before any other thread starts.
            threads::start(arguments.threads);
            interrupt::install()?;
            commands::run(&mut arguments)
        }
        // Also how clap answers --help and --version, which are no errors.
        Err(answer) => Ok(console::clap_answer(&answer)),
    }
}
