//! Scene files: TOML in, a checked [`Scene`] out.
//!
//! A [`Scene`] that exists is valid: every number is finite and in its stated range, every key was
//! known and built, nothing was ignored. What a file gets wrong is a [`SceneError`] that names the
//! line. Every key is stated once, in a table beside the type that it becomes; checks, defaults, [`json_schema`] and the
//! tables of docs/scene.md come from these. `not_built.rs` lists what is known there but not built.
#![forbid(unsafe_code)]

mod background;
mod camera_keys;
mod check;
mod color_map;
mod document;
mod error;
mod filter;
mod ground;
mod image;
mod inside;
mod keys;
mod light;
mod load;
mod material;
mod models;
mod not_built;
mod object;
mod overrides;
mod point_file;
mod preset;
mod read;
mod render_settings;
mod root;
mod scene;
mod schema;
mod settings;
mod suite;
mod suite_keys;
mod surface;
mod transfer_file;
mod transform;
mod volume;
mod whole;

#[cfg(test)]
mod reference_page;
#[cfg(test)]
mod tests;

pub use background::{Background, ImageFile, Sky, SunPlace};
pub use camera_keys::{CameraKeys, ViewFrom, camera_keys_set};
pub use color_map::{ColorMap, Scale};
pub use error::SceneError;
pub use filter::{PointFilter, VoxelEdge};
pub use image::{Filter, ImageSettings};
pub use light::Light;
pub use material::{Albedo, Material, MaterialKind, TextureAxis};
pub use models::MODELS_VARIABLE;
pub use object::{Object, PointColumn, PointColumns, Units};
pub use point_file::Quality;
pub use render_settings::{
    Fresnel, GridResolution, Integrator, Primary, RayLoop, RenderSettings, Secondary, Shadows,
};
pub use scene::{Camera, Projection, Scene, Up};
pub use schema::{json_schema, suite_json_schema};
pub use settings::settings_of_header;
pub use suite::{Shape, SimulatedScan, Suite, SuiteRow};
pub use surface::{
    FeatureSize, Neighbors, Normals, Polynomial, RadiusOf, Refine, Scatter, ShapeRadius, Surface,
    SurfaceKind,
};
pub use transform::Transform;
pub use volume::{
    Boundary, ExtinctionFactor, PerParticle, Stop, Transfer, Volume, VolumeKernel, VolumeMode,
    VolumeRadius, VolumeShading,
};
