//! The inside a surface that is known only by its points, holes and all.
//!
//! Morphology on a lattice of cells: walls are what is nearer than `reach` to a point, so holes up to twice as
//! wide are closed; what cannot be reached from outside of all walls, and is farther than `reach` from what can,
//! is inside. Distances are exact (Felzenszwalb and Huttenlocher, Distance Transforms of Sampled Functions, 2012).

use crate::fill::Vector;

/// Cells along the longest side of the box.
const CELLS: f64 = 144.0;
const FAR: f64 = 1e20;
/// How deep what is enclosed has to be: so many times the radius of the walls that enclose it, and so many cells.
/// Between points that only lie side by side, or scattered in space, there is nothing as deep.
const DEEP: [f64; 2] = [2.0, 3.0];

/// Cells of a box, each with a number.
#[derive(Debug, Clone)]
struct Lattice {
    low: Vector,
    edge: f64,
    sides: [usize; 3],
    values: Vec<f64>,
}

impl Lattice {
    fn id(&self, at: [usize; 3]) -> usize {
        at[0] + self.sides[0] * (at[1] + self.sides[1] * at[2])
    }

    fn cell_of(&self, p: Vector) -> usize {
        let at = [0, 1, 2].map(|axis| {
            let cell = ((p[axis] - self.low[axis]) / self.edge).max(0.0) as usize;
            cell.min(self.sides[axis] - 1)
        });
        self.id(at)
    }

    /// From squares of distances, 0 or far, to those of the nearest 0, in cells.
    fn spread(&mut self) {
        let strides = [1, self.sides[0], self.sides[0] * self.sides[1]];
        for (&stride, &side) in strides.iter().zip(&self.sides) {
            for first in 0..self.values.len() {
                if first / stride % side == 0 {
                    let line: Vec<f64> =
                        (0..side).map(|i| self.values[first + i * stride]).collect();
                    for (i, value) in lower_envelope(&line).into_iter().enumerate() {
                        self.values[first + i * stride] = value;
                    }
                }
            }
        }
    }

    /// Makes 0 of all cells that `is` holds for, and far of the others.
    fn marked(&self, is: impl Fn(usize) -> bool) -> Self {
        let values = (0..self.values.len()).map(|i| if is(i) { 0.0 } else { FAR }).collect();
        Self { values, ..self.clone() }
    }

    /// The cells that can be reached from the first one through cells for which `open` holds.
    fn reached(&self, open: impl Fn(usize) -> bool) -> Vec<bool> {
        let mut reached = vec![false; self.values.len()];
        let mut stack = vec![[0; 3]];
        while let Some(at) = stack.pop() {
            let id = self.id(at);
            if reached[id] || !open(id) {
                continue;
            }
            reached[id] = true;
            for axis in 0..3 {
                let (mut before, mut after) = (at, at);
                if at[axis] > 0 {
                    before[axis] -= 1;
                    stack.push(before);
                }
                if at[axis] + 1 < self.sides[axis] {
                    after[axis] += 1;
                    stack.push(after);
                }
            }
        }
        reached
    }
}

/// min over j of line[j] + (i − j)², for each i.
fn lower_envelope(line: &[f64]) -> Vec<f64> {
    let crossing = |a: usize, b: usize| {
        let (fa, fb) = (line[a] + (a * a) as f64, line[b] + (b * b) as f64);
        (fb - fa) / (2.0 * (b - a) as f64)
    };
    let mut parabolas: Vec<(usize, f64)> = vec![(0, f64::NEG_INFINITY)];
    for j in 1..line.len() {
        while let Some(&(last, from)) = parabolas.last() {
            if crossing(last, j) > from {
                break;
            }
            parabolas.pop();
        }
        let from = parabolas.last().map_or(f64::NEG_INFINITY, |&(last, _)| crossing(last, j));
        parabolas.push((j, from));
    }
    let mut at = 0;
    (0..line.len())
        .map(|i| {
            while parabolas.get(at + 1).is_some_and(|next| next.1 < i as f64) {
                at += 1;
            }
            let j = parabolas[at].0;
            line[j] + (i as f64 - j as f64).powi(2)
        })
        .collect()
}

/// How deep places are inside a surface.
#[derive(Debug)]
pub struct Solid {
    /// Lowest corner of the points' box.
    pub low: Vector,
    /// Highest corner.
    pub high: Vector,
    inside: Vec<bool>,
    to_points: Lattice,
    /// In cells.
    reach: f64,
}

impl Solid {
    /// The inside of the surface of `points`, whose holes are up to twice `reach` wide.
    #[must_use]
    pub fn new(points: &[Vector], reach: f64) -> Self {
        let bound = |axis: usize, pick: fn(f64, f64) -> f64, from: f64| {
            points.iter().map(|p| p[axis]).fold(from, pick)
        };
        let low = [0, 1, 2].map(|axis| bound(axis, f64::min, f64::INFINITY));
        let high = [0, 1, 2].map(|axis| bound(axis, f64::max, f64::NEG_INFINITY));
        let longest = (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f64::max);
        let edge = longest / CELLS;
        let border = reach + 3.0 * edge;
        let sides =
            [0, 1, 2].map(|a| ((high[a] - low[a] + 2.0 * border) / edge).ceil() as usize + 1);
        let mut to_points = Lattice {
            low: low.map(|x| x - border),
            edge,
            sides,
            values: vec![FAR; sides.iter().product()],
        };
        for &p in points {
            let cell = to_points.cell_of(p);
            to_points.values[cell] = 0.0;
        }
        to_points.spread();
        let square = (reach / edge).powi(2);
        let outside = to_points.reached(|cell| to_points.values[cell] > square);
        let mut to_outside = to_points.marked(|cell| outside[cell]);
        to_outside.spread();
        let inside = to_outside.values.iter().map(|&value| value > square).collect();
        Self { low, high, inside, to_points, reach: reach / edge }
    }

    /// Whether the surface has an inside: with walls of some radius up to the reach around its points, there is a deep
    /// place that cannot be reached from outside. A sheet has none, however it is bent.
    #[must_use]
    pub fn encloses(&self) -> bool {
        let mut radius = self.reach;
        while radius >= 1.0 {
            let wall = radius.powi(2);
            let reached = self.to_points.reached(|cell| self.to_points.values[cell] > wall);
            let [walls, cells] = DEEP;
            let deep = (walls * radius).max(cells).powi(2);
            let mut cells = reached.iter().zip(&self.to_points.values);
            if cells.any(|(&reached, &value)| !reached && value >= deep) {
                return true;
            }
            radius *= std::f64::consts::FRAC_1_SQRT_2;
        }
        false
    }

    /// Whether any cell is inside and not one of a point.
    #[must_use]
    pub fn has_inside(&self) -> bool {
        self.inside
            .iter()
            .zip(&self.to_points.values)
            .any(|(&inside, &value)| inside && value > 0.0)
    }

    /// The distance to the nearest point, to a cell, where p is inside and that is not 0.
    #[must_use]
    pub fn depth(&self, p: Vector) -> Option<f64> {
        let cell = self.to_points.cell_of(p);
        let depth = self.to_points.values[cell].sqrt() * self.to_points.edge;
        (self.inside[cell] && depth > 0.0).then_some(depth)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fill::random;

    fn length(p: Vector) -> f64 {
        p.iter().map(|x| x * x).sum::<f64>().sqrt()
    }

    /// Even points of the unit sphere.
    fn fibonacci(count: u32) -> Vec<Vector> {
        let point = |i: u32| {
            let y = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(count);
            let (sin, cos) = (f64::from(i) * 2.399_963_229_728_653).sin_cos();
            let radius = (1.0 - y * y).sqrt();
            [radius * cos, y, radius * sin]
        };
        (0..count).map(point).collect()
    }

    /// Thin and closed has an inside; thin and open has none.
    #[test]
    fn a_box_is_closed_by_its_sides() {
        let even = |i: u32, n: u32| (f64::from(i) + 0.5) / f64::from(n);
        let mut points: Vec<Vector> = Vec::new();
        for (i, j) in (0..6400).map(|k| (k % 80, k / 80)) {
            points.extend([0.0, 0.2].map(|y| [even(i, 80), y, even(j, 80)]));
        }
        assert!(!Solid::new(&points, 0.06).encloses(), "two sheets");
        for (i, j) in (0..1280).map(|k| (k % 80, k / 80)) {
            let (a, b) = (even(i, 80), 0.2 * even(j, 16));
            points.extend([[0.0, b, a], [1.0, b, a], [a, b, 0.0], [a, b, 1.0]]);
        }
        assert!(Solid::new(&points, 0.06).encloses(), "a box");
    }

    /// A ball with a hole of 0.3: inside is inside, to two cells, and the depth is the distance to the sphere.
    #[test]
    fn a_ball_with_a_hole_has_an_inside() {
        let open: Vec<Vector> = fibonacci(20_000).into_iter().filter(|p| p[1] > -0.988).collect();
        let solid = Solid::new(&open, 0.2);
        for i in 0..1000 {
            let p = [0, 1, 2].map(|axis| 2.4 * random(f64::from(i), f64::from(axis)) - 1.2);
            let radius = length(p);
            if (radius - 1.0).abs() > 0.04 && p[1] > -0.9 {
                assert_eq!(solid.depth(p).is_some(), radius < 1.0, "{p:?}");
            }
            if let (Some(depth), true) = (solid.depth(p), p[1] > -0.5) {
                assert!((depth - (1.0 - radius)).abs() < 0.04, "{p:?}: {depth}");
            }
        }
    }
}
