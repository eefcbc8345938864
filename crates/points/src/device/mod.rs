//! Polynomials and the uniform grid, built as storage buffers of a device (\[T\] §4, §5).
//!
//! Count, scan, stable scatter: the order in a cell is the order of (object, place in the file), so
//! a render gives the same bytes from run to run. No float atomics, no atomic append.

mod clip;
mod fit;
mod grid_build;
mod scan;
mod sort;

pub use scan::Scan;
pub use sort::{Pairs, Sort, SortSpace};

use crate::{Cloud, NeighborSearch, Rims, Watch, plan_grid};
use fit::FitPolynomials;
use gpu::{Buffer, Device, GpuError, Recorder};
use grid_build::{GridBuild, GridBuildIo};
use kernels::layout::{FitOutcome, FitParams, GridInfo, LINE_ROW, Polynomial, Rim};
use std::sync::Arc;

/// Points whose neighbours are listed and fitted in one go: 8 MiB of lists at k = 16.
const FIT_BATCH: usize = 1 << 17;

/// What a renderer traces.
#[derive(Debug)]
pub struct Surfaces {
    /// [`Polynomial`]s by slot.
    pub polynomials: Buffer,
    /// How each fit ended, by slot.
    pub outcomes: Vec<FitOutcome>,
    /// The same, for kernels.
    pub outcome_buffer: Buffer,
    /// Where the grid lies.
    pub grid: GridInfo,
    /// The same, for kernels.
    pub grid_info: Buffer,
    /// First and past-the-last entry of each cell in `slots`.
    pub cells: Buffer,
    /// Points, cell after cell.
    pub slots: Buffer,
    /// Each point in its own cell alone; only where hits are refined and any point carries a surface.
    pub point_cells: Option<PointCells>,
}

/// The points of each cell, each point once.
#[derive(Debug)]
pub struct PointCells {
    /// First entry of each cell in `points`, and one behind the last.
    pub offsets: Buffer,
    /// [`ListedPoint`]s, cell after cell.
    ///
    /// [`ListedPoint`]: kernels::layout::ListedPoint
    pub points: Buffer,
}

/// Why surfaces could not be built.
#[derive(Debug, thiserror::Error)]
pub enum BuildError {
    /// The device refused or failed.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The watcher asked for an end.
    #[error("interrupted")]
    Interrupted,
}

impl Surfaces {
    /// Fits every point of the cloud and sorts the fits into a grid. `fits` has one entry an object;
    /// `resolution` is the number of cells along the grid's longest axis, 0: chosen; `refines` also
    /// lists what refinement of hits reads. `stand_ins` come behind the polynomials of all points, and in
    /// no cell.
    ///
    /// # Errors
    /// A device without the memory, a buffer over its limits, a lost device, an interruption.
    pub fn build(
        device: &Arc<Device>,
        cloud: &Cloud,
        fits: &[FitParams],
        resolution: u32,
        refines: bool,
        stand_ins: &[Polynomial],
        watch: &dyn Watch,
    ) -> Result<Self, BuildError> {
        let fitted = (cloud.points.len() * size_of::<Polynomial>()) as u64;
        let bytes = fitted + size_of_val(stand_ins) as u64;
        let polynomials = Buffer::new(device, "polynomials", bytes)?;
        polynomials.write(fitted, stand_ins)?;
        let (outcomes, outcome_buffer, rims) = fit_all(device, cloud, fits, &polynomials, watch)?;
        watch.stage("building the grid", 1);
        let grid = plan_grid(&cloud.points, &outcomes, resolution);
        let grid_info = Buffer::from_slice(device, "grid info", &[grid])?;
        let build = GridBuild::new(device)?;
        let io = GridBuildIo {
            grid: &grid,
            grid_info: &grid_info,
            polynomials: &polynomials,
            order: &cloud.order,
        };
        // Refinement asks for the points, the grid for their balls: those move at rims.
        let point_cells = if refines { build.list_points(&io)? } else { None };
        clip::clip_balls(device, &polynomials, &rims.clips(&cloud.points, &outcomes))?;
        let lists = build.run(&io)?;
        watch.done(1);
        Ok(Self {
            polynomials,
            outcomes,
            outcome_buffer,
            grid,
            grid_info,
            cells: lists.cells,
            slots: lists.slots,
            point_cells,
        })
    }

    /// Bytes on the device that tracing needs.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        let listed = |cells: &PointCells| {
            cells.offsets.bytes() + cells.points.bytes() + self.outcome_buffer.bytes()
        };
        let refinement = self.point_cells.as_ref().map_or(0, listed);
        self.polynomials.bytes() + self.cells.bytes() + self.slots.bytes() + refinement
    }
}

/// Fits batch after batch, outcomes on the host and on the device, so that lists of neighbours never fill memory;
/// with the rims.
fn fit_all(
    device: &Arc<Device>,
    cloud: &Cloud,
    fits: &[FitParams],
    polynomials: &Buffer,
    watch: &dyn Watch,
) -> Result<(Vec<FitOutcome>, Buffer, Rims), BuildError> {
    let count = cloud.points.len();
    let points = Buffer::from_slice(device, "points", &cloud.points)?;
    let outcomes = Buffer::new(device, "fit outcomes", (count * size_of::<FitOutcome>()) as u64)?;
    let smoothed = fits.iter().any(|fit| fit.feature_size < 0.0);
    let sizes = Buffer::new(device, "feature sizes", if smoothed { count as u64 * 4 } else { 4 })?;
    let finds_rims = fits.iter().any(|fit| fit.rim_limit > 0.0);
    let most_rims = if finds_rims { count.min(FIT_BATCH) } else { 1 };
    let rim_buffer = Buffer::new(device, "rims", (most_rims * size_of::<Rim>()) as u64)?;
    let mut rims = Rims::default();
    let pass = FitPolynomials::new(device)?;
    let mut recorder = Recorder::new(device)?;
    watch.stage("fitting surfaces", count as u64);
    let mut done = 0;
    for (object, fit) in cloud.objects.iter().zip(fits) {
        let range = object.range();
        let search = NeighborSearch::new(&cloud.points[range.clone()], object.first_slot);
        if fit.feature_size < 0.0 {
            let smoothed = search.smoothed_sizes(fit.neighbors as usize);
            sizes.write(u64::from(object.first_slot) * 4, &smoothed)?;
        }
        for first in (0..range.len()).step_by(FIT_BATCH) {
            if watch.interrupted() {
                return Err(BuildError::Interrupted);
            }
            let batch = first..range.len().min(first + FIT_BATCH);
            let lists = search.nearest(batch.clone(), fit.neighbors as usize);
            let neighbors = Buffer::from_slice(device, "neighbors", &lists)?;
            let first_slot = object.first_slot + first as u32;
            let point_count = batch.len() as u32;
            let params = FitParams { first_slot, point_count, first_listed: first_slot, ..*fit };
            let io = fit::FitPolynomialsIo {
                points: &points,
                neighbors: &neighbors,
                polynomials,
                outcomes: &outcomes,
                sizes: &sizes,
                rims: &rim_buffer,
            };
            pass.record(&mut recorder, io, &params);
            recorder.submit()?;
            if fit.rim_limit > 0.0 {
                let mut found = vec![Rim::default(); batch.len()];
                rim_buffer.read(0, &mut found)?;
                rims.add(first_slot, &found, &lists);
            }
            done += batch.len() as u64;
            watch.done(done);
        }
    }
    let mut read = vec![FitOutcome { trust: 0.0, kind: 0, feature_size: 0.0 }; count];
    outcomes.read(0, &mut read)?;
    Ok((read, outcomes, rims))
}

/// Invocations for a list of `count` entries: over rows where one axis would be too short.
#[must_use]
pub fn line(count: u32) -> [u32; 3] {
    [count.min(LINE_ROW), count.div_ceil(LINE_ROW), 1]
}
