//! The accumulated picture and the files it is written to.
//!
//! A [`Film`] is what a render ends with. [`write`] turns it into an EXR with every channel, or
//! into a PNG or JPEG of the colours alone. The same film gives the same bytes, whatever the number
//! of threads and whenever it is written (`two_writes_are_equal_to_the_byte`), and a file is either
//! written whole or not at all: see [`store()`].
#![forbid(unsafe_code)]

mod eight_bit;
mod error;
mod exr_read;
mod exr_write;
mod image_read;
mod picture;
mod srgb;
mod store;
mod tone;

pub use error::FilmError;
pub use exr_read::{ExrPicture, read_exr};
pub use image_read::{Image, Texels, read_image};
pub use picture::{Film, Provenance, Window};
pub use srgb::{linear_from_srgb, srgb_byte};
pub use store::store;
pub use tone::{Tone, ToneCurve};

use std::ffi::OsStr;
use std::path::Path;

/// What a film can be written as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FileFormat {
    /// OpenEXR: every channel in 32-bit float, with the camera and the settings in the header.
    Exr,
    /// PNG: the colours in 8-bit sRGB, with alpha if the film is transparent.
    Png,
    /// JPEG: the colours in 8-bit sRGB, quality 95, over black if the film is transparent.
    Jpeg,
}

impl FileFormat {
    /// The format that the extension of `path` asks for, in either case: `.exr`, `.png`, `.jpg` or
    /// `.jpeg`.
    ///
    /// # Errors
    /// [`FilmError::UnknownFormat`] for any other extension, or none.
    pub fn from_path(path: &Path) -> Result<Self, FilmError> {
        let found = path.extension().unwrap_or(OsStr::new("")).to_string_lossy();
        match found.to_ascii_lowercase().as_str() {
            "exr" => Ok(Self::Exr),
            "png" => Ok(Self::Png),
            "jpg" | "jpeg" => Ok(Self::Jpeg),
            _ => Err(FilmError::UnknownFormat { path: path.into(), found: found.into_owned() }),
        }
    }
}

/// Writes a film in the format that the extension of `path` asks for.
///
/// The data window alone has pixels. An EXR places it in the full image; a PNG or JPEG is of its
/// size, not of the full image's. An existing file is replaced; through a link, the file that the
/// link names.
///
/// # Panics
/// If the lengths of the film's planes are not those of its window, if the window leaves the image,
/// or if two planes have one name: see [`Film`].
///
/// # Errors
/// An unknown extension, a folder that is missing or cannot be written to, a full disk
/// ([`FilmError::is_out_of_space`]), or a picture that the format cannot hold. Nothing is left
/// behind then, and a file that was there before is as it was.
pub fn write(film: &Film, provenance: &Provenance, path: &Path) -> Result<(), FilmError> {
    write_toned(film, provenance, Tone::default(), path)
}

/// As [`write()`], with a tone for PNG and JPEG; an EXR has the numbers as they are.
///
/// # Panics
/// As [`write()`].
///
/// # Errors
/// As [`write()`].
pub fn write_toned(
    film: &Film,
    provenance: &Provenance,
    tone: Tone,
    path: &Path,
) -> Result<(), FilmError> {
    film.assert_consistent();
    let bytes = match FileFormat::from_path(path)? {
        FileFormat::Exr => exr_write::encode(film, provenance, path)?,
        FileFormat::Png => eight_bit::png(film, tone, path)?,
        FileFormat::Jpeg => eight_bit::jpeg(film, tone, path)?,
    };
    store(path, &bytes)
}

#[cfg(test)]
mod image_read_tests;
#[cfg(test)]
mod tests;
