//! Which media the camera is in (docs/method.md, section 6).
//!
//! Rays start outside of everything, and hits say what they enter and leave: a ray alone cannot know that it began
//! inside. What is inside is what `camera.inside` says. Else spheres know, an isosurface's scalar does, normals of a file
//! point outwards, and around the eye the surfaces can be counted ([`crate::crossings`]).

use crate::bulk::World;
use crate::crossings::{Votes, votes};
use crate::field;
use crate::shapes::surface_slots;
use crate::volumes::Volumes;
use kernels::layout::{
    LIGHT_POINT, Light, MEDIA_WORDS, VOLUME_ISOSURFACE, VOLUME_SHEPARD, VolumeInfo,
};
use points::{Cloud, PointSet, ShapeKind, Shapes};
use scene::{Scene, SurfaceKind};
use std::ops::Range;
use std::sync::Arc;

/// Points whose normals are asked: one normal alone may be wrong.
const ASKED: usize = 8;

/// Point lights of which it is asked what they are inside of.
const MOST_LAMPS: usize = 16;

/// What is known of the points of a scene.
pub(crate) struct Known<'a> {
    pub sets: &'a [Arc<PointSet>],
    /// The points of each object in the world.
    pub world: &'a [World],
    pub cloud: &'a Cloud,
    pub shapes: &'a [Shapes],
    pub volumes: &'a Volumes,
}

/// The objects of glass that the eye is inside, as many as a path can hold, those of spheres once for each sphere; and
/// what is in doubt, a sentence each.
pub(crate) fn media_of_eye(
    scene: &Scene,
    known: &Known<'_>,
    eye: [f64; 3],
) -> (Vec<u32>, Vec<String>) {
    let (mut media, mut spheres, mut doubts) = (Vec::new(), Vec::new(), Vec::new());
    for (object, index) in scene.objects.iter().zip(0u32..) {
        if !object.material.kind.has_inside() {
            continue;
        }
        let held = spheres_around(known, index, eye);
        if let Some(names) = &scene.inside {
            if names.contains(&object.name) {
                media.push(index);
                spheres.extend((1..held).map(|_| index));
            }
            continue;
        }
        spheres.extend((0..held).map(|_| index));
        if matches!(object.surface.kind, SurfaceKind::Spheres(_)) {
            continue;
        }
        let (inside, doubt) = match above_isosurface(known.volumes, index, local(known, eye)) {
            Some(above) => (above, None),
            None => by_surface(scene, known, index, eye),
        };
        media.extend(inside.then_some(index));
        doubts.extend(doubt);
    }
    media.extend(spheres);
    media.truncate(2 * MEDIA_WORDS as usize);
    (media, doubts)
}

/// Of each light, the objects of glass that it is inside, or may be: a part of it, or in doubt. None of a light infinitely
/// far away. `None` where there are too many lights to ask, or more objects than a path can hold. `eye` has its media beside
/// it: a light there has them, too.
pub(crate) fn media_of_lamps(
    scene: &Scene,
    known: &Known<'_>,
    lights: &[Light],
    (eye, of_eye): ([f64; 3], &[u32]),
) -> Vec<Option<Vec<u32>>> {
    let has_inside = |index: u32| scene.objects[index as usize].material.kind.has_inside();
    let asked = lights.iter().filter(|light| light.kind == LIGHT_POINT).count();
    let of = |light: &Light| {
        if light.kind != LIGHT_POINT {
            return Some(Vec::new());
        }
        if asked > MOST_LAMPS {
            return None;
        }
        let middle = [0, 1, 2].map(|axis| f64::from(light.vector[axis]) + known.cloud.origin[axis]);
        let radius = f64::from(light.extent);
        let mut places = vec![middle];
        for axis in 0..if radius > 0.0 { 3 } else { 0 } {
            for side in [-radius, radius] {
                let mut place = middle;
                place[axis] += side;
                places.push(place);
            }
        }
        let local_eye = local(known, eye).map(|x| x as f32);
        let is_at_eye = light.vector == local_eye;
        let may_be_in = |&index: &u32| {
            has_inside(index)
                && ((is_at_eye && of_eye.contains(&index))
                    || places.iter().any(|&place| may_be_inside(scene, known, index, place)))
        };
        let media: Vec<u32> = (0..scene.objects.len() as u32).filter(may_be_in).collect();
        (media.len() <= 2 * MEDIA_WORDS as usize).then_some(media)
    };
    lights.iter().map(of).collect()
}

/// Whether a place is inside an object of glass, or that is in doubt.
fn may_be_inside(scene: &Scene, known: &Known<'_>, index: u32, place: [f64; 3]) -> bool {
    if spheres_around(known, index, place) > 0 {
        return true;
    }
    if matches!(scene.objects[index as usize].surface.kind, SurfaceKind::Spheres(_)) {
        return false;
    }
    above_isosurface(known.volumes, index, local(known, place)).unwrap_or_else(|| {
        let (inside, doubt) = by_surface(scene, known, index, place);
        inside || doubt.is_some()
    })
}

/// The eye in the kernels' coordinates.
fn local(known: &Known<'_>, eye: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|axis| eye[axis] - known.cloud.origin[axis])
}

/// How many spheres of an object hold the eye.
fn spheres_around(known: &Known<'_>, object: u32, eye: [f64; 3]) -> usize {
    let eye = local(known, eye);
    let own = |shapes: &&Shapes| shapes.kind == ShapeKind::Sphere && shapes.object == object;
    let around = |shapes: &Shapes| {
        let points = &known.cloud.points[shapes.slots().range()];
        let holds = points.iter().zip(&shapes.radii).filter(|(point, radius)| {
            let from = |axis: usize| eye[axis] - f64::from(point.position[axis]);
            let square: f64 = [0, 1, 2].map(|axis| from(axis) * from(axis)).iter().sum();
            square < f64::from(**radius) * f64::from(**radius)
        });
        holds.count()
    };
    known.shapes.iter().filter(own).map(around).sum()
}

/// Whether the scalar of an object's isosurface is over its number at a place in the kernels' coordinates; `None` where
/// it has no isosurface.
fn above_isosurface(volumes: &Volumes, object: u32, place: [f64; 3]) -> Option<bool> {
    let own =
        |of: &(&VolumeInfo, Range<usize>)| of.0.object == object && of.0.mode == VOLUME_ISOSURFACE;
    let (info, range) = volumes.point_ranges().find(own)?;
    let (mut numerator, mut denominator) = (0.0, 0.0);
    for at in range {
        let point = &volumes.points[at];
        let square: f64 =
            (0..3).map(|axis| (f64::from(point.position[axis]) - place[axis]).powi(2)).sum();
        let [weight, _] = field::weight(volumes, info, at, square).unwrap_or_default();
        numerator += weight * f64::from(point.scalar);
        denominator += weight;
    }
    if info.kernel == VOLUME_SHEPARD {
        return Some(denominator > 0.0 && numerator / denominator > f64::from(info.iso));
    }
    Some(numerator > f64::from(info.iso))
}

/// Whether the eye is inside an object's surface, by its normals where it has any, else by what lines from the eye
/// cross; and what is in doubt.
fn by_surface(
    scene: &Scene,
    known: &Known<'_>,
    index: u32,
    eye: [f64; 3],
) -> (bool, Option<String>) {
    let at = index as usize;
    let (object, positions) = (&scene.objects[at], &known.world[at]);
    let of_normals = known.sets[at].normals.as_ref().and_then(|normals| {
        let turned = |i: usize| object.transform.rotate(normals[i].map(f64::from));
        side_of_normals(positions, turned, eye)
    });
    let counted = || {
        let surface = surface_slots(known.cloud, known.shapes, at);
        let slots = if surface.count > 0 { surface } else { known.cloud.objects[at] };
        votes(&known.cloud.points[slots.range()], local(known, eye))
    };
    match of_normals {
        // Far outside nearly every eye is where normals look.
        Some(false) if !may_hold(positions, eye) => (false, None),
        Some(inside) => {
            let votes = counted();
            let agrees = !votes.is_clear() || votes.says_inside() == inside;
            let doubt = (!agrees).then(|| against_normals(&object.name, inside, votes));
            (if agrees { inside } else { !inside }, doubt)
        }
        None => {
            let votes = counted();
            let inside = votes.says_inside();
            (inside, (!votes.is_clear()).then(|| divided(&object.name, inside, votes)))
        }
    }
}

/// Whether a place is in the box around these points.
fn may_hold(positions: &[[f64; 3]], place: [f64; 3]) -> bool {
    points::bounds_of([positions]).is_some_and(|[low, high]| {
        (0..3).all(|axis| (low[axis]..=high[axis]).contains(&place[axis]))
    })
}

fn side(inside: bool) -> &'static str {
    if inside { "inside" } else { "outside" }
}

fn advice(name: &str) -> String {
    format!("say which, camera.inside = \"{name}\" or camera.inside = []")
}

fn against_normals(name: &str, inside: bool, votes: Votes) -> String {
    format!(
        "object '{name}': by its normals the eye is {} this glass, but {} of {} lines from the eye cross its surface as \
         often as from {} it, and it is taken to be there; {}",
        side(inside),
        votes.inside.max(votes.outside),
        votes.inside + votes.outside,
        side(!inside),
        advice(name)
    )
}

fn divided(name: &str, inside: bool, votes: Votes) -> String {
    format!(
        "object '{name}': whether the eye is inside this glass is in doubt, as where a surface is open or has holes: {} \
         lines from the eye say so, {} deny it, and it is taken to be {}; {}",
        votes.inside,
        votes.outside,
        side(inside),
        advice(name)
    )
}

/// Whether most of the nearest points have the eye behind them; `None` where their normals say nothing.
fn side_of_normals(
    positions: &[[f64; 3]],
    normal: impl Fn(usize) -> [f64; 3],
    eye: [f64; 3],
) -> Option<bool> {
    let from = |i: usize| [0, 1, 2].map(|axis| eye[axis] - positions[i][axis]);
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let mut nearest: Vec<(f64, usize)> =
        (0..positions.len()).map(|i| (dot(from(i), from(i)), i)).collect();
    let count = ASKED.min(nearest.len());
    if count == 0 {
        return None;
    }
    nearest.select_nth_unstable_by(count - 1, |a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    // A normal that is no number, or zero, has no say.
    let votes = nearest[..count].iter().map(|&(_, i)| dot(from(i), normal(i)));
    let signs: Vec<i32> = votes.map(|side| i32::from(side < 0.0) - i32::from(side > 0.0)).collect();
    signs.iter().any(|&sign| sign != 0).then(|| signs.iter().sum::<i32>() > 0)
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
        assert_eq!(side_of_normals(&ball, outwards, [0.1, 0.2, -0.3]), Some(true));
        assert_eq!(side_of_normals(&ball, outwards, [0.0, 1.2, 0.0]), Some(false));
        assert_eq!(side_of_normals(&ball, inwards, [0.1, 0.2, -0.3]), Some(false));
        assert_eq!(side_of_normals(&ball, |_| [f64::NAN; 3], [0.0; 3]), None, "no number");
        assert_eq!(side_of_normals(&[], outwards, [0.0; 3]), None, "no points");
    }

    #[test]
    fn one_wrong_normal_is_outvoted() {
        let ball = ball();
        let one_wrong = |i: usize| if i == 250 { ball[i].map(|x| -x) } else { ball[i] };
        let found = side_of_normals(&ball, one_wrong, ball[250].map(|x| 0.9 * x));
        assert_eq!(found, Some(true));
    }
}
