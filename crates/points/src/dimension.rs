//! Whether points lie on a surface or fill a volume, from their positions.
//!
//! Around a point of a volume there is no direction in which the neighbours are flat, however many are looked at: what
//! a quadratic polynomial leaves over stays a fixed part of their reach. On a surface it is noise or curvature, and
//! vanishes beside the reach as that grows or shrinks. So of some points the polynomial is fitted to the 16, 64 and
//! 256 nearest others and, further out, to thinned sets; of each level the median counts, to which strays are nothing
//! ([`isotropic`]). Where no level decides, it is a surface.
//!
//! Nodes of a grid lie far closer along one of its directions than along another, so that the nearest are a line or a
//! sheet. They are known by the order in which they come ([`nodes`]), or by the few coordinates that all of them
//! share: then ranks count in place of coordinates ([`ranks`]).
//!
//! The idea that residuals and growth of neighbourhoods give a set's dimension is that of Camastra, Data dimensionality
//! estimation methods, Pattern Recognition 36 (2003); the figures are measured (docs/method.md).

mod isotropic;
mod nodes;
mod ranks;
mod residual;

use crate::set::PointSet;
use crate::strays::rough_origin;
use std::fmt;

/// Fewer points show nothing.
const FEWEST: usize = 512;
/// Beyond, f32 has no room for squares; only strays can be as far.
const FARTHEST_SEEN: f64 = 1e15;

/// What points fill.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Dimension {
    /// A surface, or what cannot be told from one.
    Surface,
    /// A volume, and what shows it.
    Volume(Sign),
}

/// What shows that points fill a volume.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sign {
    /// They are the nodes of a curvilinear grid, one after another; its nodes along each direction.
    Nodes([u64; 3]),
    /// No neighbourhood is flat: the medians of what polynomials leave over, in parts of the reach of 64 and of 256
    /// neighbours.
    Residuals([f64; 2]),
    /// The same of the nodes of a rectilinear grid of which some are missing or in any order, with steps in place of
    /// lengths; its nodes along each axis.
    Lattice([u64; 3]),
}

impl Dimension {
    /// Judges the points of a set. Depends on nothing but the set.
    #[must_use]
    pub fn of(set: &PointSet) -> Self {
        if set.len() < FEWEST || u32::try_from(set.len()).is_err() {
            return Self::Surface;
        }
        if let Some(nodes) = nodes::of(set) {
            return Self::Volume(Sign::Nodes(nodes));
        }
        let Some(origin) = rough_origin(&[&set.positions]) else { return Self::Surface };
        let local = |p: &[f64; 3]| {
            [0, 1, 2]
                .map(|axis| (p[axis] - origin[axis]).clamp(-FARTHEST_SEEN, FARTHEST_SEEN) as f32)
        };
        let points: Vec<[f32; 3]> = set.positions.iter().map(local).collect();
        if let Some(residuals) = isotropic::residuals(&points) {
            return Self::Volume(Sign::Residuals(residuals));
        }
        let lattice = ranks::of(&set.positions);
        let lattice = lattice.filter(|(_, ranks)| isotropic::residuals(ranks).is_some());
        lattice.map_or(Self::Surface, |(nodes, _)| Self::Volume(Sign::Lattice(nodes)))
    }

    /// Whether points fill a volume.
    #[must_use]
    pub fn is_volume(&self) -> bool {
        matches!(self, Self::Volume(_))
    }
}

impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Surface => write!(f, "a surface"),
            Self::Volume(sign) => write!(f, "a volume: {sign}"),
        }
    }
}

impl fmt::Display for Sign {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Nodes([i, j, k]) => write!(f, "the nodes of a grid of {i} x {j} x {k}"),
            Self::Lattice([x, y, z]) => write!(f, "nodes of a lattice of {x} x {y} x {z}"),
            Self::Residuals([near, far]) => write!(
                f,
                "no neighbourhood is flat (residuals of {near:.2} and {far:.2} of the reach of 64 and 256 neighbours)"
            ),
        }
    }
}

/// Places of at most `most` of `count` things: one in each of as many even parts, at a place that changes from part to
/// part, so that no rhythm of rows and columns is met.
fn sample(count: usize, most: usize) -> Vec<u32> {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let parts = most.min(count);
    let place = |i: usize| {
        let [first, end] = [i * count / parts, (i + 1) * count / parts];
        first + ((i as f64 * GOLDEN).fract() * (end - first) as f64) as usize
    };
    (0..parts).map(|i| place(i) as u32).collect()
}

/// The middle one of some numbers; `None` where there are none.
fn median(mut numbers: Vec<f64>) -> Option<f64> {
    if numbers.is_empty() {
        return None;
    }
    let half = numbers.len() / 2;
    Some(*numbers.select_nth_unstable_by(half, f64::total_cmp).1)
}

#[cfg(test)]
mod tests;
