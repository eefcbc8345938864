//! The view: where rays start, which way they go, and the matrices that say so in an EXR.

use crate::bulk::World;
use crate::frame::Sight;
use glam::DVec3;
use kernels::layout::{CameraParams, NONE, ORTHOGRAPHIC, PERSPECTIVE};
use rayon::prelude::*;
use scene::{Camera, Projection, Up};

/// Direction from the points to the eye, for +y up.
const FRAMING_DIRECTION: DVec3 = DVec3::new(0.45, 0.35, 1.0);
const FRAMING_FOV: f64 = 40.0;
/// Share of the picture that the points fill, along the direction that is fuller.
const FRAMING_FILL: f64 = 0.88;

/// The nearest camera, of one direction and angle, that has every point well inside the picture.
///
/// A point (x, y, z) along right, up and forward stays below the frustum's upper side for an eye at
/// height c and distance D before the origin where y − c ≤ t (z + D), and likewise on the other
/// sides; so the extremes of ±x − t z and ±y − t z give eye and distance in closed form.
pub(crate) fn frame(sets: &[World], bounds: [[f64; 3]; 2], image_size: [u32; 2], up: Up) -> Camera {
    let center = 0.5 * DVec3::from(bounds[0]) + 0.5 * DVec3::from(bounds[1]);
    let DVec3 { x, y, z } = FRAMING_DIRECTION;
    let (direction, up) = match up {
        Up::Y => (FRAMING_DIRECTION, DVec3::Y),
        Up::Z => (DVec3::new(x, -z, y), DVec3::Z),
        Up::MinusY => (DVec3::new(x, -y, -z), DVec3::NEG_Y),
    };
    let forward = -direction.normalize();
    let right = forward.cross(up).normalize();
    let above = right.cross(forward);
    let half_tangent = FRAMING_FILL * (0.5 * FRAMING_FOV.to_radians()).tan();
    let aspect = f64::from(image_size[0]) / f64::from(image_size[1]);
    let tangents = [half_tangent * aspect, half_tangent];
    let parts: Vec<&[[f64; 3]]> = sets.iter().flat_map(|set| set.chunks(PART)).collect();
    let none = [[f64::NEG_INFINITY; 2]; 2]; // of +x, −x; of +y, −y
    let extremes_of = |part: &&[[f64; 3]]| {
        let mut extremes = none;
        for &point in *part {
            let p = DVec3::from(point) - center;
            let depth = p.dot(forward);
            for (axis, at) in [p.dot(right), p.dot(above)].into_iter().enumerate() {
                for (side, at) in [at, -at].into_iter().enumerate() {
                    let reach = at - tangents[axis] * depth;
                    extremes[axis][side] = extremes[axis][side].max(reach);
                }
            }
        }
        extremes
    };
    let joined = |a: [[f64; 2]; 2], b: [[f64; 2]; 2]| {
        [0, 1].map(|axis| [0, 1].map(|side| a[axis][side].max(b[axis][side])))
    };
    let extremes = parts.par_iter().map(extremes_of).reduce(|| none, joined);
    let distance = (0..2)
        .map(|axis| (extremes[axis][0] + extremes[axis][1]) / (2.0 * tangents[axis]))
        .fold(0.0, f64::max);
    let shift = [0, 1].map(|axis| 0.5 * (extremes[axis][0] - extremes[axis][1]));
    // One point, or several in one place: any distance shows the same nothing.
    let half_diagonal = (0.5 * (DVec3::from(bounds[1]) - DVec3::from(bounds[0]))).length();
    let distance = distance.max(1.05 * half_diagonal); // points along one line of sight
    let distance = if distance > 0.0 { distance } else { 1.0 };
    let shift = [0, 1].map(|axis| {
        let side = [right, above][axis];
        let place = |p: &[f64; 3]| {
            let p = DVec3::from(*p) - center;
            (p.dot(side), p.dot(forward) + distance)
        };
        balance(&parts, &place, shift[axis])
    });
    let target = center + shift[0] * right + shift[1] * above;
    let eye = target - distance * forward;
    Camera {
        eye: eye.into(),
        target: target.into(),
        up: up.into(),
        projection: Projection::Perspective { vertical_fov: FRAMING_FOV },
        aperture: 0.0,
        focus: None,
    }
}

/// Points that one thread takes at once.
const PART: usize = 1 << 14;
/// Reach and depth of no point.
const NOWHERE: (f64, f64) = (f64::NEG_INFINITY, 1.0);

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

/// A camera in the forms that kernels and files take.
#[derive(Debug, Clone, Copy)]
pub struct View {
    /// Parameters of `camera_rays`, in centred scene space; the tile is zero.
    pub params: CameraParams,
    /// Row vectors, v · M: from (world − origin) to a camera that looks along −z, +y up.
    pub world_to_camera: [[f32; 4]; 4],
    /// Row vectors, v · M: from (world − origin); after division by w, x to the right and y down,
    /// (0, 0) and (1, 1) at the corners of the picture; z = 1 − 1/depth, or the depth where rays are
    /// parallel, and w = 1.
    pub world_to_ndc: [[f32; 4]; 4],
}

impl View {
    /// `origin` is what is subtracted from world coordinates.
    #[must_use]
    pub fn new(camera: &Camera, image_size: [u32; 2], origin: [f64; 3]) -> Self {
        let sight = Sight::new(camera, image_size);
        let [eye, target] = [camera.eye, camera.target].map(DVec3::from);
        let local_eye = eye - DVec3::from(origin);
        let [width, height] = image_size.map(f64::from);
        let params = CameraParams {
            eye: local_eye.as_vec3().into(),
            scale: (sight.half_extent / (0.5 * height)) as f32,
            right: sight.right.as_vec3().into(),
            half_width: (0.5 * width) as f32,
            up: sight.up.as_vec3().into(),
            half_height: (0.5 * height) as f32,
            forward: sight.forward.as_vec3().into(),
            sample_index: NONE,
            tile_origin: [0, 0],
            tile_size: [0, 0],
            projection: match camera.projection {
                Projection::Perspective { .. } => PERSPECTIVE,
                Projection::Orthographic { .. } => ORTHOGRAPHIC,
            },
            lens_radius: (0.5 * camera.aperture) as f32,
            focus: camera.focus.unwrap_or((target - eye).length()) as f32,
            seed: 0,
        };
        let [world_to_camera, world_to_ndc] = sight.matrices(origin);
        Self { params, world_to_camera, world_to_ndc }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn apply(v: [f32; 3], m: [[f32; 4]; 4]) -> [f32; 4] {
        [0, 1, 2, 3].map(|j| v[0] * m[0][j] + v[1] * m[1][j] + v[2] * m[2][j] + m[3][j])
    }

    const WIDE: Projection = Projection::Perspective { vertical_fov: 90.0 };

    fn view(projection: Projection) -> View {
        let camera = Camera {
            eye: [10.0, 2.0, 5.0],
            target: [10.0, 2.0, 0.0],
            up: [0.0, 3.0, 0.0],
            projection,
            aperture: 0.0,
            focus: None,
        };
        View::new(&camera, [200, 100], [10.0, 0.0, 0.0])
    }

    #[test]
    fn camera_looks_along_minus_z_with_y_up() {
        // One to the right of, two above and four before the eye; the origin is subtracted.
        let [x, y, z, w] = apply([1.0, 4.0, 1.0], view(WIDE).world_to_camera);
        assert_eq!([x, y, z, w], [1.0, 2.0, -4.0, 1.0]);
    }

    #[test]
    fn ndc_has_its_corners_at_the_corners_of_the_picture() {
        let ndc = |p: [f32; 3]| {
            let [x, y, z, w] = apply(p, view(WIDE).world_to_ndc);
            [x / w, y / w, z / w]
        };
        let close = |a: [f32; 3], b: [f32; 3]| (0..3).all(|i| (a[i] - b[i]).abs() < 1e-6);
        // At depth 2 the picture reaches from -4 to 4 and from 4 above to 0.
        assert!(close(ndc([-4.0, 4.0, 3.0]), [0.0, 0.0, 0.5]), "{:?}", ndc([-4.0, 4.0, 3.0]));
        assert!(close(ndc([4.0, 0.0, 3.0]), [1.0, 1.0, 0.5]), "{:?}", ndc([4.0, 0.0, 3.0]));
        assert!(close(ndc([0.0, 2.0, 1.0]), [0.5, 0.5, 0.75]), "{:?}", ndc([0.0, 2.0, 1.0]));
    }

    #[test]
    fn parallel_rays_show_the_same_at_any_depth() {
        let view = view(Projection::Orthographic { height: 4.0 });
        // From 4 above the centre to 0, and, twice as wide as high, from -4 to 4.
        assert_eq!(apply([-4.0, 4.0, 3.0], view.world_to_ndc), [0.0, 0.0, 2.0, 1.0]);
        assert_eq!(apply([4.0, 0.0, -7.0], view.world_to_ndc), [1.0, 1.0, 12.0, 1.0]);
        assert_eq!((view.params.scale, view.params.projection), (0.04, ORTHOGRAPHIC));
        assert_eq!((view.params.focus, view.params.lens_radius), (5.0, 0.0));
    }

    /// Every point is inside the picture, and along one axis both sides are reached.
    #[test]
    fn framing_holds_every_point_and_wastes_no_room() {
        let (low, high) = ([-3.0, 10.0, 0.5], [1.0, 11.0, 2.0]);
        let corners: Vec<[f64; 3]> = (0..8)
            .map(|i| [0, 1, 2].map(|axis| if i >> axis & 1 == 0 { low[axis] } else { high[axis] }))
            .collect();
        for (up, size) in [(Up::Y, [640, 480]), (Up::Z, [640, 480]), (Up::MinusY, [100, 400])] {
            let camera = frame(&[corners.to_vec().into()], [low, high], size, up);
            let view = View::new(&camera, size, [0.0; 3]);
            let inside: Vec<[f32; 2]> = corners
                .iter()
                .map(|corner| {
                    let [x, y, _, w] = apply(corner.map(|x| x as f32), view.world_to_ndc);
                    [x / w, y / w]
                })
                .collect();
            let margin = 0.5 - 0.5 * FRAMING_FILL as f32;
            let tight = |axis: usize| {
                let all = || inside.iter().map(|p| p[axis]);
                let (low, high) = (all().fold(1.0, f32::min), all().fold(0.0, f32::max));
                assert!(low > margin - 1e-4 && high < 1.0 - margin + 1e-4, "{inside:?}");
                low < margin + 1e-4 && high > 1.0 - margin - 1e-4
            };
            let middle = |axis: usize| {
                let all = || inside.iter().map(|p| p[axis]);
                0.5 * (all().fold(1.0, f32::min) + all().fold(0.0, f32::max))
            };
            assert!((0..2).all(|axis| (middle(axis) - 0.5).abs() < 1e-4), "{inside:?}");
            let [across, along] = [tight(0), tight(1)];
            assert!(across || along, "{inside:?}");
        }
    }

    #[test]
    fn a_single_point_has_a_finite_view() {
        let point = [3.0; 3];
        let camera = frame(&[vec![point].into()], [point, point], [64, 48], Up::Y);
        assert!(camera.eye.iter().chain(&camera.target).all(|x| x.is_finite()));
        assert_ne!(camera.eye, camera.target);
    }
}
