//! How far two pictures are apart: numbers for each channel and layer, FLIP for the colours, and what
//! differs in their headers.
//!
//! [`Picture`] reads a file into named planes, [`Pair`] puts two of them one over the other, and the
//! rest measures: [`Pair::measure`], [`Pair::flip`], [`differing_attributes`]. Nothing here prints, knows
//! limits, or calls a difference too large.
#![forbid(unsafe_code)]

mod exposure;
mod false_color;
mod flip;
mod headers;
mod lanes;
mod measure;
mod pair;
mod picture;
mod tiles;

pub use false_color::{FalseColor, NOT_A_NUMBER};
pub use flip::{Flip, PIXELS_PER_DEGREE, flip_ldr};
pub use headers::{AttributeDifference, differing_attributes};
pub use measure::{Measures, PERCENTILES, Tally, Worst, difference};
pub use pair::{CompareError, Pair, layer_of};
pub use picture::{Picture, Plane, Rect};

#[cfg(test)]
mod tests;
