//! Twin of `glsl/shared/materials/glass.glsl`: smooth glass.

use super::{Drawn, Place, Sent};
use crate::media::{Crossing, ior_of};
use crate::optics::{reflectance_into, reflected, refraction};
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

/// All where the media on both sides have one index. Else, where light goes straight on, what is not reflected of it;
/// `cosine` is that of the angle on the side of the lower index, so that nothing is reflected totally.
pub(super) fn light_passed<R: Real>(
    crossing: &Crossing,
    cosine: R,
    tints: bool,
    objects: &[ObjectInfo],
) -> V3<R> {
    let [before, after] = [crossing.before, crossing.after].map(|medium| ior_of(medium, objects));
    let one = R::of(1.0);
    V3([0, 1, 2].map(|channel| {
        let [n1, n2] = [before[channel], after[channel]];
        match n1 == n2 {
            true => one,
            false if !tints => R::of(0.0),
            false => one - reflectance_into(cosine, R::of_f32(n1.min(n2)), R::of_f32(n1.max(n2))),
        }
    }))
}
