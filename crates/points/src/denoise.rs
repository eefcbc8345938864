//! Points with noise, moved onto the surface that they are samples of (docs/method.md, section 1).
//!
//! Each point has a scale of its own: the fewest neighbours whose quadratic fit gives a normal that noise hardly moves
//! (after Mitra and Nguyen, Estimating Surface Normals in Noisy Point Cloud Data, 2003, and Pauly, Keiser and Gross,
//! Multi-scale Feature Extraction on Point-Sampled Surfaces, 2003). It moves to its foot on that fit. What is no sample
//! of a surface is set apart. Normals are filtered over the surface and not over its edges, and points moved after them
//! (after Öztireli, Guennebaud and Gross, Feature Preserving Point Set Surfaces, 2009, and Huang et al., Edge-Aware Point
//! Set Resampling, 2013).
//!
//! All of it happens on the processor, once, before a device sees the points: a device and the reference get the same
//! ones. The search shares its work between eight points that follow each other on the curve; sums over neighbours run in
//! the order of slots, in eight lanes whatever registers there are, so that no bit depends on threads or processors.

mod bilateral;
mod fit;
mod judge;
mod lanes;
mod near;
mod report;
mod scales;
mod scatter;

pub use judge::Noise;
pub use report::NoiseReport;

use crate::watch::Watch;
use bilateral::Oriented;
use judge::median;
use kernels::layout::Point;
use near::Near;
use scales::{NEAREST, Nearest, Scales};
use scatter::Judged;

/// Points of a group that share a search.
const FAN: usize = 8;
/// Under this h, points lie in one place.
const SMALLEST: f32 = 1e-15;
/// A point is apart where its h16 is over so many times the median of its neighbours': before the fits, and after them.
const APART_BEFORE: f32 = 3.0;
const APART_AFTER: f32 = 2.5;
/// Rounds of the latter, and of what follows, which mostly ends after two or three: along a wire it would go on point by
/// point.
const ROUNDS: usize = 2;
const MOST_ROUNDS: usize = 16;
/// A point whose h16 grew by over so much as scatter was taken away is what is left of scatter. On the rim of a surface,
/// it grows by the square root of two.
const LEFT_OVER: f32 = 2.0;
/// The mean spacing of points on a plane of which 17 lie within h16, over that.
const SPACING: f32 = 0.43;
/// Steps of the work, for the watcher: searches, fits, rounds.
const STEPS: u64 = 16;
const FITTED: u64 = 9;

/// How noise is smoothed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Smoothing {
    /// The expected error of normals that is small enough, in radians.
    pub accuracy: f32,
    /// Whether the next scale has to agree that it is: of points that were quantised, errors of one scale are not
    /// independent.
    pub agreed: bool,
}

/// Points after smoothing.
#[derive(Debug, Clone, PartialEq)]
pub struct Denoised {
    /// Where each lies; what is scatter lies where it did.
    pub positions: Vec<[f32; 3]>,
    /// Its normal, of unit length, towards the sensor where that is known, else to either side; zero of what is far from
    /// others.
    pub normals: Vec<[f32; 3]>,
    /// Which points are no samples of a surface.
    pub is_scatter: Vec<bool>,
    /// The spacing of points at each, s; where that is over m, what is usual around, m²/s: what lies far from others
    /// stands for no area.
    pub spacings: Vec<f32>,
    /// The median spacing of points on surfaces.
    pub spacing: f32,
    /// The median standard deviation of noise along the normals.
    pub sigma: f32,
}

impl Denoised {
    /// Smooths distinct points along a curve ([`Cloud`](crate::Cloud)), without strays. Few points, or points in one
    /// place, stay as they are. `sensors` are where each was seen from, in the same coordinates, as far as that is known:
    /// one entry a point, or none at all. `None` where the watcher asks for an end.
    #[must_use]
    pub fn of(
        points: &[Point],
        sensors: &[Option<[f32; 3]>],
        smoothing: &Smoothing,
        watch: &dyn Watch,
    ) -> Option<Self> {
        let count = points.len() as u64;
        watch.stage("smoothing noise", count);
        let step = |step: u64| {
            watch.done(count * step / STEPS);
            (!watch.interrupted()).then_some(())
        };
        let positions: Vec<[f32; 3]> = points.iter().map(|point| point.position).collect();
        let mut denoised = Self {
            normals: vec![[0.0; 3]; points.len()],
            is_scatter: vec![false; points.len()],
            spacings: vec![0.0; points.len()],
            spacing: 0.0,
            sigma: 0.0,
            positions,
        };
        if points.len() <= NEAREST {
            return Some(denoised);
        }
        let near = Near::new(&denoised.positions);
        let nearest = Nearest::of(&near, |at| points[at].index);
        step(2)?;
        let apart = |at: &u32| nearest.ratio(*at as usize) < APART_BEFORE;
        let left: Vec<u32> = (0..points.len() as u32).filter(apart).collect();
        for (spacing, square) in denoised.spacings.iter_mut().zip(&nearest.squares) {
            *spacing = SPACING * square.sqrt();
        }
        if left.len() <= NEAREST {
            return Some(denoised);
        }
        let kept: Vec<[f32; 3]> = left.iter().map(|&at| denoised.positions[at as usize]).collect();
        let near = Near::new(&kept);
        let index = |at: usize| points[left[at] as usize].index;
        let nearest = nearest.of_some(&near, &left, index);
        step(3)?;
        let scales = Scales::of(&near, &nearest, smoothing, &|share: f64| {
            watch.done((count as f64 * (3.0 + share * (FITTED - 3) as f64) / STEPS as f64) as u64);
            !watch.interrupted()
        })?;
        let judged = scatter::by_fits(&near, &scales, &nearest.squares);
        let mut places: Vec<u32> =
            (0..left.len() as u32).filter(|&at| !judged.is_scatter[at as usize]).collect();
        step(FITTED + 1)?;
        for round in 0..MOST_ROUNDS {
            if places.len() <= NEAREST {
                break;
            }
            let count = places.len();
            let some: Vec<[f32; 3]> = places.iter().map(|&at| kept[at as usize]).collect();
            let around =
                nearest.of_some(&Near::new(&some), &places, |at| index(places[at] as usize));
            let stays = |at: &usize| {
                let before = nearest.squares[places[*at] as usize];
                around.squares[*at] <= LEFT_OVER * LEFT_OVER * before
                    && (round >= ROUNDS || around.ratio(*at) <= APART_AFTER)
            };
            places = (0..count).filter(stays).map(|at| places[at]).collect();
            if round >= ROUNDS && places.len() == count {
                break;
            }
        }
        step(FITTED + 2)?;
        let on_fit = |&at: &u32| {
            let (fit, p) = (&scales.fits[at as usize], kept[at as usize]);
            let position = [0, 1, 2].map(|axis| p[axis] + fit.foot[axis]);
            let mut oriented =
                Oriented { position, normal: fit.normal, error: fit.error, is_seen: false };
            if let Some(Some(sensor)) = sensors.get(left[at as usize] as usize) {
                let towards = (0..3).map(|axis| (sensor[axis] - p[axis]) * fit.normal[axis]);
                if towards.sum::<f32>() < 0.0 {
                    oriented.normal = fit.normal.map(|x| -x);
                }
                oriented.is_seen = true;
            }
            oriented
        };
        let mut oriented: Vec<Oriented> = places.iter().map(on_fit).collect();
        for round in 1..=bilateral::ROUNDS as u64 {
            bilateral::filter(&mut oriented);
            step(FITTED + 2 + round)?;
        }
        denoised.take(&places, &oriented, (&left, &scales, &judged));
        Some(denoised)
    }

    /// `places`: of what lies on surfaces, among the points `left`.
    fn take(
        &mut self,
        places: &[u32],
        oriented: &[Oriented],
        (left, scales, judged): (&[u32], &Scales, &Judged),
    ) {
        self.sigma = median(places.iter().map(|&at| scales.fits[at as usize].s).collect());
        let spacings = places.iter().map(|&at| self.spacings[left[at as usize] as usize]);
        self.spacing = median(spacings.collect());
        let mut usual = vec![self.spacing; self.spacings.len()];
        for (&at, square) in left.iter().zip(&judged.squares_around) {
            usual[at as usize] = SPACING * square.sqrt();
        }
        for (spacing, usual) in self.spacings.iter_mut().zip(usual) {
            if *spacing > usual {
                *spacing = usual * (usual / *spacing);
            }
        }
        self.is_scatter.fill(true);
        for (fit, &at) in scales.fits.iter().zip(left) {
            self.normals[at as usize] = fit.normal;
        }
        for (&at, point) in places.iter().zip(oriented) {
            let at = left[at as usize] as usize;
            self.positions[at] = point.position;
            self.normals[at] = point.normal;
            self.is_scatter[at] = false;
        }
    }
}

#[cfg(test)]
mod tests;
