//! Which media the camera is in, where given normals or spheres say so (docs/method.md, section 6).
//!
//! Rays start outside of everything, and hits tell what they enter and leave: a ray alone cannot know
//! that it began inside. Normals of a file point outwards, so the points nearest to the eye know; of an object of
//! spheres, each of them does.

use crate::bulk::World;
use kernels::layout::MEDIA_WORDS;
use points::{Cloud, PointSet, ShapeKind, Shapes};
use scene::{MaterialKind, Object, Scene, SurfaceKind};
use std::sync::Arc;

/// Points asked: one normal alone may be wrong.
const ASKED: usize = 8;

/// The objects of glass that the eye is inside, as many as a path can hold; those of spheres once for each sphere.
/// `world` has the points of each object in the world.
pub(crate) fn media_of_eye(
    scene: &Scene,
    sets: &[Arc<PointSet>],
    world: &[World],
    (cloud, shapes): (&Cloud, &[Shapes]),
    eye: [f64; 3],
) -> Vec<u32> {
    let is_glass = |object: &Object| matches!(object.material.kind, MaterialKind::Glass { .. });
    let spheres = (shapes.iter())
        .filter(|shapes| shapes.kind == ShapeKind::Sphere)
        .filter(|shapes| is_glass(&scene.objects[shapes.object as usize]))
        .flat_map(|shapes| {
            let points = &cloud.points[shapes.slots().range()];
            let holds = points.iter().zip(&shapes.radii).filter(|(point, radius)| {
                let from =
                    |axis: usize| eye[axis] - cloud.origin[axis] - f64::from(point.position[axis]);
                let square: f64 = [0, 1, 2].map(|axis| from(axis) * from(axis)).iter().sum();
                square < f64::from(**radius) * f64::from(**radius)
            });
            holds.map(|_| shapes.object)
        });
    let inside = scene.objects.iter().zip(sets).zip(world).zip(0u32..).filter_map(
        |(((object, set), positions), index)| {
            let by_normals =
                is_glass(object) && !matches!(object.surface.kind, SurfaceKind::Spheres(_));
            let normals = set.normals.as_ref().filter(|_| by_normals)?;
            let turned = |i: usize| object.transform.rotate(normals[i].map(f64::from));
            is_inside(positions, turned, eye).then_some(index)
        },
    );
    inside.chain(spheres).take(2 * MEDIA_WORDS as usize).collect()
}

/// Whether most of the nearest points have the eye behind them.
fn is_inside(positions: &[[f64; 3]], normal: impl Fn(usize) -> [f64; 3], eye: [f64; 3]) -> bool {
    let from = |i: usize| [0, 1, 2].map(|axis| eye[axis] - positions[i][axis]);
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let mut nearest: Vec<(f64, usize)> =
        (0..positions.len()).map(|i| (dot(from(i), from(i)), i)).collect();
    let count = ASKED.min(nearest.len());
    if count == 0 {
        return false;
    }
    nearest.select_nth_unstable_by(count - 1, |a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    // A normal that is no number, or zero, has no say.
    let votes = nearest[..count].iter().map(|&(_, i)| dot(from(i), normal(i)));
    votes.map(|side| i32::from(side < 0.0) - i32::from(side > 0.0)).sum::<i32>() > 0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ball() -> Vec<[f64; 3]> {
        let lattice = |i: u32| {
            let z = 1.0 - (2.0 * f64::from(i) + 1.0) / 500.0;
            let (sin, cos) = (2.4 * f64::from(i)).sin_cos();
            let r = (1.0 - z * z).sqrt();
            [r * cos, r * sin, z]
        };
        (0..500).map(lattice).collect()
    }

    #[test]
    fn the_side_of_the_nearest_points_decides() {
        let ball = ball();
        let outwards = |i: usize| ball[i];
        let inwards = |i: usize| ball[i].map(|x| -x);
        assert!(is_inside(&ball, outwards, [0.1, 0.2, -0.3]));
        assert!(!is_inside(&ball, outwards, [0.0, 1.2, 0.0]));
        assert!(!is_inside(&ball, inwards, [0.1, 0.2, -0.3]));
        assert!(!is_inside(&ball, |_| [f64::NAN; 3], [0.0; 3]), "no number");
        assert!(!is_inside(&[], outwards, [0.0; 3]), "no points");
    }

    #[test]
    fn one_wrong_normal_is_outvoted() {
        let ball = ball();
        let one_wrong = |i: usize| if i == 250 { ball[i].map(|x| -x) } else { ball[i] };
        assert!(is_inside(&ball, one_wrong, ball[250].map(|x| 0.9 * x)));
    }
}
