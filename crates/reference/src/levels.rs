//! Twin of `glsl/shared/levels.glsl`: the grids of a scene, one after another on a ray's way.

use crate::grid::Grid;
use crate::real::{NO_HIT, Real, V3};
use kernels::layout::{GridLevel, NONE};
use points::Grids;
use std::ops::Range;

/// The grids of a scene in either precision, the finest first.
#[derive(Debug, Clone)]
pub struct Levels<R>(Vec<Level<R>>);

/// One of them.
#[derive(Debug, Clone)]
pub struct Level<R> {
    /// Where it lies.
    pub grid: Grid<R>,
    /// What of the buffers of all grids is its own.
    pub info: GridLevel,
}

impl<R: Real> From<&Grids> for Levels<R> {
    fn from(grids: &Grids) -> Self {
        let level = |info: &GridLevel| Level { grid: Grid::from(&info.grid), info: *info };
        Self(grids.levels.iter().map(level).collect())
    }
}

impl<R: Real> Levels<R> {
    /// Whether there is more than one.
    #[must_use]
    pub fn are_several(&self) -> bool {
        self.0.len() > 1
    }

    /// All of them.
    pub fn iter(&self) -> impl Iterator<Item = &Level<R>> + Clone {
        self.0.iter()
    }

    /// Those that may list points of an object with these slots.
    pub fn listing(&self, slots: Range<u32>) -> impl Iterator<Item = &Level<R>> + Clone {
        let several = self.are_several();
        self.0.iter().filter(move |Level { info, .. }| {
            !several || (info.first_slot < slots.end && slots.start < info.end_slot)
        })
    }

    /// The one that a cell belongs to, and its place among them.
    #[must_use]
    pub fn of_cell(&self, cell: u32) -> (usize, &Level<R>) {
        let at = self.0.partition_point(|level| level.info.first_cell <= cell).max(1) - 1;
        (at, &self.0[at])
    }

    /// The first cell of a ray in the first of the grids from `first` on that it meets within a range of
    /// distances; `NONE` where it meets none.
    #[must_use]
    pub fn enter_from(&self, first: usize, o: V3<R>, d: V3<R>, range: [R; 2]) -> u32 {
        self.0[first..]
            .iter()
            .find_map(|level| {
                level.grid.enter(o, d, range).map(|cell| level.info.first_cell + cell)
            })
            .unwrap_or(NONE)
    }

    /// The first cell of a ray of which hits up to `after` do not count; `NONE` where it misses all grids beyond.
    #[must_use]
    pub fn enter(&self, o: V3<R>, d: V3<R>, after: R) -> u32 {
        self.enter_from(0, o, d, [after, R::of(NO_HIT)])
    }
}

impl<R: Real> Level<R> {
    /// The cell around x.
    #[must_use]
    pub fn cell_around(&self, x: V3<R>) -> u32 {
        self.info.first_cell + self.grid.cell_id(self.grid.cell_of(x))
    }
}
