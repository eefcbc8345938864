//! The stages of a frame, each of which records the passes of its kernels: from the camera, on to the nearest hits, through
//! volumes, what becomes of each ray, light, the next wave, the film.

mod camera;
mod fate;
mod film;
mod hits;
mod light;
mod trace;
mod volumes;

pub(crate) use fate::Fates;
pub(crate) use light::drawing_of;
pub(crate) use volumes::marching_of;
