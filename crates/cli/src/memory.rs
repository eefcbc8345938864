//! Whether the machine has the memory for what is about to be done.
//!
//! An allocation that fails ends a Rust process with SIGABRT, and where the system promises more than
//! it has, with SIGKILL. So the large amounts are asked about beforehand, by a lower estimate: what
//! is refused here could not have been finished.

use crate::errors::Failure;
use film::FileFormat;
use plan::Window;
use std::fs;
use std::path::Path;

/// Twelve planes of f32: the film. While an EXR is encoded, there are two of each plane.
const FILM_PIXEL: u64 = 48;
/// World position, centred point, sort key, order, polynomial, cell lists.
const POINT: u64 = 160;

/// Fails where a picture of this window with so many further channels does not fit.
pub fn require_picture(
    window: Window,
    outputs: &[FileFormat],
    added: usize,
) -> Result<(), Failure> {
    let film = FILM_PIXEL + size_of::<f32>() as u64 * added as u64;
    let copies = if outputs.contains(&FileFormat::Exr) { 2 } else { 1 };
    let [width, height] = window.size;
    let bytes = copies * film * u64::from(width) * u64::from(height);
    require(
        bytes,
        &format!("a picture of {width}x{height} pixels"),
        "render it in parts with --crop",
    )
}

/// Fails where the surfaces of this many points do not fit.
pub fn require_points(count: u64) -> Result<(), Failure> {
    require(count.saturating_mul(POINT), &format!("{count} points"), "thin the point sets")
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

fn require(bytes: u64, what: &str, help: &str) -> Result<(), Failure> {
    let lacking = |available: String| {
        Failure::exhausted(format!(
            "{what} needs at least {bytes} bytes of memory, {available}; {help}"
        ))
    };
    if let Some(available) = available().filter(|&available| bytes > available) {
        return Err(lacking(format!("but {available} are available")));
    }
    // Limits of the process show in an allocation, which costs nothing until it is written to.
    let mut trial: Vec<u8> = Vec::new();
    match usize::try_from(bytes).map(|bytes| trial.try_reserve_exact(bytes)) {
        Ok(Ok(())) => Ok(()),
        _ => Err(lacking("which this process may not have".to_owned())),
    }
}

/// Bytes that the system could give without swapping, where it says.
fn available() -> Option<u64> {
    let info = fs::read_to_string("/proc/meminfo").ok()?;
    let line = info.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes * 1024)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::errors::Exit;

    #[test]
    fn more_than_any_machine_has_is_refused_with_the_way_out() {
        let failure = require_points(u64::MAX / 200).expect_err("too many");
        assert_eq!(failure.exit, Exit::Exhausted);
        assert!(failure.lines[0].contains("thin the point sets"), "{failure:?}");
        assert!(require_points(1000).is_ok());
        let window = Window { origin: [0, 0], size: [64, 64] };
        assert!(require_picture(window, &[FileFormat::Exr], 6).is_ok());
    }
}
