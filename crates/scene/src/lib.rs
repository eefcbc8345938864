//! Scene files: TOML in, a checked [`Scene`] out.
//!
//! A [`Scene`] that exists is valid: every number is finite and in its stated range, every key was
//! known and built, nothing was ignored. What a file gets wrong is a [`SceneError`] that names the
//! line. `keys.rs` states every key once; checks, defaults, [`json_schema`] and the tables of
//! docs/scene.md come from it. `not_built.rs` lists what is known there but not built.
#![forbid(unsafe_code)]

mod camera_keys;
mod check;
mod document;
mod error;
mod inside;
mod keys;
mod load;
mod models;
mod not_built;
mod overrides;
mod preset;
mod read;
mod root;
mod scene;
mod schema;
mod settings;
mod suite;
mod suite_keys;
mod transfer_file;
mod transform;
mod whole;

#[cfg(test)]
mod reference_page;
#[cfg(test)]
mod tests;

pub use camera_keys::{CameraKeys, ViewFrom, camera_keys_set};
pub use error::SceneError;
pub use models::MODELS_VARIABLE;
pub use scene::{
    Albedo, Background, Boundary, Camera, ColorMap, ExtinctionFactor, FeatureSize, Filter, Fresnel,
    GridResolution, ImageFile, ImageSettings, Light, Material, MaterialKind, Neighbors, Normals,
    Object, PerParticle, PointColumn, PointColumns, PointFilter, Polynomial, Primary, Projection,
    RadiusOf, RayLoop, Refine, RenderSettings, Scale, Scatter, Scene, Secondary, ShapeRadius, Stop,
    Surface, SurfaceKind, TextureAxis, Transfer, Units, Up, Volume, VolumeKernel, VolumeMode,
    VolumeShading, VoxelEdge,
};
pub use schema::{json_schema, suite_json_schema};
pub use suite::{Shape, SimulatedScan, Suite, SuiteRow};
pub use transform::Transform;
