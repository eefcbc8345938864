//! Whether anything lies in the picture, and is large enough to be seen there.

use super::Asked;
use crate::Plan;
use kernels::layout::{ORTHOGRAPHIC, Point};
use points::{Cloud, Shapes};
use rayon::prelude::*;

/// Points before and after one in memory, where they are in order of space, of which it is asked how far they are.
const AROUND: usize = 8;
/// Which of the nearest of these says how far points are from each other.
const NEAREST: usize = 3;
/// What surfaces reach beyond their points, of how far these are from each other.
const REACH: f64 = 2.0;
/// Pixels beside the picture from which samples may come, at least.
const RIM: f64 = 0.5;
/// Pixels that all of an object covers at most, if it is not seen.
const SMALL: f64 = 0.25;

/// A ball in the kernels' coordinates.
struct Ball {
    center: [f64; 3],
    radius: f64,
}

impl Ball {
    /// Around places, of which there is one at least.
    fn around(places: impl Iterator<Item = [f32; 3]> + Clone) -> Self {
        let along = |axis: usize| places.clone().map(move |place| f64::from(place[axis]));
        let low = [0, 1, 2].map(|axis| along(axis).fold(f64::INFINITY, f64::min));
        let high = [0, 1, 2].map(|axis| along(axis).fold(f64::NEG_INFINITY, f64::max));
        let half = [0, 1, 2].map(|axis| 0.5 * (high[axis] - low[axis]));
        Self {
            center: [0, 1, 2].map(|axis| low[axis] + half[axis]),
            radius: half.iter().map(|side| side * side).sum::<f64>().sqrt(),
        }
    }
}

/// What of the world the picture shows.
struct Frustum {
    eye: [f64; 3],
    axes: [[f64; 3]; 3],
    /// Half of the picture's width and height at depth 1, or anywhere where rays are parallel.
    half: [f64; 2],
    is_parallel: bool,
    lens: f64,
    focus: f64,
    /// Side of a pixel at depth 1, or anywhere.
    pixel: f64,
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

impl Frustum {
    fn of(plan: &Plan) -> Self {
        let camera = &plan.camera;
        let pixel = f64::from(camera.scale);
        let rim = plan.filter.iter().map(|at| f64::from(at.abs())).fold(RIM, f64::max);
        let half =
            [camera.half_width, camera.half_height].map(|half| pixel * (f64::from(half) + rim));
        Self {
            eye: camera.eye.map(f64::from),
            axes: [camera.right, camera.up, camera.forward].map(|axis| axis.map(f64::from)),
            half,
            is_parallel: camera.projection == ORTHOGRAPHIC,
            lens: f64::from(camera.lens_radius),
            focus: f64::from(camera.focus),
            pixel,
        }
    }

    /// To the right, up and ahead of the eye.
    fn seen(&self, place: [f64; 3]) -> [f64; 3] {
        let from = [0, 1, 2].map(|axis| place[axis] - self.eye[axis]);
        self.axes.map(|axis| dot(axis, from))
    }

    /// Whether some of a ball may be in the picture.
    fn meets(&self, ball: &Ball) -> bool {
        let [x, y, depth] = self.seen(ball.center);
        let blurred = self.lens * (1.0 + depth.abs() / self.focus);
        let beside = |at: f64, half: f64| match self.is_parallel {
            true => at.abs() > half + ball.radius + blurred,
            false => at.abs() - half * depth > (ball.radius + blurred) * (1.0 + half * half).sqrt(),
        };
        depth > -ball.radius && !beside(x, self.half[0]) && !beside(y, self.half[1])
    }

    /// The side of a pixel at the depth of a place, where that is ahead.
    fn pixel_at(&self, place: [f64; 3]) -> Option<f64> {
        let [_, _, depth] = self.seen(place);
        let size = if self.is_parallel { self.pixel } else { self.pixel * depth };
        (depth > 0.0).then_some(size)
    }
}

/// A warning where the camera looks away from everything.
pub(super) fn is_out_of_sight(of: &Asked<'_>) -> Option<String> {
    let plan = of.plan;
    let frustum = Frustum::of(plan);
    let balls = || surfaces(&plan.cloud, &plan.shapes).chain(volumes(of));
    let all: Vec<Part<'_>> = balls().collect();
    let is_seen = |ball: &Ball| frustum.meets(ball);
    // Most often a point is in the picture, and nothing has to be known of its neighbours.
    if all.is_empty()
        || all.par_iter().any(|part| part.any_place(&is_seen))
        || all.par_iter().any(|part| part.any(&is_seen))
    {
        return None;
    }
    let [low, high] = plan.cloud.bounds;
    let middle = [0, 1, 2].map(|axis| 0.5 * low[axis] + 0.5 * high[axis]);
    let ahead = |ball: &Ball| frustum.seen(ball.center)[2] > -ball.radius;
    let where_they_are = match all.par_iter().any(|part| part.any(&ahead)) {
        true => "beside it",
        false => "behind the camera",
    };
    let [x, y, z] = middle.map(|at| short(at, low, high));
    let keys = &of.scene.camera;
    // What turns the camera away is the direction, where one is given.
    let advice = match keys.target {
        None if keys.view.is_some() => format!(
            "remove camera.view, so that it looks from camera.eye at their middle, [{x}, {y}, {z}], or leave camera.eye out"
        ),
        _ => format!(
            "set camera.target to their middle, [{x}, {y}, {z}], or leave camera.eye or camera.target out"
        ),
    };
    Some(format!(
        "nothing is in the picture: the camera looks away from all objects, which lie {where_they_are}; {advice}"
    ))
}

/// With no more digits than a thousandth of the box needs.
fn short(at: f64, low: [f64; 3], high: [f64; 3]) -> String {
    let size = (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f64::max);
    let digits =
        if size > 0.0 { (3.0 - size.log10().floor()).clamp(0.0, 12.0) as usize } else { 3 };
    let shown = format!("{at:.digits$}");
    match shown.trim_start_matches(['-', '0', '.']).is_empty() {
        true => "0.0".to_owned(),
        false => shown,
    }
}

/// Points that lie together in memory, with how far what is drawn of them reaches.
enum Part<'a> {
    Surface(&'a [Point]),
    Shapes(&'a [Point], &'a [f32]),
    Volume(&'a [kernels::layout::VolumePoint], f64),
}

impl Part<'_> {
    /// Whether any of the points is as asked, without what is drawn of it.
    fn any_place(&self, is: &dyn Fn(&Ball) -> bool) -> bool {
        let at = |place: [f32; 3]| is(&Ball { center: place.map(f64::from), radius: 0.0 });
        match self {
            Self::Surface(points) | Self::Shapes(points, _) => {
                points.iter().any(|point| at(point.position))
            }
            Self::Volume(points, _) => points.iter().any(|point| at(point.position)),
        }
    }

    /// Whether any of the balls around points, which hold what is drawn of them, is as asked.
    fn any(&self, is: &dyn Fn(&Ball) -> bool) -> bool {
        let ball = |place: [f32; 3], radius: f64| Ball { center: place.map(f64::from), radius };
        match self {
            Self::Surface(points) => (0..points.len())
                .any(|at| is(&ball(points[at].position, REACH * spacing(points, at)))),
            Self::Shapes(points, radii) => (points.iter().zip(*radii))
                .any(|(point, radius)| is(&ball(point.position, f64::from(*radius)))),
            Self::Volume(points, reach) => {
                points.iter().any(|point| is(&ball(point.position, *reach)))
            }
        }
    }
}

/// How far the points around one are: the distance of the third nearest of those that lie beside it in memory. Order in
/// space leaps here and there, but seldom on both sides of a point.
fn spacing(points: &[Point], at: usize) -> f64 {
    let around = at.saturating_sub(AROUND)..(at + AROUND + 1).min(points.len());
    let from = points[at].position;
    let mut nearest = [f64::INFINITY; NEAREST];
    let others = around.filter(|other| *other != at);
    for other in others {
        let to = points[other].position;
        let square = (0..3).map(|axis| f64::from(to[axis] - from[axis]).powi(2)).sum::<f64>();
        let after = nearest.partition_point(|known| *known <= square);
        if after < NEAREST {
            nearest[after..].rotate_right(1);
            nearest[after] = square;
        }
    }
    let known = nearest.into_iter().filter(|square| square.is_finite());
    known.fold(0.0, f64::max).sqrt()
}

/// Points that one thread takes at once.
const PART: usize = 1 << 13;

/// Those of surfaces and shapes.
fn surfaces<'a>(cloud: &'a Cloud, shapes: &'a [Shapes]) -> impl Iterator<Item = Part<'a>> {
    let fitted = (0..cloud.objects.len()).flat_map(|object| {
        let slots = crate::shapes::surface_slots(cloud, shapes, object);
        cloud.points[slots.range()].chunks(PART).map(Part::Surface)
    });
    let drawn = shapes.iter().flat_map(|shapes| {
        let points = cloud.points[shapes.slots().range()].chunks(PART);
        points.zip(shapes.radii.chunks(PART)).map(|(points, radii)| Part::Shapes(points, radii))
    });
    fitted.chain(drawn)
}

/// Those of volumes.
fn volumes<'a>(of: &'a Asked<'_>) -> impl Iterator<Item = Part<'a>> {
    let volumes = &of.plan.volumes;
    volumes.point_ranges().flat_map(|(info, range)| {
        let reach = f64::from(info.square_radius).sqrt();
        volumes.points[range].chunks(PART).map(move |points| Part::Volume(points, reach))
    })
}

/// Warnings of objects in the picture that are too small for it.
pub(super) fn too_small(of: &Asked<'_>) -> Vec<String> {
    let plan = of.plan;
    let frustum = Frustum::of(plan);
    let mut found = Vec::new();
    for (index, name) in plan.names.iter().enumerate() {
        let slots = plan.cloud.objects[index];
        let points = &plan.cloud.points[slots.range()];
        let has_volume = plan.volumes.infos.iter().any(|info| info.object as usize == index);
        if points.len() < 2 || has_volume {
            continue;
        }
        let own = plan.shapes.iter().filter(|shapes| shapes.object as usize == index);
        let radius = own.clone().flat_map(|shapes| &shapes.radii).copied().fold(0.0, f32::max);
        let mut ball = Ball::around(points.iter().map(|point| point.position));
        ball.radius += f64::from(radius);
        if !frustum.meets(&ball) {
            continue;
        }
        let [_, _, depth] = frustum.seen(ball.center);
        let pixel = frustum.pixel_at(ball.center).filter(|_| depth > 2.0 * ball.radius);
        if let Some(pixel) = pixel.filter(|pixel| ball.radius < SMALL * pixel) {
            found.push(format!(
                "object '{name}' is not seen: all of it is {:.1e} pixels wide; raise objects.{index}.transform.scale, or \
                 move the camera nearer",
                2.0 * ball.radius / pixel
            ));
            continue;
        }
        let is_shapes = own.clone().map(|shapes| shapes.count).sum::<u32>() == slots.count;
        let covered = |shapes: &Shapes| {
            let all = plan.cloud.points[shapes.slots().range()].iter().zip(&shapes.radii);
            let area = |(point, radius): (&Point, &f32)| {
                let pixel = frustum.pixel_at(point.position.map(f64::from));
                pixel.map_or(0.0, |pixel| {
                    std::f64::consts::PI * (f64::from(*radius) / pixel).powi(2)
                })
            };
            all.map(area).sum::<f64>()
        };
        let pixels = own.map(covered).sum::<f64>();
        if is_shapes && pixels < SMALL {
            found.push(format!(
                "object '{name}' is not seen: its spheres or discs cover {pixels:.1e} pixels together; raise \
                 objects.{index}.surface.radius"
            ));
        }
    }
    found
}
