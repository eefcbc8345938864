//! From spectra to linear Rec. 709.

use super::data::WAVELENGTHS;
use std::sync::LazyLock;

/// The integral of the eye's sensitivity ȳ over wavelengths in nm (CIE 1931, 2 degrees): what makes a mean of it.
pub(super) const LUMINOUS_WIDTH: f64 = 106.857;

/// First wavelength of the spectra in nm.
const FIRST: f64 = 320.0;
/// From one wavelength to the next, in nm.
const STEP: f64 = 40.0;

/// What 1 W nm⁻¹ at each wavelength, falling linearly to 0 at its neighbours, adds to red, green and blue, as a mean over
/// wavelengths weighted by ȳ.
pub(super) static RGB_OF: LazyLock<[[f64; 3]; WAVELENGTHS]> = LazyLock::new(|| {
    std::array::from_fn(|at| {
        let middle = FIRST + STEP * at as f64;
        let last = FIRST + STEP * (WAVELENGTHS - 1) as f64;
        let mut xyz = [0.0; 3];
        // The middles of intervals of 1 nm.
        for nm in 0..(2.0 * STEP) as u32 {
            let wavelength = middle - STEP + f64::from(nm) + 0.5;
            if (FIRST..last).contains(&wavelength) {
                let share = 1.0 - (wavelength - middle).abs() / STEP;
                let seen = matching_functions(wavelength);
                xyz = [0, 1, 2].map(|i| xyz[i] + share * seen[i] / LUMINOUS_WIDTH);
            }
        }
        rec709(xyz)
    })
});

/// x̄, ȳ and z̄ of CIE 1931 for 2 degrees at a wavelength in nm, by the fits of Wyman, Sloan and Shirley ("Simple Analytic
/// Approximations to the CIE XYZ Color Matching Functions", JCGT 2(2), 2013): within 1 % of their largest values.
fn matching_functions(nm: f64) -> [f64; 3] {
    let lobe = |height: f64, middle: f64, below: f64, above: f64| {
        let t = (nm - middle) / if nm < middle { below } else { above };
        height * (-0.5 * t * t).exp()
    };
    [
        lobe(1.056, 599.8, 37.9, 31.0) + lobe(0.362, 442.0, 16.0, 26.7)
            - lobe(0.065, 501.1, 20.4, 26.2),
        lobe(0.821, 568.8, 46.9, 40.5) + lobe(0.286, 530.9, 16.3, 31.1),
        lobe(1.217, 437.0, 11.8, 36.0) + lobe(0.681, 459.0, 26.0, 13.8),
    ]
}

/// Linear Rec. 709, whose white is D65.
fn rec709([x, y, z]: [f64; 3]) -> [f64; 3] {
    [
        3.240_454_2 * x - 1.537_138_5 * y - 0.498_531_4 * z,
        -0.969_266 * x + 1.876_010_8 * y + 0.041_556 * z,
        0.055_643_4 * x - 0.204_025_9 * y + 1.057_225_2 * z,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of 1 W nm⁻¹ at all wavelengths the luminance is 1. The fits' integral is 0.05 % greater, of which 0.02 % lie beyond
    /// 720 nm and 0.02 % are the last half step, where the spectra end.
    #[test]
    fn an_even_spectrum_has_a_luminance_of_one() {
        let [r, g, b] = RGB_OF.iter().fold([0.0; 3], |sum, rgb| [0, 1, 2].map(|i| sum[i] + rgb[i]));
        let luminance = 0.2126 * r + 0.7152 * g + 0.0722 * b;
        assert!((luminance - 1.0).abs() < 2e-3, "{luminance}");
        assert!(r > g && g > b, "the white of an even spectrum is redder than D65");
    }
}
