//! Twin of `refine` and `resume`: a stored hit's way to the point set surface (\[T\] §4, after Adamson
//! and Alexa; method, section 2).

use crate::albedo::slots_of;
use crate::camera_rays::Ray;
use crate::eigen::eigen_symmetric;
use crate::fit::{COLLINEAR, Frame, fit_coefficients};
use crate::grid::Ball;
use crate::least_squares::NormalEquations;
use crate::levels::{Level, Levels};
use crate::polynomial::Polynomial;
use crate::real::{NO_HIT, Real, V3};
use crate::surface_hit::Hit;
use kernels::layout::{FIT_NO_SURFACE, FitOutcome, NONE, ObjectInfo, Point, RAY_STARTS};

const REACH: f64 = 3.0;
const MAX_ROWS: u64 = 1024;
const MAX_LISTED: u32 = 2048;

/// The points of each cell, each point once.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct PointCells {
    /// First entry of each cell in `slots`, and one after the last.
    pub offsets: Vec<u32>,
    /// Slots, cell after cell.
    pub slots: Vec<u32>,
}

/// What refinement reads.
#[derive(Debug, Clone, Copy)]
pub struct Surroundings<'a, R> {
    /// The grids of `cells`.
    pub levels: &'a Levels<R>,
    /// By slot.
    pub polynomials: &'a [Polynomial<R>],
    /// By slot: where the points are. (Balls at rims have other centres.)
    pub points: &'a [Point],
    /// By slot.
    pub outcomes: &'a [FitOutcome],
    /// The points of each cell of each grid.
    pub cells: &'a PointCells,
    /// By object.
    pub objects: &'a [ObjectInfo],
}

/// What became of a hit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Refined<R> {
    /// It stands there, after so many iterations.
    Accepted(Hit<R>, u32),
    /// It left its trust region, or lost its surface, after so many iterations.
    Rejected(u32),
}

impl<R: Real> Surroundings<'_, R> {
    /// Slots of the rows of cells around x, where the object's points are listed; `None` where there are too many.
    fn around(&self, x: V3<R>, radius: R, object: u32) -> Option<Vec<u32>> {
        let ball = Ball::exact(x, radius);
        let boxes: Vec<(&Level<R>, [[u32; 3]; 2])> = self
            .levels
            .listing(slots_of(&self.objects[object as usize]))
            .map(|level| (level, level.grid.cells_around(&ball)))
            .collect();
        let count = |[low, high]: [[u32; 3]; 2]| (high[1] - low[1] + 1) * (high[2] - low[2] + 1);
        if boxes.iter().map(|&(_, around)| u64::from(count(around))).sum::<u64>() > MAX_ROWS {
            return None;
        }
        let rows = boxes.iter().flat_map(|&(level, [low, high])| {
            (0..count([low, high])).map(move |row| {
                let height = high[1] - low[1] + 1;
                let offset = |x: u32, past: u32| {
                    let cell = [x, low[1] + row % height, low[2] + row / height];
                    let at = level.info.first_offset + level.grid.cell_id(cell) + past;
                    self.cells.offsets[at as usize] as usize
                };
                offset(low[0], 0)..offset(high[0], 1)
            })
        });
        let listed: usize = rows.clone().map(|row| row.len()).sum();
        (listed <= MAX_LISTED as usize)
            .then(|| rows.flat_map(|row| self.cells.slots[row].iter().copied()).collect())
    }

    /// The object's point nearest to x; the stored one is near (ties: the lower index), and among `slots`
    /// if its ball was clipped, so that its centre lies elsewhere.
    fn nearest(&self, slots: &[u32], x: V3<R>, stored: u32, clipped: bool) -> u32 {
        let object = self.polynomials[stored as usize].object;
        let own = slots_of(&self.objects[object as usize]);
        let key = |slot: u32| {
            let point = &self.points[slot as usize];
            let y = V3::of_f32(point.position) - x;
            (y.dot(y), point.index)
        };
        let mut best = stored;
        let mut best_key = key(stored);
        if clipped {
            best_key.0 = R::of(NO_HIT);
        }
        for &slot in slots {
            if own.contains(&slot) && key(slot) < best_key {
                best = slot;
                best_key = key(slot);
            }
        }
        best
    }

    /// The polynomial fitted at x over the plane of its neighbourhood, and its kind.
    fn fit_at(&self, slots: &[u32], x: V3<R>, h: R, object: u32) -> (Polynomial<R>, u32) {
        let zero = R::of(0.0);
        let inverse_h = R::of(1.0) / h;
        let own = slots_of(&self.objects[object as usize]);
        let scale = R::of_f32(self.objects[object as usize].weight_scale);
        let weight_square = scale * scale;
        let neighbors = || {
            slots.iter().filter_map(|&slot| {
                let y = (V3::of_f32(self.points[slot as usize].position) - x).times(inverse_h);
                let square = y.dot(y);
                let counts = square <= R::of(REACH * REACH) && own.contains(&slot);
                counts.then(|| (y, (-square * weight_square).exp_negative()))
            })
        };
        let pairs = |a: V3<R>, b: V3<R>| V3([a.x() * b.y(), a.x() * b.z(), a.y() * b.z()]);
        let (mut total, mut sum) = (zero, V3::splat(zero));
        let (mut diagonal, mut off) = (V3::splat(zero), V3::splat(zero));
        for (y, weight) in neighbors() {
            let wy = y.times(weight);
            total = total + weight;
            sum = sum + wy;
            diagonal = diagonal + wy * y;
            off = off + pairs(wy, y);
        }
        let mean = sum.over(total.max(R::of(1e-30)));
        let eigen = eigen_symmetric(diagonal - sum * mean, off - pairs(sum, mean));
        let n = eigen.smallest.normalize();
        let u = eigen.largest;
        let frame = Frame { n, u, v: n.cross(u) };
        let mut equations = NormalEquations::default();
        for (y, weight) in neighbors() {
            equations.add_sample(y.dot(frame.u), y.dot(frame.v), y.dot(n), weight);
        }
        let spans_plane = eigen.values.y() > R::of(COLLINEAR) * eigen.values.z();
        let first =
            if spans_plane { self.objects[object as usize].polynomial } else { FIT_NO_SURFACE };
        let (kind, c) = fit_coefficients(&equations, first, u32::MAX);
        (frame.to_world(x, h, inverse_h, &c), kind)
    }

    /// Follows a stored hit to the surface, or until it leaves the trust region.
    #[must_use]
    pub fn refine(&self, ray: &Ray<R>, mut hit: Hit<R>) -> Refined<R> {
        let stored = &self.polynomials[ray.hit_slot as usize];
        let info = &self.objects[stored.object as usize];
        // More than 0 where the ball was clipped: from its point to its centre.
        let moved = R::of_f32(self.outcomes[ray.hit_slot as usize].trust) - stored.trust;
        let clipped = moved > R::of(0.0);
        let mut iterations = 0;
        while iterations < info.max_iterations {
            let from_stored = hit.position - stored.center;
            let reach = from_stored.dot(from_stored).sqrt() + moved;
            let Some(near) = self.around(hit.position, reach, stored.object) else { break };
            let nearest = self.nearest(&near, hit.position, ray.hit_slot, clipped) as usize;
            let h = R::of_f32(self.outcomes[nearest].feature_size);
            let Some(slots) = self.around(hit.position, R::of(REACH) * h, stored.object) else {
                break;
            };
            let (mut p, kind) = self.fit_at(&slots, hit.position, h, stored.object);
            p.trust = R::of_f32(self.outcomes[nearest].trust);
            iterations += 1;
            let settled = p.offset.abs() <= R::of_f32(info.tolerance) * h;
            let t =
                if settled { hit.t } else { p.intersect(ray.origin, ray.direction, R::of(0.0)) };
            if kind == FIT_NO_SURFACE || t >= R::of(NO_HIT) {
                return Refined::Rejected(iterations);
            }
            let (y, normal) = p.surface_at(ray.origin, ray.direction, t);
            let x = if settled { hit.position } else { hit.position + y };
            let from_stored = x - stored.center;
            if from_stored.dot(from_stored) > stored.trust * stored.trust {
                return Refined::Rejected(iterations);
            }
            hit = Hit { position: x, t, normal };
            if settled {
                break;
            }
        }
        Refined::Accepted(hit, iterations)
    }
}

/// Sends a ray whose hit was refined away on to the next.
pub fn resume<R: Real>(ray: &mut Ray<R>) {
    ray.after = ray.hit_t;
    ray.hit_t = R::of(NO_HIT);
    ray.hit_slot = NONE;
    ray.cell = RAY_STARTS;
}
