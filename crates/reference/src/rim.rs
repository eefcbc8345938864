//! Twin of `glsl/shared/rim.glsl` and `clip_balls`: where the surface of an open set ends, after Adamson
//! and Alexa 2004 (method, section 2). Lengths are in units of the reach of the neighbours.

use crate::polynomial::Polynomial;
use crate::real::{Real, V3};
use kernels::layout::BallClip;

const STEPS: u32 = 6;
const LEAST: f64 = 0.05;
const FARTHEST: f64 = 1.5;
const FLATTEST: f64 = 0.2;

/// Cells that reach farther may lie at a rim.
pub const OPEN: f64 = 0.8;
/// Way to the centroid that has a direction.
pub const SHORTEST: f64 = 1e-6;

/// How far along e the surface goes on from its point, at the origin: to where the distance to the
/// weighted centroid is the limit.
pub fn reach_of_rim<R: Real, I: Iterator<Item = V3<R>>>(
    neighbors: impl Fn() -> I,
    e: V3<R>,
    limit: R,
) -> R {
    let (zero, one) = (R::of(0.0), R::of(1.0));
    let mut s = zero;
    for _ in 0..STEPS {
        let mut total = (-(s * s)).exp_negative();
        let (mut first, mut second) = (zero, zero);
        for y in neighbors() {
            let d = y - e.times(s);
            let weight = (-d.dot(d)).exp_negative();
            let along = y.dot(e);
            let moment = weight * along;
            total = total + weight;
            first = first + moment;
            second = second + moment * along;
        }
        let mean = first / total;
        let variance = second / total - mean * mean;
        let slope = (one - R::of(2.0) * variance).max(R::of(FLATTEST));
        s = (s - ((s - mean) - limit) / slope).max(-one).min(R::of(FARTHEST));
    }
    s.max(R::of(LEAST))
}

/// The same surfaces, some of them in another ball. Polynomials are by slot.
pub fn clip_balls<R: Real>(polynomials: &mut [Polynomial<R>], clips: &[BallClip]) {
    for clip in clips {
        clip_one(&mut polynomials[clip.slot as usize], clip);
    }
}

fn clip_one<R: Real>(p: &mut Polynomial<R>, clip: &BallClip) {
    let center = p.center + V3::of_f32(clip.shift);
    let moved = center - p.center;
    let curved = p.apply_curvature(moved);
    p.offset = (p.offset - p.gradient.dot(moved)) + moved.dot(curved);
    p.gradient = p.gradient - curved.times(R::of(2.0));
    p.center = center;
    p.trust = R::of_f32(clip.trust);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A half plane of even points, seen from its rim: the surface ends half a spacing beyond.
    #[test]
    fn a_straight_rim_ends_half_a_spacing_beyond_its_points() {
        let spacing = 1.0 / 3.0; // the farthest of 16 neighbours is three away
        let half_plane = || {
            (-3..=3)
                .flat_map(|x| (0..=3).map(move |y| (x, y)))
                .filter(|&(x, y)| x * x + y * y <= 9 && (x, y) != (0, 0) && (x, y) != (-3, 0))
        };
        assert_eq!(half_plane().count(), 16);
        let points = || {
            half_plane().map(|(x, y)| V3([f64::from(x), f64::from(-y), 0.0].map(|c| c * spacing)))
        };
        let reach = reach_of_rim(points, V3([0.0, 1.0, 0.0]), 0.47);
        assert!((reach / spacing - 0.5).abs() < 0.15, "{} spacings", reach / spacing);
    }

    #[test]
    fn a_clipped_ball_holds_the_same_surface() {
        let mut p = Polynomial {
            center: V3([1.0, 2.0, 3.0]),
            trust: 1.0,
            gradient: V3([0.1, -0.2, 1.0]),
            offset: 0.05,
            diagonal: V3([0.3, -0.2, 0.1]),
            off: V3([0.05, -0.07, 0.02]),
            object: 0,
            index: 0,
        };
        let (o, d) = (V3([0.8, 2.1, 9.0]), V3([0.0, 0.0, -1.0]));
        let before = p.intersect(o, d, 0.0);
        clip_one(&mut p, &BallClip { slot: 0, trust: 0.75, shift: [-0.25, 0.0, 0.0] });
        assert!((p.intersect(o, d, 0.0) - before).abs() < 1e-12);
        assert!(p.intersect(V3([1.55, 2.0, 9.0]), d, 0.0) > 1e30, "beyond the clipped ball");
    }
}
