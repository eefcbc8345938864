//! The complete moving-least-squares projection in f64, the truth that the iteration of
//! `refine = "project"` is compared with: Tejada, Schafhitzel and Ertl, *Hardware-accelerated
//! point-based rendering of surfaces and volumes* (2007), section 3, after Alexa et al. (2003).
//!
//! [`PointSurface::project`] finds the plane of Equation 1, then the polynomial of Equation 2 over
//! it. [`PointSurface::project_at`] is what the renderer iterates instead (method, section 2): the
//! plane of covariance analysis through r itself. Inside, lengths are in units of h, the feature
//! size, so that tolerances mean the same for every scale.
//!
//! As the paper states Equation 1, the plane's origin q = r + t n turns with n about r, so the plane
//! depends on where r lies along n, and projecting twice is not quite projecting once. Levin's own
//! condition, [`PlaneSearch::FixedOrigin`], turns the plane about q: there P(P(r)) = P(r). How far
//! the two are apart: `the_surfaces_of_both_searches_differ_less_than_their_error`.

mod conjugate_gradient;
mod height;
mod kd_tree;
mod minimise;
mod plane;
#[cfg(test)]
mod tests;

use crate::real::V3;
use height::fit_height;
use kd_tree::KdTree;
use plane::{covariance_normal, reference_plane};

/// θ(d) = exp(−d²/h²), given d²/h².
fn theta(squared: f64) -> f64 {
    (-squared).exp()
}

/// Where h of a projection comes from. Scene units, greater than zero.
#[derive(Debug, Clone, PartialEq)]
pub enum FeatureSize {
    /// One for all.
    Constant(f64),
    /// One a point; a projection takes that of the point nearest to r, the lower index of two.
    PerPoint(Vec<f64>),
}

/// Which terms the polynomial g has. In ascending order of what they ask of the points: where these
/// cannot tell one kind, a projection takes the next lower.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum PolynomialKind {
    /// D
    Plane,
    /// A x² + B y² + C xy + D
    Incomplete,
    /// A x² + B y² + C xy + D + E x + F y
    Full,
    /// All ten of total degree three.
    Cubic,
    /// All fifteen of total degree four.
    Quartic,
}

impl PolynomialKind {
    /// All, each followed by the one to fall back to.
    const SIMPLER: [Self; 5] =
        [Self::Quartic, Self::Cubic, Self::Full, Self::Incomplete, Self::Plane];
}

/// What is held while Equation 1 is minimised over n.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlaneSearch {
    /// t: q = r + t n moves with n. The paper, and Alexa et al.
    FixedDistance,
    /// q: n is the eigenvector of the covariance about q. Levin (2003), and a true projection.
    FixedOrigin,
}

/// A point on the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Projection {
    /// P(r) = q + g(0, 0) n
    pub point: [f64; 3],
    /// Of the surface at `point`: n − ∇g(0, 0), of unit length. Its sign means nothing.
    pub normal: [f64; 3],
    /// q
    pub plane_origin: [f64; 3],
    /// n, on the side of `normal`.
    pub plane_normal: [f64; 3],
    /// The kind that the points could tell.
    pub polynomial: PolynomialKind,
    /// Rounds of the alternation between t and n; 0 for [`PointSurface::project_at`].
    pub iterations: u32,
}

/// The moving-least-squares surface of a set of points.
#[derive(Debug, Clone)]
pub struct PointSurface<'a> {
    points: &'a [[f64; 3]],
    feature_size: FeatureSize,
    polynomial: PolynomialKind,
    search: PlaneSearch,
    reach: f64,
    tree: KdTree,
}

/// The points around r: (pᵢ − r)/h, in the order of their indices.
struct Neighborhood {
    r: V3<f64>,
    h: f64,
    offsets: Vec<V3<f64>>,
}

impl<'a> PointSurface<'a> {
    /// Equation 1 as the paper states it, and sums over the points within 3 h of r, where θ is
    /// 1.2e-4.
    ///
    /// # Panics
    /// Where feature sizes are given, but not one a point, or where a position is not finite.
    #[must_use]
    pub fn new(
        points: &'a [[f64; 3]],
        feature_size: FeatureSize,
        polynomial: PolynomialKind,
    ) -> Self {
        if let FeatureSize::PerPoint(sizes) = &feature_size {
            assert_eq!(sizes.len(), points.len(), "one feature size a point");
        }
        assert!(points.as_flattened().iter().all(|x| x.is_finite()), "positions are finite");
        let search = PlaneSearch::FixedDistance;
        let tree = KdTree::new(points);
        Self { points, feature_size, polynomial, search, reach: 3.0, tree }
    }

    /// Sums over the points within `reach` × h of r. Infinity is the paper's sum over all; from 6.1
    /// on, what is left out is below the rounding of f64.
    #[must_use]
    pub fn with_reach(self, reach: f64) -> Self {
        Self { reach, ..self }
    }

    /// Minimises Equation 1 in another way.
    #[must_use]
    pub fn with_search(self, search: PlaneSearch) -> Self {
        Self { search, ..self }
    }

    /// P(r) by the complete procedure: Equation 1 from t = 0 and covariance analysis, then
    /// Equation 2. `None` where no plane with |t| < h/2 minimises Equation 1, and where the points
    /// within reach span no plane.
    #[must_use]
    pub fn project(&self, r: [f64; 3]) -> Option<Projection> {
        let around = self.neighborhood(r)?;
        let plane = reference_plane(&around.offsets, self.search)?;
        self.over_plane(&around, plane.t, plane.n, plane.rounds)
    }

    /// One step of the renderer's iteration: q = r and n of covariance analysis, then Equation 2.
    /// `None` where the points within reach span no plane.
    #[must_use]
    pub fn project_at(&self, r: [f64; 3]) -> Option<Projection> {
        let around = self.neighborhood(r)?;
        let n = covariance_normal(&around.offsets)?;
        self.over_plane(&around, 0.0, n, 0)
    }

    fn neighborhood(&self, r: [f64; 3]) -> Option<Neighborhood> {
        let nearest = self.tree.nearest(self.points, &r)?;
        let h = match &self.feature_size {
            FeatureSize::Constant(h) => *h,
            FeatureSize::PerPoint(sizes) => sizes[nearest as usize],
        };
        if !(h > 0.0 && h.is_finite()) {
            return None;
        }
        let within = self.tree.within(self.points, &r, self.reach * h);
        let r = V3(r);
        let offset = |&index: &u32| (V3(self.points[index as usize]) - r).over(h);
        Some(Neighborhood { r, h, offsets: within.iter().map(offset).collect() })
    }

    /// Equation 2 over the plane through q = r + t h n, and P(r) = q + g(0, 0) n.
    fn over_plane(
        &self,
        around: &Neighborhood,
        t: f64,
        n: V3<f64>,
        iterations: u32,
    ) -> Option<Projection> {
        let about_q: Vec<V3<f64>> = around.offsets.iter().map(|&y| y - n.times(t)).collect();
        let u = any_perpendicular(n);
        let v = n.cross(u);
        let height = fit_height(&about_q, [u, v, n], self.polynomial)?;
        let normal = n - u.times(height.slope[0]) - v.times(height.slope[1]);
        Some(Projection {
            point: (around.r + n.times(around.h * (t + height.offset))).0,
            normal: normal.normalize().0,
            plane_origin: (around.r + n.times(around.h * t)).0,
            plane_normal: n.0,
            polynomial: height.kind,
            iterations,
        })
    }
}

/// A unit vector perpendicular to n: g(0, 0) and its gradient do not depend on which.
fn any_perpendicular(n: V3<f64>) -> V3<f64> {
    let [x, y, z] = n.0;
    let other = if x.abs() <= y.abs() && x.abs() <= z.abs() {
        [1.0, 0.0, 0.0]
    } else if y.abs() <= z.abs() {
        [0.0, 1.0, 0.0]
    } else {
        [0.0, 0.0, 1.0]
    };
    n.cross(V3(other)).normalize()
}
