//! Points of sparse surroundings that only look stray, since a dense part begins beside them.

use super::boxes::Boxes;
use super::{Gone, NEIGHBORS};
use std::collections::{HashMap, HashSet};

/// The neighbour up to whose distance, twice, points are as sparse as each other.
const FOURTH: usize = 3;
/// More are not looked at.
const MOST: usize = 1 << 16;

/// Takes back what is gone but belongs to more than [`NEIGHBORS`] sparse points that are not: from each to the next it
/// is at most twice as far as from either to the fourth nearest of its own. Sparse is what has its last neighbour
/// farther than `enough`.
pub(super) fn take_back(tree: &Boxes<'_>, gone: &mut Gone, enough: f64) {
    if gone.count == 0 || gone.count > MOST || tree.neighbors < NEIGHBORS {
        return;
    }
    let found = gone.flags.iter().zip(0..).filter_map(|(gone, at)| gone.then_some(at));
    let found: Vec<u32> = found.collect();
    let none = Gone { flags: vec![false; gone.flags.len()], count: 0 };
    let mut known = Known { tree, none, enough, around: HashMap::new() };
    let mut seen: HashSet<u32> = HashSet::new();
    let mut back: HashSet<u32> = HashSet::new();
    for first in found {
        if !seen.insert(first) {
            continue;
        }
        let (mut strays, mut others) = (vec![first], HashSet::new());
        let mut next = vec![first];
        let mut belongs = false;
        while let Some(at) = next.pop() {
            for other in known.as_sparse(at) {
                if back.contains(&other) {
                    belongs = true;
                } else if gone.flags[other as usize] {
                    if seen.insert(other) {
                        strays.push(other);
                        next.push(other);
                    }
                } else if others.len() <= NEIGHBORS && others.insert(other) {
                    next.push(other);
                }
            }
        }
        if belongs || others.len() > NEIGHBORS {
            back.extend(strays);
        }
    }
    gone.count -= back.len();
    back.into_iter().for_each(|at| gone.flags[at as usize] = false);
}

/// What was found around points.
struct Known<'a> {
    tree: &'a Boxes<'a>,
    none: Gone,
    enough: f64,
    /// The nearest others, each with the square of its distance.
    around: HashMap<u32, Vec<(f64, u32)>>,
}

impl Known<'_> {
    fn of(&mut self, at: u32) -> &[(f64, u32)] {
        self.around.entry(at).or_insert_with(|| self.tree.nearby(at, &self.none, f64::INFINITY))
    }

    /// The points near this one that are as sparse as it is.
    fn as_sparse(&mut self, at: u32) -> Vec<u32> {
        let reach = |around: &[(f64, u32)]| 4.0 * around[FOURTH].0;
        let own = self.of(at);
        let own_reach = reach(own);
        let within = own.iter().take_while(|(square, _)| *square <= own_reach);
        let near: Vec<(f64, u32)> = within.copied().collect();
        let enough = self.enough * self.enough;
        let is_as_sparse = |&(square, other): &(f64, u32)| {
            let around = self.of(other);
            around.last().is_some_and(|last| last.0 > enough) && square <= reach(around)
        };
        near.into_iter().filter(is_as_sparse).map(|(_, other)| other).collect()
    }
}
