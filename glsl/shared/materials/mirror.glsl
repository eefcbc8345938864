// mirror: a perfect mirror.
//
// twin  crates/reference/src/material/mirror.rs
#include "optics.glsl"

Sent mirror_sends(Place place) {
    return Sent(reflected(place.d, place.normal), object_albedo_at(place.object), true);
}
