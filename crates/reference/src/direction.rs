//! Twin of `glsl/shared/direction.glsl`: unit vectors: about an axis, and in 32 bits.

use crate::real::{Real, V3};

/// The direction at two sines about a unit axis.
pub(crate) fn about_axis<R: Real>(axis: V3<R>, s: [R; 2], cosine: R) -> V3<R> {
    let one = R::of(1.0);
    let [x, y, z] = axis.0;
    let side = if z >= R::of(0.0) { one } else { -one };
    let a = -one / (side + z);
    let b = x * y * a;
    let first = V3([one + side * x * x * a, side * b, -side * x]);
    let second = V3([b, side + y * y * a, -y]);
    (first.times(s[0]) + second.times(s[1])) + axis.times(cosine)
}

/// Cosine and sine of an angle in turns, 0 to 1.
pub(crate) fn on_circle<R: Real>(turns: R) -> [R; 2] {
    let quarters = (R::of(4.0) * turns + R::of(0.5)).floor();
    let rest = (turns - R::of(0.25) * quarters) * R::of(std::f64::consts::TAU);
    let (s, c) = (rest.sin_octant(), rest.cos_octant());
    match quarters.to_u32() & 3 {
        0 => [c, s],
        1 => [-s, c],
        2 => [-c, -s],
        _ => [s, -c],
    }
}

/// The outer corners of the square, which are the lower half of the octahedron, are folded inwards, and back.
fn folded<R: Real>([x, y]: [R; 2]) -> [R; 2] {
    let (zero, one) = (R::of(0.0), R::of(1.0));
    let sign = |p: R| if p < zero { -one } else { one };
    [(one - y.abs()) * sign(x), (one - x.abs()) * sign(y)]
}

/// As 16 bits an axis of an octahedron that is unfolded to a square.
pub(crate) fn packed_direction<R: Real>(v: V3<R>) -> u32 {
    let V3([x, y, z]) = v;
    let sum = (x.abs() + y.abs()) + z.abs();
    let mut p = [x / sum, y / sum];
    if z < R::of(0.0) {
        p = folded(p);
    }
    let [x, y] = p.map(|p| (p * R::of(32767.0) + R::of(32767.5)).to_u32());
    x | y << 16
}

/// What comes back.
pub(crate) fn unpacked_direction<R: Real>(packed: u32) -> V3<R> {
    let [x, y] = [packed & 0xffff, packed >> 16]
        .map(|word| (R::of_u32(word) - R::of(32767.0)) / R::of(32767.0));
    let z = (R::of(1.0) - x.abs()) - y.abs();
    let [x, y] = if z < R::of(0.0) { folded([x, y]) } else { [x, y] };
    V3([x, y, z]).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Half a step of 1/32767 along both axes of the square, times the most that the octahedron is stretched by, √3
    /// and a little, is 6.5e-5.
    #[test]
    fn directions_come_back() {
        for i in 0..10_000 {
            let (a, b) = (f64::from(i) * 2.399_963, 1.0 - f64::from(i) / 4999.5);
            let r = (1.0 - b * b).max(0.0).sqrt();
            let v = V3([r * a.cos(), r * a.sin(), b]);
            let back: V3<f64> = unpacked_direction(packed_direction(v));
            let off = back - v;
            assert!(off.dot(off).sqrt() < 7e-5, "{v:?}: {back:?}");
        }
    }
}
