//! The sRGB transfer curve, IEC 61966-2-1.

/// Encodes a linear value as an 8-bit sRGB value, rounded to nearest. Values outside 0..=1 are
/// clamped; NaN gives 0.
pub fn srgb_byte(linear: f32) -> u8 {
    let x = f64::from(linear.clamp(0.0, 1.0));
    let encoded = if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 };
    unit_byte(encoded)
}

/// Decodes a value of 0..=1.
pub fn linear_from_srgb(v: f64) -> f64 {
    if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
}

/// A value of 0..=1 as 0..=255, rounded to nearest.
pub(crate) fn unit_byte(value: f64) -> u8 {
    // NaN passes through `clamp`; the cast makes it 0.
    (value.clamp(0.0, 1.0) * 255.0).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curve_meets_its_closed_forms() {
        assert_eq!(srgb_byte(0.0), 0);
        // The linear part ends here: 12.92 * 0.0031308 * 255 = 10.31.
        assert_eq!(srgb_byte(0.003_130_8), 10);
        // 1.055 * 0.5^(1/2.4) - 0.055 = 0.73536, and times 255 = 187.52.
        assert_eq!(srgb_byte(0.5), 188);
        assert_eq!(srgb_byte(1.0), 255);
    }

    #[test]
    fn values_outside_the_range_are_clamped() {
        assert_eq!(srgb_byte(7.5), 255);
        assert_eq!(srgb_byte(f32::INFINITY), 255);
        assert_eq!(srgb_byte(-0.25), 0);
        assert_eq!(srgb_byte(f32::NEG_INFINITY), 0);
        assert_eq!(srgb_byte(f32::NAN), 0);
    }

    /// Decoding a byte and encoding it again is the identity, so no byte is skipped or doubled.
    #[test]
    fn every_byte_comes_back() {
        for byte in 0..=255u8 {
            assert_eq!(srgb_byte(linear_from_srgb(f64::from(byte) / 255.0) as f32), byte);
        }
    }
}
