//! Twin of the discs' build: `disc_count`, `disc_emit`, the scan, the sort and `disc_ranges`.

use crate::disc::{depth_rank, disc_radius, disc_tiles};
use crate::polynomial::Polynomial;
use crate::real::{NO_HIT, Real, V3};
use kernels::layout::{DISC_TILE, DepthRanks, DiscParams, LEAF_BITS, LEAF_POINTS};
use plan::MAX_DISC_PAIRS;
use std::collections::BTreeMap;

/// The leaves of each screen tile of a tile of the picture, front to back.
#[derive(Debug, Clone, PartialEq)]
pub struct DiscLists {
    /// First and past-the-last pair of each screen tile; empty ones have zeros.
    pub tiles: Vec<[u32; 2]>,
    /// Screen tile and rank of each pair, ascending.
    pub keys: Vec<u32>,
    /// The leaf of each pair, eight consecutive slots, and above it which of its points cover the screen tile; in the
    /// order of leaves where keys are equal.
    pub leaves: Vec<u32>,
    /// How the pairs of a screen tile are ordered.
    pub ranks: DepthRanks,
    /// First pixel of the tile of the picture.
    pub origin: [u32; 2],
    /// Screen tiles along x.
    pub across: u32,
}

/// Lists the leaves of whose points discs cover each screen tile; `None` where they are too many.
#[must_use]
pub fn disc_bin<R: Real>(params: &DiscParams, polynomials: &[Polynomial<R>]) -> Option<DiscLists> {
    let camera = &params.camera;
    let eye = V3::<R>::of_f32(camera.eye);
    let [across, down] = camera.tile_size.map(|pixels| pixels.div_ceil(DISC_TILE));
    let mut pairs: Vec<(u32, u32)> = Vec::new();
    for (points, leaf) in polynomials.chunks(LEAF_POINTS as usize).zip(0u32..) {
        let mut covered: BTreeMap<[u32; 2], u32> = BTreeMap::new(); // by row and column
        let mut nearest = R::of(NO_HIT);
        for (polynomial, place) in points.iter().zip(0..) {
            let from_eye = polynomial.center - eye;
            let Some([columns, rows]) = disc_tiles(camera, from_eye, polynomial.trust) else {
                continue;
            };
            let distance = from_eye.dot(from_eye).sqrt() - disc_radius(from_eye, polynomial.trust);
            nearest = if distance < nearest { distance } else { nearest };
            for (y, x) in rows.flat_map(|y| columns.clone().map(move |x| (y, x))) {
                *covered.entry([y, x]).or_default() |= 1 << place;
            }
        }
        let rank = depth_rank(&params.ranks, nearest);
        pairs.extend(covered.into_iter().map(|([y, x], which)| {
            ((y * across + x) << params.ranks.bits | rank, leaf | which << LEAF_BITS)
        }));
        if pairs.len() > MAX_DISC_PAIRS as usize {
            return None;
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
    let (keys, leaves) = pairs.into_iter().unzip();
    Some(DiscLists { tiles, keys, leaves, ranks: params.ranks, origin: camera.tile_origin, across })
}
