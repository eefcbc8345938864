//! The accumulated picture and the files it is written to.
//!
//! A [`Film`] is what a render ends with. [`write`] turns it into an EXR with every channel, or
//! into a PNG or JPEG of the colours alone. The same film gives the same bytes, whatever the number
//! of threads and whenever it is written (`two_writes_are_equal_to_the_byte`), and a file is either
//! written whole or not at all: see [`store()`].
#![forbid(unsafe_code)]

mod canvas;
mod eight_bit;
mod error;
mod exposure;
mod exr_header;
mod exr_read;
mod exr_write;
mod image_read;
mod legend;
mod picture;
mod plausible;
mod raster_read;
mod srgb;
mod store;
mod tone;

pub use canvas::{Canvas, Color, Pen};
pub use error::FilmError;
pub use exposure::mid_grey_exposure;
pub use exr_header::{ExrAttribute, ExrHeader, read_exr_headers};
pub use exr_read::{
    ExrFile, ExrPart, ExrPicture, Samples, exr_pixel_bytes, exr_text, read_exr, read_exr_file,
};
pub use exr_write::HALF_MAX;
pub use image_read::{Image, Texels, read_image};
pub use legend::{ColorBar, legend};
pub use picture::{Film, Provenance, Window};
pub use raster_read::{Raster, is_exr, read_raster};
pub use srgb::{linear_from_srgb, srgb_byte};
pub use store::{remove_unfinished, remove_unfinished_at_once, store};
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

/// How a film is written, beyond what its format says.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Style {
    /// How PNG and JPEG are made of the colours; an EXR has the numbers as they are.
    pub tone: Tone,
    /// Whether R, G, B, A and N of an EXR are in 16 bits. Finite values beyond [`HALF_MAX`] become
    /// that; all other channels stay in 32 bits.
    pub half: bool,
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
    write_styled(film, provenance, Style::default(), path)
}

/// As [`write()`], with a tone for PNG and JPEG, or 16 bits in an EXR.
///
/// # Panics
/// As [`write()`].
///
/// # Errors
/// As [`write()`].
pub fn write_styled(
    film: &Film,
    provenance: &Provenance,
    style: Style,
    path: &Path,
) -> Result<(), FilmError> {
    store(path, &encode(film, provenance, style, FileFormat::from_path(path)?, path)?)
}

/// The bytes that [`write_styled`] makes a file of. `name` is for messages.
///
/// # Panics
/// As [`write()`].
///
/// # Errors
/// A picture that the format cannot hold.
pub fn encode(
    film: &Film,
    provenance: &Provenance,
    style: Style,
    format: FileFormat,
    name: &Path,
) -> Result<Vec<u8>, FilmError> {
    film.assert_consistent();
    match format {
        FileFormat::Exr => exr_write::encode(film, provenance, style.half, name),
        FileFormat::Png => eight_bit::png(film, style.tone, name),
        FileFormat::Jpeg => eight_bit::jpeg(film, style.tone, name),
    }
}

/// What a file of 8 bits shows of each pixel: R, G and B in sRGB, and alpha where the film is transparent, else 255. R, G
/// and B are not divided by alpha.
#[must_use]
pub fn shown_bytes(film: &Film, tone: Tone) -> Vec<[u8; 4]> {
    eight_bit::shown(film, tone)
}

/// How many colour values of a film are finite and beyond [`HALF_MAX`], so that [`Style::half`] changes
/// them by more than rounding.
#[must_use]
pub fn beyond_half(film: &Film) -> usize {
    exr_write::beyond_half(film)
}

/// Writes planes of 32-bit floats as an EXR: `planes` by their channel names, each row-major with the
/// pixels of the data window, of `extent` columns and rows from `origin` on, in a display window of
/// `size` from 0, 0 on.
///
/// # Panics
/// If a plane has not as many values as the data window has pixels.
///
/// # Errors
/// As [`write()`].
pub fn write_planes(
    size: [u32; 2],
    origin: [i32; 2],
    extent: [u32; 2],
    planes: Vec<(String, Vec<f32>)>,
    path: &Path,
) -> Result<(), FilmError> {
    let pixels = extent[0] as usize * extent[1] as usize;
    for (name, plane) in &planes {
        assert_eq!(plane.len(), pixels, "film: pixels of plane '{name}'");
    }
    store(path, &exr_write::encode_planes(size, origin, extent, planes, path)?)
}

/// Writes colours in 8-bit sRGB as a PNG of `size` pixels, row-major.
///
/// # Panics
/// If there are not as many colours as pixels.
///
/// # Errors
/// As [`write()`].
pub fn write_png(size: [u32; 2], pixels: &[[u8; 3]], path: &Path) -> Result<(), FilmError> {
    assert_eq!(pixels.len(), size[0] as usize * size[1] as usize, "film: pixels of a PNG");
    store(path, &eight_bit::png_of(size, png::ColorType::Rgb, pixels.as_flattened(), path)?)
}

#[cfg(test)]
mod exr_read_tests;
#[cfg(test)]
mod half_tests;
#[cfg(test)]
mod image_read_tests;
#[cfg(test)]
mod tests;
