//! How far each point has to look around for a normal that noise hardly moves.

use super::fit::{Fit, Neighborhood};
use super::near::{Near, Scratch};
use super::{FAN, Smoothing};
use rayon::prelude::*;

/// Neighbours of each level.
pub(super) const LEVELS: [usize; 5] = [16, 32, 64, 128, 256];
/// Neighbours that the local spacing is measured by.
pub(super) const NEAREST: usize = LEVELS[0];
/// The square root of two, which a radius grows by where neighbours on a surface double, and a little more.
const GROWTH: f32 = 1.5;
/// Around a radius that is guessed from that of another level.
const GROWTH_AGAIN: f32 = 1.25;
/// Where h grows by over so much to twice the neighbours, these lie across a gap. Along a line it doubles.
const GAP: f32 = 3.0;
/// What the residual of pure noise grows by at most from level to level, with what few neighbours scatter it by.
const NOISE_GROWTH: f32 = 1.22;
const NOISE_SCATTER: f32 = 1.5;
/// A residual over this share of h is that of a blob, which no feature explains.
const BLOB: f32 = 0.2;
/// Not even in space it grows by so much: there is another sheet.
const JUMP: f32 = 2.0;
/// A residual under this share of h is that of a surface without noise.
const TINY: f32 = 0.02;

/// Points fill space where the residual is over this share of h, and grew by over so much from a quarter of the
/// neighbours, in the median of the points around: 4^(1/3), what h grows by in space. Noise on a surface stays (measured:
/// 1.0 to 1.3; trees 1.75).
const FILLED: f32 = 0.12;
const FILLED_GROWTH: f32 = 1.65;
/// Points that are fitted before progress is shown, and the share of the time that first fits take.
const BATCH: usize = 1 << 17;
const FIRST_FITS: f64 = 0.75;

/// The nearest others of each point, with the squared distance to the last.
pub(super) struct Nearest {
    pub squares: Vec<f32>,
    pub lists: Vec<[u32; NEAREST]>,
}

impl Nearest {
    /// Of more points than [`NEAREST`]. `index`: a point's place in its file, by which ties go.
    pub fn of(near: &Near<'_>, index: impl Fn(usize) -> u32 + Sync) -> Self {
        let count = near.points.len();
        let mut nearest = Self { squares: vec![0.0; count], lists: vec![[0; NEAREST]; count] };
        nearest.search(near, &index, |_| true);
        nearest
    }

    /// Of some of the points, whose places ascend; `near` has these. Only those look again that lost one of theirs.
    pub fn of_some(
        &self,
        near: &Near<'_>,
        places: &[u32],
        index: impl Fn(usize) -> u32 + Sync,
    ) -> Self {
        let mut place_now = vec![u32::MAX; self.squares.len()];
        for (now, &before) in (0..).zip(places) {
            place_now[before as usize] = now;
        }
        let squares = places.iter().map(|&before| self.squares[before as usize]).collect();
        let list = |&before: &u32| self.lists[before as usize].map(|at| place_now[at as usize]);
        let lists: Vec<[u32; NEAREST]> = places.par_iter().map(list).collect();
        let has_lost: Vec<bool> = lists.iter().map(|list| list.contains(&u32::MAX)).collect();
        let mut nearest = Self { squares, lists };
        nearest.search(near, &index, |at| has_lost[at]);
        nearest
    }

    fn search(
        &mut self,
        near: &Near<'_>,
        index: &(impl Fn(usize) -> u32 + Sync),
        looks: impl Fn(usize) -> bool + Sync,
    ) {
        let squares = self.squares.par_chunks_mut(FAN);
        let groups = squares.zip(self.lists.par_chunks_mut(FAN)).enumerate();
        groups.with_min_len(64).for_each_init(
            || (Scratch::default(), Vec::new()),
            |(scratch, found), (group, (squares, lists))| {
                let places = near.group(group);
                let looking = places.clone().filter(|&at| looks(at));
                let bounds = looking.map(|at| near.bound(at, NEAREST, scratch));
                let radius = bounds.flatten().fold(0.0, f32::max).sqrt();
                if radius == 0.0 {
                    return;
                }
                near.gather(group, radius, scratch);
                for ((at, to), list) in places.zip(squares).zip(lists) {
                    if !looks(at) {
                        continue;
                    }
                    let Some(farthest) = near.select(at, NEAREST, radius, scratch) else {
                        unreachable!("more points than {NEAREST}")
                    };
                    *to = farthest;
                    found.clear();
                    found.extend(scratch.within(farthest).map(|(entry, square)| {
                        let place = scratch.places[entry];
                        (square.to_bits(), place)
                    }));
                    found.retain(|&(_, place)| place as usize != at);
                    if found.len() > NEAREST {
                        found.sort_unstable_by_key(|&(bits, place)| (bits, index(place as usize)));
                    }
                    for (entry, &(_, place)) in list.iter_mut().zip(found.iter()) {
                        *entry = place;
                    }
                }
            },
        );
    }

    /// Values of a point and of its list.
    fn with_others<T: Copy>(&self, at: usize, value: impl Fn(usize) -> T) -> [T; NEAREST + 1] {
        let mut values = [value(at); NEAREST + 1];
        for (entry, &other) in values[1..].iter_mut().zip(&self.lists[at]) {
            *entry = value(other as usize);
        }
        values
    }

    /// The distance to the last of each point, over the median of that of its neighbours.
    pub fn ratio(&self, at: usize) -> f32 {
        let mut around = self.lists[at].map(|other| self.squares[other as usize]);
        around.sort_unstable_by(f32::total_cmp);
        // The median of sixteen: the mean of the two in the middle.
        let middle = 0.5 * (around[NEAREST / 2 - 1].sqrt() + around[NEAREST / 2].sqrt());
        if middle > 0.0 { self.squares[at].sqrt() / middle } else { f32::INFINITY }
    }
}

/// The fit of each point at its level.
pub(super) struct Scales {
    pub fits: Vec<Fit>,
    /// Whether the points around fill space, as those of leaves do.
    pub fills_space: Vec<bool>,
}

impl Scales {
    /// `on` takes the share that is done, and says whether to go on; `None` where it does not.
    pub fn of(
        near: &Near<'_>,
        nearest: &Nearest,
        smoothing: &Smoothing,
        on: &dyn Fn(f64) -> bool,
    ) -> Option<Self> {
        let count = near.points.len();
        let mut reached = vec![Reached::default(); count];
        let batches = reached.chunks_mut(BATCH).zip((0..).step_by(BATCH / FAN));
        for (batch, first) in batches {
            let each = |worker: &mut Worker, (at, reached): (usize, &mut [Reached])| {
                worker.fit_group(near, nearest, first + at, smoothing, reached);
            };
            let groups = batch.par_chunks_mut(FAN).enumerate().with_min_len(16);
            groups.for_each_init(Worker::default, each);
            if !on(FIRST_FITS * (first * FAN + BATCH) as f64 / count.max(BATCH) as f64) {
                return None;
            }
        }
        // The median of a point and its neighbours.
        let level = |at: usize| {
            let own = &reached[at];
            let around = nearest.with_others(at, |at| reached[at].level);
            let median = nth(around, u8::cmp);
            if median <= own.fitted { median } else { own.level }
        };
        let places = || (0..count).into_par_iter().with_min_len(512);
        let levels: Vec<u8> = places().map(level).collect();
        // Where that is another level, once more at that one.
        let fit = |worker: &mut Worker, at: usize| {
            let own = &reached[at];
            if levels[at] == own.level {
                return own.fit;
            }
            let [k, known] = [levels[at], own.level].map(|level| LEVELS[usize::from(level)]);
            let radius = own.fit.h * GROWTH_AGAIN * (k as f32 / known as f32).sqrt();
            worker.fit_within(near, at, k, radius)
        };
        let fits: Vec<Fit> = places().map_init(Worker::default, fit).collect();
        let fills = |at: usize| {
            let growth = || nth(nearest.with_others(at, |at| reached[at].growth), f32::total_cmp);
            fits[at].s > FILLED * fits[at].h && growth() > FILLED_GROWTH
        };
        let fills_space = places().map(fills).collect();
        on(1.0).then_some(Self { fits, fills_space })
    }
}

/// The median of a point and its neighbours.
fn nth<T: Copy>(mut values: [T; NEAREST + 1], order: impl Fn(&T, &T) -> std::cmp::Ordering) -> T {
    values.sort_unstable_by(order);
    values[NEAREST / 2]
}

/// Where a point got to.
#[derive(Debug, Clone, Copy, Default)]
struct Reached {
    fit: Fit,
    /// The level of that, and the highest that was fitted.
    level: u8,
    fitted: u8,
    growth: f32,
}

/// One point on its way through the levels.
struct Climb {
    /// Squared distance to the k-th nearest of the last level.
    square: f32,
    fits: [Fit; LEVELS.len()],
    /// The level that is right, once it is known.
    right: Option<usize>,
    /// Levels in a row whose error is small enough.
    good: usize,
    fitted: usize,
    done: bool,
}

impl Climb {
    fn new(square: f32) -> Self {
        let fits = [Fit::default(); LEVELS.len()];
        Self { square, fits, right: None, good: 0, fitted: 0, done: false }
    }

    fn level(&self) -> u8 {
        self.right.unwrap_or(self.fitted) as u8
    }

    /// What the residual grew by over the last two levels; nothing where these reach over a feature.
    fn growth(&self) -> f32 {
        let is_feature = self.right.is_some_and(|right| right + 1 == self.fitted);
        match self.fitted.checked_sub(2) {
            Some(below) if !is_feature => {
                self.fits[self.fitted].s / self.fits[below].s.max(f32::MIN_POSITIVE)
            }
            _ => 1.0,
        }
    }

    /// The last level is the highest that is on one side of a gap.
    fn end(&mut self) {
        self.right = Some(self.fitted);
        self.done = true;
    }

    fn result(&self) -> Fit {
        self.fits[usize::from(self.level())]
    }

    fn judge(&mut self, level: usize, fit: Fit, smoothing: &Smoothing) {
        self.fits[level] = fit;
        self.fitted = level;
        if level > 0 {
            let below = self.fits[level - 1];
            let growth = NOISE_GROWTH + NOISE_SCATTER / (LEVELS[level - 1] as f32).sqrt();
            // The residual grows with the reach, and the neighbourhood is no blob; or it jumps: a feature, not noise.
            let grows = fit.s > growth * below.s && fit.s < BLOB * fit.h;
            let jumps = (grows || fit.s > JUMP * below.s) && below.s > TINY * below.h;
            // Of steps, what is left over grows until several are in reach.
            let is_feature = jumps && !smoothing.agreed;
            if is_feature {
                self.right = Some(level - 1);
                self.done = true;
                return;
            }
        }
        self.good = if fit.error < smoothing.accuracy { self.good + 1 } else { 0 };
        let agreeing = usize::from(smoothing.agreed);
        if self.good > agreeing {
            self.right = Some(level - agreeing);
            self.done = true;
        }
    }
}

/// What a thread fits with.
#[derive(Default)]
pub(super) struct Worker {
    scratch: Scratch,
    neighborhood: Neighborhood,
}

impl Worker {
    /// The fits of a group.
    fn fit_group(
        &mut self,
        near: &Near<'_>,
        nearest: &Nearest,
        group: usize,
        smoothing: &Smoothing,
        reached: &mut [Reached],
    ) {
        let start = |at: usize| Climb::new(nearest.squares[at]);
        let mut climbs: Vec<Climb> = near.group(group).map(start).collect();
        for level in 0..LEVELS.len() {
            self.climb(near, group, level, &mut climbs, smoothing);
        }
        for (climb, reached) in climbs.iter().zip(reached) {
            *reached = Reached {
                fit: climb.result(),
                level: climb.level(),
                fitted: climb.fitted as u8,
                growth: climb.growth(),
            };
        }
    }

    /// One level of a group.
    fn climb(
        &mut self,
        near: &Near<'_>,
        group: usize,
        level: usize,
        climbs: &mut [Climb],
        smoothing: &Smoothing,
    ) {
        let k = LEVELS[level];
        if near.points.len() <= k {
            climbs.iter_mut().for_each(|climb| climb.done = true);
            return;
        }
        let growth = if level == 0 { 1.0 } else { GROWTH };
        let reach = |climb: &Climb| climb.square.sqrt() * growth;
        let active = climbs.iter().filter(|climb| !climb.done);
        let radius = active.map(reach).fold(0.0, f32::max);
        if radius == 0.0 {
            return;
        }
        near.gather(group, radius, &mut self.scratch);
        let mut missed = [false; FAN];
        for ((at, climb), missed) in near.group(group).zip(climbs.iter_mut()).zip(&mut missed) {
            if climb.done {
                continue;
            }
            match near.select(at, k, radius, &mut self.scratch) {
                Some(square) => self.take(near, at, square, climb, level, smoothing),
                None => *missed = true,
            }
        }
        for ((at, climb), missed) in near.group(group).zip(climbs.iter_mut()).zip(missed) {
            if missed {
                let square = self.search_alone(near, at, k, radius);
                self.take(near, at, square, climb, level, smoothing);
            }
        }
    }

    fn take(
        &mut self,
        near: &Near<'_>,
        at: usize,
        square: f32,
        climb: &mut Climb,
        level: usize,
        smoothing: &Smoothing,
    ) {
        if level > 0 && square > GAP * GAP * climb.square {
            climb.end();
            return;
        }
        climb.square = square;
        let fit = self.fit(near.points[at], square);
        climb.judge(level, fit, smoothing);
    }

    /// Searches for one point, wider and wider.
    fn search_alone(&mut self, near: &Near<'_>, at: usize, k: usize, radius: f32) -> f32 {
        let bound = near.bound(at, k, &mut self.scratch);
        let most = bound.unwrap_or(f32::INFINITY).sqrt();
        let mut radius = radius;
        loop {
            radius = (radius * GROWTH).min(most);
            near.gather_around(near.points[at], radius, &mut self.scratch);
            if let Some(square) = near.select(at, k, radius, &mut self.scratch) {
                return square;
            }
        }
    }

    /// The fit of one point to its k nearest others, of which there are so many, and most likely within a radius.
    fn fit_within(&mut self, near: &Near<'_>, at: usize, k: usize, radius: f32) -> Fit {
        near.gather_around(near.points[at], radius, &mut self.scratch);
        let found = near.select(at, k, radius, &mut self.scratch);
        let square = found.unwrap_or_else(|| self.search_alone(near, at, k, radius));
        self.fit(near.points[at], square)
    }

    /// The distance of one point to its k-th nearest other; `None` where there are fewer.
    pub fn reach(&mut self, near: &Near<'_>, at: usize, k: usize) -> Option<f32> {
        let bound = near.bound(at, k, &mut self.scratch)?.sqrt();
        near.gather_around(near.points[at], bound, &mut self.scratch);
        Some(near.select(at, k, bound, &mut self.scratch)?.sqrt())
    }

    /// The others within a distance of the point that was asked about last.
    pub fn others(&self, at: usize, reach: f32) -> Vec<usize> {
        let within = self.scratch.within(reach * reach * (1.0 + 1e-6));
        let places = within.map(|(entry, _)| self.scratch.places[entry] as usize);
        places.filter(|&place| place != at).collect()
    }

    /// The fit of one point at its own level.
    pub fn fit_of(&mut self, near: &Near<'_>, at: usize, smoothing: &Smoothing) -> Fit {
        let mut climb = Climb::new(0.0);
        for (level, &k) in LEVELS.iter().enumerate() {
            if climb.done {
                break;
            }
            match self.fit_alone(near, at, k) {
                Some(fit) if level > 0 && fit.h > GAP * climb.fits[level - 1].h => climb.end(),
                Some(fit) => climb.judge(level, fit, smoothing),
                None => break,
            }
        }
        climb.result()
    }

    /// The fit of one point to its k nearest others; `None` where there are fewer.
    pub fn fit_alone(&mut self, near: &Near<'_>, at: usize, k: usize) -> Option<Fit> {
        let bound = near.bound(at, k, &mut self.scratch)?;
        near.gather_around(near.points[at], bound.sqrt(), &mut self.scratch);
        let square = near.select(at, k, bound.sqrt(), &mut self.scratch)?;
        Some(self.fit(near.points[at], square))
    }

    /// The fit to what is listed within a squared distance, which is measured.
    fn fit(&mut self, center: [f32; 3], limit: f32) -> Fit {
        let h = limit.sqrt();
        if h < super::SMALLEST {
            return Fit::default();
        }
        let inverse = 1.0 / h;
        self.neighborhood.clear();
        for (entry, _) in self.scratch.within(limit) {
            let position = self.scratch.position(entry);
            let offset = [0, 1, 2].map(|axis| (position[axis] - center[axis]) * inverse);
            self.neighborhood.push(offset);
        }
        self.neighborhood.fit(h)
    }
}
