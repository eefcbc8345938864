//! What a render cost: one row, as `render --stats` writes it and `bench --json` lists it.

use crate::engine::{Built, Engine, Frame};
use film::Film;
use kernels::layout::{FIT_FULL, FIT_INCOMPLETE, FIT_NO_SURFACE, FIT_PLANE};
use plan::Plan;
use serde::Serialize;
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::time::Duration;

/// One scene on one engine. Times are milliseconds.
#[derive(Debug, Clone, Serialize)]
pub struct Row {
    /// Stem of the scene's file.
    pub name: String,
    /// From submission to completion of all passes of a frame, shading included.
    pub trace_ms: Spread,
    /// `render`: from reading points to the picture; `bench`: a frame with its picture read back.
    pub wall_ms: Spread,
    /// Fitting surfaces and building the grid.
    pub build_ms: Spread,
    /// Rays by kind.
    pub rays: Rays,
    /// Dispatches of the traversal.
    pub passes: u32,
    /// Points that a ray was tested against, on average.
    pub tests_per_ray: f64,
    /// Bytes that tracing needs, over the points.
    pub bytes_per_point: f64,
    /// Hash of the picture: equal pictures have equal hashes.
    pub pixels: String,
    /// Name of the device.
    pub device: String,
    /// Its driver with version.
    pub driver: String,
    /// Points of all objects.
    pub points: u64,
    /// Points dropped from all objects.
    pub dropped: u64,
    /// How the fits ended.
    pub fits: Fits,
    /// The grid.
    pub grid: Grid,
    /// Milliseconds of each kernel in the last frame.
    pub kernels: BTreeMap<&'static str, f64>,
    /// Pixels that hit a surface.
    pub hits: u64,
    /// The world position that was subtracted.
    pub origin: [f64; 3],
}

/// Some durations.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Spread {
    /// The middle one, or the mean of the two in the middle.
    pub median: f64,
    /// The shortest.
    pub min: f64,
    /// The longest.
    pub max: f64,
}

/// Rays by kind.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Rays {
    /// From the camera.
    pub camera: u64,
    /// Towards lights.
    pub shadow: u64,
    /// From mirrors and glass.
    pub reflected: u64,
    /// Into and out of glass.
    pub refracted: u64,
}

/// How the fits of all points ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Fits {
    /// The polynomial with linear terms.
    pub full: u64,
    /// The paper's polynomial without.
    pub incomplete: u64,
    /// A plane.
    pub plane: u64,
    /// No surface.
    pub none: u64,
}

/// The uniform grid.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Grid {
    /// Cells along each axis.
    pub resolution: [u32; 3],
    /// Edge of a cell in scene units.
    pub edge: f32,
    /// Cells in all.
    pub cells: u32,
}

/// The frames that were timed, and all that they had in common.
pub struct Measured<'a> {
    /// Stem of the scene's file.
    pub name: String,
    /// What ran.
    pub engine: &'a Engine,
    /// The plan.
    pub plan: &'a Plan,
    /// Its surfaces.
    pub built: &'a Built,
    /// The last frame.
    pub frame: &'a Frame,
    /// Of every frame.
    pub trace: &'a [Duration],
    /// Of every frame.
    pub wall: &'a [Duration],
    /// Points dropped from all objects.
    pub dropped: u64,
}

impl Row {
    /// Puts it together.
    pub fn new(measured: &Measured<'_>) -> Self {
        let Measured { engine, plan, built, frame, .. } = *measured;
        let points = plan.point_count;
        let grid = built.grid();
        Self {
            name: measured.name.clone(),
            trace_ms: Spread::of(measured.trace),
            wall_ms: Spread::of(measured.wall),
            build_ms: Spread::of(&[built.duration]),
            rays: Rays {
                camera: frame.rays.camera,
                shadow: frame.rays.shadow,
                reflected: frame.rays.reflected,
                refracted: frame.rays.refracted,
            },
            passes: frame.passes,
            tests_per_ray: frame.tests as f64 / frame.rays.all().max(1) as f64,
            bytes_per_point: (built.bytes() + plan.volumes.bytes()) as f64 / points.max(1) as f64,
            pixels: pixel_hash(&frame.film),
            device: engine.name(),
            driver: engine.driver(),
            points,
            dropped: measured.dropped,
            fits: Fits::of(built),
            grid: Grid { resolution: grid.resolution, edge: grid.edge, cells: grid.cell_count() },
            kernels: frame.kernels.iter().copied().collect(),
            hits: frame.hits,
            origin: plan.cloud.origin,
        }
    }
}

impl Spread {
    /// Of at least one duration.
    pub fn of(durations: &[Duration]) -> Self {
        let mut sorted: Vec<f64> =
            durations.iter().map(|duration| 1e3 * duration.as_secs_f64()).collect();
        sorted.sort_by(f64::total_cmp);
        let (Some(&min), Some(&max)) = (sorted.first(), sorted.last()) else {
            return Self { median: 0.0, min: 0.0, max: 0.0 };
        };
        let (lower, upper) = (sorted[(sorted.len() - 1) / 2], sorted[sorted.len() / 2]);
        Self { median: 0.5 * (lower + upper), min, max }
    }
}

impl Fits {
    fn of(built: &Built) -> Self {
        let count =
            |kind| built.outcomes().iter().filter(|outcome| outcome.kind == kind).count() as u64;
        Self {
            full: count(FIT_FULL),
            incomplete: count(FIT_INCOMPLETE),
            plane: count(FIT_PLANE),
            none: count(FIT_NO_SURFACE),
        }
    }
}

/// The first 64 bits of a SHA-256 over the bits of R, G, B, A, Z, N and object.
pub fn pixel_hash(film: &Film) -> String {
    let mut hash = Sha256::new();
    let mut bytes = Vec::with_capacity(9 * 4 * film.window.width as usize);
    for (at, color) in film.color.iter().enumerate() {
        let [r, g, b, a] = *color;
        let [nx, ny, nz] = film.normal[at];
        for value in [r, g, b, a, film.depth[at], nx, ny, nz, film.object[at]] {
            bytes.extend(value.to_le_bytes());
        }
        if (at + 1).is_multiple_of(film.window.width as usize) {
            hash.update(&bytes);
            bytes.clear();
        }
    }
    hash.update(&bytes);
    hash.finalize().iter().take(8).map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_of_an_even_number_lies_between_the_two_in_the_middle() {
        let spread = |ms: &[u64]| {
            Spread::of(&ms.iter().map(|&ms| Duration::from_millis(ms)).collect::<Vec<_>>())
        };
        assert_eq!(spread(&[9, 1, 3]), Spread { median: 3.0, min: 1.0, max: 9.0 });
        assert_eq!(spread(&[4, 1, 2, 9]), Spread { median: 3.0, min: 1.0, max: 9.0 });
        assert_eq!(spread(&[7]), Spread { median: 7.0, min: 7.0, max: 7.0 });
    }

    #[test]
    fn any_plane_changes_the_hash() {
        let film = || Film::empty([4, 4], film::Window { x: 1, y: 1, width: 3, height: 2 }, false);
        let hash = pixel_hash(&film());
        assert_eq!(hash.len(), 16);
        assert_eq!(hash, pixel_hash(&film()));
        for change in [
            |film: &mut Film| film.color[5][3] = 1.0,
            |film: &mut Film| film.depth[0] = 1.0,
            |film: &mut Film| film.normal[2][1] = -0.0,
            |film: &mut Film| film.object[5] = 0.0,
        ] {
            let mut changed = film();
            change(&mut changed);
            assert_ne!(hash, pixel_hash(&changed));
        }
    }
}
