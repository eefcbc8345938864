//! Twin of `glsl/shared/materials/glass.glsl`: smooth glass.

use super::{Drawn, Place, Sent};
use crate::media::{Crossing, ior_of};
use crate::optics::{reflected, refraction};
use crate::real::{Real, V3};
use kernels::layout::ObjectInfo;

/// Straight on where the ray `passes`, or where its channels meet no other index; else refracted or reflected.
pub(super) fn sent_on<R: Real>(
    place: &Place<'_, R>,
    (crossing, passes): (&Crossing, bool),
    channels: u32,
    drawn: &Drawn<R>,
    objects: &[ObjectInfo],
) -> Sent<R> {
    let sent =
        |direction, reflects| Sent { direction, weight: V3::of_f32(place.info.albedo), reflects };
    if passes || crossing.passes(channels, objects) {
        return sent(place.d, false);
    }
    let channel = channels.trailing_zeros() as usize;
    let [n1, n2] =
        [crossing.before, crossing.after].map(|medium| R::of_f32(ior_of(medium, objects)[channel]));
    let bent = refraction(place.d, place.normal, n1, n2);
    let reflects = bent.total || drawn.chance.is_some_and(|u| u < bent.reflectance);
    sent(if reflects { reflected(place.d, place.normal) } else { bent.direction }, reflects)
}

/// Where the media on both sides have one index.
pub(super) fn lets_light_pass(crossing: &Crossing, objects: &[ObjectInfo]) -> [bool; 3] {
    let [before, after] = [crossing.before, crossing.after].map(|medium| ior_of(medium, objects));
    [0, 1, 2].map(|channel| before[channel] == after[channel])
}
