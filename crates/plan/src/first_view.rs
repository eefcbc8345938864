//! The first view of a depth image: that of the sensor that took it.

use crate::degrees::in_degrees;
use glam::DVec3;
use points::{PointSet, Sensor};
use scene::{Camera, CameraKeys, Object, Projection, Scene};
use std::f64::consts::PI;
use std::sync::Arc;

/// Widest view of a sensor that one picture shows.
const WIDEST: f64 = 150.0 * PI / 180.0;
/// Part of the points at each rim of the view that may lie outside the picture: less than a row of pixels.
const RIM: f64 = 1e-3;
/// How far the middle of what a sensor saw may lie beside the middle of its view, over the size of what it saw, if its own
/// axes are kept.
const ASIDE: f64 = 0.15;
/// Farthest that a scene may place what it has.
const FARTHEST: f64 = 1e15;
/// Steepest view.
const STEEPEST: f64 = 80.0 * PI / 180.0;

/// What a sensor sees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SensorView {
    /// In the place of the sensor, in the world.
    pub camera: Camera,
    /// Unit vectors to its right, up and ahead.
    pub axes: [[f64; 3]; 3],
    /// Angles from side to side and from top to bottom that the points take up, in degrees.
    pub angles: [f64; 2],
}

/// The view of the sensor that took the points of a scene; `None` where the points are not one image with columns and rows, of less
/// than 150 degrees, or the scene's camera has an eye or a view of its own, or parallel rays.
///
/// The eye stands where the sensor stood, and up is the sensor's. Ahead is as well, unless the points lie to one side of that: then it is the
/// middle of the angles that they take up, as for scanners, which have no ahead. The picture is just large enough for all points.
#[must_use]
pub fn sensor_view(scene: &Scene, sets: &[Arc<PointSet>]) -> Option<SensorView> {
    let mut standing = scene.objects.iter().zip(sets).filter(|(object, _)| !object.is_ground());
    let (Some((object, set)), None) = (standing.next(), standing.next()) else { return None };
    let keys = &scene.camera;
    if keys.eye.is_some() || keys.view.is_some() || keys.is_orthographic {
        return None;
    }
    let [sensor] = set.sensors.as_slice() else { return None };
    let is_image = sensor.image.is_some() && !in_degrees(object, set);
    let has_all = || set.file_index.iter().all(|index| sensor.points.contains(index));
    if !is_image || !has_all() {
        return None;
    }
    Seen::of(object, set, sensor)?.view(scene.image.size)?.with(keys)
}

impl SensorView {
    /// The same with the keys that are given; `None` where they leave it no line of sight.
    fn with(mut self, keys: &CameraKeys) -> Option<Self> {
        let camera = &mut self.camera;
        if let Some(vertical_fov) = keys.vertical_fov {
            camera.projection = Projection::Perspective { vertical_fov };
        }
        (camera.aperture, camera.focus) = (keys.aperture, keys.focus);
        if keys.target.is_none() && keys.up.is_none() {
            return Some(self);
        }
        camera.target = keys.target.unwrap_or(camera.target);
        camera.up = keys.up.unwrap_or(camera.up);
        let [eye, target, up] = [camera.eye, camera.target, camera.up].map(DVec3::from);
        let ahead = (target - eye).try_normalize()?;
        let right = ahead.cross(up.normalize()).try_normalize()?;
        self.axes = [right, right.cross(ahead), ahead].map(Into::into);
        Some(self)
    }
}

/// Right, up and ahead.
type Axes = [DVec3; 3];

/// The points of a set about its sensor.
struct Seen {
    eye: DVec3,
    axes: Axes,
    /// From the eye, in the world; none is there.
    points: Vec<DVec3>,
}

impl Seen {
    /// Turned as the sensor is, or as the points are, if they lie to one side.
    fn of(object: &Object, set: &PointSet, sensor: &Sensor) -> Option<Self> {
        let transform = &object.transform;
        let eye = DVec3::from(transform.apply(sensor.position));
        let axes = sensor.axes.map(|axis| DVec3::from(transform.rotate(axis)));
        let from_eye = |&p: &[f64; 3]| DVec3::from(transform.apply(p)) - eye;
        let points = set.positions.iter().map(from_eye);
        let points: Vec<DVec3> = points.filter(|d| d.length_squared() > 0.0).collect();
        if points.is_empty() || !axes.iter().all(|axis| axis.is_normalized()) {
            return None;
        }
        let seen = Self { eye, axes, points };
        let is_in_the_middle = |[low, high]: [f64; 2]| (low + high).abs() < ASIDE * (high - low);
        match seen.window() {
            Some(window) if window.into_iter().all(is_in_the_middle) => Some(seen),
            _ => seen.turned(),
        }
    }

    /// The same, turned to the middle of the angles that the points take up.
    fn turned(self) -> Option<Self> {
        let [right, up, ahead] = self.axes;
        let sum: DVec3 = self.points.iter().map(|d| d.normalize()).sum();
        // The direction of most points, so that angles are counted from the far side of it.
        let (x, z) = (sum.dot(right), sum.dot(ahead));
        let length = x.hypot(z);
        if length <= 1e-3 * self.points.len() as f64 {
            return None;
        }
        let (x, z) = (x / length, z / length);
        let (across, along) = (right * z - ahead * x, right * x + ahead * z);
        let turn = |d: &DVec3| d.dot(across).atan2(d.dot(along));
        let height = |d: &DVec3| d.dot(up).atan2(d.dot(across).hypot(d.dot(along)));
        let [turns, heights] = [&turn as &dyn Fn(&DVec3) -> f64, &height]
            .map(|angle| extent(self.points.iter().map(angle).collect()));
        if [turns, heights].iter().any(|[low, high]| high - low >= WIDEST) {
            return None;
        }
        let [turn, height] = [turns, heights].map(|[low, high]| 0.5 * (low + high));
        if height.abs() > STEEPEST {
            return None;
        }
        let level = across * turn.sin() + along * turn.cos();
        let ahead = level * height.cos() + up * height.sin();
        let right = ahead.cross(up).normalize();
        Some(Self { axes: [right, right.cross(ahead), ahead], ..self })
    }

    /// Least and greatest tangents to the right and up that points have; `None` where points lie behind the eye.
    fn window(&self) -> Option<[[f64; 2]; 2]> {
        let [right, up, ahead] = self.axes;
        let most = (0.5 * WIDEST).tan();
        // What is not before the eye is beyond any window.
        let tangent = |d: &DVec3, axis: DVec3| match d.dot(ahead) {
            depth if depth > 0.0 => d.dot(axis) / depth,
            _ => f64::INFINITY,
        };
        let of = |axis| extent(self.points.iter().map(|d| tangent(d, axis)).collect());
        let window = [of(right), of(up)];
        window.iter().flatten().all(|tangent| tangent.abs() < most).then_some(window)
    }

    /// The picture that has all of the window.
    fn view(&self, size: [u32; 2]) -> Option<SensorView> {
        let window = self.window()?;
        let [right, up, ahead] = self.axes;
        let [across, above] = window.map(|[low, high]| high.max(-low));
        let aspect = f64::from(size[0]) / f64::from(size[1]);
        let tangent = above.max(across / aspect);
        if !(tangent > 1e-6 && tangent.is_finite()) {
            return None;
        }
        let mut depths: Vec<f64> = self.points.iter().map(|d| d.dot(ahead)).collect();
        let middle = depths.len() / 2;
        let depth = *depths.select_nth_unstable_by(middle, f64::total_cmp).1;
        let camera = Camera {
            eye: self.eye.into(),
            target: (self.eye + depth * ahead).into(),
            up: up.into(),
            projection: Projection::Perspective { vertical_fov: 2.0 * tangent.atan().to_degrees() },
            aperture: 0.0,
            focus: None,
        };
        let angles = window.map(|[low, high]| (high.atan() - low.atan()).to_degrees());
        let is_near = camera.eye.iter().all(|x| x.abs() < FARTHEST);
        (depth > 0.0 && is_near && camera.eye != camera.target).then(|| SensorView {
            camera,
            axes: [right, up, ahead].map(Into::into),
            angles,
        })
    }
}

/// Least and greatest of all values but those of the rims.
fn extent(mut values: Vec<f64>) -> [f64; 2] {
    let rim = (values.len() as f64 * RIM) as usize;
    let last = values.len() - 1;
    let mut nth = |n: usize| *values.select_nth_unstable_by(n, f64::total_cmp).1;
    [nth(rim), nth(last - rim)]
}

#[cfg(test)]
mod tests;
