//! Nodes of rectilinear grids, of which any may be missing: all of them share a few coordinates along each axis.

use std::collections::HashMap;

/// Coordinates along an axis.
const FEWEST: usize = 8;
const MOST: usize = 4096;
/// Nodes of the whole grid for each that is there.
const EMPTY: u64 = 8;

/// How many coordinates there are along each axis, and where in their order those of each position are; `None` where
/// positions are no nodes.
pub(super) fn of(positions: &[[f64; 3]]) -> Option<([u64; 3], Vec<[f32; 3]>)> {
    let mut known: [HashMap<u64, f32>; 3] = Default::default();
    for p in positions {
        for (known, coordinate) in known.iter_mut().zip(p) {
            known.insert(key(*coordinate), 0.0);
            if known.len() > MOST {
                return None;
            }
        }
    }
    let sides = [0, 1, 2].map(|axis| known[axis].len());
    let nodes: u64 = sides.iter().map(|side| *side as u64).product();
    if sides.iter().any(|side| *side < FEWEST) || nodes > EMPTY * positions.len() as u64 {
        return None;
    }
    for known in &mut known {
        let mut ordered: Vec<(f64, &mut f32)> =
            known.iter_mut().map(|(key, rank)| (f64::from_bits(*key), rank)).collect();
        ordered.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        (0u16..).zip(ordered).for_each(|(rank, (_, place))| *place = rank.into());
    }
    let rank = |p: &[f64; 3]| [0, 1, 2].map(|axis| known[axis][&key(p[axis])]);
    Some((sides.map(|side| side as u64), positions.iter().map(rank).collect()))
}

/// Both zeros are one coordinate.
fn key(coordinate: f64) -> u64 {
    (coordinate + 0.0).to_bits()
}
