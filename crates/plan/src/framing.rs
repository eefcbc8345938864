//! The automatic camera: whatever a scene leaves out of its camera is chosen so that the points are in the picture.
//!
//! docs/scene.md has what each combination of keys means.

use crate::PlanError;
use crate::bulk::World;
use glam::{DQuat, DVec3};
use rayon::prelude::*;
use scene::{Camera, CameraKeys, Light, Projection, Up, ViewFrom};

/// From the points to the eye, along right, up and back.
const FRAMING_DIRECTION: [f64; 3] = [0.45, 0.35, 1.0];
const FRAMING_FOV: f64 = 40.0;
/// The way that the key light of a point file travels where the camera is framed, along right, up and back.
const KEY_LIGHT: [f64; 3] = [-0.5, -1.0, -0.6];
/// Share of the picture that the points fill, along the direction that is fuller.
const FRAMING_FILL: f64 = 0.88;
/// The sine of the smallest angle between `up` and the line of sight.
const MIN_SINE: f64 = 1e-6;
/// Widest and narrowest angle that is chosen for an eye that is given, in degrees.
const WIDEST: f64 = 90.0;
const NARROWEST: f64 = 0.001;
/// How wide points are that lie along one line of sight, at most, of half the diagonal of their box.
const LINE: f64 = 1e-6;
/// Least distance of the nearest point from an eye that is chosen, of how wide the points are.
const CLOSEST: f64 = 5e-4;
/// Widest lens over the distance in focus.
const MAX_APERTURE: f64 = 1000.0;
/// Points that one thread takes at once.
const PART: usize = 1 << 14;
/// Reach and depth of no point.
const NOWHERE: (f64, f64) = (f64::NEG_INFINITY, 1.0);

/// What a camera is framed on.
pub(crate) struct Subject<'a> {
    pub sets: &'a [World],
    pub bounds: [[f64; 3]; 2],
    pub image_size: [u32; 2],
    /// Which axis is up where the camera's keys do not say.
    pub up: Up,
}

/// The whole camera of which a scene gives these keys.
///
/// # Errors
/// [`PlanError::Camera`] where an `up` that is given lies along the line of sight, or the lens is wider than rays can bear.
pub(crate) fn complete(keys: &CameraKeys, subject: &Subject<'_>) -> Result<Camera, PlanError> {
    if let Some(camera) = keys.whole() {
        return Ok(camera);
    }
    let up = upwards(keys, subject.up);
    let axes = axes_of(up);
    let room = Room::of(subject);
    let [eye, target] = [keys.eye, keys.target].map(|place| place.map(DVec3::from));
    let (forward, up) = match (eye, target, keys.view) {
        (Some(eye), Some(target), _) => (target - eye, up),
        (Some(eye), None, None) if room.center != eye => sight_of(room.center - eye, up, axes),
        (_, _, view) => looking(view, up, axes),
    };
    let forward = forward.normalize();
    // The checks of scenes know only what is given.
    if forward.cross(up.normalize()).length() < MIN_SINE {
        return Err(PlanError::Camera(
            "camera.up: found a direction parallel to the line of sight, which the objects decide here; turn it, or give \
             camera.eye and camera.target"
                .to_owned(),
        ));
    }
    let right = forward.cross(up).normalize();
    let sight = Sight { right, above: right.cross(forward), forward };
    let (eye, target, projection) = match keys.is_orthographic {
        true => room.parallel(&sight, eye, target, keys.height),
        false => room.perspective(&sight, eye, target, keys.vertical_fov),
    };
    let focus = keys.focus.unwrap_or((target - eye).length());
    if keys.aperture > MAX_APERTURE * focus {
        return Err(PlanError::Camera(format!(
            "camera.aperture: found {} scene units with a focus at {focus}, expected at most {MAX_APERTURE} times as \
             much; lower it",
            keys.aperture
        )));
    }
    Ok(Camera {
        eye: eye.into(),
        target: target.into(),
        up: up.into(),
        projection,
        aperture: keys.aperture,
        focus: keys.focus,
    })
}

/// The lights of a scene: the key light of a point file comes from where it comes from in the automatic view, as the
/// camera has it.
pub(crate) fn lights_for(
    lights: &[Light],
    key_light: Option<usize>,
    camera: &Camera,
) -> Vec<Light> {
    let mut lights = lights.to_vec();
    if let Some(Light::Directional { direction, .. }) =
        key_light.and_then(|index| lights.get_mut(index))
    {
        *direction = key_direction(camera).into();
    }
    lights
}

fn key_direction(camera: &Camera) -> DVec3 {
    let [eye, target, up] = [camera.eye, camera.target, camera.up].map(DVec3::from);
    let forward = (target - eye).normalize();
    let axes = axes_of(up);
    let usual = -along(FRAMING_DIRECTION, axes).normalize();
    if (forward - usual).length() < 1e-9 {
        return along(KEY_LIGHT, axes);
    }
    // The same as seen by a camera in the usual place.
    let seen = {
        let [right, above, forward] =
            frame_of(-DVec3::from(FRAMING_DIRECTION).normalize(), DVec3::Y);
        let key = DVec3::from(KEY_LIGHT);
        [key.dot(right), key.dot(above), key.dot(forward)]
    };
    along(seen, frame_of(forward, up))
}

/// Unit vectors to the right, up and ahead.
fn frame_of(forward: DVec3, up: DVec3) -> [DVec3; 3] {
    let right = forward.cross(up).normalize();
    [right, right.cross(forward), forward]
}

fn along(parts: [f64; 3], axes: [DVec3; 3]) -> DVec3 {
    parts[0] * axes[0] + parts[1] * axes[1] + parts[2] * axes[2]
}

/// The direction that is up, of unit length where it is not given.
pub(crate) fn upwards(keys: &CameraKeys, up: Up) -> DVec3 {
    keys.up.map_or_else(
        || match up {
            Up::Y => DVec3::Y,
            Up::Z => DVec3::Z,
            Up::MinusY => DVec3::NEG_Y,
        },
        DVec3::from,
    )
}

/// Right, up and back of whoever stands in front of the points: of the axis nearest to `up`, turned by as little as takes
/// that axis there.
fn axes_of(up: DVec3) -> [DVec3; 3] {
    let up = up.normalize();
    // Of equals the last, so that y goes before z, and z before x.
    let nearest = [DVec3::X, DVec3::Z, DVec3::Y]
        .into_iter()
        .max_by(|a, b| a.dot(up).abs().total_cmp(&b.dot(up).abs()))
        .unwrap_or(DVec3::Y);
    let axis = nearest * nearest.dot(up).signum();
    let right = if nearest == DVec3::X { -axis.x * DVec3::Y } else { DVec3::X };
    let back = right.cross(axis);
    if axis == up {
        return [right, up, back];
    }
    let turn = DQuat::from_rotation_arc(axis, up);
    [turn * right, up, turn * back]
}

/// The line of sight and what is up in the picture of a camera that looks from somewhere.
fn looking(view: Option<ViewFrom>, up: DVec3, axes: [DVec3; 3]) -> (DVec3, DVec3) {
    let [right, axis, back] = axes;
    match view {
        None => (-along(FRAMING_DIRECTION, axes), up),
        Some(ViewFrom::Front) => (-back, up),
        Some(ViewFrom::Back) => (back, up),
        Some(ViewFrom::Left) => (right, up),
        Some(ViewFrom::Right) => (-right, up),
        Some(ViewFrom::Top) => (-axis, -back),
        Some(ViewFrom::Bottom) => (axis, back),
        Some(ViewFrom::Iso) => (-(right + axis + back), up),
        Some(ViewFrom::Along(direction)) => sight_of(direction.into(), up, axes),
    }
}

/// A line of sight with what is up in the picture: as in the view from the top or the bottom where it is along `up`.
fn sight_of(direction: DVec3, up: DVec3, [_, axis, back]: [DVec3; 3]) -> (DVec3, DVec3) {
    let forward = direction.normalize();
    match forward.cross(axis).length() < MIN_SINE {
        false => (direction, up),
        true if forward.dot(axis) < 0.0 => (direction, -back),
        true => (direction, back),
    }
}

/// Unit vectors of a camera.
struct Sight {
    right: DVec3,
    above: DVec3,
    forward: DVec3,
}

/// The points, in parts for threads, and the picture that is to hold them.
struct Room<'a> {
    parts: Vec<&'a [[f64; 3]]>,
    center: DVec3,
    half_diagonal: f64,
    aspect: f64,
}

impl<'a> Room<'a> {
    fn of(subject: &Subject<'a>) -> Self {
        let [low, high] = subject.bounds.map(DVec3::from);
        Self {
            parts: subject.sets.iter().flat_map(|set| set.chunks(PART)).collect(),
            center: 0.5 * low + 0.5 * high,
            half_diagonal: (0.5 * (high - low)).length(),
            aspect: f64::from(subject.image_size[0]) / f64::from(subject.image_size[1]),
        }
    }

    /// Eye and target, where one is left out, and the angle.
    fn perspective(
        &self,
        sight: &Sight,
        eye: Option<DVec3>,
        target: Option<DVec3>,
        fov: Option<f64>,
    ) -> (DVec3, DVec3, Projection) {
        let of = |vertical_fov: f64| Projection::Perspective { vertical_fov };
        if let Some(eye) = eye {
            let target = target.unwrap_or_else(|| self.middle_from(eye, sight.forward));
            let fov = fov.unwrap_or_else(|| self.angle_from(eye, sight));
            return (eye, target, of(fov));
        }
        let fov = fov.unwrap_or(FRAMING_FOV);
        let half_tangent = FRAMING_FILL * (0.5 * fov.to_radians()).tan();
        let (eye, target) = self.eye_and_target(sight, target, half_tangent);
        (eye, target, of(fov))
    }

    /// The point of a line of sight beside the middle of the points.
    fn middle_from(&self, eye: DVec3, forward: DVec3) -> DVec3 {
        let depth = (self.center - eye).dot(forward);
        let beside = depth > 1e-6 * self.half_diagonal && depth > 0.0;
        let other = if self.half_diagonal > 0.0 { self.half_diagonal } else { 1.0 };
        match beside {
            true if (self.center - eye).normalize() == forward => self.center,
            true => eye + depth * forward,
            false => eye + other * forward,
        }
    }

    /// The angle at which an eye has all points well inside the picture, as far as one has.
    fn angle_from(&self, eye: DVec3, sight: &Sight) -> f64 {
        let tangent_of = |part: &&[[f64; 3]]| {
            let of = |point: &[f64; 3]| {
                let p = DVec3::from(*point) - eye;
                let reach = p.dot(sight.above).abs().max(p.dot(sight.right).abs() / self.aspect);
                let depth = p.dot(sight.forward);
                if depth > 0.0 { reach / depth } else { f64::INFINITY }
            };
            part.iter().map(of).fold(0.0, f64::max)
        };
        let tangent = self.parts.par_iter().map(tangent_of).reduce(|| 0.0, f64::max);
        if tangent == 0.0 {
            return FRAMING_FOV;
        }
        (2.0 * (tangent / FRAMING_FILL).atan().to_degrees()).clamp(NARROWEST, WIDEST)
    }

    /// The nearest eye, of one direction and angle, that has every point well inside the picture, and its target.
    ///
    /// A point (x, y, z) along right, up and forward stays below the frustum's upper side for an eye at
    /// height c and distance D before the origin where y − c ≤ t (z + D), and likewise on the other
    /// sides; so the extremes of ±x − t z and ±y − t z give eye and distance in closed form. Of a target that is given,
    /// c is 0.
    fn eye_and_target(
        &self,
        sight: &Sight,
        target: Option<DVec3>,
        half_tangent: f64,
    ) -> (DVec3, DVec3) {
        let center = target.unwrap_or(self.center);
        let tangents = [half_tangent * self.aspect, half_tangent];
        // Of +x, −x and of +y, −y; then of the same without the depth, and of +z, −z.
        let none = [[f64::NEG_INFINITY; 2]; 5];
        let extremes_of = |part: &&[[f64; 3]]| {
            let mut extremes = none;
            for &point in *part {
                let p = DVec3::from(point) - center;
                let depth = p.dot(sight.forward);
                extremes[4] = [extremes[4][0].max(depth), extremes[4][1].max(-depth)];
                for (axis, at) in [p.dot(sight.right), p.dot(sight.above)].into_iter().enumerate() {
                    for (side, at) in [at, -at].into_iter().enumerate() {
                        let reach = at - tangents[axis] * depth;
                        extremes[axis][side] = extremes[axis][side].max(reach);
                        extremes[2 + axis][side] = extremes[2 + axis][side].max(at);
                    }
                }
            }
            extremes
        };
        let extremes = self.parts.par_iter().map(extremes_of).reduce(|| none, joined);
        let distance = (0..2)
            .map(|axis| match target {
                None => (extremes[axis][0] + extremes[axis][1]) / (2.0 * tangents[axis]),
                Some(_) => extremes[axis][0].max(extremes[axis][1]) / tangents[axis],
            })
            .fold(0.0, f64::max);
        let wide = extremes[2].iter().chain(&extremes[3]).copied().fold(0.0, f64::max);
        let distance = if wide > LINE * self.half_diagonal {
            distance.max(extremes[4][1] + CLOSEST * wide)
        } else {
            // Points along one line of sight.
            distance.max(1.05 * self.half_diagonal - (self.center - center).dot(sight.forward))
        };
        // One point, or several in one place: any distance shows the same nothing.
        let distance = if distance > 0.0 { distance } else { 1.0 };
        if let Some(target) = target {
            return (target - distance * sight.forward, target);
        }
        let shift = [0, 1].map(|axis| 0.5 * (extremes[axis][0] - extremes[axis][1]));
        let shift = [0, 1].map(|axis| {
            let side = [sight.right, sight.above][axis];
            let place = |p: &[f64; 3]| {
                let p = DVec3::from(*p) - center;
                (p.dot(side), p.dot(sight.forward) + distance)
            };
            balance(&self.parts, &place, shift[axis])
        });
        let target = center + shift[0] * sight.right + shift[1] * sight.above;
        (target - distance * sight.forward, target)
    }

    /// Eye and target, where one is left out, and the height: the lines of sight of all points are inside the picture, and
    /// an eye that is chosen is before all of them.
    fn parallel(
        &self,
        sight: &Sight,
        eye: Option<DVec3>,
        target: Option<DVec3>,
        height: Option<f64>,
    ) -> (DVec3, DVec3, Projection) {
        let from = target.or(eye).unwrap_or(self.center);
        let none = [[f64::NEG_INFINITY; 2]; 3];
        let extremes_of = |part: &&[[f64; 3]]| {
            let mut extremes = none;
            for &point in *part {
                let p = DVec3::from(point) - from;
                for (axis, of) in [sight.right, sight.above, sight.forward].into_iter().enumerate()
                {
                    let at = p.dot(of);
                    extremes[axis] = [extremes[axis][0].max(at), extremes[axis][1].max(-at)];
                }
            }
            extremes
        };
        let extremes = self.parts.par_iter().map(extremes_of).reduce(|| none, joined);
        let [right, above, forward] = extremes;
        let is_free = target.or(eye).is_none();
        let half = |[high, low]: [f64; 2]| match is_free {
            true => 0.5 * (high + low),
            false => high.max(low),
        };
        let fitting = 2.0 * half(above).max(half(right) / self.aspect) / FRAMING_FILL;
        let height = height.unwrap_or(if fitting > 0.0 { fitting } else { 1.0 });
        let target = match (eye, target) {
            (_, Some(target)) => target,
            (Some(eye), None) => self.middle_from(eye, sight.forward),
            (None, None) => {
                let middle = |[high, low]: [f64; 2]| 0.5 * (high - low);
                from + middle(right) * sight.right + middle(above) * sight.above
            }
        };
        let eye = eye.unwrap_or_else(|| {
            let room = if self.half_diagonal > 0.0 { self.half_diagonal } else { 1.0 };
            target - (forward[1].max(0.0) + room) * sight.forward
        });
        (eye, target, Projection::Orthographic { height })
    }
}

/// The greater of each.
fn joined<const N: usize>(a: [[f64; 2]; N], b: [[f64; 2]; N]) -> [[f64; 2]; N] {
    std::array::from_fn(|axis| [0, 1].map(|side| a[axis][side].max(b[axis][side])))
}

/// The shift c at which the extremes of (at − c)/depth, in the picture, are equally far from its middle.
///
/// Only the fuller direction is as full as it may be; along the other the eye could stand anywhere within
/// a range. Newton's method: near its root the difference is linear in c, unless an extreme changes
/// hands, and few steps see to that.
fn balance(
    parts: &[&[[f64; 3]]],
    place: &(dyn Fn(&[f64; 3]) -> (f64, f64) + Sync),
    start: f64,
) -> f64 {
    let mut shift = start;
    for _ in 0..6 {
        let extreme = |sign: f64| {
            // The first of equals, whichever thread has it.
            let better =
                |best: (f64, f64), next: (f64, f64)| if next.0 > best.0 { next } else { best };
            let of_part = |part: &&[[f64; 3]]| {
                part.iter().map(place).fold(NOWHERE, |best, (at, depth)| {
                    better(best, (sign * (at - shift) / depth, depth))
                })
            };
            parts.par_iter().map(of_part).reduce(|| NOWHERE, better)
        };
        let (high, low) = (extreme(1.0), extreme(-1.0));
        shift += (high.0 - low.0) / (1.0 / high.1 + 1.0 / low.1);
    }
    shift
}

#[cfg(test)]
mod tests;
