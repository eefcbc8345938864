//! What a frame cost.

use kernels::layout::NONE;
use kernels::spirv;
use std::time::Duration;

/// What a frame cost.
#[derive(Debug, Clone, Default)]
pub struct FrameStats {
    /// From submission to completion of all passes, shading included; without what `pipelines` took.
    pub trace: Duration,
    /// What passes waited for pipelines that were not made yet.
    pub pipelines: Duration,
    /// Dispatches of the traversal.
    pub passes: u32,
    /// Camera rays whose paths have ended.
    pub(crate) rays: u64,
    /// GPU time of each kernel, in milliseconds, by name, in the order of first use.
    pub kernels: Vec<(&'static str, f64)>,
    /// What of it the traversal took.
    pub traversal: Traversal,
}

/// GPU time of traversal by kind of rays, in milliseconds; all zero where the device has no timestamps.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Traversal {
    /// From the camera.
    pub camera: f64,
    /// From surfaces towards lights.
    pub shadow: f64,
    /// Reflected and refracted ones, which share their waves.
    pub scattered: f64,
}

/// Which rays a pass works on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Traced {
    /// From the camera.
    Camera,
    /// From surfaces.
    Scattered,
    /// From surfaces towards a light, as far as the first hit.
    Shadows,
    /// From the points of a volume towards a light, past the surface of their object.
    PastObject(u32),
}

impl Traced {
    /// Whether they go to a light.
    pub fn to_light(self) -> bool {
        matches!(self, Self::Shadows | Self::PastObject(_))
    }

    /// The object whose surface is not there for them, or `NONE`.
    pub fn passed(self) -> u32 {
        match self {
            Self::PastObject(object) => object,
            _ => NONE,
        }
    }

    /// Whether they start at the camera.
    pub fn is_from_camera(self) -> bool {
        self == Self::Camera
    }
}

impl FrameStats {
    /// Adds what passes took.
    pub(crate) fn add(&mut self, passes: &[(&'static str, f64)], traced: Option<Traced>) {
        for &(name, milliseconds) in passes {
            match self.kernels.iter_mut().find(|kernel| kernel.0 == name) {
                Some(kernel) => kernel.1 += milliseconds,
                None => self.kernels.push((name, milliseconds)),
            }
        }
        let kinds = &mut self.traversal;
        let sum = match traced {
            Some(Traced::Camera) => &mut kinds.camera,
            Some(Traced::Shadows) => &mut kinds.shadow,
            Some(Traced::Scattered) => &mut kinds.scattered,
            // Rays from points of volumes are in no count of rays.
            Some(Traced::PastObject(_)) | None => return,
        };
        let traversal = passes.iter().filter(|pass| spirv::is_traversal(pass.0));
        *sum += traversal.map(|pass| pass.1).sum::<f64>();
    }
}
