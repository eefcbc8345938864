//! `fill`: a volume of points inside a surface.

use crate::args::FillArgs;
use crate::errors::Failure;
use crate::input;
use crate::progress::Progress;
use crate::source::PIPE;
use crate::{files, interrupt, memory};
use points::fill::NotFilled;
use points::{PlyPoints, ReadOptions};
use serde_json::json;
use std::path::Path;

/// Fills, and writes the file.
pub fn run(args: &FillArgs) -> Result<(), Failure> {
    if args.output == Path::new(PIPE) {
        return Err(Failure::usage(
            "-: fill writes a file, not to stdout; name one that ends in .ply",
        ));
    }
    if input::is_scene_file(&args.input) {
        return Err(Failure::usage(format!(
            "{}: found a scene, expected a point file of a surface; name the file that it shows",
            args.input.display()
        )));
    }
    let is_ply = args.output.extension().is_some_and(|it| it.eq_ignore_ascii_case("ply"));
    if !is_ply {
        return Err(Failure::usage(format!(
            "{}: expected the extension '.ply', the format that fill writes; rename the output",
            args.output.display()
        )));
    }
    files::check_output(&args.output)?;
    files::check_distinct(&[&args.output], &[&args.input])?;
    let progress = Progress::new(&args.progress);
    let columns = args.columns.clone().unwrap_or_default();
    let options = ReadOptions { columns, ..ReadOptions::default() };
    let set = input::read_file(&args.input, &options, &progress)?;
    let surface = set.len();
    let filled = filled(&args.input, &set.positions, args.count, args.reach, &progress)?;
    drop(set);
    write(&args.output, &encoded(&filled))?;
    progress.result(
        &format!(
            "{}: {surface} points, and {} inside -> {}",
            args.input.display(),
            args.count,
            args.output.display()
        ),
        json!({ "outputs": [args.output.display().to_string()] }),
    );
    Ok(())
}

/// Points of a surface, and so many inside. `file` names them in messages.
pub fn filled(
    file: &Path,
    surface: &[[f64; 3]],
    count: u32,
    reach: f64,
    progress: &Progress,
) -> Result<PlyPoints, Failure> {
    memory::require_points(surface.len() as u64 + u64::from(count), progress)?;
    let filled = interrupt::held(|| {
        points::fill::filled(surface, count, reach, progress).map_err(|error| match error {
            NotFilled::Interrupted => Failure::interrupted(),
            NotFilled::NoInside => Failure::usage(format!(
                "{}: found no inside, expected points that enclose one; raise --reach where their surface has \
                 wide holes",
                file.display()
            )),
        })
    });
    progress.clear();
    filled
}

/// The bytes of the file.
pub fn encoded(filled: &PlyPoints) -> Vec<u8> {
    points::encode_ply("pointillist fill", filled)
}

/// Writes the file, whole or not at all.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    interrupt::writing(|| Ok(film::store(path, bytes)?))
}
