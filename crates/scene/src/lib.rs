//! Scene files: TOML in, a checked [`Scene`] out.
//!
//! A [`Scene`] that exists is valid: every number is finite and in its stated range, every key was
//! known, nothing was ignored. What the file got wrong is a [`SceneError`] that names the line.
#![forbid(unsafe_code)]

mod error;
mod load;
mod scene;
mod transform;

pub use error::SceneError;
pub use load::json_schema;
pub use scene::{
    Albedo, Background, Camera, FeatureSize, Fresnel, ImageSettings, Light, Material, Object,
    Polynomial, RayLoop, RenderSettings, Scene, Surface, Up,
};
pub use transform::Transform;
