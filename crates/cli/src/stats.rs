//! What a render cost: one row, as `render --stats` writes it and `bench --json` lists it.

use crate::engine::{Built, Engine, Frame};
use film::Film;
use kernels::layout::{
    FIT_DISC, FIT_FULL, FIT_INCOMPLETE, FIT_NO_SURFACE, FIT_PLANE, FIT_SPHERE, GridLevel,
};
use plan::{Choice, Plan, RaysFrom};
use render::Traversal;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::time::Duration;

/// One scene on one engine. Times are milliseconds.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub struct Row {
    /// Stem of the scene's file, or the name of a suite's row.
    pub name: String,
    /// The suite.
    pub suite: Option<String>,
    /// From submission to completion of all passes of a frame, shading included.
    pub trace_ms: Spread,
    /// `render`: from reading points to the picture; `bench`: a frame with its picture read back.
    pub wall_ms: Spread,
    /// Time of all kernels of a frame by the device's own clock, where it has one.
    pub gpu_ms: Option<Spread>,
    /// Reading points.
    pub read_ms: f64,
    /// What is done on the CPU between reading and building: images are read, isolated points dropped, points sorted,
    /// volumes prepared.
    pub plan_ms: f64,
    /// Fitting surfaces and building the grid.
    pub build_ms: Spread,
    /// Planning and building over that of another row, where the suite asks for it.
    pub prepared_over: Option<PreparedOver>,
    /// What a preset costs and changes, where `bench --preset` asks for it.
    pub beside: Option<Beside>,
    /// How many builds that is of. Where there are several, the first is not among them.
    pub builds: u32,
    /// The same on the CPU with a k-d tree, neighbours and fits alone; where `bench --cpu-preparation` asks for it.
    pub cpu_preparation_ms: Option<Spread>,
    /// Milliseconds of each kernel of the last build.
    pub build_kernels: BTreeMap<&'static str, f64>,
    /// Points whose neighbours the device left to the CPU, since its search is bounded: by work, and to 64 neighbours.
    pub searched_on_cpu: u64,
    /// What the first build and frame waited for the driver to make pipelines; not in `trace_ms`.
    pub pipelines_ms: f64,
    /// The frame before those that are timed, with what the driver compiles at a first dispatch.
    pub warm_up_ms: Option<f64>,
    /// Frames a second, by the median.
    pub frames_per_second: f64,
    /// Frames a second that the paper states.
    pub paper_frames_per_second: Option<f64>,
    /// Columns and rows of the picture.
    pub size: [u32; 2],
    /// Rays by kind.
    pub rays: Rays,
    /// How fast they are.
    pub rays_per_second: RaysPerSecond,
    /// Cells a ray may cross in a pass; 0: as many as it likes.
    pub cells_per_pass: u32,
    /// How camera rays found their first hit, as `render.primary` has it: what the scene asked for, or was chosen.
    pub primary: &'static str,
    /// How all other rays found theirs, as `render.secondary` has it.
    pub secondary: &'static str,
    /// Where the ray state lived, as `render.loop` has it; `null` on the CPU reference.
    #[serde(rename = "loop")]
    pub ray_loop: Option<&'static str>,
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
    /// Points that the filters of all objects left out.
    pub filtered_out: u64,
    /// Points that lack what is shown of them: a colour, an attribute, the scalar of a volume.
    pub missing: u64,
    /// What was chosen where the scene leaves it to the program: lengths that are "auto", ranges that colour maps took.
    pub chosen: Vec<Chosen>,
    /// How the fits ended.
    pub fits: Fits,
    /// The grids, the finest first: one, or several where sizes of trust balls differ; none where no ray goes through
    /// one, and nothing is looked up in it.
    pub grids: Vec<Grid>,
    /// The tree, if any ray goes through it.
    pub tree: Option<Tree>,
    /// Milliseconds of each kernel in the last frame.
    pub kernels: BTreeMap<&'static str, f64>,
    /// Pixels that hit a surface.
    pub hits: u64,
    /// The world position that was subtracted.
    pub origin: [f64; 3],
}

/// Some durations.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Spread {
    /// The middle one, or the mean of the two in the middle.
    pub median: f64,
    /// The shortest.
    pub min: f64,
    /// The longest.
    pub max: f64,
}

/// Times of two rows of one run.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct PreparedOver {
    /// The other row.
    pub name: String,
    /// Medians of planning and of building together, over those of that row.
    pub ratio: f64,
}

/// A row with a preset beside the same without.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Beside {
    /// The row without.
    pub name: String,
    /// Median of tracing over that of the other row.
    pub trace_ratio: f64,
    /// Median of building over that of the other row.
    pub build_ratio: f64,
    /// Mean FLIP of both pictures, the other row's taken as the reference: 0 to 1.
    pub flip: f64,
    /// Share of pixels whose R, G, B or A differ by any bit.
    pub differing: f64,
}

impl Beside {
    /// Of a row and another with their pictures, which have one size.
    pub fn new((row, film): (&Row, &Film), (other, reference): (&Row, &Film)) -> Self {
        let colors = |film: &Film| -> Vec<[f32; 3]> {
            film.color.iter().map(|&[r, g, b, _]| [r, g, b]).collect()
        };
        let size = [film.window.width as usize, film.window.height as usize];
        let bits = |pixel: &[f32; 4]| pixel.map(f32::to_bits);
        let pairs = film.color.iter().zip(&reference.color);
        let differing = pairs.filter(|(a, b)| bits(a) != bits(b)).count();
        Self {
            name: other.name.clone(),
            trace_ratio: row.trace_ms.median / other.trace_ms.median,
            build_ratio: row.build_ms.median / other.build_ms.median,
            flip: compare::Flip::hdr(&colors(reference), &colors(film), size).mean,
            differing: differing as f64 / film.color.len() as f64,
        }
    }
}

/// Rays by kind.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
pub struct Rays {
    /// From the camera.
    pub camera: u64,
    /// Towards lights.
    pub shadow: u64,
    /// From mirrors and glass.
    pub reflected: u64,
    /// Into and out of glass.
    pub refracted: u64,
    /// To all sides, from matt surfaces and in volumes, where light goes from surface to surface.
    pub scattered: u64,
}

/// Rays a second. By kind: over the device's time for the traversal of that kind alone; null where there are
/// no such rays, or the device has no clock.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct RaysPerSecond {
    /// All rays over the median of the whole frame, shading included.
    pub all: f64,
    /// From the camera.
    pub camera: Option<f64>,
    /// Towards lights.
    pub shadow: Option<f64>,
    /// Reflected, refracted and scattered ones, which are traced together.
    pub scattered: Option<f64>,
}

/// A value that was chosen.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Chosen {
    /// Name of the object.
    pub object: String,
    /// The key below the object that would say so, such as `volume.radius`.
    pub key: &'static str,
    /// What it would say.
    pub value: Value,
}

/// A number, the values at the lower and the upper end of a range, or a word.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum Value {
    /// In the key's unit.
    Number(f64),
    /// In the attribute's unit.
    Range([f64; 2]),
    /// One of the key's words.
    Word(&'static str),
}

/// How the fits of all points ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, JsonSchema)]
pub struct Fits {
    /// The polynomial with linear terms.
    pub full: u64,
    /// The paper's polynomial without.
    pub incomplete: u64,
    /// A plane.
    pub plane: u64,
    /// No fit: drawn as a disc.
    pub disc: u64,
    /// No fit: drawn as a sphere.
    pub sphere: u64,
    /// No surface.
    pub none: u64,
}

/// One of the grids.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
pub struct Grid {
    /// Cells along each axis.
    pub resolution: [u32; 3],
    /// Edge of a cell in scene units.
    pub edge: f32,
    /// Cells in all.
    pub cells: u32,
}

/// The boxes in boxes around the surfaces of points.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
pub struct Tree {
    /// Boxes around eight others, or around the surfaces of eight points.
    pub nodes: u64,
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
    /// Of reading points and of planning.
    pub prepared: [Duration; 2],
    /// Points dropped from all objects.
    pub dropped: u64,
    /// Points that the filters of all objects left out.
    pub filtered_out: u64,
}

impl Row {
    /// Puts it together.
    pub fn new(measured: &Measured<'_>) -> Self {
        let Measured { engine, plan, built, frame, .. } = *measured;
        let points = plan.point_count;
        let grid_of = |level: &GridLevel| Grid {
            resolution: level.grid.resolution,
            edge: level.grid.edge,
            cells: level.grid.cell_count(),
        };
        let trace_ms = Spread::of(measured.trace);
        let rays = Rays {
            camera: frame.rays.camera,
            shadow: frame.rays.shadow,
            reflected: frame.rays.reflected,
            refracted: frame.rays.refracted,
            scattered: frame.rays.scattered,
        };
        Self {
            name: measured.name.clone(),
            suite: None,
            trace_ms,
            wall_ms: Spread::of(measured.wall),
            read_ms: milliseconds(measured.prepared[0]),
            plan_ms: milliseconds(measured.prepared[1]),
            gpu_ms: frame.gpu_ms().map(|ms| Spread { median: ms, min: ms, max: ms }),
            build_ms: Spread::of(&[built.duration]),
            prepared_over: None,
            beside: None,
            builds: 1,
            cpu_preparation_ms: None,
            build_kernels: built.kernels().iter().copied().collect(),
            searched_on_cpu: built.searched_on_cpu(),
            pipelines_ms: milliseconds(built.pipelines + frame.pipelines),
            warm_up_ms: None,
            frames_per_second: 1e3 / trace_ms.median.max(1e-6),
            paper_frames_per_second: None,
            size: plan.image_size,
            rays,
            rays_per_second: RaysPerSecond::new(&rays, trace_ms.median, &frame.traversal),
            cells_per_pass: plan.cells_per_pass,
            primary: {
                let tiles = plan.tiles();
                let by_discs = tiles.iter().find(|tile| plan.by_discs(tile));
                built.through(plan, by_discs.map_or(RaysFrom::Camera, RaysFrom::Tile))
            },
            secondary: built.through(plan, RaysFrom::Surface),
            ray_loop: built.ray_loop(),
            passes: frame.passes,
            tests_per_ray: frame.tests as f64 / frame.rays.all().max(1) as f64,
            bytes_per_point: (built.bytes() + plan.volumes.bytes()) as f64 / points.max(1) as f64,
            pixels: pixel_hash(&frame.film, plan.samples),
            device: engine.name(),
            driver: engine.driver(),
            points,
            dropped: measured.dropped,
            filtered_out: measured.filtered_out,
            missing: plan.missing.iter().map(|missing| missing.points).sum(),
            chosen: plan.chosen.iter().map(|chosen| Chosen::of(chosen, plan)).collect(),
            fits: Fits::of(built),
            grids: built.grids().into_iter().flat_map(|grids| &grids.levels).map(grid_of).collect(),
            tree: built.tree().map(|tree| Tree { nodes: tree.node_count() }),
            kernels: frame.kernels.iter().copied().collect(),
            hits: frame.hits,
            origin: plan.cloud.origin,
        }
    }
}

impl PreparedOver {
    /// A row over an earlier one.
    pub fn new(row: &Row, earlier: &Row) -> Self {
        let prepared = |row: &Row| row.plan_ms + row.build_ms.median;
        Self { name: earlier.name.clone(), ratio: prepared(row) / prepared(earlier).max(1e-6) }
    }
}

/// A duration in the unit of rows.
pub fn milliseconds(duration: Duration) -> f64 {
    1e3 * duration.as_secs_f64()
}

impl RaysPerSecond {
    /// From counts, the milliseconds of a frame, and those of its traversal.
    pub fn new(rays: &Rays, frame: f64, traversal: &Traversal) -> Self {
        let scattered = rays.reflected + rays.refracted + rays.scattered;
        let all = rays.camera + rays.shadow + scattered;
        let per_second =
            |count: u64, ms: f64| (count > 0 && ms > 0.0).then(|| 1e3 * count as f64 / ms);
        Self {
            all: per_second(all, frame).unwrap_or(0.0),
            camera: per_second(rays.camera, traversal.camera),
            shadow: per_second(rays.shadow, traversal.shadow),
            scattered: per_second(scattered, traversal.scattered),
        }
    }
}

impl Spread {
    /// Of at least one duration.
    pub fn of(durations: &[Duration]) -> Self {
        Self::of_milliseconds(durations.iter().copied().map(milliseconds).collect())
    }

    /// The same of numbers.
    pub fn of_milliseconds(mut sorted: Vec<f64>) -> Self {
        sorted.sort_by(f64::total_cmp);
        let (Some(&min), Some(&max)) = (sorted.first(), sorted.last()) else {
            return Self { median: 0.0, min: 0.0, max: 0.0 };
        };
        let (lower, upper) = (sorted[(sorted.len() - 1) / 2], sorted[sorted.len() / 2]);
        Self { median: 0.5 * (lower + upper), min, max }
    }
}

impl Chosen {
    fn of(chosen: &plan::Chosen, plan: &Plan) -> Self {
        Self {
            object: plan.names[chosen.object].clone(),
            key: chosen.key,
            value: match chosen.value {
                Choice::Number(number) => Value::Number(number),
                Choice::Range(range) => Value::Range(range),
                Choice::Word(word) => Value::Word(word),
            },
        }
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
            disc: count(FIT_DISC),
            sphere: count(FIT_SPHERE),
            none: count(FIT_NO_SURFACE),
        }
    }
}

/// The first 64 bits of a SHA-256 over the bits of R, G, B, A and, of pictures with one sample a pixel, of Z, N and
/// object: with several, these depend on whether a file wants them.
pub fn pixel_hash(film: &Film, samples: u32) -> String {
    let mut hash = Sha256::new();
    let mut bytes = Vec::with_capacity(9 * 4 * film.window.width as usize);
    for (at, color) in film.color.iter().enumerate() {
        let [r, g, b, a] = *color;
        let [nx, ny, nz] = film.normal[at];
        let values = [r, g, b, a, film.depth[at], nx, ny, nz, film.object[at]];
        let hashed = if samples > 1 { &values[..4] } else { &values };
        bytes.extend(hashed.iter().flat_map(|value| value.to_le_bytes()));
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
        let hash = pixel_hash(&film(), 1);
        assert_eq!(hash.len(), 16);
        assert_eq!(hash, pixel_hash(&film(), 1));
        let of_several = pixel_hash(&film(), 2);
        for change in [
            |film: &mut Film| film.color[5][3] = 1.0,
            |film: &mut Film| film.depth[0] = 1.0,
            |film: &mut Film| film.normal[2][1] = -0.0,
            |film: &mut Film| film.object[5] = 0.0,
        ] {
            let mut changed = film();
            change(&mut changed);
            assert_ne!(hash, pixel_hash(&changed, 1));
            let is_color = changed.color != film().color;
            assert_eq!(of_several != pixel_hash(&changed, 2), is_color);
        }
    }
}
