//! What the scenes are made of: shapes for `generate-points` and pictures for `generate-images`.
#![forbid(unsafe_code)]

pub mod color;
pub mod figure;
pub mod files;
pub mod filling;
pub mod implicit;
pub mod noise;
pub mod room;
pub mod scenery;
pub mod sets;
pub mod sphere;
pub mod terrain;
pub mod tube;
pub mod vector;
