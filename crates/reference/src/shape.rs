//! Twin of `shape_spheres`, `shape_discs` and `glsl/shared/shape.glsl`: points that are drawn as spheres and discs.

use crate::fit_polynomials::Fitted;
use crate::media::Way;
use crate::polynomial::Polynomial;
use crate::real::{NO_HIT, Real, V3};
use kernels::layout::{FIT_DISC, FIT_NO_SURFACE, FIT_SPHERE, Point, Rim};
use points::{ShapeKind, Shapes};

const SPHERE_MARGIN: f64 = 1.00001; // trust radius over radius
const NO_NORMAL: f64 = 0.5;

/// The sphere about a point: (|y|² − r²) / 2r.
pub fn shape_spheres<R: Real>(point: &Point, radius: f32, object: u32) -> Polynomial<R> {
    let is_drawn = radius >= Shapes::SMALLEST;
    let (zero, r) = (R::of(0.0), if is_drawn { R::of_f32(radius) } else { R::of(1.0) });
    Polynomial {
        center: V3::of_f32(point.position),
        trust: if is_drawn { r * R::of(SPHERE_MARGIN) } else { zero },
        gradient: V3::splat(zero),
        offset: R::of(0.5) * r,
        diagonal: V3::splat(R::of(-0.5) / r),
        off: V3::splat(zero),
        object,
        index: point.index,
    }
}

/// The disc about a point, across the normal or, where there is none, across z.
pub fn shape_discs<R: Real>(
    point: &Point,
    radius: f32,
    normal: V3<R>,
    object: u32,
) -> Polynomial<R> {
    let zero = R::of(0.0);
    let is_known = normal.dot(normal) > R::of(NO_NORMAL);
    let across = if is_known { normal } else { V3([zero, zero, R::of(1.0)]) };
    Polynomial {
        center: V3::of_f32(point.position),
        trust: if radius >= Shapes::SMALLEST { R::of_f32(radius) } else { zero },
        gradient: across.normalize(),
        offset: zero,
        diagonal: V3::splat(zero),
        off: V3::splat(zero),
        object,
        index: point.index,
    }
}

/// The shapes of one object, by slot. `planes` are those that were fitted, where discs have no normals.
pub fn shapes_of<R: Real>(
    points: &[Point],
    shapes: &Shapes,
    planes: &[Fitted<R>],
) -> Vec<Fitted<R>> {
    let shape = |(i, point): (usize, &Point)| {
        let radius = shapes.radii[i];
        let normal = match (&shapes.normals, planes.get(i)) {
            (Some(normals), _) => V3::of_f32(normals[i]),
            (None, Some(plane)) if plane.kind != FIT_NO_SURFACE => plane.polynomial.gradient,
            (None, _) => V3::splat(R::of(0.0)),
        };
        let (polynomial, kind) = match shapes.kind {
            ShapeKind::Sphere => (shape_spheres(point, radius, shapes.object), FIT_SPHERE),
            ShapeKind::Disc => (shape_discs(point, radius, normal, shapes.object), FIT_DISC),
        };
        let kind = if polynomial.trust > R::of(0.0) { kind } else { FIT_NO_SURFACE };
        Fitted { polynomial, kind, feature_size: R::of_f32(radius), rim: Rim::default() }
    };
    points[shapes.slots().range()].iter().enumerate().map(shape).collect()
}

impl<R: Real> Polynomial<R> {
    /// Whether it is a sphere: no other polynomial has m = 0.
    pub fn is_sphere(&self) -> bool {
        self.gradient.0.iter().all(|&m| m == R::of(0.0))
    }

    /// Where a ray that starts on this sphere meets it again: on the far side, if it goes inwards.
    pub fn far_side(&self, o: V3<R>, d: V3<R>) -> R {
        let s = -(o - self.center).dot(d);
        if s > R::of(0.0) { R::of(2.0) * s } else { R::of(NO_HIT) }
    }

    /// The way of a ray through its surface at distance t: each sphere is entered and left for itself.
    pub fn way_through(&self, o: V3<R>, d: V3<R>, t: R) -> Way {
        match self.is_sphere() {
            false => Way::Either,
            true if t < -(o - self.center).dot(d) => Way::In,
            true => Way::Out,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const POINT: Point = Point { position: [1.0, 2.0, 3.0], index: 5 };

    fn sphere(radius: f32) -> Polynomial<f32> {
        shape_spheres(&POINT, radius, 0)
    }

    #[test]
    fn a_ray_meets_a_sphere_at_its_distance_less_the_radius() {
        let along = V3([1.0, 0.0, 0.0]);
        for radius in [1e-12, 1e-6, 0.25, 1e6] {
            let point = Point { position: [0.0; 3], index: 0 };
            let o = V3([-4.0 * radius, 0.0, 0.0]);
            let t = shape_spheres(&point, radius, 0).intersect(o, along, 0.0);
            // Some steps of f32 at 3.
            assert!((t / radius - 3.0).abs() <= 1e-6, "{radius}: {t}");
        }
        let beside = V3([0.0, 2.2501, 3.0]);
        assert_eq!(sphere(0.25).intersect(beside, along, 0.0), NO_HIT as f32);
    }

    /// Of random chords, down to one 1e-3 of the radius, the near end is no hit and the far end is.
    #[test]
    fn a_ray_that_leaves_a_sphere_inwards_meets_the_far_side_alone() {
        let (radius, center) = (0.25, V3(POINT.position));
        let sphere = sphere(radius);
        for i in 0..200 {
            let angle = 0.37 * i as f32;
            let [out, across] = [V3([angle.cos(), angle.sin(), 0.0]), V3([0.0, 0.0, 1.0])];
            let o = center + out.times(radius);
            for slope in [1.0, 0.1, 1e-2, 5e-4] {
                let d = (across - out.times(slope)).normalize();
                let t = sphere.far_side(o, d);
                let chord = 2.0 * radius * slope / (1.0 + slope * slope).sqrt();
                // Positions near 3 are rounded by 2.4e-7.
                assert!((t - chord).abs() < 1.2e-6, "{slope}: {t} and {chord}");
                assert_eq!(sphere.way_through(o, d, t), Way::Out);
                let away = (across + out.times(slope)).normalize();
                assert_eq!(sphere.far_side(o, away), NO_HIT as f32);
            }
        }
    }

    #[test]
    fn what_has_no_radius_is_not_drawn_and_no_number_is_wrong() {
        for radius in [0.0, 1e-20, 9e-16] {
            let sphere = sphere(radius);
            assert_eq!(sphere.trust, 0.0);
            assert!(sphere.diagonal.0.iter().all(|x: &f32| x.is_finite()));
        }
        let disc = shape_discs::<f32>(&POINT, 0.5, V3([0.0; 3]), 0);
        assert_eq!((disc.trust, disc.gradient), (0.5, V3([0.0, 0.0, 1.0])));
    }
}
