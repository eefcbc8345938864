//! One module a command.

mod bench;
mod check;
mod compare;
mod compare_report;
mod devices;
pub mod fill;
mod info;
mod info_picture;
mod render;

use crate::args::{Arguments, Command, SchemaArgs};
use crate::bench::report;
use crate::errors::{Exit, Failure};
use crate::{console, source};

/// Does what was asked for.
pub fn run(arguments: &mut Arguments) -> Result<Exit, Failure> {
    match &mut arguments.command {
        Command::Render(args) => {
            args.scene = args.source.resolve(&args.scene)?;
            render::run(args)?;
        }
        Command::Bench(args) => return bench::run(args),
        Command::Info(args) => {
            args.file = source::resolve(&args.file, None, args.input_format.as_deref())?;
            info::run(args)?;
        }
        Command::Check(args) => {
            args.scene = args.source.resolve(&args.scene)?;
            check::run(args)?;
        }
        Command::Schema(args) => console::result(&format!("{:#}\n", schema(args)))?,
        Command::Fill(args) => {
            args.input = source::resolve(&args.input, None, None)?;
            fill::run(args)?;
        }
        Command::Devices => devices::run()?,
        Command::Compare(args) => return compare::run(args),
    }
    Ok(Exit::Done)
}

fn schema(args: &SchemaArgs) -> serde_json::Value {
    match (args.bench, args.suite) {
        (true, _) => report::json_schema(),
        (_, true) => scene::suite_json_schema(),
        _ => scene::json_schema(),
    }
}
