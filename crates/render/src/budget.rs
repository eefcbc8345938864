//! How much of a wave one dispatch may do, so that none runs away.
//!
//! A ray that has spent its share goes on in the next pass with the same bits, whatever the share is; the
//! tests `a_cell_with_too_many_points_for_one_pass_is_finished_in_the_next` and
//! `any_budget_gives_the_same_bytes` hold that.

use gpu::{DeviceInfo, DeviceKind};

/// Loop iterations that a ray may spend in one pass, at most. lavapipe silently stops all loops of a shader
/// group at 65 535 iterations; eight rays share that count there, and each may go 64 over its share.
const MOST: u32 = 7_000;
/// Enough for any ray to get on: two batches of points.
const LEAST: u32 = 64;
/// Where a device is not known yet.
const FIRST: u32 = 1_000;
/// Milliseconds that a pass should take on a GPU, where others wait for it: a picture on a screen, a
/// watchdog of seconds.
const LONG: f64 = 50.0;

/// Loop iterations that a ray may spend in one pass; of a GPU, adapted to how long passes take.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Budget {
    work: u32,
    adapts: bool,
}

impl Budget {
    /// For a device. A processor gets the most at once: nothing waits for it, and a pass costs it a look at
    /// every ray.
    pub fn of(device: &DeviceInfo) -> Self {
        match device.kind {
            DeviceKind::Cpu => Self { work: MOST, adapts: false },
            _ => Self { work: FIRST, adapts: true },
        }
    }

    /// The same share for every pass.
    pub fn fixed(work: u32) -> Self {
        Self { work: work.clamp(LEAST, MOST), adapts: false }
    }

    /// What the next pass may spend on a ray.
    pub fn work(self) -> u32 {
        self.work
    }

    /// After a pass of so many milliseconds, that some rays `outlived` or none: half where it took long, twice where
    /// it did not take a quarter of that and was cut short. Without timestamps a pass takes 0.
    pub fn passed(&mut self, milliseconds: f64, outlived: bool) {
        if !self.adapts || milliseconds <= 0.0 {
            return;
        }
        if milliseconds > LONG {
            self.work = (self.work / 2).max(LEAST);
        } else if outlived && milliseconds < LONG / 4.0 {
            self.work = (self.work * 2).min(MOST);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_passes_halve_the_share_and_short_ones_double_it_within_bounds() {
        let mut budget = Budget { work: FIRST, adapts: true };
        budget.passed(60.0, true);
        assert_eq!(budget.work(), FIRST / 2);
        budget.passed(30.0, true);
        budget.passed(1.0, false); // over by itself
        budget.passed(0.0, true); // not timed
        assert_eq!(budget.work(), FIRST / 2);
        budget.passed(1.0, true);
        assert_eq!(budget.work(), FIRST);
        for _ in 0..20 {
            budget.passed(1.0, true);
        }
        assert_eq!(budget.work(), MOST);
        for _ in 0..20 {
            budget.passed(1e3, true);
        }
        assert_eq!(budget.work(), LEAST);
        let mut fixed = Budget::fixed(0);
        fixed.passed(1e3, true);
        assert_eq!(fixed.work(), LEAST);
    }
}
