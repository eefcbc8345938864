//! The parameters of discs (\[T\] §4): where the points of a screen tile are, and how they are ordered.

use crate::{CENTER, Plan, Window};
use kernels::layout::{
    CameraParams, CameraTraceParams, DISC_TILE, DepthRanks, DiscParams, PERSPECTIVE, TreeInfo,
};
use points::Grids;

/// Pairs of a screen tile and a leaf that one tile of the picture may have. What has more is traced as other rays are,
/// which gives the same bytes.
pub const MAX_DISC_PAIRS: u32 = 2_000_000;
/// Bits of a pair's key: three short rounds of the sort. What the screen tile leaves goes to the rank.
const KEY_BITS: u32 = 21;
/// Depths are told apart from the farthest down to this share of it.
const NEAREST_SHARE: f64 = 1.0 / 64.0;
/// With several grids down to this many cells of the finest: small things may be near.
const NEAREST_CELLS: f64 = 64.0;

impl Plan {
    /// Whether all camera rays of a sample start from the eye and go through their pixel's centre.
    #[must_use]
    pub fn looks_through_centers(&self, sample: u32) -> bool {
        (self.samples == 1 || sample == CENTER) && self.camera.projection == PERSPECTIVE
    }

    /// Parameters of `disc_count` for one tile of the picture. The grids say where the points are.
    #[must_use]
    pub fn discs_of(&self, tile: &Window, grids: &Grids) -> DiscParams {
        DiscParams {
            camera: self.camera_of(tile, 0),
            ranks: depth_ranks(self.camera.eye, grids, screen_tiles(tile)),
            point_count: self.cloud.points.len() as u32,
            pair_count: 0,
        }
    }

    /// Whether the first wave of a tile may be one pass: where its rays meet nothing but
    /// surfaces, which are taken as they are.
    #[must_use]
    pub fn meets_surfaces_alone(&self) -> bool {
        let leaves_light = !self.follows_paths(); // else all that comes is added to what it writes
        leaves_light
            && self.volumes.infos.is_empty()
            && self.camera_media.is_empty()
            && !self.refines()
    }

    /// Parameters of `camera_trace` for one tile, whose rays may spend so much work.
    #[must_use]
    pub fn camera_trace_of(&self, tile: &Window, grids: &Grids, work: u32) -> CameraTraceParams {
        let wave = self.wave_of(tile, 0);
        let CameraParams { eye, scale, right, half_width, up, half_height, forward, .. } =
            self.camera;
        CameraTraceParams {
            eye,
            scale,
            right,
            half_width,
            up,
            half_height,
            forward,
            work,
            tile_origin: tile.origin,
            tile_size: tile.size,
            background: wave.background,
            ranks: self.discs_of(tile, grids).ranks,
            transparent: wave.transparent,
            max_bounces: wave.max_bounces,
            tree: TreeInfo::default(),
        }
    }
}

/// Screen tiles of a tile of the picture.
#[must_use]
pub fn screen_tiles(tile: &Window) -> u32 {
    tile.size[0].div_ceil(DISC_TILE) * tile.size[1].div_ceil(DISC_TILE)
}

fn depth_ranks(eye: [f32; 3], grids: &Grids, tiles: u32) -> DepthRanks {
    let grid = grids.whole();
    let (mut near, mut far) = (0.0, 0.0);
    for (axis, eye) in eye.into_iter().map(f64::from).enumerate() {
        let low = f64::from(grid.origin[axis]) - eye;
        let high = low + f64::from(grid.edge) * f64::from(grid.resolution[axis]);
        let (least, most) = (low.max(-high).max(0.0), high.max(-low));
        near += least * least;
        far += most * most;
    }
    let farthest = (far.sqrt() as f32).max(f32::MIN_POSITIVE);
    let told_apart = match grids.are_several() {
        true => (far.sqrt() * NEAREST_SHARE).min(NEAREST_CELLS * f64::from(grids.finest_edge())),
        false => far.sqrt() * NEAREST_SHARE,
    };
    let nearest = (near.sqrt().max(told_apart) as f32).max(f32::MIN_POSITIVE);
    let nearest = nearest.min(farthest);
    let bits = KEY_BITS - (u32::BITS - tiles.saturating_sub(1).leading_zeros());
    let steps = farthest.to_bits() - nearest.to_bits();
    let shift = (u32::BITS - steps.leading_zeros()).saturating_sub(bits);
    DepthRanks { nearest, farthest, shift, bits }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kernels::layout::GridInfo;

    fn grid(origin: [f32; 3], edge: f32) -> Grids {
        Grids::single(GridInfo { origin, edge, resolution: [2; 3], inverse_edge: 1.0 / edge })
    }

    #[test]
    fn ranks_span_the_depths_of_the_scene_and_fit_their_bits() {
        for (eye, nearest) in [([0.0, 0.0, 5.0], 4.0), ([0.5, 0.0, 0.0], 4.25f32.sqrt() / 64.0)] {
            let ranks = depth_ranks(eye, &grid([-1.0; 3], 1.0), 4800);
            assert!((ranks.nearest / nearest - 1.0).abs() < 1e-6, "{ranks:?}");
            assert_eq!(ranks.bits, 8);
            let highest = (ranks.farthest.to_bits() - ranks.nearest.to_bits()) >> ranks.shift;
            assert!(highest < 1 << ranks.bits && highest >= 1 << (ranks.bits - 1), "{ranks:?}");
        }
    }
}
