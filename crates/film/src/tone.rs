//! From a picture's radiance to what 8 bits can show: exposure, then a tone curve.
//!
//! Nothing here changes an EXR, which holds the numbers as they are. Off, which is the default, a
//! colour comes through to the bit.

/// How 8-bit files are made of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Tone {
    /// Colours are multiplied by 2 to this power.
    pub exposure: f64,
    /// What becomes of what is brighter than white.
    pub curve: ToneCurve,
}

/// From linear values to linear values in 0..=1, channel by channel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ToneCurve {
    /// c, cut at 1.
    #[default]
    Linear,
    /// c / (1 + c), after Reinhard et al. 2002: nothing is ever quite white.
    Reinhard,
    /// A film-like S, after Narkowicz's fit of the ACES curve: deeper darks, a soft shoulder.
    Aces,
}

/// Brighter than anything that is not infinite by mistake; its square is far inside f64.
const BRIGHTEST: f64 = 1e30;

impl Tone {
    /// One linear channel, to be encoded as sRGB.
    pub(crate) fn apply(self, linear: f32) -> f32 {
        if self == Self::default() {
            return linear;
        }
        // NaN passes through, and is black in the end.
        let c = (f64::from(linear) * self.exposure.exp2()).clamp(0.0, BRIGHTEST);
        let shown = match self.curve {
            ToneCurve::Linear => c,
            ToneCurve::Reinhard => c / (1.0 + c),
            ToneCurve::Aces => (c * (2.51 * c + 0.03)) / (c * (2.43 * c + 0.59) + 0.14),
        };
        shown.clamp(0.0, 1.0) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tone(exposure: f64, curve: ToneCurve) -> Tone {
        Tone { exposure, curve }
    }

    #[test]
    fn off_is_the_identity() {
        for c in [0.0, 1e-30, 0.3, 1.0, 7.5, -1.0, f32::INFINITY] {
            assert_eq!(Tone::default().apply(c).to_bits(), c.to_bits());
        }
    }

    #[test]
    fn a_stop_doubles() {
        assert_eq!(tone(1.0, ToneCurve::Linear).apply(0.25), 0.5);
        assert_eq!(tone(-2.0, ToneCurve::Linear).apply(2.0), 0.5);
        assert_eq!(tone(1.0, ToneCurve::Linear).apply(0.75), 1.0);
    }

    #[test]
    fn curves_meet_their_closed_forms_and_rise_to_white() {
        assert_eq!(tone(0.0, ToneCurve::Reinhard).apply(1.0), 0.5);
        assert_eq!(tone(1.0, ToneCurve::Reinhard).apply(1.5), 0.75);
        // (2.51 + 0.03) / (2.43 + 0.59 + 0.14) = 2.54 / 3.16.
        assert!((tone(0.0, ToneCurve::Aces).apply(1.0) - 0.803_797_5).abs() < 1e-6);
        for curve in [ToneCurve::Linear, ToneCurve::Reinhard, ToneCurve::Aces] {
            let tone = tone(0.5, curve);
            assert_eq!(tone.apply(0.0), 0.0);
            let shown: Vec<f32> = (0..200).map(|i| tone.apply(1.1f32.powi(i - 100))).collect();
            assert!(shown.windows(2).all(|pair| pair[0] <= pair[1]), "{curve:?}");
            for bright in [1e30, f32::MAX, f32::INFINITY] {
                assert_eq!(tone.apply(bright), 1.0, "{curve:?}");
            }
            assert_eq!(tone.apply(-1.0), 0.0);
            assert!(tone.apply(f32::NAN).is_nan(), "and srgb_byte makes it black");
        }
    }
}
