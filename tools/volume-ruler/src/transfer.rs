//! The transfer function between two scalars, integrated (docs/method.md, Eq. 15), in f64.

use kernels::layout::{VolumeInfo, VolumeStop};
use plan::Volumes;

/// What is sent along the ray per length, in three channels, and the extinction.
pub type Shown = [f64; 4];

/// Of second degree between stops, constant beyond the outer ones.
pub struct Transfer {
    values: Vec<f64>,
    /// One more than stops: before the first, between, after the last.
    pieces: Vec<Piece>,
    /// From the first stop to each.
    integrals: Vec<Shown>,
}

/// What is shown between two stops: a polynomial of the share u of the way from one to the other.
#[derive(Clone, Copy, Default)]
struct Piece {
    low: f64,
    inverse_span: f64,
    terms: [Shown; 3],
    sends: bool,
}

impl Piece {
    fn of(low: &VolumeStop, high: &VolumeStop) -> Self {
        let mut piece = Self { low: low.value.into(), ..Self::default() };
        let [extinction, extinction_high] = [low.extinction, high.extinction].map(f64::from);
        let more = extinction_high - extinction;
        let span = f64::from(high.value) - f64::from(low.value);
        piece.inverse_span = if span > 0.0 { 1.0 / span } else { 0.0 };
        piece.terms[0][3] = extinction;
        piece.terms[1][3] = more;
        for i in 0..3 {
            let [color, emission] = [low.color[i], low.emission[i]].map(f64::from);
            let change = f64::from(high.color[i]) - color;
            piece.terms[0][i] = color * extinction + emission;
            piece.terms[1][i] =
                change * extinction + color * more + f64::from(high.emission[i]) - emission;
            piece.terms[2][i] = change * more;
        }
        piece.sends = piece.terms.iter().flatten().any(|&of| of != 0.0);
        piece
    }

    /// The mean between two scalars of this piece.
    #[inline(always)]
    fn mean(&self, a: f64, b: f64) -> Shown {
        let (from, to) = ((a - self.low) * self.inverse_span, (b - self.low) * self.inverse_span);
        let (middle, width) = (0.5 * (from + to), to - from);
        let square = middle * middle + width * width * (1.0 / 12.0);
        let mut sum = self.terms[0];
        for i in 0..4 {
            sum[i] += middle * self.terms[1][i] + square * self.terms[2][i];
        }
        sum
    }
}

impl Transfer {
    pub fn of(info: &VolumeInfo, volumes: &Volumes) -> Self {
        let first = info.first_stop as usize;
        let stops = &volumes.stops[first..first + info.stop_count as usize];
        let values: Vec<f64> = stops.iter().map(|s| f64::from(s.value)).collect();
        let last = stops.len() - 1;
        let pieces: Vec<Piece> = (0..=stops.len())
            .map(|i| Piece::of(&stops[i.max(1) - 1], &stops[i.min(last)]))
            .collect();
        let mut integrals = vec![[0.0; 4]];
        for i in 1..stops.len() {
            let mean = pieces[i].mean(values[i - 1], values[i]);
            let before: Shown = integrals[i - 1];
            let length = values[i] - values[i - 1];
            integrals.push([0, 1, 2, 3].map(|c| before[c] + mean[c] * length));
        }
        Self { values, pieces, integrals }
    }

    /// How many stops are at a scalar or below it.
    #[inline(always)]
    fn piece(&self, scalar: f64) -> usize {
        if self.values.len() > 16 {
            return self.values.partition_point(|&value| value <= scalar);
        }
        self.values.iter().map(|&value| usize::from(value <= scalar)).sum()
    }

    /// The mean over all scalars between two; `None` where nothing is sent.
    #[inline(always)]
    pub fn mean(&self, a: f64, b: f64) -> Option<Shown> {
        let (low, high) = (a.min(b), a.max(b));
        let (lower, upper) = (self.piece(low), self.piece(high));
        if lower == upper {
            let piece = &self.pieces[lower];
            return piece.sends.then(|| piece.mean(low, high));
        }
        if !self.pieces[lower..=upper].iter().any(|piece| piece.sends) {
            return None;
        }
        let (end, begin) = (self.values[lower], self.values[upper - 1]);
        let one = self.pieces[lower].mean(low, end);
        let other = self.pieces[upper].mean(begin, high);
        let (from, to) = (&self.integrals[lower], &self.integrals[upper - 1]);
        let inverse = 1.0 / (high - low);
        let mut mean = [0.0; 4];
        for i in 0..4 {
            let ends = one[i] * (end - low) + other[i] * (high - begin);
            mean[i] = (ends + (to[i] - from[i])) * inverse;
        }
        Some(mean)
    }
}
