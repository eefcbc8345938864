//! Lengths that checks of several keys ask for.

use crate::keys::{Fault, SHORT, plain};

pub(crate) fn long_enough(name: &'static str, v: [f64; 3]) -> Result<(), Fault> {
    let length = length(v);
    if length >= SHORT {
        return Ok(());
    }
    let [found, shortest] = [length, SHORT].map(plain);
    Err((name, format!("found a length of {found}, expected at least {shortest}; lengthen it")))
}

/// Scaled by the largest component, so that squares neither overflow nor vanish.
pub(crate) fn length(v: [f64; 3]) -> f64 {
    let largest = v.iter().fold(0.0_f64, |max, x| max.max(x.abs()));
    if largest == 0.0 {
        return 0.0;
    }
    largest * v.iter().map(|x| (x / largest) * (x / largest)).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::length;

    #[test]
    fn length_neither_overflows_nor_vanishes() {
        for (v, expected) in [([3e200, 0.0, -4e200], 5e200), ([0.0, 3e-200, 4e-200], 5e-200)] {
            // A division, a root and a product round once each.
            assert!((length(v) / expected - 1.0).abs() < 1e-15, "{v:?}");
        }
        assert_eq!(length([0.0, -0.0, 0.0]), 0.0);
    }
}
