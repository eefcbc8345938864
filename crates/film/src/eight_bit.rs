//! PNG and JPEG: the colours of a film in 8-bit sRGB.
//!
//! Unless a [`Tone`] says otherwise, colours are clamped: 1 is white. PNG is written by the crate `png` itself,
//! since `image` offers no way to add the chunk that says the values are sRGB.

use crate::error::FilmError;
use crate::picture::{Film, Window};
use crate::srgb::{srgb_byte, unit_byte};
use crate::tone::Tone;
use image::ExtendedColorType;
use image::codecs::jpeg::JpegEncoder;
use rayon::prelude::*;
use std::path::Path;

const JPEG_QUALITY: u8 = 95;

/// The film's window as PNG: RGBA if the film is transparent, else RGB.
pub(crate) fn png(film: &Film, tone: Tone, path: &Path) -> Result<Vec<u8>, FilmError> {
    let Window { width, height, .. } = film.window;
    let (color, pixels): (_, Vec<u8>) = if film.transparent {
        let straight = |at| straight_rgba(with_one_alpha(film, at), tone);
        (
            png::ColorType::Rgba,
            (0..film.color.len()).into_par_iter().flat_map_iter(straight).collect(),
        )
    } else {
        (png::ColorType::Rgb, opaque(film, tone))
    };
    png_of([width, height], color, &pixels, path)
}

/// Bytes of sRGB as PNG.
pub(crate) fn png_of(
    size: [u32; 2],
    color: png::ColorType,
    pixels: &[u8],
    path: &Path,
) -> Result<Vec<u8>, FilmError> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, size[0], size[1]);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    encoder.set_color(color);
    encoder
        .write_header()
        .and_then(|mut writer| {
            writer.write_image_data(pixels)?;
            writer.finish()
        })
        .map_err(|error| encode_error(size, path, &error))?;
    Ok(file)
}

/// The film's window as JPEG, over black if the film is transparent.
pub(crate) fn jpeg(film: &Film, tone: Tone, path: &Path) -> Result<Vec<u8>, FilmError> {
    let Window { width, height, .. } = film.window;
    let mut file = Vec::new();
    JpegEncoder::new_with_quality(&mut file, JPEG_QUALITY)
        .encode(&opaque(film, tone), width, height, ExtendedColorType::Rgb8)
        .map_err(|error| encode_error([width, height], path, &error))?;
    Ok(file)
}

/// The colours without alpha. A premultiplied colour over black is the colour itself.
fn opaque(film: &Film, tone: Tone) -> Vec<u8> {
    let shown = |c: f32| srgb_byte(tone.apply(c));
    film.color.par_iter().flat_map_iter(|&[r, g, b, _]| [r, g, b].map(shown)).collect()
}

/// What 8 bits hold of each pixel: R, G, B, and alpha where the film is transparent, not divided by it.
pub(crate) fn shown(film: &Film, tone: Tone) -> Vec<[u8; 4]> {
    let byte = |c: f32| srgb_byte(tone.apply(c));
    let of = |&[r, g, b, a]: &[f32; 4]| {
        let alpha = if film.transparent { unit_byte(f64::from(a)) } else { 255 };
        [byte(r), byte(g), byte(b), alpha]
    };
    film.color.par_iter().map(of).collect()
}

/// A pixel with the one alpha that PNG has room for: the mean where the channels have their own.
fn with_one_alpha(film: &Film, at: usize) -> [f32; 4] {
    let [r, g, b, a] = film.color[at];
    let mean = |[r, g, b]: [f32; 3]| (r + g + b) / 3.0;
    [r, g, b, film.channel_alpha.as_ref().map_or(a, |alpha| mean(alpha[at]))]
}

/// A premultiplied colour as PNG wants it: not multiplied by alpha. Without coverage it is black,
/// however bright.
fn straight_rgba([r, g, b, a]: [f32; 4], tone: Tone) -> [u8; 4] {
    let straight = |c: f32| if a > 0.0 { srgb_byte(tone.apply(c / a)) } else { 0 };
    [straight(r), straight(g), straight(b), unit_byte(f64::from(a))]
}

fn encode_error(
    [width, height]: [u32; 2],
    path: &Path,
    reason: &dyn std::fmt::Display,
) -> FilmError {
    FilmError::Encode { path: path.into(), width, height, reason: reason.to_string() }
}
