//! What rays go through to their nearest hits. The choice changes no picture.

use crate::{Diagnostic, Plan, Primary, RayLoop, Secondary, Window};

/// Points a pixel up to which discs are faster than the grid, and than the tree: each picture bins all points anew.
/// Measured in docs/benchmarks.md.
const POINTS_PER_PIXEL: f64 = 4.0;
const POINTS_PER_PIXEL_TO_TREE: f64 = 2.0;
/// Pixels from which on they are: the dispatches of the binning cost what they cost.
const FEWEST_PIXELS: usize = 32_768;

/// A structure that rays go through (`glsl/shared/structure.glsl`).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StructureKind {
    /// Grids; any rays can go through them.
    Grid,
    /// The tree of boxes, where the device has room for it.
    Tree,
    /// The discs of a tile's points, for rays from the eye through the centres of pixels.
    Discs,
}

impl StructureKind {
    /// As scene files name it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Grid => "grid",
            Self::Tree => "tree",
            Self::Discs => "discs",
        }
    }
}

/// Which rays look for a structure.
#[derive(Debug, Clone, Copy)]
pub enum RaysFrom<'a> {
    /// The camera's of a tile of the picture.
    Tile(&'a Window),
    /// Those from the camera that have lost a hit, or whose tile is not known.
    Camera,
    /// All others.
    Surface,
}

impl Plan {
    /// What rays are to go through: the first of these that the device has and that takes them. The last takes all.
    #[must_use]
    pub fn structures(&self, from: RaysFrom<'_>) -> Vec<StructureKind> {
        let by_discs = matches!(from, RaysFrom::Tile(tile) if self.by_discs(tile));
        let by_tree = match from {
            RaysFrom::Tile(_) | RaysFrom::Camera => self.camera_by_tree(),
            RaysFrom::Surface => self.by_tree(),
        };
        let wanted = [(by_discs, StructureKind::Discs), (by_tree, StructureKind::Tree)];
        let wanted = wanted.into_iter().filter(|wanted| wanted.0).map(|wanted| wanted.1);
        wanted.chain([StructureKind::Grid]).collect()
    }

    /// Whether it is the choice of any rays, beside those of a tile.
    #[must_use]
    pub fn takes(&self, kind: StructureKind) -> bool {
        let first = |from| self.structures(from).first() == Some(&kind);
        first(RaysFrom::Camera) || first(RaysFrom::Surface)
    }

    /// Whether the camera rays of a tile of the picture are to find their first hit by discs: where they go through
    /// the centres of pixels, which binning relies on.
    #[must_use]
    pub fn by_discs(&self, tile: &Window) -> bool {
        match self.primary {
            _ if !self.looks_through_centers(0) => false,
            Primary::Discs => true,
            Primary::Grid | Primary::Tree => false,
            Primary::Auto => self.discs_are_faster(tile) && !self.is_about_cells(),
        }
    }

    fn discs_are_faster(&self, tile: &Window) -> bool {
        let (pixels, points) = (tile.pixels(), self.cloud.points.len());
        let most = if self.by_tree() { POINTS_PER_PIXEL_TO_TREE } else { POINTS_PER_PIXEL };
        pixels >= FEWEST_PIXELS && points as f64 <= most * pixels as f64
    }

    /// Whether rays that do not come from the camera go through the tree, where the device can.
    fn by_tree(&self) -> bool {
        self.secondary != Secondary::Grid && self.may_take_tree()
    }

    /// Whether camera rays that are not traced by discs do.
    fn camera_by_tree(&self) -> bool {
        let wanted = match self.primary {
            Primary::Grid => false,
            Primary::Discs => self.secondary != Secondary::Grid, // a tile that has too many of them
            Primary::Tree | Primary::Auto => true,
        };
        wanted && self.may_take_tree()
    }

    fn may_take_tree(&self) -> bool {
        self.ray_loop != RayLoop::Images && !self.is_about_cells()
    }

    /// Whether somebody wants to see the grid at work.
    fn is_about_cells(&self) -> bool {
        self.cells_per_pass != 0 || self.counts_work()
    }

    /// Whether a diagnostic counts what all rays of a pixel do.
    pub(crate) fn counts_work(&self) -> bool {
        let counts = [Diagnostic::Tests, Diagnostic::Cells];
        self.diagnostics.iter().any(|shown| counts.contains(shown))
    }
}
