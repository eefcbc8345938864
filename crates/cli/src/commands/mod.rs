//! One module a command.

mod bench;
mod check;
mod compare;
mod compare_report;
mod devices;
mod info;
mod info_picture;
mod render;

use crate::args::{Arguments, Command};
use crate::console;
use crate::errors::{Exit, Failure};

/// Does what was asked for.
pub fn run(arguments: &Arguments) -> Result<Exit, Failure> {
    match &arguments.command {
        Command::Render(args) => render::run(args)?,
        Command::Bench(args) => bench::run(args)?,
        Command::Info(args) => info::run(args)?,
        Command::Check(args) => check::run(args)?,
        Command::Schema => console::result(&format!("{:#}\n", scene::json_schema()))?,
        Command::Devices => devices::run()?,
        Command::Compare(args) => return compare::run(args),
    }
    Ok(Exit::Done)
}
