//! Spheres and discs: points that are drawn as they are, without a surface through them.
//!
//! The last slots of an object are its shapes, those before them carry its surface: fits and their search for
//! neighbours never see a shape. In what rays meet, a shape is a polynomial like any other (`shape_spheres`,
//! `shape_discs`).

use crate::SlotRange;
use kernels::layout::{FIT_PLANE, FitParams};

/// What a point is drawn as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ShapeKind {
    /// A flat disc, seen from both sides.
    Disc,
    /// A sphere.
    Sphere,
}

/// Consecutive slots of one object that are drawn as spheres or as discs.
#[derive(Debug, Clone, PartialEq)]
pub struct Shapes {
    /// Index of the object in the scene.
    pub object: u32,
    /// The first slot.
    pub first_slot: u32,
    /// Slots.
    pub count: u32,
    /// What is drawn.
    pub kind: ShapeKind,
    /// Of each slot, scene units, 0 to [`FARTHEST`](crate::FARTHEST); what is under [`SMALLEST`](Self::SMALLEST) is
    /// not drawn.
    pub radii: Vec<f32>,
    /// Of discs: what they lie across, of each slot, of unit length. `None`: the normal of the plane through the
    /// nearest others among these slots.
    pub normals: Option<Vec<[f32; 3]>>,
}

impl Shapes {
    /// Radii under this are none: their reciprocals would leave f32.
    pub const SMALLEST: f32 = 1e-15;
    /// Nearest others that a disc's plane goes through.
    pub const NEIGHBORS: u32 = 16;

    /// The slots.
    #[must_use]
    pub fn slots(&self) -> SlotRange {
        SlotRange { first_slot: self.first_slot, count: self.count }
    }

    /// Parameters of `fit_polynomials` for the planes that discs without normals lie in.
    #[must_use]
    pub fn plane_fit(&self) -> Option<FitParams> {
        let fitted = self.kind == ShapeKind::Disc && self.normals.is_none() && self.count > 0;
        fitted.then(|| FitParams {
            first_slot: self.first_slot,
            point_count: self.count,
            neighbors: Self::NEIGHBORS.min(self.count - 1).max(1),
            polynomial: FIT_PLANE,
            feature_size: 0.0,
            trust: 1.0,
            object: self.object,
            first_listed: self.first_slot,
            weight_scale: 1.0,
            close_gaps: 0,
            rim_limit: 0.0,
            bound_from: 0,
        })
    }
}
