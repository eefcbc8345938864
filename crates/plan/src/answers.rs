//! What whoever executes a plan asks it.

use crate::{Extra, Picture, Plan};
use kernels::layout::{self, CHANNELS_ALL, MEDIA_WORDS, NONE, WAVE_LOSSES, WAVE_VALUES};

impl Plan {
    /// Whether a pixel has a ray through its centre beside its samples.
    #[must_use]
    pub fn takes_centers(&self) -> bool {
        self.aovs && (self.samples > 1 || self.volumes.any_cloud())
    }

    /// Whether that ray is followed to its end, since somebody counts what the rays of a pixel do, or asks for volumes that
    /// may lie beyond a surface; otherwise to the first surface.
    #[must_use]
    pub fn follows_centers(&self) -> bool {
        self.counts_work() || (self.shows_of_volumes() != 0 && self.scatters())
    }

    /// What rays look for beyond the first surface for channels of volumes: flags of a wave.
    #[must_use]
    pub fn shows_of_volumes(&self) -> u32 {
        match (self.volumes.any_marched(), self.volumes.is_whole()) {
            (true, true) if self.wants_along() => WAVE_VALUES,
            (true, false) if self.wants_volume_depth() => WAVE_LOSSES,
            _ => 0,
        }
    }

    /// Whether any object's hits are refined.
    #[must_use]
    pub fn refines(&self) -> bool {
        self.objects.iter().any(|object| object.max_iterations > 0)
    }

    /// The path of every ray from the camera, but for its pixel.
    #[must_use]
    pub fn camera_path(&self) -> layout::Path {
        let mut media = [0; MEDIA_WORDS as usize];
        for (i, object) in self.camera_media.iter().enumerate() {
            media[i / 2] |= object << (16 * (i % 2));
        }
        layout::Path {
            throughput: [1.0; 3],
            pixel: NONE,
            channels: CHANNELS_ALL,
            bounces: 0,
            crossings: 0,
            media_count: self.camera_media.len() as u32,
            media,
            emitted: [0.0; 3],
            depth: if self.follows_paths() { 1.0 } else { 0.0 },
        }
    }

    /// The media of a light as kernels take them: how many, or `NONE` where that is not known, and which.
    #[must_use]
    pub fn lamp_media_of(&self, light: u32) -> (u32, [u32; MEDIA_WORDS as usize]) {
        let mut words = [0; MEDIA_WORDS as usize];
        let Some(media) = &self.lamp_media[light as usize] else { return (NONE, words) };
        for (i, object) in media.iter().enumerate() {
            words[i / 2] |= object << (16 * (i % 2));
        }
        (media.len() as u32, words)
    }

    /// Whether it is asked for where volumes take the camera's light.
    #[must_use]
    pub fn wants_volume_depth(&self) -> bool {
        self.extras.contains(&Extra::Volume)
    }

    /// Whether any channel of volumes is asked for.
    #[must_use]
    pub fn wants_along(&self) -> bool {
        self.extras.iter().any(|extra| matches!(extra, Extra::Volume | Extra::Value))
    }

    /// An empty picture, to be filled tile by tile.
    #[must_use]
    pub fn picture(&self) -> Picture {
        Picture::new(self)
    }

    /// What an EXR says of this render.
    #[must_use]
    pub fn provenance(&self) -> &film::Provenance {
        &self.provenance
    }
}
