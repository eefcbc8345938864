//! Colours, chosen where equal steps look equal.

use std::f64::consts::TAU;

/// The colour of a given lightness, chroma and hue (in turns) in Oklab, as linear Rec. 709.
/// Björn Ottosson, "A perceptual color space for image processing", 2020.
pub fn oklch(lightness: f64, chroma: f64, hue: f64) -> [f64; 3] {
    let (sin, cos) = (TAU * hue).sin_cos();
    let (a, b) = (chroma * cos, chroma * sin);
    let l = (lightness + 0.396_337_777_4 * a + 0.215_803_757_3 * b).powi(3);
    let m = (lightness - 0.105_561_345_8 * a - 0.063_854_172_8 * b).powi(3);
    let s = (lightness - 0.089_484_177_5 * a - 1.291_485_548_0 * b).powi(3);
    [
        4.076_741_662_1 * l - 3.307_711_591_3 * m + 0.230_969_929_2 * s,
        -1.268_438_004_6 * l + 2.609_757_401_1 * m - 0.341_319_396_5 * s,
        -0.004_196_086_3 * l - 0.703_418_614_7 * m + 1.707_614_701_0 * s,
    ]
}

/// From `a` at t = 0 to `b` at t = 1, clamped.
pub fn mix(a: [f64; 3], b: [f64; 3], t: f64) -> [f64; 3] {
    let t = t.clamp(0.0, 1.0);
    [0, 1, 2].map(|i| a[i] + t * (b[i] - a[i]))
}

/// A linear colour as the three bytes of a point file, which hold sRGB.
pub fn srgb_bytes(linear: [f64; 3]) -> [u8; 3] {
    linear.map(|value| {
        let value = value.clamp(0.0, 1.0);
        let encoded = if value <= 0.003_130_8 {
            12.92 * value
        } else {
            1.055 * value.powf(1.0 / 2.4) - 0.055
        };
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 255")]
        let byte = (255.0 * encoded).round() as u8;
        byte
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lightness_one_without_chroma_is_white() {
        for value in oklch(1.0, 0.0, 0.3) {
            assert!((value - 1.0).abs() < 1e-6, "{value}");
        }
        assert_eq!(srgb_bytes([1.0, 0.5, 0.0]), [255, 188, 0]);
    }
}
