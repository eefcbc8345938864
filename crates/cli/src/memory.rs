//! Whether the machine has the memory for what is about to be done.
//!
//! An allocation that fails ends the process ([`ending`](crate::ending)), and where the system promises more than it
//! has, the system ends it with SIGKILL. So the large amounts are asked about beforehand, by a lower estimate: what is
//! refused here could not have been finished.

use crate::errors::Failure;
use crate::limits::{self, Limit};
use crate::progress::Progress;
use crate::threads;
use film::FileFormat;
use gpu::process::fallible;
use plan::Window;
use serde_json::json;
use std::path::Path;

/// Twelve planes of f32: the film. While an EXR is encoded, there are two of each plane.
const FILM_PIXEL: u64 = 48;
/// World position, centred point, sort key, order, polynomial, cell lists.
const POINT: u64 = 160;

const MIB: u64 = 1 << 20;
/// From here on, or from a quarter of what is free, a line says what the work needs.
const MUCH: u64 = 1 << 30;
/// What a driver takes, with a fifth more than was measured: see [`require_driver`].
const DRIVER_ADDRESSES: u64 = 400 * MIB;
const DRIVER_THREAD_ADDRESSES: u64 = 20 * MIB;
const DRIVER_DATA: u64 = 150 * MIB;
const DRIVER_THREAD_DATA: u64 = 4 * MIB;
const DRIVER_MEMORY: u64 = 160 * MIB;
/// Address space that a point takes beside the driver, at the most: while noise is smoothed, 240 were measured.
const POINT_BESIDE: u64 = 320;
/// Bytes that a point has in files of these extensions, at the least; of any other, [`BYTES_OF_POINT`].
const BYTES_OF_POINT_IN: [(&[&str], u64); 3] = [
    (&["laz", "gz", "npz", "e57"], 4),
    (&["xyz", "txt", "asc", "csv", "tsv", "dat", "pts", "ptx", "obj", "off"], 20),
    (&["las"], 20),
];
const BYTES_OF_POINT: u64 = 12;
/// Mesa starts no more.
const MOST_DRIVER_THREADS: usize = 32;

/// Bytes of a picture of this window with so many further channels. Fails where it does not fit, and says of a large one
/// what it takes.
pub fn require_picture(
    window: Window,
    outputs: &[FileFormat],
    added: usize,
    progress: &Progress,
) -> Result<u64, Failure> {
    let film = FILM_PIXEL + size_of::<f32>() as u64 * added as u64;
    let copies = if outputs.contains(&FileFormat::Exr) { 2 } else { 1 };
    let [width, height] = window.size;
    let bytes = copies * film * u64::from(width) * u64::from(height);
    let what = format!("a picture of {width}x{height} pixels");
    require(bytes, &what, "render it in parts with --crop, or raise the limit")?;
    forecast(bytes, &what, progress);
    Ok(bytes)
}

/// What the points of some files take beside a driver, about, by the sizes of the files.
pub fn of_point_files<'a>(files: impl Iterator<Item = &'a Path>) -> u64 {
    let of_file = |file: &Path| {
        let size = std::fs::metadata(file).map_or(0, |found| found.len());
        let extension = file.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        let known = BYTES_OF_POINT_IN.iter().find(|(all, _)| all.contains(&extension.as_str()));
        (size / known.map_or(BYTES_OF_POINT, |known| known.1)).saturating_mul(POINT_BESIDE)
    };
    files.map(of_file).fold(0, u64::saturating_add)
}

/// Fails where the surfaces of this many points do not fit, and says of many what they take.
pub fn require_points(count: u64, progress: &Progress) -> Result<(), Failure> {
    let bytes = count.saturating_mul(POINT);
    let what = format!("{count} points");
    require(bytes, &what, "thin the point sets, or raise the limit")?;
    forecast(bytes, &what, progress);
    Ok(())
}

/// Says what is needed, where that is much.
fn forecast(bytes: u64, what: &str, progress: &Progress) {
    let Some(room) = limits::rooms().into_iter().min_by_key(|room| room.free) else { return };
    if bytes < MUCH && bytes < room.free / 4 {
        return;
    }
    let in_gigabytes = |bytes: u64| format!("{:.1} GB", bytes as f64 * 1e-9);
    progress.forecast(
        &format!(
            "at least {} of memory for {what}; {} {} are free",
            in_gigabytes(bytes),
            in_gigabytes(room.free),
            room.limit
        ),
        json!({ "bytes": bytes, "bytes_free": room.free }),
    );
}

/// Fails where the pixels of these pictures do not fit, so far as their headers tell.
pub fn require_pictures(paths: &[&Path]) -> Result<(), Failure> {
    let mut bytes: u64 = 0;
    for path in paths {
        if film::is_exr(path)? {
            bytes = bytes.saturating_add(film::exr_pixel_bytes(path)?);
        }
    }
    let names: Vec<String> = paths.iter().map(|path| path.display().to_string()).collect();
    require(bytes, &names.join(" with "), "use a machine with more memory, or crop the pictures")
}

/// Says why a Vulkan driver does not fit, of which some crash where memory runs out. `beside` is what the work takes, about:
/// a limit that the user has set has to hold both, so that the CPU does what it has the room for. What the machine
/// and its groups have is not divided by a guess.
///
/// Measured with lavapipe (Mesa 22.3, LLVM 15) in a render of 64x48 pixels on two cores, with one heap for all threads,
/// as processes with a limit have it: 356 MiB of address space, 16 MiB of which for each thread of the driver; 135 MiB
/// in memory; 134 MiB of data.
pub fn require_driver(beside: u64) -> Result<(), String> {
    let threads = threads::count().min(MOST_DRIVER_THREADS) as u64;
    for room in limits::rooms() {
        let needed = match room.limit {
            Limit::AddressSpace => {
                (DRIVER_ADDRESSES + threads * DRIVER_THREAD_ADDRESSES).saturating_add(beside)
            }
            Limit::Data => (DRIVER_DATA + threads * DRIVER_THREAD_DATA).saturating_add(beside),
            Limit::Machine | Limit::Group => DRIVER_MEMORY,
        };
        if needed > room.free {
            let work = if needed > DRIVER_MEMORY && beside > 0 {
                " with the points and the picture"
            } else {
                ""
            };
            return Err(format!(
                "a Vulkan driver{work} needs about {needed} bytes, but {} bytes {} are free",
                room.free, room.limit
            ));
        }
    }
    Ok(())
}

fn require(bytes: u64, what: &str, help: &str) -> Result<(), Failure> {
    let lacking = |available: String| {
        Failure::exhausted(format!(
            "no room for {what}: at least {bytes} bytes are needed, {available}; {help}"
        ))
    };
    if let Some(room) = limits::rooms().into_iter().find(|room| bytes > room.free) {
        return Err(lacking(format!("but {} bytes {} are free", room.free, room.limit)));
    }
    // Limits of the process show in an allocation, which costs nothing until it is written to.
    let mut trial: Vec<u8> = Vec::new();
    let bytes = usize::try_from(bytes);
    match bytes.map(|bytes| fallible(|| trial.try_reserve_exact(bytes))) {
        Ok(Ok(())) => Ok(()),
        _ => Err(lacking("which this process may not have".to_owned())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::errors::Exit;

    #[test]
    fn more_than_any_machine_has_is_refused_with_the_way_out() {
        let failure = require(u64::MAX / 2, "x", "thin the point sets").expect_err("too many");
        assert_eq!(failure.exit, Exit::Exhausted);
        assert!(failure.lines[0].contains("thin the point sets"), "{failure:?}");
        assert!(require(1000, "x", "").is_ok());
    }
}
