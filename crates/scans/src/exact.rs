//! Sine, cosine, logarithm and exponential by +, −, × and ÷ only, so that scans are the same bits on every machine.
//! (A crate of such functions, `libm`, would be one more dependency of the program for four short series.)

use std::f64::consts::{FRAC_PI_2, LN_2, SQRT_2};

/// The first 33 bits of π/2, so that multiples are exact, and the rest (fdlibm's).
const HIGH: f64 = 1.570_796_326_734_125_6;
const LOW: f64 = 6.077_100_506_506_192e-11;

/// Sine and cosine, to a few units of the last place for angles of up to some thousand.
pub(crate) fn sin_cos(angle: f64) -> (f64, f64) {
    let turns = (angle / FRAC_PI_2).round();
    let x = (angle - turns * HIGH) - turns * LOW;
    let square = x * x;
    // Of |x| ≤ π/4: what is left out is below 1e-17.
    let series = |first: f64, from: u32| {
        let (mut sum, mut term) = (first, first);
        for i in (from..from + 18).step_by(2) {
            term *= -square / f64::from(i * (i + 1));
            sum += term;
        }
        sum
    };
    let (sin, cos) = (series(x, 2), series(1.0, 1));
    match (turns as i64).rem_euclid(4) {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// The natural logarithm of a normal positive number.
pub(crate) fn ln(x: f64) -> f64 {
    let bits = x.to_bits();
    let mut exponent = (bits >> 52) as i64 - 1023;
    let mut mantissa = f64::from_bits(bits & ((1 << 52) - 1) | 1023 << 52);
    if mantissa > SQRT_2 {
        mantissa *= 0.5;
        exponent += 1;
    }
    // ln m = 2 artanh s, |s| ≤ 0.172: what is left out is below 1e-18.
    let s = (mantissa - 1.0) / (mantissa + 1.0);
    let (square, mut power, mut sum) = (s * s, s, 0.0);
    for i in (1..25).step_by(2) {
        sum += power / f64::from(i);
        power *= square;
    }
    exponent as f64 * LN_2 + 2.0 * sum
}

/// The exponential of numbers from −700 to 700.
pub(crate) fn exp(x: f64) -> f64 {
    let power = (x / LN_2).round();
    let rest = x - power * LN_2;
    let (mut sum, mut term) = (1.0, 1.0);
    for i in 1..18 {
        term *= rest / f64::from(i);
        sum += term;
    }
    sum * f64::from_bits(((power as i64 + 1023) as u64) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The platform's functions are right to a unit of the last place; ours are to four.
    #[test]
    fn functions_are_those_of_the_platform_but_for_last_bits() {
        let near = |a: f64, b: f64, size: f64| (a - b).abs() <= 4.0 * f64::EPSILON * size;
        for i in -4000..4000 {
            let x = f64::from(i) * 0.0173;
            let (sin, cos) = sin_cos(x);
            assert!(near(sin, x.sin(), 1.0) && near(cos, x.cos(), 1.0), "{x}: {sin}, {cos}");
            assert!(near(exp(x), x.exp(), x.exp() * (1.0 + x.abs())), "{x}: {}", exp(x));
            let y = x.abs() + 1e-9;
            assert!(near(ln(y), y.ln(), 1.0 + y.ln().abs()), "{y}: {}", ln(y));
        }
    }
}
