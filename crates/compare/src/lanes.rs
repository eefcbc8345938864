//! Functions of f32 that a compiler computes for several values at once: the same bits whatever registers a
//! processor has.
//!
//! `pulp` compiles what runs through [`wide`] once more for each kind of registers, and chooses when it runs. Nothing
//! is contracted or reordered by it.

use pulp::Arch;

/// Runs something with the widest registers there are. What it calls has to be inlined.
#[inline(always)]
pub(crate) fn wide<R>(run: impl FnOnce() -> R) -> R {
    Arch::new().dispatch(run)
}

/// Cube root of a number of at least 1e-30, within 2 units of its last place.
#[inline(always)]
pub(crate) fn cube_root(x: f32) -> f32 {
    // A third of the exponent: 5 % off at most. Then Halley's iteration, whose error is cubed each time.
    let mut y = f32::from_bits(x.to_bits() / 3 + 0x2a51_19f2);
    for _ in 0..2 {
        let cube = y * y * y;
        y *= (cube + 2.0 * x) / (2.0 * cube + x);
    }
    y
}

/// xʸ for x from 0 to 1e9 and y from 0 to 1, within 3e-6 of its value; 0⁰ is 1.
#[inline(always)]
pub(crate) fn power(x: f32, y: f32) -> f32 {
    // 1.5 times 2^23: what is added to it is rounded to an integer, which its last bits are.
    const ROUND: f32 = 12_582_912.0;
    const SMALLEST: f32 = 1e-36;
    let bounded = if x > SMALLEST { x } else { SMALLEST };
    // x is 2^exponent times m, with m from √½ to √2.
    let bits = bounded.to_bits().wrapping_sub(0x3f35_04f3);
    let exponent = ((bits as i32) >> 23) as f32;
    let m = f32::from_bits((bits & 0x007f_ffff) + 0x3f35_04f3);
    // The logarithm as a series in (m - 1) / (m + 1), whose square is at most 0.0295.
    let s = (m - 1.0) / (m + 1.0);
    let square = s * s;
    let mut series = 2.0 / 9.0;
    for factor in [2.0 / 7.0, 2.0 / 5.0, 2.0 / 3.0, 2.0f32] {
        series = series * square + factor;
    }
    let log2 = exponent + s * series * std::f32::consts::LOG2_E;
    let product = y * log2;
    let rounded = product + ROUND;
    // Within half of the nearest integer.
    let rest = (product - (rounded - ROUND)) * std::f32::consts::LN_2;
    let mut value = 1.0 / 5040.0;
    for factor in [1.0 / 720.0, 1.0 / 120.0, 1.0 / 24.0, 1.0 / 6.0, 0.5, 1.0, 1.0] {
        value = value * rest + factor;
    }
    let power = value * f32::from_bits((rounded.to_bits() << 23).wrapping_add(127 << 23));
    choose((x > SMALLEST) | (y == 0.0), power, 0.0)
}

/// One of two values, both of which are computed: a branch would keep several from being computed at once.
#[inline(always)]
pub(crate) fn choose(condition: bool, yes: f32, no: f32) -> f32 {
    let mask = u32::from(condition).wrapping_neg();
    f32::from_bits((yes.to_bits() & mask) | (no.to_bits() & !mask))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// f64 is the truth to 1e-16.
    #[test]
    fn roots_and_powers_are_near_those_of_f64() {
        for i in 0..200_000 {
            let x = 1e-6f32 * 1.000_15f32.powi(i % 140_000) * (1.0 + i as f32 / 200_000.0);
            let exact = f64::from(x).cbrt();
            let error = f64::from(cube_root(x)) / exact - 1.0;
            assert!(error.abs() < 2.5e-7, "cube root of {x}: {error:e}");
            let y = (i % 1000) as f32 / 999.0;
            let exact = f64::from(x).powf(f64::from(y));
            let error = f64::from(power(x, y)) / exact - 1.0;
            assert!(error.abs() < 3e-6, "{x} to the power {y}: {error:e}");
        }
        assert_eq!((power(0.0, 0.7), power(0.0, 0.0), power(1.0, 0.3)), (0.0, 1.0, 1.0));
        assert!((power(1e-30, 0.7) / 1e-21 - 1.0).abs() < 3e-6);
    }
}
