//! The checked scene, as the renderer takes it.
//!
//! Ranges that its parts state hold for every value that came from a file: the tables of keys beside them set these.

use crate::{Background, CameraKeys, ImageSettings, Light, Object, RenderSettings};

/// What to render. Lengths are scene units, colours linear RGB with Rec. 709 primaries.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Scene {
    /// Names of the objects of glass that the eye is inside (`camera.inside`); `None`: the renderer finds out.
    pub inside: Option<Vec<String>>,
    /// What is given of the view; the renderer frames the objects with the rest.
    pub camera: CameraKeys,
    /// Size and sampling of the picture.
    pub image: ImageSettings,
    /// How rays are followed.
    pub render: RenderSettings,
    /// What rays that hit nothing see.
    pub background: Background,
    /// The lights, 0 to 1024.
    pub lights: Vec<Light>,
    /// The directional light whose direction follows the camera, by its place among the lights: the key light of a point
    /// file rendered directly, unless its direction is given. Scene files have none.
    pub key_light: Option<usize>,
    /// The objects, 1 to 65536; an object's place here is its index in the picture.
    pub objects: Vec<Object>,
}

/// A camera. `eye` and `target` differ, and `up` is not parallel to the line of sight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// World position, each -1e15 to 1e15.
    pub eye: [f64; 3],
    /// World position in the middle of the picture, each -1e15 to 1e15.
    pub target: [f64; 3],
    /// World direction that is upwards in the picture, any length from 1e-12.
    pub up: [f64; 3],
    /// How the scene comes onto the picture.
    pub projection: Projection,
    /// Diameter of the lens, 0 to 1e15 and at most 1000 times the distance in focus; 0: a pinhole.
    pub aperture: f64,
    /// Distance along the viewing axis of the plane in focus, 1e-12 to 1e15; `None`: the target's.
    pub focus: Option<f64>,
}

/// How the scene comes onto the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Projection {
    /// Towards the eye.
    Perspective {
        /// Angle between the lower and the upper edge in degrees, 0.001 to 179.
        vertical_fov: f64,
    },
    /// By parallels to the viewing axis.
    Orthographic {
        /// Distance of the lower edge from the upper, 1e-12 to 1e15.
        height: f64,
    },
}

/// Which axis of a point file points upwards.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Up {
    /// +y, as in most models.
    #[default]
    Y,
    /// +z, as in most surveys.
    Z,
    /// -y, as in what a depth camera sees: x to the right, y down, z forward.
    MinusY,
}
