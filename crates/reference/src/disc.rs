//! Twin of `glsl/shared/disc.glsl`: which pixels a point's trust ball can cover.

use crate::real::{Real, V3};
use kernels::layout::{CameraParams, DISC_TILE, DepthRanks};

const DISC_GROWTH: f64 = 1.0001;
const DISTANCE_ERROR: f64 = 4e-6;
const PIXEL_MARGIN: f64 = 0.03125;
const STEEPEST: f64 = 1e6;
const UNBOUNDED: f64 = 1e20;

/// Screen tiles, first to last along x and y.
pub type TileSpan = [std::ops::RangeInclusive<u32>; 2];

/// The trust ball, grown by what rounding may do on the way to the pixels.
pub fn disc_radius<R: Real>(from_eye: V3<R>, trust: R) -> R {
    trust * R::of(DISC_GROWTH) + from_eye.dot(from_eye).sqrt() * R::of(DISTANCE_ERROR)
}

/// x / z over the points with z > 0 of the disc of radius r about (x, z), seen from the origin, for
/// z ≥ −r.
fn tangents<R: Real>(x: R, z: R, r: R) -> [R; 2] {
    let squared = (x * x + z * z) - r * r;
    let outside = squared > R::of(0.0);
    let c = if outside { squared } else { R::of(0.0) }.sqrt();
    let bound = |across: R, along: R, unbounded: f64| {
        if outside && along * R::of(STEEPEST) > across.abs() {
            across / along
        } else {
            R::of(unbounded)
        }
    };
    [
        bound(x * c - z * r, z * c + x * r, -UNBOUNDED),
        bound(x * c + z * r, z * c - x * r, UNBOUNDED),
    ]
}

/// First and last screen tile among `size` pixels whose centres lie in the range.
fn tiles_of<R: Real>(range: [R; 2], origin: u32, size: u32) -> Option<[u32; 2]> {
    let (margin, half, origin) = (R::of(PIXEL_MARGIN), R::of(0.5), R::of_u32(origin));
    let first = -(-((range[0] - margin - half) - origin)).floor();
    let last = ((range[1] + margin - half) - origin).floor();
    let first = first.max(R::of(0.0));
    let last = last.min(R::of_u32(size) - R::of(1.0));
    if first > last { None } else { Some([first, last].map(|at| at.to_u32() / DISC_TILE)) }
}

/// The screen tiles that the disc of a trust ball covers.
pub fn disc_tiles<R: Real>(camera: &CameraParams, from_eye: V3<R>, trust: R) -> Option<TileSpan> {
    let r = disc_radius(from_eye, trust);
    let along = |axis: [f32; 3]| V3::of_f32(axis).dot(from_eye);
    let z = along(camera.forward);
    if trust <= R::of(0.0) || z < -r {
        return None;
    }
    let in_pixels = |axis| tangents(along(axis), z, r).map(|x| x / R::of_f32(camera.scale));
    let columns = in_pixels(camera.right).map(|x| x + R::of_f32(camera.half_width));
    let [low, high] = in_pixels(camera.up).map(|y| R::of_f32(camera.half_height) - y);
    let [x0, x1] = tiles_of(columns, camera.tile_origin[0], camera.tile_size[0])?;
    let [y0, y1] = tiles_of([high, low], camera.tile_origin[1], camera.tile_size[1])?;
    Some([x0..=x1, y0..=y1])
}

/// Ranks distances along a ray: a lesser one never has a greater rank.
pub fn depth_rank<R: Real>(ranks: &DepthRanks, t: R) -> u32 {
    let clamped = t.max(R::of_f32(ranks.nearest)).min(R::of_f32(ranks.farthest)).to_f32();
    (clamped.to_bits() - ranks.nearest.to_bits()) >> ranks.shift
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> CameraParams {
        CameraParams {
            eye: [0.0; 3],
            scale: 0.01,
            right: [1.0, 0.0, 0.0],
            half_width: 100.0,
            up: [0.0, 1.0, 0.0],
            half_height: 60.0,
            forward: [0.0, 0.0, 1.0],
            sample_index: kernels::layout::NONE,
            tile_origin: [0; 2],
            tile_size: [200, 120],
            projection: kernels::layout::PERSPECTIVE,
            lens_radius: 0.0,
            focus: 1.0,
            seed: 0,
        }
    }

    #[test]
    fn a_disc_in_view_covers_the_tiles_around_its_projection() {
        let span = disc_tiles(&camera(), V3([0.0f32, 0.0, 10.0]), 1.0);
        // tan(asin(0.1)) / 0.01 = 10.05 pixels on each side of (100, 60).
        assert_eq!(span, Some([11..=13, 6..=8]));
        assert_eq!(disc_tiles(&camera(), V3([0.0f32, 0.0, -10.0]), 1.0), None, "behind the eye");
        assert_eq!(disc_tiles(&camera(), V3([30.0f32, 0.0, 10.0]), 1.0), None, "beside the view");
        assert_eq!(disc_tiles(&camera(), V3([0.0f32, 0.0, 10.0]), 0.0), None, "no surface");
        let all = Some([0..=24, 0..=14]);
        assert_eq!(disc_tiles(&camera(), V3([0.0f32, 0.0, -0.5]), 1.0), all, "around the eye");
        // Seen from 24.6 degrees below the axis on, which is row 105.8.
        let below = disc_tiles(&camera(), V3([0.0f32, -1.1, 0.0]), 1.0);
        assert_eq!(below, Some([0..=24, 13..=14]), "across the eye's plane");
    }

    #[test]
    fn a_disc_between_pixel_centres_covers_none() {
        // Column 100.0 is the edge between two pixels; a pixel is 0.1 wide at z = 10.
        assert_eq!(disc_tiles(&camera(), V3([0.0f32, 0.0, 10.0]), 0.04), None);
        let centre = V3([0.05f32, 0.05, 10.0]);
        assert_eq!(disc_tiles(&camera(), centre, 0.001), Some([12..=12, 7..=7]));
    }
}
