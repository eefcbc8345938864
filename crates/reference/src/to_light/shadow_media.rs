//! Twin of `shadow_media`: what a shadow ray starts inside, where light may pass surfaces.

use crate::camera_rays::Ray;
use crate::media::Media;

/// What a shadow ray has behind it and before it.
pub(super) struct ShadowPath<R> {
    pub media: Media,
    /// Surfaces that have let it through.
    pub crossings: u32,
    /// The way to the light from where it is now.
    pub left: R,
}

pub(super) fn shadow_media<R: Copy>(ray: &Ray<R>, media: Media) -> ShadowPath<R> {
    ShadowPath { media, crossings: 0, left: ray.hit_t }
}
