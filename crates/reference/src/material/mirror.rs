//! Twin of `glsl/shared/materials/mirror.glsl`: a perfect mirror.

use super::{Place, Sent};
use crate::optics::reflected;
use crate::real::{Real, V3};

pub(super) fn sent_on<R: Real>(place: &Place<'_, R>) -> Sent<R> {
    Sent {
        direction: reflected(place.d, place.normal),
        weight: V3::of_f32(place.info.albedo),
        reflects: true,
    }
}
