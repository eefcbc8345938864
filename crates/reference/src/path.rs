//! Twin of `glsl/shared/path.glsl`: what a ray has behind it.

use crate::media::Media;
use crate::real::{Real, V3};
use kernels::layout::CHANNELS_ALL;

/// What a ray has behind it.
#[derive(Debug, Clone)]
pub(crate) struct Path<R> {
    pub throughput: V3<R>,
    pub channels: u32,
    pub reflected: bool,
    /// Surfaces on its way were lit, so that what it brings is added to what the pixel has.
    pub adds: bool,
    /// The last thing on its way scattered it to all sides, and has asked the lamps and the background for light.
    pub scattered: bool,
    /// Something on its way before the last did.
    pub indirect: bool,
    /// Of the background, where light goes from surface to surface.
    pub share: R,
    pub bounces: u32,
    pub crossings: u32,
    pub media: Media,
    /// What volumes on its way have sent to the pixel.
    pub emitted: V3<R>,
    /// Optical depth of the volumes on its way so far, which is no part of the throughput.
    pub depth: R,
    pub has_volumes: bool,
}

impl<R: Real> Path<R> {
    /// That of a ray from the camera, which starts inside `media`.
    pub fn of_camera(media: &[u32], has_volumes: bool) -> Self {
        Self {
            throughput: V3::splat(R::of(1.0)),
            channels: CHANNELS_ALL,
            reflected: false,
            adds: false,
            scattered: false,
            indirect: false,
            share: R::of(1.0),
            bounces: 0,
            crossings: 0,
            media: Media::of(media),
            emitted: V3::splat(R::of(0.0)),
            depth: R::of(0.0),
            has_volumes,
        }
    }

    /// What of a light comes through the volumes on the path.
    pub fn through_volumes(&self, light: V3<R>) -> V3<R> {
        if self.has_volumes { light.times((-self.depth).exp_negative()) } else { light }
    }

    /// 1 less the throughput of surfaces and volumes; 1 where something reflected it.
    pub fn alpha(&self) -> V3<R> {
        let one = V3::splat(R::of(1.0));
        match (self.reflected, self.has_volumes) {
            (true, _) => one,
            (false, false) => one - self.throughput,
            (false, true) => {
                (one - self.throughput) + self.throughput.times(self.depth.absorptance())
            }
        }
    }
}
