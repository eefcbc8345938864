//! Points that a file does not store but describes: the nodes of a lattice.

use crate::columns::Numbers;
use crate::error::PointsError;
use std::io;
use std::path::Path;

/// Most nodes of a lattice for which a file stores nothing.
pub(super) const MAX_BARE_NODES: u64 = 1_000_000;

/// The nodes of a lattice, x fastest.
pub(super) struct Lattice {
    axes: [Axis; 3],
    /// The node that comes next, from 0.
    next: u64,
}

/// Coordinates along one axis.
#[derive(Clone)]
pub(super) enum Axis {
    Even { origin: f64, step: f64, count: u64 },
    Listed(Vec<f64>),
}

impl Axis {
    pub(super) fn count(&self) -> u64 {
        match self {
            Self::Even { count, .. } => *count,
            Self::Listed(list) => list.len() as u64,
        }
    }

    fn at(&self, index: u64) -> f64 {
        match self {
            Self::Even { origin, step, .. } => origin + step * index as f64,
            Self::Listed(list) => list[index as usize],
        }
    }
}

impl Lattice {
    pub(super) fn new(axes: [Axis; 3]) -> Self {
        Self { axes, next: 0 }
    }
}

impl Numbers for Lattice {
    fn next(&mut self, out: &mut [f64]) -> io::Result<usize> {
        let [x, y, z] = &self.axes;
        let (nx, ny) = (x.count().max(1), y.count().max(1));
        for (node, out) in (self.next..).zip(out.chunks_exact_mut(3)) {
            let [i, j, k] = [node % nx, node / nx % ny, node / nx / ny];
            if k >= z.count() {
                return Err(io::ErrorKind::UnexpectedEof.into());
            }
            out.copy_from_slice(&[x.at(i), y.at(j), z.at(k)]);
        }
        self.next += out.len() as u64 / 3;
        Ok(out.len())
    }
}

/// A lattice of more nodes than a file has data for.
pub(super) fn too_many_nodes(path: &Path, [x, y, z]: [u64; 3], most: u64) -> PointsError {
    PointsError::wrong(
        path,
        "the dimensions of the lattice",
        format!("{x} {y} {z}"),
        &format!("at most {most} nodes: data is there for no more"),
        "export the lattice with data for its points",
    )
}
