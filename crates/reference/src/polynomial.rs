//! Twin of `glsl/shared/polynomial.glsl`: where a ray meets the polynomial of one point.

use crate::real::{NO_HIT, Real, V3};
use kernels::layout;

/// Of the trust radius: how far a ray may still meet the sheet that it starts on.
pub const SHEET_REACH: f64 = 0.5;
const ENTRY_MARGIN: f64 = 0.0625; // of the trust radius
const SHEET_HEIGHT: f64 = 0.3;
const SHEET_COSINE: f64 = 0.5;

/// The surface near one point, in world form: with y = x − center,
/// gradient · y − offset − yᵀ M y = 0 where |y| ≤ trust (method, section 1, step 3).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Polynomial<R> {
    /// p
    pub center: V3<R>,
    /// b; 0 where the point carries no surface.
    pub trust: R,
    /// m = n − E u − F v
    pub gradient: V3<R>,
    /// D
    pub offset: R,
    /// M: xx, yy, zz
    pub diagonal: V3<R>,
    /// M: xy, xz, yz
    pub off: V3<R>,
    /// Index of the object in the scene.
    pub object: u32,
    /// Place in its file.
    pub index: u32,
}

impl From<Polynomial<f32>> for layout::Polynomial {
    fn from(p: Polynomial<f32>) -> Self {
        let [x, y, z] = p.center.0;
        let [mx, my, mz] = p.gradient.0;
        let [xx, yy, zz] = p.diagonal.0;
        let [xy, xz, yz] = p.off.0;
        Self {
            center_trust: [x, y, z, p.trust],
            gradient_offset: [mx, my, mz, p.offset],
            curvature: [xx, yy, zz, xy],
            cross_terms: [xz, yz],
            object: p.object,
            index: p.index,
        }
    }
}

impl<R: Real> From<&layout::Polynomial> for Polynomial<R> {
    fn from(p: &layout::Polynomial) -> Self {
        let vector = |v: [f32; 4]| V3::of_f32([v[0], v[1], v[2]]);
        Self {
            center: vector(p.center_trust),
            trust: R::of_f32(p.center_trust[3]),
            gradient: vector(p.gradient_offset),
            offset: R::of_f32(p.gradient_offset[3]),
            diagonal: vector(p.curvature),
            off: V3::of_f32([p.curvature[3], p.cross_terms[0], p.cross_terms[1]]),
            object: p.object,
            index: p.index,
        }
    }
}

/// The nearest approach of a ray to a point: s along the ray, y₀ from the point.
fn nearest_approach<R: Real>(o: V3<R>, d: V3<R>, center: V3<R>) -> (R, V3<R>) {
    let from_center = o - center;
    let s = -from_center.dot(d);
    (s, from_center + d.times(s))
}

impl<R: Real> Polynomial<R> {
    /// M v
    pub fn apply_curvature(&self, v: V3<R>) -> V3<R> {
        let [xx, yy, zz] = self.diagonal.0;
        let [xy, xz, yz] = self.off.0;
        V3([
            xx * v.x() + xy * v.y() + xz * v.z(),
            xy * v.x() + yy * v.y() + yz * v.z(),
            xz * v.x() + yz * v.y() + zz * v.z(),
        ])
    }

    /// Whether the ray comes within the trust ball at a distance that can still matter.
    pub fn near_trust_ball(&self, o: V3<R>, d: V3<R>, nearest: R) -> bool {
        let (s, y0) = nearest_approach(o, d, self.center);
        let b = self.trust;
        y0.dot(y0) <= b * b && s + b > R::of(0.0) && s - b <= nearest
    }

    /// Whether the ray enters the trust ball on its way through the range of distances, or nearly.
    pub fn entered_within(&self, o: V3<R>, d: V3<R>, within: [R; 2]) -> bool {
        let (s, y0) = nearest_approach(o, d, self.center);
        let b = self.trust;
        let under_root = b * b - y0.dot(y0); // the ray enters at s - its root
        let margin = R::of(ENTRY_MARGIN) * b;
        let behind_low = s - (within[0] - margin);
        let behind_high = s - (within[1] + margin);
        behind_low >= R::of(0.0)
            && behind_low * behind_low >= under_root
            && (behind_high <= R::of(0.0) || behind_high * behind_high <= under_root)
    }

    /// The unit normal of the polynomial's own level through x.
    pub fn normal_at(&self, x: V3<R>) -> V3<R> {
        let y = x - self.center;
        (self.gradient - self.apply_curvature(y).times(R::of(2.0))).normalize()
    }

    /// Whether this is the sheet that a ray starts on at o, where its normal is `normal`.
    pub fn same_sheet(&self, o: V3<R>, normal: V3<R>) -> bool {
        let y = o - self.center;
        let curved = self.apply_curvature(y);
        let gradient = self.gradient - curved.times(R::of(2.0));
        let steepness = gradient.dot(gradient).sqrt();
        let height = (self.gradient.dot(y) - self.offset) - y.dot(curved);
        height.abs() < (R::of(SHEET_HEIGHT) * self.trust) * steepness
            && gradient.dot(normal).abs() > R::of(SHEET_COSINE) * steepness
    }

    /// Nearest t > from where o + t d meets the polynomial inside its trust ball, or [`NO_HIT`]. d has
    /// unit length.
    pub fn intersect(&self, o: V3<R>, d: V3<R>, from: R) -> R {
        let zero = R::of(0.0);
        let b = self.trust;
        let (s, y0) = nearest_approach(o, d, self.center);
        let m = self.gradient;
        let curved = self.apply_curvature(d);
        let a2 = -d.dot(curved);
        let a1 = m.dot(d) - R::of(2.0) * y0.dot(curved);
        let a0 = (m.dot(y0) - self.offset) - y0.dot(self.apply_curvature(y0));
        let discriminant = a1 * a1 - R::of(4.0) * a2 * a0;
        let root = discriminant.max(zero).sqrt();
        let q = R::of(-0.5) * if a1 < zero { a1 - root } else { a1 + root };
        let r1 = if q != zero { a0 / q } else { R::of(NO_HIT) };
        let r2 = if a2 != zero { q / a2 } else { R::of(NO_HIT) };
        let (first, second) = if r1 < r2 { (r1, r2) } else { (r2, r1) };
        let counts = |root: R| {
            let y = y0 + d.times(root);
            discriminant >= zero && root.abs() <= b && y.dot(y) <= b * b && s + root > from
        };
        if counts(first) {
            s + first
        } else if counts(second) {
            s + second
        } else {
            R::of(NO_HIT)
        }
    }

    /// The hit at distance t relative to the point, and the unit normal there, facing the ray's
    /// origin.
    pub fn surface_at(&self, o: V3<R>, d: V3<R>, t: R) -> (V3<R>, V3<R>) {
        let (s, y0) = nearest_approach(o, d, self.center);
        let y = y0 + d.times(t - s);
        let gradient = (self.gradient - self.apply_curvature(y).times(R::of(2.0))).normalize();
        (y, if gradient.dot(d) > R::of(0.0) { -gradient } else { gradient })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plane(trust: f64) -> Polynomial<f64> {
        Polynomial {
            center: V3([1.0, 2.0, 3.0]),
            trust,
            gradient: V3([0.0, 0.0, 1.0]),
            offset: 0.0,
            diagonal: V3::splat(0.0),
            off: V3::splat(0.0),
            object: 0,
            index: 0,
        }
    }

    #[test]
    fn a_plane_is_hit_inside_its_trust_ball_alone() {
        let down = V3([0.0, 0.0, -1.0]);
        assert_eq!(plane(0.5).intersect(V3([1.25, 2.0, 10.0]), down, 0.0), 7.0);
        assert_eq!(plane(0.5).intersect(V3([1.75, 2.0, 10.0]), down, 0.0), NO_HIT);
        assert_eq!(
            plane(0.5).intersect(V3([1.25, 2.0, 2.0]), down, 0.0),
            NO_HIT,
            "behind the origin"
        );
        assert_eq!(
            plane(0.5).intersect(V3([1.25, 2.0, 3.25]), down, 0.0),
            0.25,
            "from inside the ball"
        );
        let (y, normal) = plane(0.5).surface_at(V3([1.25, 2.0, 10.0]), down, 7.0);
        assert_eq!((y, normal), (V3([0.25, 0.0, 0.0]), V3([0.0, 0.0, 1.0])));
    }

    /// z = x² seen along −x: two roots in the ball, the smaller t first; the second counts where the
    /// first lies outside.
    #[test]
    fn both_roots_count_and_the_smaller_comes_first() {
        let mut bowl = plane(1.0);
        bowl.diagonal = V3([1.0, 0.0, 0.0]);
        let along = V3([-1.0, 0.0, 0.0]);
        let t = bowl.intersect(V3([11.0, 2.0, 3.25]), along, 0.0);
        assert!((t - 9.5).abs() < 1e-14, "x = 0.5 comes before x = -0.5; t = {t}");
        let t = bowl.intersect(V3([1.25, 2.0, 3.25]), along, 0.0);
        assert!((t - 0.75).abs() < 1e-14, "from between the two roots; t = {t}");
        assert_eq!(bowl.intersect(V3([11.0, 2.0, 2.75]), along, 0.0), NO_HIT, "below the bowl");
    }

    /// The perpendicular distance decides before anything is squared that is far away: with the
    /// textbook discriminant 1e-4 vanishes beside 1e8.
    #[test]
    fn small_far_ball_is_hit_in_f32() {
        let p = Polynomial::<f32> {
            center: V3([0.0, 0.0, 1e4]),
            trust: 1e-2,
            gradient: V3([0.0, 0.0, 1.0]),
            offset: 0.0,
            diagonal: V3::splat(0.0),
            off: V3::splat(0.0),
            object: 0,
            index: 0,
        };
        let d = V3([0.0, 0.0, 1.0]);
        assert!(p.near_trust_ball(V3([0.009, 0.0, 0.0]), d, 3e38));
        assert!(!p.near_trust_ball(V3([0.011, 0.0, 0.0]), d, 3e38));
        assert_eq!(p.intersect(V3([0.009, 0.0, 0.0]), d, 0.0), 1e4);
    }
}
