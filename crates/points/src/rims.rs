//! Rims of open point sets: which trust balls end there, and where (`boundary_clip`).
//!
//! Fitting says of each point whether its Voronoi cell is open, in which direction the set ends and how
//! far beyond the point (`glsl/shared/rim.glsl`). One open cell is no rim: uneven points of a closed surface
//! have some. So a rim point has others beside it that look the same way; its neighbours, whose
//! balls may reach farther out than its own, end where it does.
//!
//! All of it in f32 on the host, for device and reference alike.

use kernels::layout::{BallClip, FitOutcome, NONE, Point, Rim};
use std::collections::BTreeMap;

/// Openness of a rim point's cell.
const RIM: f32 = 2.0;
/// Open neighbours of a rim point that look its way, at least.
const COMPANIONS: usize = 2;
/// Cosine between directions that are the same way.
const SAME_WAY: f32 = 0.5;

/// The open points of a scene.
#[derive(Debug, Clone, Default)]
pub struct Rims {
    /// By slot, ascending.
    open: Vec<OpenPoint>,
}

#[derive(Debug, Clone)]
struct OpenPoint {
    slot: u32,
    rim: Rim,
    /// Slots, nearest first.
    neighbors: Vec<u32>,
}

/// Where one ball is to end.
#[derive(Debug, Clone, Copy)]
struct End {
    /// d² of the rim point that says so, and its place in the file: the nearest counts.
    nearest: (f32, u32),
    outward: [f32; 3],
    reach: f32,
}

impl Rims {
    /// Whether the cell of a point is open, so that [`add`](Self::add) is to know of it.
    #[must_use]
    pub fn is_open(rim: &Rim) -> bool {
        rim.openness > 0.0
    }

    /// Adds an open point; they come by ascending slot. `list` has its neighbours, `NONE` behind the last.
    pub fn add(&mut self, slot: u32, rim: &Rim, list: &[u32]) {
        let neighbors = list.iter().copied().take_while(|&slot| slot != NONE).collect();
        self.open.push(OpenPoint { slot, rim: *rim, neighbors });
    }

    /// The balls that end at a rim, by slot, ascending. Each lies inside the trust ball of its point: it
    /// is the largest that does and ends where the surface does.
    #[must_use]
    pub fn clips(&self, points: &[Point], outcomes: &[FitOutcome]) -> Vec<BallClip> {
        let mut ends: BTreeMap<u32, End> = BTreeMap::new();
        for open in self.open.iter().filter(|open| self.is_rim(open)) {
            let Rim { outward, reach, .. } = open.rim;
            let point = &points[open.slot as usize];
            ends.insert(open.slot, End { nearest: (-1.0, 0), outward, reach });
            for &neighbor in &open.neighbors {
                let q = points[neighbor as usize].position;
                let way = [0, 1, 2].map(|axis| point.position[axis] - q[axis]);
                let end = End {
                    nearest: (dot(way, way), point.index),
                    outward,
                    reach: dot(way, outward).max(0.0) + reach,
                };
                let known = ends.entry(neighbor).or_insert(end);
                if end.nearest < known.nearest {
                    *known = end;
                }
            }
        }
        let clipped = |(slot, end): (u32, End)| {
            let trust = outcomes[slot as usize].trust;
            (end.reach < trust).then(|| {
                let back = 0.5 * (trust - end.reach);
                BallClip { slot, trust: trust - back, shift: end.outward.map(|e| -(back * e)) }
            })
        };
        ends.into_iter().filter_map(clipped).collect()
    }

    /// Open neighbours of a point that look its way.
    fn companions<'a>(&'a self, point: &'a OpenPoint) -> impl Iterator<Item = &'a OpenPoint> {
        let open = point.neighbors.iter().filter_map(|slot| {
            let at = self.open.binary_search_by_key(slot, |open| open.slot).ok()?;
            Some(&self.open[at])
        });
        open.filter(|other| dot(other.rim.outward, point.rim.outward) > SAME_WAY)
    }

    fn has_companions(&self, point: &OpenPoint) -> bool {
        point.rim.openness > RIM && self.companions(point).take(COMPANIONS).count() == COMPANIONS
    }

    /// A point that stands out of its rim sees less of it: one companion that is sure will do.
    fn is_rim(&self, point: &OpenPoint) -> bool {
        point.rim.openness > RIM
            && (self.has_companions(point)
                || self.companions(point).any(|other| self.has_companions(other)))
    }
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points at x = 0, 1, 2 … along a rim that looks along y, and one behind it.
    fn rims(openness: f32) -> (Rims, Vec<Point>) {
        let at = |x: f32, y: f32, index| Point { position: [x, y, 0.0], index };
        let points = vec![at(0.0, 0.0, 0), at(1.0, 0.0, 1), at(2.0, 0.0, 2), at(1.0, -1.0, 3)];
        let open = Rim { outward: [0.0, 1.0, 0.0], reach: 0.5, openness };
        let lists = [[1, 2, 3], [0, 2, 3], [1, 0, 3]];
        let mut rims = Rims::default();
        for (slot, list) in (0..3).zip(&lists) {
            rims.add(slot, &open, list);
        }
        (rims, points)
    }

    fn clips(openness: f32, trust: f32) -> Vec<BallClip> {
        let (rims, points) = rims(openness);
        rims.clips(&points, &[FitOutcome { trust, kind: 3, feature_size: 3.0 }; 4])
    }

    #[test]
    fn balls_at_a_rim_and_behind_it_end_there() {
        let clips = clips(3.0, 2.0);
        assert_eq!(clips.len(), 4);
        // From 2 behind the point to 1/2 before it.
        assert_eq!(clips[0], BallClip { slot: 0, trust: 1.25, shift: [0.0, -0.75, 0.0] });
        // From 2 behind to 3/2 before.
        assert_eq!(clips[3], BallClip { slot: 3, trust: 1.75, shift: [0.0, -0.25, 0.0] });
    }

    #[test]
    fn balls_that_do_not_reach_the_rim_stay() {
        let slots: Vec<u32> = clips(3.0, 1.25).iter().map(|clip| clip.slot).collect();
        assert_eq!(slots, [0, 1, 2]);
        assert!(clips(3.0, 0.5).is_empty());
    }

    #[test]
    fn cells_that_are_not_wide_open_are_no_rim() {
        assert!(clips(1.5, 2.0).is_empty());
    }

    /// One open cell among closed ones: a gap between uneven points.
    #[test]
    fn a_single_open_point_is_no_rim() {
        let (mut rims, points) = rims(3.0);
        rims.open.drain(1..);
        let outcomes = [FitOutcome { trust: 2.0, kind: 3, feature_size: 3.0 }; 4];
        assert!(rims.clips(&points, &outcomes).is_empty());
    }
}
