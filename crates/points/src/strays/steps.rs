//! How far the search for strays is.

use crate::watch::Watch;

/// Shares of the time after which points are placed, sorted, and their surroundings bounded, measured with six
/// million; the rest is searches.
pub(super) const PLACED: f64 = 0.05;
pub(super) const SORTED: f64 = 0.6;
pub(super) const BOUNDED: f64 = 0.9;

/// Shows how far the search for strays is.
pub(super) struct Steps<'a> {
    pub(super) watch: &'a dyn Watch,
    pub(super) before: u64,
    pub(super) points: u64,
}

impl Steps<'_> {
    /// This share of the work is done; `None` where an end is asked for.
    pub(super) fn reach(&self, share: f64) -> Option<()> {
        self.watch.done(self.before + (share * self.points as f64) as u64);
        (!self.watch.interrupted()).then_some(())
    }
}
