//! Twin of `glsl/shared/around.glsl`: the points of an object around a place, in the order of their indices.

use crate::grid_build::CellLists;
use crate::levels::{Level, Levels};
use crate::polynomial::Polynomial;
use crate::real::{Real, V3};
use std::borrow::Cow;
use std::ops::Range;

const MOST_LISTED_AROUND: usize = 2048;
const MOST_MERGED: usize = 1024;

/// Slots around x: `most` of one list, others than the object's among them, or, where several lists may have some,
/// those of the object whose trust ball holds x. `slots` are all of the object's.
pub(crate) fn points_around<'a, R: Real>(
    levels: &Levels<R>,
    lists: &'a CellLists,
    polynomials: &[Polynomial<R>],
    x: V3<R>,
    slots: Range<u32>,
    most: usize,
) -> Cow<'a, [u32]> {
    let list = |level: &Level<R>| {
        let [first, end] = lists.cells[level.cell_around(x) as usize].map(|entry| entry as usize);
        &lists.slots[first..end.max(first)]
    };
    let first = |listed: &'a [u32], most: usize| &listed[..listed.len().min(most)];
    if !levels.are_several() {
        return Cow::Borrowed(first(levels.iter().next().map(list).unwrap_or_default(), most));
    }
    let around: Vec<&[u32]> = levels
        .listing(slots.clone())
        .filter(|level| level.grid.holds(x))
        .map(|level| first(list(level), MOST_LISTED_AROUND))
        .filter(|listed| !listed.is_empty())
        .collect();
    if let [one] = around[..] {
        return Cow::Borrowed(first(one, most));
    }
    let holds = |slot: &u32| {
        let p = &polynomials[*slot as usize];
        let y = x - p.center;
        slots.contains(slot) && y.dot(y) < p.trust * p.trust
    };
    let mut held: Vec<u32> = around.concat();
    held.retain(holds);
    held.sort_by_key(|&slot| polynomials[slot as usize].index);
    held.truncate(MOST_MERGED);
    Cow::Owned(held)
}
