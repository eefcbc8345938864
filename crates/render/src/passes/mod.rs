//! The passes of a frame. Each owns its pipeline, borrows what it works on, and offers `record`.

mod accumulate;
mod albedo;
mod camera_rays;
mod camera_trace;
mod classify;
mod disc_count;
mod disc_emit;
mod disc_ranges;
mod disc_trace;
mod grid_trace;
mod isosurface;
mod light_passes;
mod march;
mod marked;
mod point_light;
mod refine;
mod scatter;
mod shade;
mod shadow_rays;
mod surface_hit;
mod tree_trace;

pub(crate) use accumulate::Accumulate;
pub(crate) use albedo::AlbedoIo;
pub(crate) use camera_rays::{CameraRays, CameraRaysIo};
pub(crate) use camera_trace::{CameraTrace, CameraTraceIo};
pub(crate) use classify::{Classify, ClassifyIo};
pub(crate) use disc_count::DiscCount;
pub(crate) use disc_emit::DiscEmit;
pub(crate) use disc_ranges::DiscRanges;
pub(crate) use disc_trace::{DiscTrace, DiscTraceIo};
pub(crate) use grid_trace::{GridTrace, Start, TraceIo};
pub(crate) use isosurface::{Isosurface, IsosurfaceIo, Searching};
pub(crate) use light_passes::{LightPasses, LightPassesIo};
pub(crate) use march::{March, MarchIo, Marched};
pub(crate) use marked::{ListMarked, Marks};
pub(crate) use point_light::{PointLight, PointLightIo};
pub(crate) use refine::{Refine, RefineIo};
pub(crate) use scatter::{Scatter, ScatterIo};
pub(crate) use shade::{Shade, ShadeIo};
pub(crate) use shadow_rays::{ShadowRays, ShadowRaysIo};
pub(crate) use surface_hit::{SurfaceHit, SurfaceHitIo};
pub(crate) use tree_trace::TreeTrace;

use crate::state::RayLoop;
use gpu::{Binding, Texel};
use kernels::layout::{
    DISC_KEYS_IN, DISC_LEAVES_IN, DISC_RANGES_IN, MARCH_CELLS, MARCH_LENGTHS, MARCH_POINTS,
    MARCH_STOPS, TILE_GROUP, TRACE_CELLS, TRACE_POLYNOMIALS, TRACE_SLOTS, WAVE_LIT_HITS,
    WAVE_LIT_RAYS, WAVE_PATHS,
};
use points::device::line;

/// Pixels that a workgroup covers along each side (`tile_pixel` in `glsl/shared/index.glsl`).
const TILE_EDGE: u32 = 8;

/// The polynomials, and the lists of points of cells (`glsl/shared/records.glsl`).
fn surface_lists(form: RayLoop) -> [(u32, Binding); 3] {
    [
        (TRACE_POLYNOMIALS, form.read(Texel::Four)),
        (TRACE_CELLS, form.read(Texel::Two)),
        (TRACE_SLOTS, form.read(Texel::Four)),
    ]
}

/// The rays that hit diffuse surfaces, their hits and paths (`glsl/shared/lit.glsl`, `path.glsl`).
fn lit_rays(form: RayLoop) -> [(u32, Binding); 3] {
    [
        (WAVE_LIT_RAYS, form.read(Texel::One)),
        (WAVE_LIT_HITS, form.read(Texel::Four)),
        (WAVE_PATHS, form.read(Texel::Four)),
    ]
}

/// The lists of points of screen tiles (`glsl/shared/disc_walk.glsl`).
fn disc_lists(form: RayLoop) -> [(u32, Binding); 3] {
    [
        (DISC_RANGES_IN, form.read(Texel::Two)),
        (DISC_KEYS_IN, form.read(Texel::One)),
        (DISC_LEAVES_IN, form.read(Texel::Four)),
    ]
}

/// The cells, points and transfer functions of volumes (`glsl/shared/volume.glsl`).
fn volume_lists(form: RayLoop) -> [(u32, Binding); 4] {
    [
        (MARCH_CELLS, form.read(Texel::Two)),
        (MARCH_POINTS, form.read(Texel::Four)),
        (MARCH_LENGTHS, form.read(Texel::One)),
        (MARCH_STOPS, form.read(Texel::Four)),
    ]
}

/// Invocations for a tile of pixels: a row of [`TILE_GROUP`] for each 8 × 8 of them.
fn over_pixels(size: [u32; 2]) -> [u32; 3] {
    [size[0].div_ceil(TILE_EDGE) * TILE_GROUP, size[1].div_ceil(TILE_EDGE), 1]
}
