//! Simulated scans of a room whose surfaces have closed forms, so that pictures of the scans can be held against the
//! truth: the corner of a room with a box, a thin plate, a ball sunk into the floor, a column and a slanted rectangle.
//!
//! [`Room::new`] makes rooms of that kind by number, [`Scan::new`] scans one. Lengths are metres, z is up. The same
//! arguments give the same bits on every machine: nothing is computed by the platform's mathematical functions, which
//! differ in last bits, but by those of `exact.rs`.
//!
//! `Scan::at` says of any place how noisy and how dense the scan is there, and whether it was seen at all: what a
//! judge of pictures needs.
#![forbid(unsafe_code)]

mod exact;
mod noise;
mod photo;
mod random;
mod room;
mod scan;
mod sensor;
mod shapes;
mod vector;

pub use room::{Room, View};
pub use scan::{Kind, Observed, Sample, Scan, Scanner};
pub use shapes::Hit;
pub use vector::{V3, add, cross, dot, length, unit};
