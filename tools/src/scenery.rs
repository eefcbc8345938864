//! Pictures that scenes need: a sky all around, a map of the dunes, tiles of a floor.

use crate::color::{mix, oklch, srgb_bytes};
use crate::noise::{noise, random};
use crate::terrain::{DUNES, dunes, smooth_step};
use crate::vector::{Vector, add_scaled, dot, length, scale, unit};
use std::f64::consts::{PI, TAU};
use std::io::Cursor;

/// A picture of linear colours, rows from the top.
#[derive(Debug)]
pub struct Image {
    /// Width and height.
    pub size: [u32; 2],
    /// Red, green and blue.
    pub pixels: Vec<[f64; 3]>,
}

impl Image {
    fn of(size: [u32; 2], color: impl Fn(f64, f64) -> [f64; 3]) -> Self {
        let [width, height] = size.map(f64::from);
        let rows = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y)));
        let at = |(x, y)| color((f64::from(x) + 0.5) / width, (f64::from(y) + 0.5) / height);
        Self { size, pixels: rows.map(at).collect() }
    }

    /// The bytes of a PNG file, sRGB.
    ///
    /// # Errors
    /// Whatever the encoder says.
    pub fn png(&self) -> image::ImageResult<Vec<u8>> {
        let bytes: Vec<u8> = self.pixels.iter().copied().flat_map(srgb_bytes).collect();
        let [width, height] = self.size;
        let mut out = Cursor::new(Vec::new());
        let encoder = image::codecs::png::PngEncoder::new_with_quality(
            &mut out,
            image::codecs::png::CompressionType::Best,
            image::codecs::png::FilterType::Adaptive,
        );
        let color = image::ExtendedColorType::Rgb8;
        image::ImageEncoder::write_image(encoder, &bytes, width, height, color)?;
        Ok(out.into_inner())
    }

    /// The bytes of a Radiance HDR file.
    ///
    /// # Errors
    /// Whatever the encoder says.
    pub fn hdr(&self) -> image::ImageResult<Vec<u8>> {
        #[expect(clippy::cast_possible_truncation, reason = "rounding to float is meant")]
        let pixels: Vec<_> = self.pixels.iter().map(|c| image::Rgb(c.map(|x| x as f32))).collect();
        let mut out = Vec::new();
        let [width, height] = self.size.map(|side| side as usize);
        image::codecs::hdr::HdrEncoder::new(&mut out).encode(&pixels, width, height)?;
        Ok(out)
    }
}

/// Where the sun stands, from the middle.
pub const SUN: Vector = [-0.60, 0.62, 0.50];

/// A late afternoon: sun, a few clouds, hills on the horizon. Equirectangular, as environments are.
pub fn sky() -> Image {
    Image::of([512, 256], |u, v| {
        let (sin, cos) = (TAU * (u - 0.5)).sin_cos();
        let (across, up) = (PI * v).sin_cos();
        sky_color([across * sin, up, -across * cos])
    })
}

fn sky_color([x, y, z]: Vector) -> [f64; 3] {
    let sun = unit(SUN);
    let toward = dot([x, y, z], sun);
    let azimuth = z.atan2(x);
    // Hills: whole numbers of waves around, so that they close.
    let waves = [(3.0, 0.022, 0.4), (7.0, 0.014, 1.9), (13.0, 0.008, 0.7), (29.0, 0.003, 2.2)];
    let hills =
        waves.iter().map(|&(n, a, phase): &(f64, f64, f64)| a * (n * azimuth + phase).sin());
    let horizon = 0.045 + hills.sum::<f64>();
    let high = smooth_step(0.0, 0.9, y);
    let pale = mix([0.72, 0.80, 0.90], [1.25, 1.0, 0.72], smooth_step(0.1, 1.0, toward));
    let mut color = mix(pale, [0.10, 0.24, 0.58], high.sqrt());
    let cover = clouds(x, y, z);
    let lit = mix([0.62, 0.66, 0.74], [1.5, 1.40, 1.25], 0.5 + 0.5 * toward);
    color = mix(color, lit, cover);
    // The sun and its glow, as wide as some texels: it is seen in glass and mirrors.
    let glow = 0.9 * smooth_step(0.90, 1.0, toward).powi(2);
    let disc = 60.0 * smooth_step(0.9970, 0.9992, toward);
    color = add_scaled(color, glow + disc, [1.0, 0.86, 0.62]);
    // Far hills are blue; the plain before them fades into the same haze.
    let ridge = smooth_step(-0.012, 0.020, horizon - y);
    color = mix(color, mix([0.42, 0.50, 0.62], [0.22, 0.30, 0.42], 18.0 * y), ridge);
    mix(color, plain([x, y, z]), smooth_step(-0.006, 0.012, -y))
}

/// Sand with darker patches, lost in haze towards the horizon.
fn plain([x, y, z]: Vector) -> [f64; 3] {
    let depth = (-y).max(1e-3);
    let [a, b] = [x / depth, z / depth];
    let patches = 0.6 * noise(0.45 * a, 0.45 * b) + 0.4 * noise(1.3 * a + 9.0, 1.3 * b);
    let sand = mix([0.56, 0.44, 0.28], [0.30, 0.25, 0.14], smooth_step(0.35, 0.75, patches));
    mix([0.46, 0.53, 0.63], sand, smooth_step(0.0, 0.22, depth))
}

/// How much cloud there is in a direction: noise on a plane above, thinning out towards the horizon.
fn clouds(x: f64, y: f64, z: f64) -> f64 {
    if y <= 0.04 {
        return 0.0;
    }
    let [a, b] = [1.1 * x / (y + 0.18), 1.1 * z / (y + 0.18)];
    let octaves = [(1.0, 0.55), (2.1, 0.27), (4.3, 0.13), (8.7, 0.05)];
    let value: f64 = octaves.iter().map(|&(f, share)| share * noise(f * a + 3.0, f * b - f)).sum();
    0.92 * smooth_step(0.50, 0.68, value) * smooth_step(0.04, 0.16, y)
}

/// The mean over 4 by 4 places of a pixel.
fn smoothed(size: u32, color: impl Fn(f64, f64) -> [f64; 3]) -> Image {
    let pixel = 1.0 / f64::from(size);
    Image::of([size, size], |u, v| {
        let sum = (0..16).fold([0.0; 3], |sum, n| {
            let [du, dv] = [n % 4, n / 4].map(|k| ((f64::from(k) + 0.5) / 4.0 - 0.5) * pixel);
            add_scaled(sum, 1.0, color(u + du, v + dv))
        });
        scale(1.0 / 16.0, sum)
    })
}

/// A map of the dunes: tints by height, contour lines, and a grid of half a unit.
pub fn dunes_map() -> Image {
    smoothed(720, |u, v| {
        let [x, z] = [u, v].map(|t| DUNES * (2.0 * t - 1.0));
        let height = dunes(x, z);
        let level = (height / 0.05).floor();
        let tint = mix(oklch(0.66, 0.09, 0.36), oklch(0.86, 0.075, 0.22), (level + 5.0) / 8.0);
        let high = mix(tint, oklch(0.72, 0.09, 0.12), (level - 3.0) / 7.0);
        // As wide on the map whatever the slope: distance to the line, over the slope.
        let e = 1e-4;
        let slope = length([dunes(x + e, z) - height, dunes(x, z + e) - height, 0.0]) / e;
        let line = |step: f64| {
            let t = height / step;
            (t - t.round()).abs() * step / slope.max(0.02)
        };
        let dark = oklch(0.42, 0.08, 0.13);
        let wide = line(0.25) < 0.016;
        let ground = if line(0.05) < 0.008 || wide { mix(high, dark, 0.75) } else { high };
        let to_grid = [x, z].map(|a| (2.0 * a - (2.0 * a).round()).abs() / 2.0);
        let on_grid = to_grid[0].min(to_grid[1]) < 0.009;
        if on_grid { mix(ground, oklch(0.45, 0.09, 0.70), 0.7) } else { ground }
    })
}

/// Tiles of half a unit on a floor as wide as the dunes: cream and slate, a few of them coloured.
pub fn tiles() -> Image {
    smoothed(512, |u, v| {
        let [i, j] = [u, v].map(|t| (16.0 * t).floor());
        let [a, b] = [16.0 * u - i, 16.0 * v - j];
        let edge = a.min(1.0 - a).min(b).min(1.0 - b);
        if edge < 0.03 {
            return oklch(0.40, 0.01, 0.2);
        }
        let shade = 0.03 * (random(i, j) - 0.5);
        if (i + j).rem_euclid(2.0) < 0.5 {
            return oklch(0.93 + shade, 0.025, 0.22);
        }
        match random(i + 31.0, j - 7.0) {
            n if n < 0.18 => oklch(0.60 + shade, 0.16, 0.11),
            n if n < 0.36 => oklch(0.55 + shade, 0.11, 0.60),
            n if n < 0.50 => oklch(0.78 + shade, 0.14, 0.24),
            _ => oklch(0.42 + shade, 0.03, 0.70),
        }
    })
}
