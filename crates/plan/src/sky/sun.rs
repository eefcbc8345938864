//! The light of the sun through the air (Hošek and Wilkie 2013).

use super::color::RGB_OF;
use super::data::{self, LIMB, SUN_PIECES, TURBIDITIES, WAVELENGTHS};
use std::f64::consts::FRAC_PI_2;

/// The solid angle of the sun as it is seen from the earth, whose mean diameter is 0.5332 degrees.
const SUN_STERADIANS: f64 = 6.80e-5;

/// The irradiance of a surface that faces the sun, whose elevation has this sine, in W m⁻² nm⁻¹. Of the horizon's air where
/// the sun is lower; of its disc, the whole. A channel that would be negative is 0.
pub(super) fn irradiance(turbidity: f64, sine: f64) -> [f64; 3] {
    let elevation = sine.clamp(0.0, 1.0).asin();
    let piece = ((elevation / FRAC_PI_2).cbrt() * SUN_PIECES as f64) as usize;
    let piece = piece.min(SUN_PIECES - 1);
    let start = FRAC_PI_2 * (piece as f64 / SUN_PIECES as f64).powi(3);
    let below = (turbidity as usize).clamp(1, TURBIDITIES - 1);
    let part = turbidity - below as f64;
    let mut sum = [0.0; 3];
    for wavelength in 0..WAVELENGTHS {
        let at = |turbidity| cubic(data::sun(turbidity, piece, wavelength), elevation - start);
        let [low, high] = [at(below - 1), at(below)];
        let middle = (low + part * (high - low)).max(0.0);
        let watts = middle * disc_over_middle(wavelength) * SUN_STERADIANS;
        sum = [0, 1, 2].map(|i| sum[i] + watts * RGB_OF[wavelength][i]);
    }
    sum.map(|x| x.max(0.0))
}

fn cubic([a, b, c, d]: [f64; 4], x: f64) -> f64 {
    a + x * (b + x * (c + x * d))
}

/// The mean radiance of the disc over that of its middle. The mean of cosᵏ over a disc, on which sine squared is evenly
/// distributed, is 2 / (k + 2).
fn disc_over_middle(wavelength: usize) -> f64 {
    let limb = data::limb(wavelength);
    (0..LIMB).map(|power| limb[power] * 2.0 / (power as f64 + 2.0)).sum()
}
