//! Twin of `camera_rays`: the camera's ray of a pixel.

use crate::real::{NO_HIT, Real, V3};
use crate::sampler::{concentric_disc, sample_2d};
use kernels::layout::{
    CameraParams, FILTER_INTERVALS, NONE, ORTHOGRAPHIC, RAY_STARTS, SAMPLE_FILM, SAMPLE_LENS,
};

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
    /// The object whose surface is not there for it, or `NONE`.
    pub passed: u32,
    /// The cell that it is in; `RAY_STARTS` before its structure has begun with it; `NONE` once it is done.
    pub cell: u32,
    /// Cells crossed so far.
    pub cells: u32,
    /// Points tested so far.
    pub tests: u32,
}

/// Where the filter's integral reaches u, in pixels from a pixel's centre.
fn filter_place<R: Real>(filter: &[f32], u: R) -> R {
    let at = u * R::of_u32(FILTER_INTERVALS);
    let low = at.floor();
    let i = low.to_u32() as usize;
    let (a, b) = (R::of_f32(filter[i]), R::of_f32(filter[i + 1]));
    a + (at - low) * (b - a)
}

/// The ray of one pixel of the tile. `filter` is the plan's.
#[must_use]
pub fn camera_ray<R: Real>(params: &CameraParams, filter: &[f32], pixel: [u32; 2]) -> Ray<R> {
    let zero = R::of(0.0);
    let at = [0, 1].map(|axis| params.tile_origin[axis] + pixel[axis]);
    let (mut offset, mut lens) = ([zero; 2], [zero; 2]);
    if params.sample_index != NONE {
        offset = sample_2d(at, params.sample_index, params.seed, SAMPLE_FILM)
            .map(|u| filter_place(filter, u));
        let u = sample_2d(at, params.sample_index, params.seed, SAMPLE_LENS);
        lens = concentric_disc(u).map(|x: R| R::of_f32(params.lens_radius) * x);
    }
    let center = at.map(|i| R::of_u32(i) + R::of(0.5));
    let scale = R::of_f32(params.scale);
    let place = [
        ((center[0] - R::of_f32(params.half_width)) + offset[0]) * scale,
        ((R::of_f32(params.half_height) - center[1]) - offset[1]) * scale,
    ];
    let parallel = params.projection == ORTHOGRAPHIC;
    let [seen, from] = if parallel { [[zero; 2], place] } else { [place, [zero; 2]] };
    let slope = [0, 1].map(|i| seen[i] - lens[i] / R::of_f32(params.focus));
    let start = [0, 1].map(|i| from[i] + lens[i]);
    let [right, up, forward, eye] =
        [params.right, params.up, params.forward, params.eye].map(V3::of_f32);
    let direction = ((forward + right.times(slope[0])) + up.times(slope[1])).normalize();
    let origin =
        if start == [zero; 2] { eye } else { (eye + right.times(start[0])) + up.times(start[1]) };
    Ray::new(origin, direction, NONE)
}

impl<R: Real> Ray<R> {
    /// A ray from the surface of a point or from nowhere, that its structure has yet to begin with.
    #[must_use]
    pub fn new(origin: V3<R>, direction: V3<R>, left: u32) -> Self {
        Self {
            origin,
            direction,
            hit_t: R::of(NO_HIT),
            after: R::of(0.0),
            hit_slot: NONE,
            left,
            passed: NONE,
            cell: RAY_STARTS,
            cells: 0,
            tests: 0,
        }
    }
}
