//! The frame of what a file says about places: positions and matrices of an EXR are those of the world less one
//! origin, which has few digits and is none where floats resolve the scene without.
//!
//! What the kernels compute in is another: their origin is the middle of the scene. Pixels are moved from the one to
//! the other in f64, when the picture is made.

use glam::{DMat4, DVec3, DVec4};
use points::{origin_of, single_step};
use scene::{Camera, Projection};

/// Of the scene's size: steps of f32 that are no longer need no origin.
const RESOLVED: f64 = 1e-6;
/// Of a pixel: by so much at most, rounding moves a hit off the ray through its pixel's centre. What lies farther off
/// is no hit of that ray.
const ROUNDED: f64 = 0.5;
/// Steps of f32 by which coefficients of a matrix are moved, so that their roundings cancel.
const STEPS: i32 = 4;
/// What an error at the eye counts over one at the target, where nearer things are larger.
const NEARER: f64 = 4.0;

/// What is subtracted from world coordinates before they are floats of a file. `bounds` is the box around the scene's
/// points without strays, and its longest side is the scene's size.
///
/// None where the farthest coordinate has steps of f32 no longer than a millionth of the size; else the middle of the
/// box, rounded to the largest power of ten that is no longer than a tenth of the size.
pub(crate) fn file_origin(bounds: [[f64; 3]; 2]) -> [f64; 3] {
    let [low, high] = bounds;
    let size = (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f64::max);
    let farthest = bounds.iter().flatten().map(|x| x.abs()).fold(0.0, f64::max);
    let size = if size > 0.0 { size } else { 1.0 };
    if single_step(farthest) <= RESOLVED * size {
        return [0.0; 3];
    }
    let exponent = (0.1 * size).log10();
    // The logarithm of a power of ten is off by its last digit.
    let exponent = (exponent + 1e-12 * exponent.abs().max(1.0)).floor() as i32;
    origin_of(bounds).map(|x| rounded_to(x, exponent))
}

/// To a multiple of ten to this power. Powers below one divide by a whole number, which is exact where the power is not.
fn rounded_to(x: f64, exponent: i32) -> f64 {
    let rounded = match exponent {
        0.. => {
            let unit = 10f64.powi(exponent);
            (x / unit).round() * unit
        }
        _ => {
            let parts = 10f64.powi(-exponent);
            (x * parts).round() / parts
        }
    };
    rounded + 0.0 // no −0
}

/// A camera's rays in f64, in the world.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sight {
    eye: DVec3,
    /// Where the camera looks.
    target: DVec3,
    /// Unit vectors.
    pub right: DVec3,
    pub up: DVec3,
    pub forward: DVec3,
    /// Half of what the picture shows from top to bottom: at distance 1, or, where rays are parallel, anywhere.
    pub half_extent: f64,
    is_parallel: bool,
    /// Columns and rows.
    size: [f64; 2],
}

impl Sight {
    pub(crate) fn new(camera: &Camera, image_size: [u32; 2]) -> Self {
        let [eye, target, up] = [camera.eye, camera.target, camera.up].map(DVec3::from);
        let forward = (target - eye).normalize();
        let right = forward.cross(up).normalize();
        let (half_extent, is_parallel) = match camera.projection {
            Projection::Perspective { vertical_fov } => {
                ((0.5 * vertical_fov.to_radians()).tan(), false)
            }
            Projection::Orthographic { height } => (0.5 * height, true),
        };
        Self {
            eye,
            target,
            right,
            up: right.cross(forward),
            forward,
            half_extent,
            is_parallel,
            size: image_size.map(f64::from),
        }
    }

    /// Where a hit of the ray through the centre of a pixel lies on that ray: at its depth, free of what 32 bits
    /// moved it aside. A hit farther off than half a pixel stays where it is.
    pub(crate) fn on_ray(&self, pixel: [u32; 2], world: [f64; 3]) -> [f64; 3] {
        let way = DVec3::from(world) - self.eye;
        let depth = way.dot(self.forward);
        let spread = if self.is_parallel { 1.0 } else { depth };
        let side = 2.0 * self.half_extent / self.size[1] * spread;
        let right = (f64::from(pixel[0]) + 0.5 - 0.5 * self.size[0]) * side;
        let up = (0.5 * self.size[1] - f64::from(pixel[1]) - 0.5) * side;
        let on_ray = depth * self.forward + right * self.right + up * self.up;
        match (on_ray - way).length() <= ROUNDED * side {
            true => (self.eye + on_ray).into(),
            false => world,
        }
    }

    /// The matrices of [`crate::View`], from the world less `origin`.
    pub(crate) fn matrices(&self, origin: [f64; 3]) -> [[[f32; 4]; 4]; 2] {
        let origin = DVec3::from(origin);
        let (eye, target) = (self.eye - origin, self.target - origin);
        // glam's columns, read as rows, are the row vectors' matrix.
        let camera_axes = DMat4::from_cols(
            self.right.extend(-self.right.dot(eye)),
            self.up.extend(-self.up.dot(eye)),
            (-self.forward).extend(self.forward.dot(eye)),
            DVec4::W,
        );
        let [width, height] = self.size;
        let x_scale = 0.5 / (self.half_extent * width / height);
        let y_scale = 0.5 / self.half_extent;
        let projection = match self.is_parallel {
            false => DMat4::from_cols(
                DVec4::new(x_scale, 0.0, -0.5, 0.0),
                DVec4::new(0.0, -y_scale, -0.5, 0.0),
                DVec4::new(0.0, 0.0, -1.0, -1.0),
                DVec4::new(0.0, 0.0, -1.0, 0.0),
            ),
            true => DMat4::from_cols(
                DVec4::new(x_scale, 0.0, 0.0, 0.5),
                DVec4::new(0.0, -y_scale, 0.0, 0.5),
                DVec4::new(0.0, 0.0, -1.0, 0.0),
                DVec4::W,
            ),
        };
        let nearer = if self.is_parallel { 1.0 } else { NEARER };
        let exact = [(eye, nearer), (target, 1.0)];
        [camera_axes, camera_axes * projection].map(|m| row_vector_matrix(m, &exact))
    }
}

/// `m`'s columns hold the coefficients of each output coordinate: element [i][j] of the result is
/// what input i adds to output j. Places that have to be exact come with what an error there counts.
fn row_vector_matrix(m: DMat4, exact: &[(DVec3, f64)]) -> [[f32; 4]; 4] {
    let outputs = [m.x_axis, m.y_axis, m.z_axis, m.w_axis].map(|output| in_single(output, exact));
    [0, 1, 2, 3].map(|input| [0, 1, 2, 3].map(|output| outputs[output][input]))
}

/// a·p + b with coefficients of f32, whose roundings cancel at places that have to be exact.
///
/// Each coefficient is off by up to 3e-8 of itself, and so the last one, which is as large as the others times the
/// distance of the eye from the origin: where a picture shows a small part of a scene, that is more than a hundredth
/// of a pixel. Of the few hundred ways to round the first three otherwise, the one that errs least there is taken.
fn in_single(output: DVec4, exact: &[(DVec3, f64)]) -> [f32; 4] {
    let (a, b) = (output.truncate(), output.w);
    let near = a.to_array().map(|x| x as f32);
    let steps: Vec<[f32; 3]> = (-STEPS..=STEPS).map(|by| near.map(|x| stepped(x, by))).collect();
    let mut best = ([near[0], near[1], near[2], b as f32], f64::INFINITY);
    let count = steps.len();
    // Outwards from the nearest ones.
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by_key(|&at| at.abs_diff(count / 2));
    for &x in &order {
        for &y in &order {
            for &z in &order {
                let rounded = [steps[x][0], steps[y][1], steps[z][2]];
                let moved = DVec3::from(rounded.map(f64::from)) - a;
                let offset = (b - moved.dot(exact[0].0)) as f32;
                let error = f64::from(offset) - b;
                let cost = (exact.iter())
                    .map(|(place, weight)| weight * (moved.dot(*place) + error).abs())
                    .fold(0.0, f64::max);
                if cost < best.1 {
                    best = ([rounded[0], rounded[1], rounded[2], offset], cost);
                }
            }
        }
    }
    best.0
}

/// So many numbers of f32 farther; 0 stays.
fn stepped(x: f32, by: i32) -> f32 {
    match (x == 0.0, by) {
        (true, _) | (_, 0) => x,
        (_, 1..) => (0..by).fold(x, |x, _| x.next_up()),
        (_, ..0) => (by..0).fold(x, |x, _| x.next_down()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube(middle: [f64; 3], size: f64) -> [[f64; 3]; 2] {
        [middle.map(|x| x - 0.5 * size), middle.map(|x| x + 0.5 * size)]
    }

    /// f32 has 2^23 steps from a power of two to the next, and a millionth is eight of them: up to eight sizes away
    /// there is no origin.
    #[test]
    fn there_is_no_origin_where_floats_resolve_a_millionth_of_the_scene() {
        for exponent in -12..=12 {
            let unit = 10f64.powi(exponent);
            for (at, has_origin) in [(0.0, false), (3.0, false), (20.0, true), (1e4, true)] {
                let origin = file_origin(cube([at * unit, 0.0, -at * unit], unit));
                assert_eq!(origin != [0.0; 3], has_origin, "{at} of 1e{exponent}: {origin:?}");
            }
        }
        assert_eq!(file_origin(cube([7.4, 0.0, 0.0], 1.0)), [0.0; 3], "steps of 4.8e-7");
        assert_eq!(file_origin(cube([8.0, 0.0, 0.0], 0.9)), [8.0, 0.0, 0.0], "steps of 9.5e-7");
    }

    #[test]
    fn the_middle_is_rounded_to_a_power_of_ten_of_at_most_a_tenth_of_the_size() {
        let survey = [[413_201.2, 5_318_004.9, 201.1], [413_701.9, 5_318_320.4, 290.3]];
        assert_eq!(file_origin(survey), [413_450.0, 5_318_160.0, 250.0], "501 m across: tens");
        assert_eq!(file_origin(cube([1234.567, -0.04, 9.96], 0.5)), [1234.57, -0.04, 9.96]);
        // 100 has hundredths of 10 exactly, 99 of 1.
        assert_eq!(file_origin(cube([12_346.0, 0.0, 0.0], 100.0)), [12_350.0, 0.0, 0.0]);
        assert_eq!(file_origin(cube([12_346.0, 0.0, 0.0], 99.0)), [12_346.0, 0.0, 0.0]);
        assert_eq!(
            file_origin(cube([1e6 + 0.123_46, 0.0, 0.0], 1e-3)),
            [1_000_000.123_5, 0.0, 0.0]
        );
        // One point, or several in one place.
        assert_eq!(file_origin([[6e6, 0.26, 0.0]; 2]), [6e6, 0.3, 0.0]);
        let far = file_origin(cube([1e15, 0.0, 0.0], 1e3));
        assert_eq!(far, [1e15, 0.0, 0.0]);
        assert!(file_origin(survey).iter().all(|x| x.is_sign_positive()), "no -0");
    }

    fn camera(eye: [f64; 3], target: [f64; 3], projection: Projection) -> Camera {
        Camera { eye, target, up: [0.1, 0.2, 0.97], projection, aperture: 0.0, focus: None }
    }

    fn apply(m: &[[f32; 4]; 4], p: DVec3) -> [f64; 4] {
        [0, 1, 2, 3]
            .map(|j| (0..3).map(|i| p[i] * f64::from(m[i][j])).sum::<f64>() + f64::from(m[3][j]))
    }

    /// A picture of a hundredth and of a ten-thousandth of a scene that reaches to `far`: matrices rounded to the nearest
    /// err by steps of f32 at the eye, 0.06 and 6 pixels.
    #[test]
    fn matrices_of_32_bits_hit_a_tenth_of_a_hundredth_of_a_pixel() {
        let size = [1920, 1080];
        for far in [1e-3, 8.0, 1e6] {
            for share in [1.0, 1e-2, 1e-4] {
                let across = share * far;
                let target = DVec3::new(0.9, -0.7, 0.8) * far;
                let eye = target + DVec3::new(1.3, 0.4, -0.8) * across;
                for projection in [
                    Projection::Perspective { vertical_fov: 35.0 },
                    Projection::Orthographic { height: across },
                ] {
                    let sight = Sight::new(&camera(eye.into(), target.into(), projection), size);
                    let [_, ndc] = sight.matrices([0.0; 3]);
                    let mut most = 0.0f64;
                    for (column, row) in [(0, 0), (960, 540), (1919, 0), (37, 1079)] {
                        for depth in [0.1, 0.5, 1.5, 20.0] {
                            let p = eye + sight.forward * (depth * across);
                            let spread = if sight.is_parallel { 1.0 } else { depth * across };
                            let side = 2.0 * sight.half_extent / 1080.0 * spread;
                            let p = p
                                + sight.right * ((f64::from(column) + 0.5 - 960.0) * side)
                                + sight.up * ((540.0 - 0.5 - f64::from(row)) * side);
                            let on_ray = DVec3::from(sight.on_ray([column, row], p.into()));
                            assert!(on_ray.distance(p) < 1e-9 * far);
                            let [x, y, _, w] = apply(&ndc, p);
                            let off_x = x / w * 1920.0 - f64::from(column) - 0.5;
                            let off_y = y / w * 1080.0 - f64::from(row) - 0.5;
                            most = most.max(off_x.abs()).max(off_y.abs());
                        }
                    }
                    // In pixels, half a step of f32 of the farthest coordinate.
                    let step = 0.5 * single_step(0.9 * far) / (across / 1080.0);
                    let limit = 1e-3 + 0.4 * step;
                    assert!(most < limit, "{far} {share} {projection:?}: {most} of {limit}");
                }
            }
        }
    }

    #[test]
    fn a_hit_beside_its_ray_is_moved_onto_it_at_its_depth() {
        let projection = Projection::Perspective { vertical_fov: 40.0 };
        let sight =
            Sight::new(&camera([5e5, 5e6, 10.0], [5e5, 5e6 + 1.0, 10.0], projection), [64, 48]);
        let side = 2.0 * sight.half_extent / 48.0 * 100.0;
        let exact =
            sight.eye + 100.0 * sight.forward + 1.5 * side * sight.right - 0.5 * side * sight.up;
        let moved = |by: f64| {
            let hit = exact + by * side * sight.right.lerp(sight.up, 0.3).normalize();
            (DVec3::from(sight.on_ray([33, 24], hit.into())), hit)
        };
        // f64 rounds at 5e6 by 5e-10.
        assert!(moved(0.0).0.distance(exact) < 2e-9);
        assert!(moved(0.49).0.distance(exact) < 2e-9);
        assert_eq!(moved(0.51).0, moved(0.51).1);
    }
}
