//! What is no surface: strays, mixed pixels, and neighbourhoods that no surface goes through.

use super::FAN;
use super::fit::Fit;
use super::near::{Near, Scratch};
use super::scales::Scales;
use rayon::prelude::*;

/// A residual over this share of h: the points fill space.
const BLOB: f32 = 0.25;
/// A point that lies so many residuals off the surface of its neighbours is none of its points.
const FAR_OFF: f32 = 3.5;
/// Every so many points one stands for those around it.
const EVERY: usize = 64;
/// So many of those are asked: some 4000 points around.
const ASKED: usize = 64;
/// A point is scatter where its residual and its spacing are over so many times the medians of those.
const NOISIER: f32 = 4.0;
const SPARSER: f32 = 2.0;
/// Or, where its spacing is over so many times their median, by less: its residual is over so many times theirs, or over
/// this share of h. Mixed pixels beside an edge are a sheet, but a thick and sparse one.
const SPARSE: f32 = 2.5;
const NOISY: f32 = 1.5;
const THICK: f32 = 0.15;

/// What fits say of points.
pub(super) struct Judged {
    /// Which are scatter.
    pub is_scatter: Vec<bool>,
    /// The median of h16² around each.
    pub squares_around: Vec<f32>,
}

/// Judges points by their fits. `squares`: h16².
pub(super) fn by_fits(near: &Near<'_>, scales: &Scales, squares: &[f32]) -> Judged {
    let fits = &scales.fits;
    let standing: Vec<usize> = (0..near.points.len()).step_by(EVERY).collect();
    let few: Vec<[f32; 3]> = standing.iter().map(|&at| near.points[at]).collect();
    let sparse = Near::new(&few);
    let mut judged = Judged {
        is_scatter: vec![false; near.points.len()],
        squares_around: vec![0.0; near.points.len()],
    };
    let chunks = judged.is_scatter.par_chunks_mut(FAN);
    let chunks = chunks.zip(judged.squares_around.par_chunks_mut(FAN)).enumerate();
    let judge =
        |medians: &mut Medians,
         (group, (is_scatter, around)): (usize, (&mut [bool], &mut [f32]))| {
            let places = near.group(group);
            // The first of the group asks for all.
            let [s, square] = medians.around(
                &sparse,
                near.points[places.start],
                |of, which| {
                    let at = standing[of];
                    if which == 0 { fits[at].s } else { squares[at] }
                },
                places.start / EVERY,
            );
            for (at, is_scatter) in places.zip(is_scatter) {
                *is_scatter = scales.fills_space[at] || by_fit(&fits[at], squares[at], [s, square]);
            }
            around.fill(square);
        };
    chunks.with_min_len(64).for_each_init(Medians::default, judge);
    judged
}

/// Whether a point is scatter by its fit and h16², with the medians of residuals and h16² around.
pub(super) fn by_fit(fit: &Fit, square: f32, [s_around, square_around]: [f32; 2]) -> bool {
    let off = fit.foot.iter().map(|x| x * x).sum::<f32>().sqrt();
    fit.s > BLOB * fit.h
        || off > FAR_OFF * fit.s
        || (fit.s > NOISIER * s_around && square > SPARSER * SPARSER * square_around)
        || ((fit.s > NOISY * s_around || fit.s > THICK * fit.h)
            && square > SPARSE * SPARSE * square_around)
}

#[derive(Default)]
struct Medians {
    scratch: Scratch,
    values: Vec<f32>,
}

impl Medians {
    /// The medians of two values of the points of `sparse` that are nearest to a position; `like` is the place of one of
    /// them that is near.
    fn around(
        &mut self,
        sparse: &Near<'_>,
        center: [f32; 3],
        value: impl Fn(usize, usize) -> f32,
        like: usize,
    ) -> [f32; 2] {
        let count = sparse.points.len();
        let k = ASKED.min(count);
        // The k nearest of a position are within the reach of those of a point near it and the way there.
        let radius = if k == count {
            f32::MAX.sqrt()
        } else {
            let bound = sparse.bound(like, k, &mut self.scratch).unwrap_or(f32::MAX).sqrt();
            bound + super::near::square(center, sparse.points[like]).sqrt()
        };
        sparse.gather_around(center, radius, &mut self.scratch);
        self.scratch.measure(center);
        let farthest = self.scratch.nth(k - 1);
        [0, 1].map(|which| {
            self.values.clear();
            for (entry, _) in self.scratch.within(farthest) {
                self.values.push(value(self.scratch.places[entry] as usize, which));
            }
            let middle = self.values.len() / 2;
            *self.values.select_nth_unstable_by(middle, f32::total_cmp).1
        })
    }
}
