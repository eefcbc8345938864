//! Pictures without named channels, as numbers: PNG, JPEG and Radiance HDR with their alpha.

use crate::error::FilmError;
use crate::exr_header::EXR_MAGIC;
use crate::image_read::decode;
use image::DynamicImage;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// A picture of red, green, blue and perhaps alpha.
#[derive(Debug, Clone, PartialEq)]
pub struct Raster {
    /// Columns and rows, each at least 1.
    pub size: [u32; 2],
    /// Bits of each value in the file: 8 or 16 for integers, 32 for floats.
    pub bits: u32,
    /// Whether values are linear, as floats are. Integers are in sRGB, 1 at full intensity.
    pub linear: bool,
    /// Whether the file has an alpha. Colours are not multiplied by it.
    pub alpha: bool,
    /// Row by row, the top row first. Grey is three equal values. Alpha is 1 where the file has none.
    pub pixels: Vec<[f32; 4]>,
}

/// Whether a file begins as an EXR does.
///
/// # Errors
/// [`FilmError::IsFolder`] for a folder, [`FilmError::NotFile`] for a pipe or a device, which is not opened:
/// pictures are read more than once. [`FilmError::Read`] if it cannot be read.
pub fn is_exr(path: &Path) -> Result<bool, FilmError> {
    let read_error = |source| FilmError::Read { path: path.into(), source };
    let found = path.metadata().map_err(read_error)?;
    if found.is_dir() {
        return Err(FilmError::IsFolder { path: path.into() });
    }
    if !found.is_file() {
        return Err(FilmError::NotFile { path: path.into() });
    }
    let mut start = Vec::new();
    let file = File::open(path).map_err(read_error)?;
    file.take(EXR_MAGIC.len() as u64).read_to_end(&mut start).map_err(read_error)?;
    Ok(start == EXR_MAGIC)
}

/// Reads a PNG, JPEG or Radiance HDR file.
///
/// # Errors
/// A file that cannot be read, is none of the three, is damaged, or is longer than 65536 pixels on a
/// side.
pub fn read_raster(path: &Path) -> Result<Raster, FilmError> {
    let decoded = decode(path)?;
    let color = decoded.color();
    let bits = 8 * u32::from(color.bytes_per_pixel()) / u32::from(color.channel_count().max(1));
    let (size, alpha) = ([decoded.width(), decoded.height()], color.has_alpha());
    let linear = matches!(decoded, DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_));
    let pixels = if bits == 8 {
        // Divided as f64, so that a byte is the float nearest to its value.
        let value = |byte: u8| (f64::from(byte) / 255.0) as f32;
        decoded.into_rgba8().pixels().map(|pixel| pixel.0.map(value)).collect()
    } else if bits == 16 {
        let value = |word: u16| (f64::from(word) / 65_535.0) as f32;
        decoded.into_rgba16().pixels().map(|pixel| pixel.0.map(value)).collect()
    } else {
        decoded.into_rgba32f().pixels().map(|pixel| pixel.0).collect()
    };
    Ok(Raster { size, bits, linear, alpha, pixels })
}
