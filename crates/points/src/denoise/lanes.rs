//! Sums over neighbours, eight side by side: the same bits whatever registers a processor has.
//!
//! `pulp` compiles what runs through [`wide`] once more for each kind of registers, and chooses when it runs. Nothing is
//! contracted or reordered by it.

use pulp::Arch;

/// Runs something with the widest registers there are. What it calls has to be inlined.
#[inline(always)]
pub(super) fn wide<R>(run: impl FnOnce() -> R) -> R {
    Arch::new().dispatch(run)
}

pub(super) const LANES: usize = 8;
pub(super) type Lanes = [f32; LANES];

/// Adds up in a fixed order.
#[inline(always)]
pub(super) fn sum(lanes: &Lanes) -> f32 {
    ((lanes[0] + lanes[4]) + (lanes[2] + lanes[6]))
        + ((lanes[1] + lanes[5]) + (lanes[3] + lanes[7]))
}

/// exp(-t) for t in 0 to 1, within 1.2e-7: the Taylor series about one half.
#[inline(always)]
pub(super) fn exp_down(t: f32) -> f32 {
    const MIDDLE: f32 = 0.606_530_66;
    let x = 0.5 - t;
    let mut p = 1.0 / 5040.0;
    for factor in [1.0 / 720.0, 1.0 / 120.0, 1.0 / 24.0, 1.0 / 6.0, 0.5, 1.0, 1.0] {
        p = p * x + factor;
    }
    MIDDLE * p
}

/// exp(x) for x up to 0, within 4e-7 of its value: not `f32::exp`, whose last bits differ between platforms.
#[inline(always)]
pub(super) fn exp_negative(x: f32) -> f32 {
    // 1.5 times 2^23: what is added to it is rounded to an integer, which its last bits are.
    const ROUND: f32 = 12_582_912.0;
    let x = if x > -80.0 { x } else { -80.0 };
    let rounded = x * std::f32::consts::LOG2_E + ROUND;
    let n = rounded - ROUND;
    // ln 2 in two parts; r within half of it.
    let r = (x - n * 0.693_359_4) + n * 2.121_944_4e-4;
    let mut p = 1.0 / 5040.0;
    for factor in [1.0 / 720.0, 1.0 / 120.0, 1.0 / 24.0, 1.0 / 6.0, 0.5, 1.0, 1.0] {
        p = p * r + factor;
    }
    p * f32::from_bits((rounded.to_bits() << 23).wrapping_add(127 << 23))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponentials_are_near_those_of_f64() {
        for i in 0..=1000 {
            let t = i as f32 / 1000.0;
            let expected = (-f64::from(t)).exp();
            assert!((f64::from(exp_down(t)) - expected).abs() < 1.5e-7, "exp(-{t})");
            let x = -60.0 * t;
            let expected = f64::from(x).exp();
            let error = f64::from(exp_negative(x)) / expected - 1.0;
            assert!(error.abs() < 4e-7, "exp({x}): {error:e}");
        }
    }
}
