//! Whether points come as the nodes of a curvilinear grid, one row after the other.
//!
//! Nothing says how long rows are, but the number of nodes is the product of three lengths, so each pair of divisors is tried:
//! along each of three strides the way must bend little, and the three steps from a node must span a cell of one
//! handedness. Two strides of a folded map of rows and columns lie in its surface: its cells have no volume, or one of
//! either sign.

use super::{median, sample};
use crate::set::PointSet;

/// Nodes that are looked at.
const SAMPLE: usize = 300;
/// Fewer of them prove nothing.
const ENOUGH: usize = 50;
/// Fewer nodes along a direction may be as many sheets.
const SHORTEST: u64 = 8;
/// How much steps change from one to the next, over the longer one, in the median.
const STRAIGHT: f64 = 0.5;
/// The volume of a cell over the product of its edges: at least this, of the same sign, in this part of all; and in the
/// median. Grids have 0.97 and 1; the best that surfaces reach is 0.24 in the median, and 41 of 100 cells.
const SPANNED: f64 = 0.1;
const OF_ALL: f64 = 0.95;
const IN_THE_MEDIAN: f64 = 0.3;

/// Nodes of a grid along each direction, the first index fastest; `None` where points are no such nodes.
pub(super) fn of(set: &PointSet) -> Option<[u64; 3]> {
    let nodes = Nodes { set, count: set.in_file(), sample: sample(set.len(), SAMPLE) };
    nodes.is_straight(1).then_some(())?;
    let strides: Vec<u64> = (divisors(nodes.count).into_iter())
        .filter(|&stride| stride >= SHORTEST && nodes.count / stride >= SHORTEST)
        .filter(|&stride| nodes.is_straight(stride))
        .collect();
    // Strides that go aside as well span the same cells: the shortest steps are those of the grid.
    let mut best: Option<(f64, [u64; 3])> = None;
    for (at, &row) in strides.iter().enumerate() {
        for &sheet in strides[at + 1..].iter().filter(|sheet| *sheet % row == 0) {
            let sides = [row, sheet / row, nodes.count / sheet];
            let edges = if sides[1] < SHORTEST { None } else { nodes.edges_of_cells(row, sheet) };
            if let Some(edges) = edges.filter(|edges| best.is_none_or(|(least, _)| *edges < least))
            {
                best = Some((edges, sides));
            }
        }
    }
    best.map(|(_, sides)| sides)
}

struct Nodes<'a> {
    set: &'a PointSet,
    /// In the file, those that were dropped included.
    count: u64,
    sample: Vec<u32>,
}

impl Nodes<'_> {
    /// The position of the node at a place in the file.
    fn at(&self, place: u64) -> Option<[f64; 3]> {
        let index = &self.set.file_index;
        // Where nothing is missing, a point's place is that in the file.
        let same = index.get(usize::try_from(place).ok()?).filter(|own| u64::from(**own) == place);
        let at = match same {
            Some(_) => place as usize,
            None => index.binary_search(&u32::try_from(place).ok()?).ok()?,
        };
        Some(self.set.positions[at])
    }

    fn places(&self) -> impl Iterator<Item = u64> {
        self.sample.iter().map(|&at| u64::from(self.set.file_index[at as usize]))
    }

    /// Whether two steps of a stride are much the same.
    fn is_straight(&self, stride: u64) -> bool {
        let bend = |place: u64| {
            let [a, b, c] = [0, 1, 2].map(|steps| self.at(place + steps * stride));
            let (first, second) = (step(a?, b?), step(b?, c?));
            let longer = length(first).max(length(second));
            (longer > 0.0).then(|| length(step(first, second)) / longer)
        };
        let bends: Vec<f64> = self.places().filter_map(bend).collect();
        bends.len() >= ENOUGH && median(bends).is_some_and(|bend| bend < STRAIGHT)
    }

    /// The median sum of the steps along the three directions, of nodes that have a next one along each; `None` where the
    /// three span no cells.
    fn edges_of_cells(&self, row: u64, sheet: u64) -> Option<f64> {
        let has_next =
            |&place: &u64| place % row != row - 1 && place / row % (sheet / row) != sheet / row - 1;
        let cell = |place: u64| {
            let from = self.at(place)?;
            let [u, v, w] = [
                step(from, self.at(place + 1)?),
                step(from, self.at(place + row)?),
                step(from, self.at(place + sheet)?),
            ];
            let cross =
                [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
            let edges = [u, v, w].map(length);
            let box_of_edges: f64 = edges.iter().product();
            let volume = cross[0] * w[0] + cross[1] * w[1] + cross[2] * w[2];
            // A node at a pole, or one where the grid closes on itself, has no cell.
            (box_of_edges > 0.0).then(|| (volume / box_of_edges, edges.iter().sum::<f64>()))
        };
        let cells = self.places().filter(has_next).filter_map(cell);
        let (volumes, edges): (Vec<f64>, Vec<f64>) = cells.unzip();
        let middle = median(volumes.clone())?;
        let spanned = volumes.iter().filter(|volume| **volume * middle.signum() > SPANNED).count();
        let are_cells = volumes.len() >= ENOUGH
            && middle.abs() > IN_THE_MEDIAN
            && spanned as f64 >= OF_ALL * volumes.len() as f64;
        median(edges).filter(|_| are_cells)
    }
}

fn step(from: [f64; 3], to: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|axis| to[axis] - from[axis])
}

fn length([x, y, z]: [f64; 3]) -> f64 {
    x.hypot(y).hypot(z)
}

/// All divisors, ascending.
fn divisors(number: u64) -> Vec<u64> {
    let small = || (1..).take_while(|d| d * d <= number).filter(|d| number.is_multiple_of(*d));
    let mut all: Vec<u64> = small().flat_map(|d| [d, number / d]).collect();
    all.sort_unstable();
    all.dedup();
    all
}
