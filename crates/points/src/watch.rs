//! Progress out of, and interruption into, work that takes long.

/// Whoever waits for the work: shows progress, and may ask for an end.
pub trait Watch: Sync {
    /// A stage begins; `total` is how many units it has.
    fn stage(&self, name: &'static str, total: u64);
    /// How many units of the stage are done.
    fn done(&self, units: u64);
    /// Whether the work should stop where it is.
    fn interrupted(&self) -> bool;
}

/// Nobody waits.
#[derive(Debug, Clone, Copy, Default)]
pub struct Unwatched;

impl Watch for Unwatched {
    fn stage(&self, _: &'static str, _: u64) {}
    fn done(&self, _: u64) {}
    fn interrupted(&self) -> bool {
        false
    }
}
