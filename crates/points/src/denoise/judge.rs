//! Whether a set has noise, and of which kind, by a thousand of its points.

use super::fit::Fit;
use super::near::{Near, Scratch};
use super::scales::{LEVELS, Worker};
use rayon::prelude::*;

/// Points that are looked at.
const SAMPLE: usize = 1000;
/// Sets of fewer points say nothing about noise.
const FEWEST: usize = 64;
/// Normals whose median expected error at the first level is under this are right as they are, in radians: 1 degree.
const CLEAN: f32 = 1.0 / 180.0 * std::f32::consts::PI;
/// Up to this median error, residuals may be relief and no noise: where they grow with the reach, by over so much to a
/// level at which it is twice as far. The residual of noise stays; that of terrain grows as the reach does (measured:
/// noise 1.03 to 1.2, terrain 1.6 and 2.2).
const ROUGH: f32 = 2.5 / 180.0 * std::f32::consts::PI;
const RELIEF: f32 = 1.4;
const RELIEF_LEVEL: usize = 2;
/// A residual at the first level under this share of h is none: all neighbours lie on one step.
const ON_A_STEP: f32 = 0.01;
/// Over this share at the fourth level, several steps are in reach.
const OVER_STEPS: f32 = 0.03;
const WIDE: usize = 3;
/// The share of the points that this holds for in a quantised set, and of those whose steps are taken in one direction.
const QUANTISED: f32 = 0.5;
const ONE_DIRECTION: f32 = 0.9;
/// The cosine of the largest angle to that direction, 8 degrees.
const ALONG: f64 = 0.99;
/// Steps at least that the sample takes.
const STEPS: usize = 8;
/// Edge of a voxel over the median distance to the nearest other.
const EDGE: f32 = 3.5;

/// What the noise of a set is like.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Noise {
    /// None that matters: fits to 16 neighbours are good.
    Clean,
    /// Points off their surface at random.
    Random,
    /// Steps along one direction, as of a depth camera, with more points to a step than fits to 16 neighbours see. Means
    /// over voxels of this edge, of at least [`LEAST`](Noise::LEAST) points, are points with random noise.
    Quantised {
        /// In units of the positions.
        edge: f32,
    },
}

impl Noise {
    /// Points of a voxel at least.
    pub const LEAST: usize = 3;

    /// What noise distinct positions along a curve have ([`Cloud`](crate::Cloud)), without strays.
    #[must_use]
    pub fn of(points: &[[f32; 3]]) -> Self {
        Sample::of(points).map_or(Self::Clean, |sample| sample.noise())
    }
}

/// The fits of a sample.
pub(super) struct Sample<'a> {
    pub near: Near<'a>,
    /// Ascending.
    pub places: Vec<u32>,
    first: Vec<Fit>,
}

impl<'a> Sample<'a> {
    /// `None` for sets that are too small.
    pub fn of(points: &'a [[f32; 3]]) -> Option<Self> {
        let count = points.len();
        if count < FEWEST {
            return None;
        }
        let sampled = SAMPLE.min(count);
        let places = (0..sampled).map(|i| (i as u64 * count as u64 / sampled as u64) as u32);
        let mut sample = Self { near: Near::new(points), places: places.collect(), first: vec![] };
        sample.first = sample.fits(&sample.places, 0);
        Some(sample)
    }

    fn fits(&self, places: &[u32], level: usize) -> Vec<Fit> {
        let fit = |worker: &mut Worker, &at: &u32| {
            worker.fit_alone(&self.near, at as usize, LEVELS[level]).unwrap_or_default()
        };
        places.par_iter().with_min_len(16).map_init(Worker::default, fit).collect()
    }

    pub fn noise(&self) -> Noise {
        if self.is_quantised() {
            return Noise::Quantised { edge: EDGE * self.spacing() };
        }
        let error = self.error();
        let is_clean = error < CLEAN || (error < ROUGH && self.growth() > RELIEF);
        if is_clean { Noise::Clean } else { Noise::Random }
    }

    /// The median of what the residual grows by from the first to the third level, in which h doubles.
    fn growth(&self) -> f32 {
        let wide = self.fits(&self.places, RELIEF_LEVEL);
        let growth = |(wide, first): (&Fit, &Fit)| wide.s / first.s.max(f32::MIN_POSITIVE);
        median(wide.iter().zip(&self.first).map(growth).collect())
    }

    /// The median expected error at the first level.
    pub fn error(&self) -> f32 {
        median(self.first.iter().map(|fit| fit.error).collect())
    }

    /// The median distance to the nearest other.
    pub fn spacing(&self) -> f32 {
        let nearest = |scratch: &mut Scratch, &at: &u32| {
            let at = at as usize;
            let radius = self.near.bound(at, 1, scratch)?.sqrt();
            self.near.gather_around(self.near.points[at], radius, scratch);
            self.near.select(at, 1, radius, scratch)
        };
        let places = self.places.par_iter().with_min_len(16);
        let squares: Vec<f32> = places.map_init(Scratch::default, nearest).flatten().collect();
        median(squares).sqrt()
    }

    fn is_quantised(&self) -> bool {
        let steps =
            self.places.iter().zip(&self.first).filter(|(_, fit)| fit.s < ON_A_STEP * fit.h);
        let (places, fits): (Vec<u32>, Vec<Fit>) = steps.unzip();
        let enough = |count: usize| count as f32 > QUANTISED * self.places.len() as f32;
        if !enough(places.len()) {
            return false;
        }
        let wide = self.fits(&places, WIDE);
        let crosses = |wide: &Fit| wide.s > OVER_STEPS * wide.h;
        let crossing = fits.iter().zip(&places).zip(&wide).filter(|(_, wide)| crosses(wide));
        let (fits, places): (Vec<Fit>, Vec<u32>) =
            crossing.map(|((fit, place), _)| (*fit, *place)).unzip();
        if !enough(fits.len()) {
            return false;
        }
        let normals: Vec<[f32; 3]> = fits.iter().map(|fit| fit.normal).collect();
        let way = main_direction(&normals);
        let along = |normal: &&[f32; 3]| {
            let cosine: f64 = (0..3).map(|axis| f64::from(normal[axis]) * way[axis]).sum();
            cosine.abs() > ALONG
        };
        if normals.iter().filter(along).count() as f32 <= ONE_DIRECTION * normals.len() as f32 {
            return false;
        }
        // A few sheets are no steps.
        let height = |&at: &u32| -> f64 {
            let p = self.near.points[at as usize];
            (0..3).map(|axis| f64::from(p[axis]) * way[axis]).sum()
        };
        let mut heights: Vec<f64> = places.iter().map(height).collect();
        heights.sort_unstable_by(f64::total_cmp);
        let apart = f64::from(ON_A_STEP * median(fits.iter().map(|fit| fit.h).collect()));
        let steps = heights.windows(2).filter(|pair| pair[1] - pair[0] > apart).count() + 1;
        steps >= STEPS
    }
}

/// The direction that most of some unit vectors have, whatever their signs: powers of the sum of their squares.
fn main_direction(vectors: &[[f32; 3]]) -> [f64; 3] {
    let mut matrix = [[0.0; 3]; 3];
    for v in vectors {
        for (i, row) in matrix.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                *entry += f64::from(v[i]) * f64::from(v[j]);
            }
        }
    }
    let times = |v: [f64; 3]| matrix.map(|row| (0..3).map(|j| row[j] * v[j]).sum::<f64>());
    let unit = |v: [f64; 3]| {
        let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
        v.map(|x| x / length.max(f64::MIN_POSITIVE))
    };
    // Not across any axis, nor along one.
    (0..64).fold(unit([0.57, 0.6, 0.55]), |v, _| unit(times(v)))
}

/// 0 of nothing.
pub(super) fn median(mut values: Vec<f32>) -> f32 {
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f32::total_cmp).1
}
