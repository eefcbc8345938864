//! Twin of the discs' build: `disc_count`, `disc_emit`, the scan, the sort and `disc_ranges`.

use crate::disc::{depth_rank, disc_radius, disc_tiles};
use crate::polynomial::Polynomial;
use crate::real::{Real, V3};
use kernels::layout::{DISC_TILE, DepthRanks, DiscParams};
use plan::MAX_DISC_PAIRS;

/// The points of each screen tile of a tile of the picture, front to back.
#[derive(Debug, Clone, PartialEq)]
pub struct DiscLists {
    /// First and past-the-last pair of each screen tile; empty ones have zeros.
    pub tiles: Vec<[u32; 2]>,
    /// Screen tile and rank of each pair, ascending.
    pub keys: Vec<u32>,
    /// The point of each pair; in the order of slots where keys are equal.
    pub slots: Vec<u32>,
    /// How the pairs of a screen tile are ordered.
    pub ranks: DepthRanks,
    /// First pixel of the tile of the picture.
    pub origin: [u32; 2],
    /// Screen tiles along x.
    pub across: u32,
}

/// Lists the points whose discs cover each screen tile; `None` where they are too many.
#[must_use]
pub fn disc_bin<R: Real>(params: &DiscParams, polynomials: &[Polynomial<R>]) -> Option<DiscLists> {
    let camera = &params.camera;
    let eye = V3::<R>::of_f32(camera.eye);
    let [across, down] = camera.tile_size.map(|pixels| pixels.div_ceil(DISC_TILE));
    let spans = || {
        polynomials.iter().zip(0..).filter_map(|(polynomial, slot)| {
            let from_eye = polynomial.center - eye;
            disc_tiles(camera, from_eye, polynomial.trust).map(|span| (slot, from_eye, span))
        })
    };
    let covered: u64 = spans().map(|(_, _, [x, y])| x.count() as u64 * y.count() as u64).sum();
    if covered > u64::from(MAX_DISC_PAIRS) {
        return None;
    }
    let mut pairs: Vec<(u32, u32)> = Vec::with_capacity(covered as usize);
    for (slot, from_eye, [columns, rows]) in spans() {
        let trust = polynomials[slot as usize].trust;
        let nearest = from_eye.dot(from_eye).sqrt() - disc_radius(from_eye, trust);
        let rank = depth_rank(&params.ranks, nearest);
        for y in rows {
            let ids = columns.clone().map(|x| y * across + x);
            pairs.extend(ids.map(|id| (id << params.ranks.bits | rank, slot)));
        }
    }
    pairs.sort_by_key(|pair| pair.0);
    let mut tiles = vec![[0, 0]; (across * down) as usize];
    for (at, &(key, _)) in pairs.iter().enumerate() {
        let range = &mut tiles[(key >> params.ranks.bits) as usize];
        if range[1] == 0 {
            range[0] = at as u32;
        }
        range[1] = at as u32 + 1;
    }
    let (keys, slots) = pairs.into_iter().unzip();
    Some(DiscLists { tiles, keys, slots, ranks: params.ranks, origin: camera.tile_origin, across })
}
