//! Polynomials and grids, built as storage buffers of a device (\[T\] §4, §5).
//!
//! Count, scan, stable scatter: the order in a cell is the order of (object, place in the file), so
//! a render gives the same bytes from run to run. No float atomics, no atomic append.

mod clip;
mod fit;
mod fitting;
mod grid_build;
mod scan;
mod search;
mod shapes;
mod skip;
mod smooth;
mod sort;
mod tree;
mod work;

pub use fitting::{modules_of_fits, nearest_others};
pub use scan::Scan;
pub use shapes::modules_of_shapes;
pub use sort::{Pairs, Sort, SortSpace};
pub use tree::Tree;

use crate::{Cloud, Grids, Shapes, Watch, plan_grids};
use fitting::{Fitted, fit_all, lists_of};
use gpu::{Buffer, Device, GpuError};
use grid_build::{GridBuild, GridToBuild, LISTED_POINT_BYTES, slab_pairs};
use kernels::layout::{FitOutcome, FitParams, GridLevel, LINE_ROW, Point, Polynomial};
use kernels::spirv::{Lists, Module};
use std::sync::Arc;
use work::Work;

/// What a renderer traces.
#[derive(Debug)]
pub struct Surfaces {
    /// [`Polynomial`]s by slot.
    pub polynomials: Buffer,
    /// How each fit ended, by slot.
    pub outcomes: Vec<FitOutcome>,
    /// The same, for kernels, where hits are refined.
    pub outcome_buffer: Buffer,
    /// Where the grids lie.
    pub grids: Grids,
    /// The same, for kernels.
    pub grid_levels: Buffer,
    /// First and past-the-last entry in `slots` of each cell of each grid.
    pub cells: Buffer,
    /// Points, cell after cell.
    pub slots: Buffer,
    /// Each point in its own cell alone; only where hits are refined and any point carries a surface.
    pub point_cells: Option<PointCells>,
    /// The boxes around them, where rays go through these.
    pub tree: Option<Tree>,
    /// Whether `cells` and `slots` list anything.
    pub is_listed: bool,
    /// Points whose neighbours were found on the host, since the search on the device is bounded.
    pub searched_on_host: u64,
    /// Milliseconds of each kernel of the build by the device's clock, in the order of first use.
    pub kernels: Vec<(&'static str, f64)>,
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
    /// More points than the device has memory for.
    #[error(
        "{points} points need {peak} bytes of the device's memory while they are built and {kept} after \
         that, but it has {heap}: thin the point sets to about {fitting} points, or render with --device \
         reference"
    )]
    Memory {
        /// Points that carry a surface.
        points: u64,
        /// Bytes while the grid is built.
        peak: u64,
        /// Bytes that tracing needs.
        kept: u64,
        /// Bytes of the device's heap.
        heap: u64,
        /// About how many points would fit.
        fitting: u64,
    },
    /// The watcher asked for an end.
    #[error("interrupted")]
    Interrupted,
}

/// What the tree takes a point, at least.
const TREE_BYTES_PER_POINT: u64 = 9;

/// Bytes of a device's memory that a build takes, by a lower estimate: what does not fit could not have been
/// finished.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Memory {
    points: u64,
    needed: Needed,
}

impl Memory {
    fn of(points: u64, needed: Needed) -> Self {
        Self { points, needed }
    }

    /// What tracing needs: polynomials, of the tree a node and more every eight points, of the grid a cell and two
    /// entries of its list a point.
    fn kept(self) -> u64 {
        let tree = if self.needed.tree { TREE_BYTES_PER_POINT } else { 0 };
        let lists = if self.has_lists() { 16 } else { 0 };
        let refinement =
            if self.needed.point_cells { size_of::<FitOutcome>() as u64 + 16 } else { 0 };
        self.points * (size_of::<Polynomial>() as u64 + tree + lists + refinement)
    }

    fn has_lists(self) -> bool {
        self.needed.lists || !self.needed.tree
    }

    /// Beside that, while fitting, the points; while the grid is built, their balls and what else it lists them by.
    fn peak(self) -> u64 {
        let building =
            if self.has_lists() { LISTED_POINT_BYTES } else { size_of::<Point>() as u64 };
        self.kept() + self.points * building
    }

    fn require(self, heap: u64) -> Result<(), BuildError> {
        let (points, peak, kept) = (self.points, self.peak(), self.kept());
        if peak <= heap || points == 0 {
            return Ok(());
        }
        let fitting = heap / (peak / points);
        Err(BuildError::Memory { points, peak, kept, heap, fitting })
    }
}

/// What tracing will ask for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Needed {
    /// The points of each cell; listed in any case where there is no tree.
    pub lists: bool,
    /// The tree, if the device can.
    pub tree: bool,
    /// What refinement of hits reads.
    pub point_cells: bool,
}

/// The modules of tree and grid that a build asks for after the fits, to be [made ahead](gpu::Kernel::make_ahead).
#[must_use]
pub fn modules_of_structures(needed: Needed) -> Vec<&'static Module> {
    let mut modules = Vec::new();
    if needed.tree {
        modules.extend(Tree::modules());
    }
    if needed.lists || !needed.tree {
        modules.extend(GridBuild::modules(Lists::Texels));
    }
    modules
}

impl Surfaces {
    /// Fits the points of the cloud, makes the others spheres and discs, and sorts all into grids. `fits` has one entry
    /// an object; `resolution` is the number of cells along the grid's longest axis, 0: chosen. `stand_ins` come behind the
    /// polynomials of all points, and in no cell and no node.
    ///
    /// # Errors
    /// A device without the memory, a buffer over its limits, a lost device, an interruption.
    pub fn build(
        device: &Arc<Device>,
        cloud: &Cloud,
        (fits, shapes): (&[FitParams], &[Shapes]),
        resolution: u32,
        needed: Needed,
        stand_ins: &[Polynomial],
        watch: &dyn Watch,
    ) -> Result<Self, BuildError> {
        let refines = needed.point_cells;
        let heap = device.limits().heap_bytes;
        let memory = Memory::of(cloud.points.len() as u64, needed);
        memory.require(heap)?;
        let mut work = Work::new(device)?;
        let fitted = (cloud.points.len() * size_of::<Polynomial>()) as u64;
        let bytes = fitted + size_of_val(stand_ins) as u64;
        let polynomials = Buffer::paged(device, "polynomials", bytes)?;
        polynomials.write(fitted, stand_ins)?;
        let Fitted { outcomes, outcome_buffer, rims, searched_on_host } =
            fit_all(device, cloud, (fits, shapes), &polynomials, &mut work, watch)?;
        // Refinement alone reads them on the device.
        let outcome_buffer = match refines {
            true => outcome_buffer,
            false => Buffer::new(device, "fit outcomes", size_of::<FitOutcome>() as u64)?,
        };
        watch.stage("building the grid", 4);
        let lists = lists_of(device, bytes / 16);
        let count = cloud.points.len() as u32;
        let may_have_tree = needed.tree && Tree::fits(device, count);
        let looks = needed.lists || refines || !may_have_tree;
        let grids = match looks {
            true => plan_grids(&cloud.points, &outcomes, resolution, needed.tree),
            false => Grids::around(&cloud.points, &outcomes),
        };
        let slab_pairs = slab_pairs(memory.points, heap.saturating_sub(memory.kept()));
        watch.done(1);
        let build = GridBuild::new(device, lists, slab_pairs);
        let widest = outcomes.iter().map(|outcome| outcome.trust).fold(0.0, f32::max);
        let io = |(at, level): (usize, &GridLevel)| -> Result<GridToBuild<'_>, GpuError> {
            Ok(GridToBuild {
                level: *level,
                grid_info: Buffer::from_slice(device, "grid info", &[level.grid])?,
                polynomials: &polynomials,
                order: grids.order_of(at, &cloud.order),
                // Others are no wider than two cells, and touch four along each axis at most.
                any_large: widest > 0.99 * level.grid.edge,
            })
        };
        let levels: Vec<_> = grids.levels.iter().enumerate().map(io).collect::<Result<_, _>>()?;
        // Refinement asks for the points, the grid for their balls: those move at rims.
        let point_cells = if refines { build.list_points(&mut work, &levels)? } else { None };
        watch.done(2);
        clip::clip_balls(device, &mut work, &polynomials, &rims.clips(&cloud.points, &outcomes))?;
        // What goes through the tree reads cells as texels too.
        let cells_fit = grids.cell_count() <= device.limits().max_texel_buffer_elements;
        let tree = match may_have_tree && cells_fit {
            true => Some(Tree::build(device, &mut work, &polynomials, count)?),
            false => None,
        };
        watch.done(3);
        let is_listed = needed.lists || tree.is_none();
        let lists = if is_listed { build.run(&mut work, &levels)? } else { build.no_lists()? };
        if is_listed && grids.skip_cells() {
            for io in &levels {
                skip::skip_cells(device, &mut work, &io.level, &io.grid_info, &lists.cells)?;
            }
        }
        drop(levels);
        let grid_levels = Buffer::from_slice(device, "grids", &grids.levels)?;
        watch.done(4);
        Ok(Self {
            polynomials,
            outcomes,
            outcome_buffer,
            grids,
            grid_levels,
            cells: lists.cells,
            slots: lists.slots,
            point_cells,
            tree,
            is_listed,
            searched_on_host,
            kernels: work.kernels,
        })
    }

    /// Bytes on the device that tracing needs.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        let listed = |cells: &PointCells| {
            cells.offsets.bytes() + cells.points.bytes() + self.outcome_buffer.bytes()
        };
        let refinement = self.point_cells.as_ref().map_or(0, listed);
        let tree = self.tree.as_ref().map_or(0, |tree| tree.nodes.bytes());
        self.polynomials.bytes() + self.cells.bytes() + self.slots.bytes() + tree + refinement
    }
}

/// Invocations for a list of `count` entries: over rows where one axis would be too short.
#[must_use]
pub fn line(count: u32) -> [u32; 3] {
    [count.min(LINE_ROW), count.div_ceil(LINE_ROW), 1]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_points_than_memory_are_refused_with_how_many_would_fit() {
        let heap = 2 << 30;
        let listed = Needed { lists: true, tree: true, point_cells: false };
        let bare = Needed { lists: false, ..listed };
        let refined = Needed { point_cells: true, ..listed };
        assert!(Memory::of(0, refined).require(0).is_ok());
        assert!(Memory::of(10_000_000, listed).require(heap).is_ok());
        for needed in [listed, bare, refined] {
            let Err(error) = Memory::of(100_000_000, needed).require(heap) else {
                unreachable!("6.4 GB of polynomials alone")
            };
            let BuildError::Memory { fitting, .. } = error else { unreachable!("{error}") };
            assert!(Memory::of(fitting, needed).require(heap).is_ok());
            assert!(Memory::of(fitting + fitting / 50, needed).require(heap).is_err());
        }
    }
}
