//! Twin of `camera_rays`: the ray through a pixel's centre, in the first cell that it meets.

use crate::grid::Grid;
use crate::real::{NO_HIT, Real, V3};
use kernels::layout::{CameraParams, NONE};

/// What a ray carries (`glsl/shared/state.glsl`).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray<R> {
    /// Centred scene space.
    pub origin: V3<R>,
    /// Unit length.
    pub direction: V3<R>,
    /// Nearest hit so far, or [`NO_HIT`].
    pub hit_t: R,
    /// Hits up to this distance do not count: they were refined away.
    pub after: R,
    /// The point hit, or `NONE`.
    pub hit_slot: u32,
    /// The point whose surface it starts on, or `NONE`.
    pub left: u32,
    /// The cell that it is in, or `NONE`.
    pub cell: u32,
    /// Cells crossed so far.
    pub cells: u32,
    /// Points tested so far.
    pub tests: u32,
}

/// The ray of one pixel of the tile.
#[must_use]
pub fn camera_ray<R: Real>(params: &CameraParams, grid: &Grid<R>, pixel: [u32; 2]) -> Ray<R> {
    let center = |axis: usize| R::of_u32(params.tile_origin[axis] + pixel[axis]) + R::of(0.5);
    let scale = R::of_f32(params.scale);
    let x = (center(0) - R::of_f32(params.half_width)) * scale;
    let y = (R::of_f32(params.half_height) - center(1)) * scale;
    let [right, up, forward] = [params.right, params.up, params.forward].map(V3::of_f32);
    let direction = ((forward + right.times(x)) + up.times(y)).normalize();
    Ray::new(V3::of_f32(params.eye), direction, grid, NONE)
}

impl<R: Real> Ray<R> {
    /// A ray in the first cell that it meets, from the surface of a point or from nowhere.
    #[must_use]
    pub fn new(origin: V3<R>, direction: V3<R>, grid: &Grid<R>, left: u32) -> Self {
        Self {
            origin,
            direction,
            hit_t: R::of(NO_HIT),
            after: R::of(0.0),
            hit_slot: NONE,
            left,
            cell: grid.enter(origin, direction),
            cells: 0,
            tests: 0,
        }
    }
}
