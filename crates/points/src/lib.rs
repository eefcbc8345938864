//! Point sets: readers, neighbours, local polynomials and the uniform grid.
//!
//! Without the feature `device` this crate knows no Vulkan: points are read, centred, sorted and
//! searched for neighbours, and the grid is planned. With it, polynomials and the grid are built as
//! storage buffers of a device.
#![forbid(unsafe_code)]

mod assign;
mod cloud;
mod collect;
mod color;
mod columns;
mod curve;
mod denoise;
#[cfg(feature = "device")]
pub mod device;
mod dimension;
mod distinct;
mod e57;
mod error;
mod esri;
mod field;
pub mod fill;
mod filter;
mod foreign;
mod format;
mod grid;
mod guard;
mod guess;
mod gzip;
mod las;
mod lines;
mod meaning;
mod names;
pub mod neighbors;
mod npy;
mod number;
mod obj;
mod off;
mod options;
mod pcd;
mod ply;
mod precision;
mod ptx;
mod read;
mod rims;
mod sensor;
mod set;
mod shapes;
mod source;
mod spacing;
mod strays;
mod stream;
mod summary;
mod text;
mod units;
mod upright;
mod voxels;
mod vtk;
mod watch;

pub use assign::{Column, Columns};
pub use cloud::{Cloud, CloudError, FARTHEST, ObjectPoints, SlotRange, bounds_of, origin_of};
pub use denoise::{Denoised, Noise, NoiseReport, Smoothing};
pub use dimension::{Dimension, Sign};
pub use error::PointsError;
pub use filter::Filter;
pub use grid::{BALL_MARGIN, Grids, plan_grids};
pub use neighbors::NeighborSearch;
pub use options::{ReadOptions, Wanted};
pub use ply::{PlyPoints, encode_ply};
pub use precision::{Coarse, coarse, coarse_rounding, single_axes, single_step};
pub use read::{read, read_bytes, read_with};
pub use rims::Rims;
pub use sensor::Sensor;
pub use set::{Attribute, ColorEncoding, PointSet, Values};
pub use shapes::{ShapeKind, Shapes};
pub use strays::{Apart, Strays, rough_origin};
pub use stream::Outlet;
pub use summary::{Dropped, Histogram, PointSummary, Range, summarize};
pub use units::Units;
pub use upright::Upwards;
pub use voxels::{Voxel, voxel_means};
pub use watch::{Unwatched, Watch};
