//! Parts of a picture: what is rendered of it, and the tiles that are traced at a time.

use crate::{Plan, PlanError};
use kernels::layout::{self, CameraParams, NONE, WaveParams};

/// Columns of a tile at most: a row of the ray state's images.
const TILE_WIDTH: u32 = layout::STATE_ROW;
/// Rays of a wave at most: their state is 128 MiB.
const WAVE_RAYS: u32 = 1 << 20;
/// Volumes of a scene, for so many rays: what is known of one along a ray takes 80 bytes.
const VOLUMES_A_RAY: u32 = 1;
/// Sides of the blocks of pixels whose rays lie together.
const BLOCK: u32 = 8;

/// A rectangle of pixels of the full image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Window {
    /// Column and row of the first pixel.
    pub origin: [u32; 2],
    /// Columns and rows.
    pub size: [u32; 2],
}

impl Window {
    /// Pixels.
    #[must_use]
    pub fn pixels(&self) -> usize {
        self.size[0] as usize * self.size[1] as usize
    }
}

impl Plan {
    /// The tiles of the picture, row by row.
    #[must_use]
    pub fn tiles(&self) -> Vec<Window> {
        let width = TILE_WIDTH.min(self.window.size[0].next_multiple_of(BLOCK));
        // What a ray keeps of each volume is in one buffer.
        let volumes = (self.volumes.infos.len() as u32).div_ceil(VOLUMES_A_RAY).max(1);
        let rows = (WAVE_RAYS / self.rays_per_pixel() / width / volumes).max(BLOCK);
        let sides = [width, rows / BLOCK * BLOCK];
        let starts = |axis: usize| {
            let (first, count) = (self.window.origin[axis], self.window.size[axis]);
            (first..first + count)
                .step_by(sides[axis] as usize)
                .map(move |at| (at, sides[axis].min(first + count - at)))
        };
        starts(1)
            .flat_map(|(y, height)| {
                starts(0).map(move |(x, width)| Window { origin: [x, y], size: [width, height] })
            })
            .collect()
    }

    /// Parameters of `camera_rays` for one sample of one tile.
    #[must_use]
    pub fn camera_of(&self, tile: &Window, sample: u32) -> CameraParams {
        let sample_index = self.sample_index(sample);
        CameraParams { tile_origin: tile.origin, tile_size: tile.size, sample_index, ..self.camera }
    }

    /// Parameters of the kernels that scatter and shade, for the first wave of one sample of one
    /// tile.
    #[must_use]
    pub fn wave_of(&self, tile: &Window, sample: u32) -> WaveParams {
        let sample_index = self.sample_index(sample);
        // The ray through a pixel's centre takes what the one sample of a pixel would.
        let bits = if sample_index == NONE { 0 } else { self.samples.next_power_of_two().ilog2() };
        WaveParams {
            tile_origin: tile.origin,
            tile_size: tile.size,
            ray_count: camera_wave(tile),
            sample_index,
            sample_bits: bits,
            ..self.wave
        }
    }

    /// As kernels take it: the one sample of a pixel is none of a sequence, nor is [`CENTER`].
    fn sample_index(&self, sample: u32) -> u32 {
        if self.samples > 1 { sample } else { NONE }
    }
}

/// Rays of the wave from the camera, with those that are none because the tile ends within a block.
#[must_use]
pub fn camera_wave(tile: &Window) -> u32 {
    tile.size[0].next_multiple_of(BLOCK) * tile.size[1].next_multiple_of(BLOCK)
}

/// What of an image of these columns and rows is rendered: `crop`, or all of it.
///
/// # Errors
/// [`PlanError::Crop`] where the crop is empty or leaves the image.
pub fn checked_crop(crop: Option<Window>, image: [u32; 2]) -> Result<Window, PlanError> {
    let crop = crop.unwrap_or(Window { origin: [0, 0], size: image });
    let inside = (0..2).all(|axis| {
        crop.size[axis] > 0
            && crop.origin[axis].checked_add(crop.size[axis]).is_some_and(|end| end <= image[axis])
    });
    if inside { Ok(crop) } else { Err(PlanError::Crop { crop, image }) }
}
