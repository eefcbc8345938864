//! Point sets: readers, neighbours, local polynomials and the uniform grid.
//!
//! Without the feature `device` this crate knows no Vulkan: points are read, centred, sorted and
//! searched for neighbours, and the grid is planned. With it, polynomials and the grid are built as
//! storage buffers of a device.
#![forbid(unsafe_code)]

mod cloud;
#[cfg(feature = "device")]
pub mod device;
mod grid;
pub mod neighbors;
mod ply;
mod read;
mod rims;
mod set;
mod summary;
mod watch;

pub use cloud::{Cloud, CloudError, FARTHEST, ObjectPoints, SlotRange, bounds_of};
pub use grid::{BALL_MARGIN, Grids, plan_grids};
pub use neighbors::NeighborSearch;
pub use read::{PointsError, read};
pub use rims::Rims;
pub use set::{Attribute, ColorEncoding, PointSet, Values};
pub use summary::{Dropped, PointSummary, Range};
pub use watch::{Unwatched, Watch};
