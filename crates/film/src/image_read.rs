//! Images that scenes use: PNG, JPEG, OpenEXR and Radiance HDR, told apart by their first bytes.

use crate::error::FilmError;
use crate::exr_read::read_exr;
use crate::plausible::too_short_for;
use crate::raster_read::is_exr;
use crate::srgb::linear_from_srgb;
use image::{DynamicImage, ImageDecoder, ImageError, ImageReader};
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

/// Longest side of an image.
const LONGEST: u32 = 65_536;
/// What decoding may take, and what it may give.
const MOST_BYTES: u64 = 4 << 30;

/// An image as a file has it, without its alpha.
#[derive(Debug, Clone, PartialEq)]
pub struct Image {
    /// Columns, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
    /// Row by row, the top row first.
    pub texels: Texels,
}

/// Red, green and blue of each pixel.
#[derive(Debug, Clone, PartialEq)]
pub enum Texels {
    /// In sRGB.
    Srgb8(Vec<[u8; 3]>),
    /// Linear. May hold anything, also what is no number.
    Linear(Vec<[f32; 3]>),
}

/// Reads an image. Integers are taken as sRGB, of 16 bits decoded at once, and floats as linear. Grey
/// becomes three equal channels.
///
/// # Errors
/// A file that cannot be read, is none of the four formats, is damaged, or is longer than 65536 pixels on a
/// side.
pub fn read_image(path: &Path) -> Result<Image, FilmError> {
    if is_exr(path)? {
        return from_exr(path);
    }
    let decoded = decode(path)?;
    Ok(Image { width: decoded.width(), height: decoded.height(), texels: texels_of(decoded) })
}

/// Decodes a file that is no EXR.
pub(crate) fn decode(path: &Path) -> Result<DynamicImage, FilmError> {
    let read_error = |source| FilmError::Read { path: path.into(), source };
    let not_image = |reason: String| FilmError::NotImage { path: path.into(), reason };
    let file = File::open(path).map_err(read_error)?;
    let mut reader =
        ImageReader::new(BufReader::new(file)).with_guessed_format().map_err(read_error)?;
    if reader.format().is_none() {
        return Err(not_image("found none of these".to_owned()));
    }
    let mut limits = image::Limits::default();
    (limits.max_image_width, limits.max_image_height) = (Some(LONGEST), Some(LONGEST));
    limits.max_alloc = Some(MOST_BYTES);
    reader.limits(limits);
    let image_error = |error| match error {
        ImageError::IoError(source) => read_error(source),
        other => not_image(other.to_string()),
    };
    let decoder = reader.into_decoder().map_err(image_error)?;
    let bytes = decoder.total_bytes();
    if let Some(reason) = too_short_for(bytes, path).map_err(read_error)? {
        return Err(not_image(reason));
    }
    if bytes > MOST_BYTES {
        return Err(not_image(format!(
            "found {bytes} bytes of pixels, at most {MOST_BYTES} are read"
        )));
    }
    let decoded = DynamicImage::from_decoder(decoder).map_err(image_error)?;
    if decoded.width() == 0 || decoded.height() == 0 {
        return Err(not_image("found no pixel".to_owned()));
    }
    Ok(decoded)
}

fn texels_of(decoded: DynamicImage) -> Texels {
    match decoded {
        DynamicImage::ImageLuma16(_)
        | DynamicImage::ImageLumaA16(_)
        | DynamicImage::ImageRgb16(_)
        | DynamicImage::ImageRgba16(_) => {
            let linear: Vec<f32> =
                (0..=65_535).map(|v| linear_from_srgb(f64::from(v) / 65_535.0) as f32).collect();
            let decode = |v: u16| linear[usize::from(v)];
            Texels::Linear(decoded.to_rgb16().pixels().map(|pixel| pixel.0.map(decode)).collect())
        }
        DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_) => {
            Texels::Linear(decoded.to_rgb32f().pixels().map(|pixel| pixel.0).collect())
        }
        _ => Texels::Srgb8(decoded.to_rgb8().pixels().map(|pixel| pixel.0).collect()),
    }
}

/// The display window of an EXR's channels R, G and B, or Y; black where the file has no data.
fn from_exr(path: &Path) -> Result<Image, FilmError> {
    let picture = read_exr(path)?;
    let channels: Option<Vec<&Vec<f32>>> = [["R", "Y"], ["G", "Y"], ["B", "Y"]]
        .map(|names| names.into_iter().find_map(|name| picture.channels.get(name)))
        .into_iter()
        .collect();
    let found: Vec<&str> = picture.channels.keys().map(String::as_str).collect();
    let Some(channels) = channels else {
        let reason = format!("found the channels {}, but not R, G, B or Y", found.join(", "));
        return Err(FilmError::NotExr { path: path.into(), reason });
    };
    let [width, height] = picture.display_size;
    if width == 0 || height == 0 || width > LONGEST || height > LONGEST {
        let reason =
            format!("found {width} x {height} pixels, more than {LONGEST} on a side or none");
        return Err(FilmError::NotExr { path: path.into(), reason });
    }
    let read_error = |source| FilmError::Read { path: path.into(), source };
    let bytes = size_of::<[f32; 3]>() as u64 * u64::from(width) * u64::from(height);
    if let Some(reason) = too_short_for(bytes, path).map_err(read_error)? {
        return Err(FilmError::NotExr { path: path.into(), reason });
    }
    let mut texels = vec![[0.0; 3]; width as usize * height as usize];
    let columns = picture.data_size[0] as usize;
    let [red, green, blue] = channels[..] else { unreachable!("three channels") };
    for (at, ((&r, &g), &b)) in red.iter().zip(green).zip(blue).enumerate() {
        let place = [at % columns, at / columns];
        let in_display = |axis: usize, size: u32| {
            let offset =
                i64::from(picture.data_origin[axis]) - i64::from(picture.display_origin[axis]);
            u32::try_from(place[axis] as i64 + offset).ok().filter(|&at| at < size)
        };
        if let (Some(column), Some(row)) = (in_display(0, width), in_display(1, height)) {
            texels[row as usize * width as usize + column as usize] = [r, g, b];
        }
    }
    Ok(Image { width, height, texels: Texels::Linear(texels) })
}
