//! Arithmetic of the twins: one source over f32, which must give lavapipe's bits, and f64, which
//! says how far both are from the truth. Twin of `glsl/shared/math.glsl`.

use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Optical depth of which nothing is seen.
const SHALLOW: f64 = 1e-30;

/// f32 or f64, with the operations that kernels use.
pub trait Real:
    Copy
    + PartialOrd
    + PartialEq
    + Debug
    + Send
    + Sync
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// A constant, rounded to this precision.
    fn of(value: f64) -> Self;
    /// A value of a host struct.
    fn of_f32(value: f32) -> Self;
    /// Rounded to f32.
    fn to_f32(self) -> f32;
    /// A count.
    fn of_u32(value: u32) -> Self;
    /// A value that is clamped to the range of u32 before.
    fn to_u32(self) -> u32;
    /// Square root, correctly rounded.
    fn sqrt(self) -> Self;
    /// Largest integer not above.
    fn floor(self) -> Self;
    /// e^x for x ≤ 0, and 0 below −80.
    fn exp_negative(self) -> Self;
    /// 2^x for −126 ≤ x ≤ 126.
    fn power_of_two(self) -> Self;
    /// 1 − e^−x for x ≥ 0, with all digits.
    fn absorptance(self) -> Self;
    /// −ln(1 − x) for 0 ≤ x ≤ ½, with all digits.
    fn depth_of_absorptance(self) -> Self;
    /// −ln(1 − u) for 0 ≤ u ≤ 1 − 2⁻²⁴.
    fn depth_of_chance(self) -> Self;
    /// Sine for |x| ≤ π/4.
    fn sin_octant(self) -> Self;
    /// Cosine for |x| ≤ π/4.
    fn cos_octant(self) -> Self;
    /// The angle of (x, y) from the x axis, −π to π, where self is y; 0 for (0, 0).
    fn arc_tangent(self, x: Self) -> Self;

    /// (1 − e^−x) / x for x ≥ 0, and 1 for 0.
    #[must_use]
    fn mean_transmittance(self) -> Self {
        if self > Self::of(SHALLOW) { self.absorptance() / self } else { Self::of(1.0) }
    }
    /// As GLSL defines it.
    #[must_use]
    fn min(self, other: Self) -> Self {
        if other < self { other } else { self }
    }
    /// As GLSL defines it.
    #[must_use]
    fn max(self, other: Self) -> Self {
        if self < other { other } else { self }
    }
    /// Absolute value.
    #[must_use]
    fn abs(self) -> Self {
        if self < Self::of(0.0) { -self } else { self }
    }
}

impl Real for f32 {
    fn of(value: f64) -> Self {
        value as Self
    }
    fn of_f32(value: f32) -> Self {
        value
    }
    fn to_f32(self) -> f32 {
        self
    }
    fn of_u32(value: u32) -> Self {
        value as Self
    }
    fn to_u32(self) -> u32 {
        self as u32
    }
    fn sqrt(self) -> Self {
        self.sqrt()
    }
    fn floor(self) -> Self {
        self.floor()
    }
    #[expect(clippy::excessive_precision, reason = "the kernel's digits")]
    fn exp_negative(self) -> Self {
        let clamped = Real::max(self, -80.0);
        let n = (clamped * std::f32::consts::LOG2_E + 0.5).floor();
        let r = (clamped - n * 0.693_359_375) + n * 2.121_944_4e-4;
        let mut p = 1.987_569_15e-4;
        p = p * r + 1.398_199_950_7e-3;
        p = p * r + 8.333_451_907_3e-3;
        p = p * r + 4.166_579_589_4e-2;
        p = p * r + 1.666_666_545_9e-1;
        p = p * r + 5.000_000_120_1e-1;
        let e = (p * (r * r) + r) + 1.0;
        let scale = Self::from_bits(((n as i32 + 127) as u32) << 23);
        if self < -80.0 { 0.0 } else { e * scale }
    }
    #[expect(clippy::excessive_precision, reason = "the kernel's digits")]
    fn power_of_two(self) -> Self {
        let n = (self + 0.5).floor();
        let r = self - n;
        let square = r * r;
        let low = r * 6.931_470_04e-1 + 1.0;
        let middle = r * 5.550_733_58e-2 + 2.402_224_24e-1;
        let high = r * 1.326_472_5e-3 + 9.671_512_99e-3;
        let p = low + square * (middle + square * high);
        p * Self::from_bits(((n as i32 + 127) as u32) << 23)
    }
    #[expect(clippy::excessive_precision, reason = "the kernel's digits")]
    fn absorptance(self) -> Self {
        let clamped = Real::max(-self, -80.0);
        let n = (clamped * std::f32::consts::LOG2_E + 0.5).floor();
        let r = (clamped - n * 0.693_359_375) + n * 2.121_944_4e-4;
        let mut p = r * 1.987_569_15e-4 + 1.398_199_950_7e-3;
        p = p * r + 8.333_451_907_3e-3;
        p = p * r + 4.166_579_589_4e-2;
        p = p * r + 1.666_666_545_9e-1;
        p = p * r + 5.000_000_120_1e-1;
        let less = p * (r * r) + r;
        let scale = Self::from_bits(((n as i32 + 127) as u32) << 23);
        if self > 80.0 { 1.0 } else { (1.0 - scale) - scale * less }
    }
    #[expect(clippy::excessive_precision, reason = "the kernel's digits")]
    fn depth_of_absorptance(self) -> Self {
        let t = self / (2.0 - self);
        let z = t * t;
        let mut p = 6.666_666_67e-2 * z + 7.692_307_69e-2;
        p = p * z + 9.090_909_09e-2;
        p = p * z + 1.111_111_11e-1;
        p = p * z + 1.428_571_43e-1;
        p = p * z + 2.000_000_00e-1;
        p = p * z + 3.333_333_33e-1;
        2.0 * (t + t * (z * p))
    }
    fn depth_of_chance(self) -> Self {
        let bits = (1.0 - self).to_bits();
        let halvings = (126 - (bits >> 23) as i32) as Self;
        let m = Self::from_bits(bits & 0x7f_ffff | 0x3f00_0000);
        Real::max((1.0 - m).depth_of_absorptance() + halvings * std::f32::consts::LN_2, 0.0)
    }
    #[expect(clippy::excessive_precision, reason = "the kernel's digits")]
    fn sin_octant(self) -> Self {
        let z = self * self;
        let mut p = -1.951_529_589_1e-4;
        p = p * z + 8.332_160_873_6e-3;
        p = p * z - 1.666_665_461_1e-1;
        p * z * self + self
    }
    #[expect(clippy::excessive_precision, reason = "the kernel's digits")]
    fn cos_octant(self) -> Self {
        let z = self * self;
        let mut p = 2.443_315_711_809_948e-5;
        p = p * z - 1.388_731_625_493_765e-3;
        p = p * z + 4.166_664_568_298_827e-2;
        (p * z * z - 0.5 * z) + 1.0
    }
    #[expect(clippy::excessive_precision, reason = "the kernel's digits")]
    fn arc_tangent(self, x: Self) -> Self {
        let (across, along) = (Real::abs(self), Real::abs(x));
        let (lesser, larger) = (Real::min(across, along), Real::max(across, along));
        let steep = lesser > 0.414_213_562 * larger;
        let over = if steep { lesser - larger } else { lesser };
        let under = if steep { lesser + larger } else { larger };
        let t = over / (if under > 0.0 { under } else { 1.0 });
        let z = t * t;
        let mut p = 8.053_744_495_38e-2;
        p = p * z - 1.387_768_560_32e-1;
        p = p * z + 1.997_771_064_78e-1;
        p = p * z - 3.333_294_915_39e-1;
        let quarter = if steep { std::f32::consts::FRAC_PI_4 } else { 0.0 };
        let angle = (p * z * t + t) + quarter;
        let angle = if across > along { std::f32::consts::FRAC_PI_2 - angle } else { angle };
        let angle = if x < 0.0 { std::f32::consts::PI - angle } else { angle };
        if self < 0.0 { -angle } else { angle }
    }
}

impl Real for f64 {
    fn of(value: f64) -> Self {
        value
    }
    fn of_f32(value: f32) -> Self {
        Self::from(value)
    }
    fn to_f32(self) -> f32 {
        self as f32
    }
    fn of_u32(value: u32) -> Self {
        Self::from(value)
    }
    fn to_u32(self) -> u32 {
        self as u32
    }
    fn sqrt(self) -> Self {
        self.sqrt()
    }
    fn floor(self) -> Self {
        self.floor()
    }
    fn exp_negative(self) -> Self {
        if self < -80.0 { 0.0 } else { self.exp() }
    }
    fn power_of_two(self) -> Self {
        self.exp2()
    }
    fn absorptance(self) -> Self {
        if self > 80.0 { 1.0 } else { -(-self).exp_m1() }
    }
    fn depth_of_absorptance(self) -> Self {
        -(-self).ln_1p()
    }
    fn depth_of_chance(self) -> Self {
        -(-self).ln_1p()
    }
    fn sin_octant(self) -> Self {
        self.sin()
    }
    fn cos_octant(self) -> Self {
        self.cos()
    }
    fn arc_tangent(self, x: Self) -> Self {
        self.atan2(x)
    }
}

/// Farther than any hit; finite, so that no infinity enters a sum.
pub const NO_HIT: f64 = 3.0e38;

/// Three numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct V3<R>(pub [R; 3]);

impl<R: Real> V3<R> {
    /// The same number three times.
    pub fn splat(value: R) -> Self {
        Self([value; 3])
    }
    /// A vector of a host struct.
    pub fn of_f32(v: [f32; 3]) -> Self {
        Self(v.map(R::of_f32))
    }
    /// Rounded to f32.
    pub fn to_f32(self) -> [f32; 3] {
        self.0.map(R::to_f32)
    }
    /// x
    pub fn x(self) -> R {
        self.0[0]
    }
    /// y
    pub fn y(self) -> R {
        self.0[1]
    }
    /// z
    pub fn z(self) -> R {
        self.0[2]
    }
    /// The largest of these channels, or 0.
    pub fn largest_of(self, channels: u32) -> R {
        let of = |channel: usize| match channels >> channel & 1 {
            0 => R::of(0.0),
            _ => self.0[channel],
        };
        of(0).max(of(1)).max(of(2))
    }
    /// Number by number.
    #[must_use]
    pub fn zip(self, other: Self, f: impl Fn(R, R) -> R) -> Self {
        Self([0, 1, 2].map(|i| f(self.0[i], other.0[i])))
    }
    /// Each number times a scalar.
    #[must_use]
    pub fn times(self, s: R) -> Self {
        Self(self.0.map(|x| x * s))
    }
    /// Each number divided by a scalar.
    #[must_use]
    pub fn over(self, s: R) -> Self {
        Self(self.0.map(|x| x / s))
    }
    /// (x·x + y·y) + z·z, in this order.
    pub fn dot(self, b: Self) -> R {
        self.x() * b.x() + self.y() * b.y() + self.z() * b.z()
    }
    /// Vector product.
    #[must_use]
    pub fn cross(self, b: Self) -> Self {
        let a = self;
        Self([
            a.y() * b.z() - a.z() * b.y(),
            a.z() * b.x() - a.x() * b.z(),
            a.x() * b.y() - a.y() * b.x(),
        ])
    }
    /// The vector over its length.
    #[must_use]
    pub fn normalize(self) -> Self {
        self.over(self.dot(self).sqrt())
    }
}

impl<R: Real> Add for V3<R> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl<R: Real> Sub for V3<R> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl<R: Real> Mul for V3<R> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }
}

impl<R: Real> Neg for V3<R> {
    type Output = Self;
    fn neg(self) -> Self {
        Self(self.0.map(|x| -x))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two units in the last place, against f64's exponential.
    #[test]
    fn exp_negative_is_within_two_ulp() {
        for i in 0..=800_000 {
            let x = -(i as f32) * 1e-4;
            let (ours, exact) = (f64::from(Real::exp_negative(x)), f64::from(x).exp());
            assert!((ours / exact - 1.0).abs() < 2.0 * f64::from(f32::EPSILON), "x = {x}: {ours}");
        }
        assert_eq!(Real::exp_negative(0.0f32), 1.0);
        assert_eq!(Real::exp_negative(-81.0f32), 0.0);
    }

    /// Three units in the last place, against f64's power.
    #[test]
    fn powers_of_two_are_within_three_ulp() {
        for i in -126_000..=126_000 {
            let x = i as f32 * 1e-3;
            let (ours, exact) = (f64::from(x.power_of_two()), f64::from(x).exp2());
            assert!((ours / exact - 1.0).abs() < 3.0 * f64::from(f32::EPSILON), "x = {x}: {ours}");
        }
        assert_eq!(
            [-126.0f32, 0.0, 126.0].map(Real::power_of_two),
            [126, 0, -126].map(|n| 0.5f32.powi(n))
        );
    }

    /// Three units in the last place, against f64's, over 45 decades of optical depth.
    #[test]
    fn absorptance_keeps_its_digits() {
        for i in 0..=900_000 {
            let x = 10f64.powf(-37.0 + f64::from(i) * 4e-5 * 1.1) as f32;
            let (ours, exact) = (f64::from(x.absorptance()), -(-f64::from(x)).exp_m1());
            assert!((ours / exact - 1.0).abs() < 3.0 * f64::from(f32::EPSILON), "x = {x}: {ours}");
            let mean = f64::from(x.mean_transmittance()) * f64::from(x);
            assert!((mean / exact - 1.0).abs() < 4.0 * f64::from(f32::EPSILON), "x = {x}: {mean}");
        }
        assert_eq!([0.0f32, 100.0, f32::INFINITY].map(Real::absorptance), [0.0, 1.0, 1.0]);
        assert_eq!(0.0f32.mean_transmittance(), 1.0);
    }

    /// Four units in the last place, against f64's.
    #[test]
    fn the_depth_of_an_absorptance_keeps_its_digits() {
        for i in 0..=100_000 {
            let x = (0.5 * 10f64.powf(-f64::from(i) * 3e-4)) as f32;
            let (ours, exact) = (f64::from(x.depth_of_absorptance()), -(-f64::from(x)).ln_1p());
            assert!((ours / exact - 1.0).abs() < 4.0 * f64::from(f32::EPSILON), "x = {x}: {ours}");
        }
        assert_eq!(0.0f32.depth_of_absorptance(), 0.0);
    }

    /// One unit in the last place, against f64's functions, all over the octants.
    #[test]
    fn sine_and_cosine_are_within_one_ulp() {
        for i in -785_398..=785_398 {
            let x = i as f32 * 1e-6;
            let ulp = |exact: f64| {
                let bits = (exact as f32).abs().to_bits();
                f64::from(f32::from_bits(bits + 1)) - f64::from(f32::from_bits(bits))
            };
            let (sin, cos) = f64::from(x).sin_cos();
            let (ours_sin, ours_cos) =
                (f64::from(Real::sin_octant(x)), f64::from(Real::cos_octant(x)));
            assert!((ours_sin - sin).abs() <= ulp(sin), "sin {x}: {ours_sin}");
            assert!((ours_cos - cos).abs() <= ulp(cos), "cos {x}: {ours_cos}");
        }
        assert_eq!((Real::sin_octant(0.0f32), Real::cos_octant(0.0f32)), (0.0, 1.0));
    }

    /// Four units in the last place, against f64's, all around and close to the axes.
    #[test]
    fn arc_tangent_is_within_four_ulp() {
        let check = |y: f32, x: f32| {
            let (ours, exact) = (f64::from(y.arc_tangent(x)), f64::from(y).atan2(f64::from(x)));
            let bound = 4.0 * f64::from(f32::EPSILON) * exact.abs();
            assert!((ours - exact).abs() <= bound, "({x}, {y}): {ours}, not {exact}");
        };
        for i in 0..200_000 {
            let angle = f64::from(i) * (std::f64::consts::TAU / 200_000.0) + 1e-6;
            check(angle.sin() as f32, angle.cos() as f32);
        }
        for tiny in [1e-30, 1e-12, 1e-7, 1e-3] {
            for (y, x) in [(tiny, 1.0), (tiny, -1.0), (1.0, tiny), (1.0, -tiny)] {
                check(y, x);
                check(-y, x);
            }
        }
        assert_eq!(0.0f32.arc_tangent(0.0), 0.0);
        assert_eq!(0.0f32.arc_tangent(-1.0), std::f32::consts::PI);
    }
}
