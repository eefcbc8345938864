//! Where a ray takes samples, and what it shows of the scalars there (docs/method.md, section 7).

use crate::transfer::Transfer;
use kernels::layout::VolumeInfo;

/// The optical depth through which nothing is seen.
const DEEPEST: f64 = 69.077_552_8;

/// A ray's way through the boxes of all volumes.
#[derive(Clone, Copy)]
pub struct Way {
    pub from: f64,
    pub span: f64,
    /// Places are the ends of these, and the beginning of the first.
    pub steps: u32,
}

impl Way {
    pub fn of(infos: &[VolumeInfo], step: f32, origin: [f64; 3], direction: [f64; 3]) -> Self {
        let (mut from, mut to) = (f64::MAX, 0.0f64);
        for info in infos {
            let (mut enter, mut leave) = (0.0f64, f64::MAX);
            for i in 0..3 {
                let [low, high] = [info.grid.origin[i], info.high[i]].map(f64::from);
                let inverse = 1.0 / direction[i];
                let (a, b) = ((low - origin[i]) * inverse, (high - origin[i]) * inverse);
                enter = enter.max(a.min(b));
                leave = leave.min(a.max(b));
            }
            if enter <= leave {
                from = from.min(enter);
                to = to.max(leave);
            }
        }
        let span = to - from;
        let steps = (span / f64::from(step)).ceil().max(0.0);
        Self { from, span, steps: steps as u32 }
    }

    /// Whether a place is at the border of the boxes, where nothing is in reach.
    #[inline(always)]
    pub fn is_border(&self, place: u32) -> bool {
        (place == 0 && self.from > 0.0) || place >= self.steps
    }
}

/// What a place shows of a volume.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum End {
    /// Nothing, whatever the scalar is.
    Unseen,
    /// No point is in reach.
    Unreached,
    At(f64),
}

/// What a ray has gathered.
#[derive(Debug, Clone, Copy)]
pub struct Light {
    /// The fourth is of no use.
    pub color: [f64; 4],
    pub depth: f64,
    /// e^−depth.
    pub through: f64,
}

impl Default for Light {
    fn default() -> Self {
        Self { color: [0.0; 4], depth: 0.0, through: 1.0 }
    }
}

impl Light {
    #[inline(always)]
    pub fn is_over(&self) -> bool {
        self.depth > DEEPEST
    }

    /// Goes on by a step between such ends of each volume.
    #[inline(always)]
    pub fn add(
        &mut self,
        ends: impl Iterator<Item = (End, End)>,
        transfers: &[Transfer],
        length: f64,
    ) {
        let mut sum = [0.0; 4];
        let mut any = false;
        for ((there, here), transfer) in ends.zip(transfers) {
            let (share, from, to) = match (there, here) {
                (End::At(from), End::At(to)) => (1.0, from, to),
                (End::At(s), End::Unreached) | (End::Unreached, End::At(s)) => (0.5, s, s),
                _ => continue,
            };
            let Some(seen) = transfer.mean(from, to) else { continue };
            any = true;
            for i in 0..4 {
                sum[i] += share * seen[i];
            }
        }
        if !any {
            return;
        }
        let depth = sum[3] * length;
        let lost = absorbed(depth);
        let share = if depth > 1e-12 { lost / depth } else { 1.0 } * length * self.through;
        for i in 0..4 {
            self.color[i] += sum[i] * share;
        }
        self.depth += depth;
        self.through *= 1.0 - lost;
    }
}

/// 1 − e^−x for x ≥ 0, within 1e-10 of itself below 1 and of 1 above.
#[inline(always)]
fn absorbed(x: f64) -> f64 {
    if x < 0.06 {
        let square = x * x;
        let odd = 0.5 - x * (1.0 / 6.0);
        let high = 1.0 / 24.0 - x * (1.0 / 120.0) + square * (1.0 / 720.0 - x * (1.0 / 5040.0));
        return x - square * (odd + square * high);
    }
    let n = (x * std::f64::consts::LOG2_E + 0.5) as i64 as f64;
    let r = n * std::f64::consts::LN_2 - x;
    let p = [1.0 / 362_880.0, 1.0 / 40_320.0, 1.0 / 5040.0, 1.0 / 720.0, 1.0 / 120.0, 1.0 / 24.0];
    let high = p.into_iter().fold(0.0, |sum, of| sum * r + of);
    let less = r * (1.0 + r * (0.5 + r * (1.0 / 6.0 + r * high)));
    let scale = f64::from_bits(((1023 - n.min(1000.0) as i64) as u64) << 52);
    (1.0 - scale) - scale * less
}

#[cfg(test)]
mod tests {
    use super::absorbed;

    #[test]
    fn what_is_absorbed_has_its_digits() {
        for i in 0..70_000 {
            let x = f64::from(i) * 1e-3 + 1e-9;
            let exact = -(-x).exp_m1();
            assert!((absorbed(x) / exact - 1.0).abs() < 1e-9, "{x}: {} {exact}", absorbed(x));
        }
    }
}
