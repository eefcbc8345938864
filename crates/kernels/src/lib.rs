//! The compute kernels as SPIR-V, and the host side of the structs they share.
//!
//! GLSL under `glsl/` is the source; `spirv/*.spv` is what everyone runs, so that everyone gets the
//! same pixels. The feature `compile` regenerates it (`compile-kernels`), and `spirv/manifest.txt`
//! holds the hash of each module's source with all its includes, so that a stale module fails
//! the test `spirv_is_up_to_date` also where no compiler is at hand.
#![forbid(unsafe_code)]

#[cfg(feature = "compile")]
pub mod compile;
mod exact;
pub mod glsl;
pub mod layout;
mod prune;
pub mod source;
pub mod spirv;

pub use exact::{FLOAT_ARITHMETIC, forbid_contraction};
pub use prune::without_unused;
