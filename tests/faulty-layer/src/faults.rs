//! What fails, and when.

use ash::vk;
use std::collections::BTreeMap;
use std::env;
use std::fmt::Write;
use std::sync::{LazyLock, Mutex, MutexGuard, PoisonError};

/// What the environment asks for.
pub(crate) static ASKED: LazyLock<Asked> = LazyLock::new(|| {
    let text = env::var(crate::FAULTS).unwrap_or_default();
    text.split(',').filter(|word| !word.is_empty()).fold(Asked::default(), Asked::with)
});

static STATE: Mutex<State> = Mutex::new(State { counts: BTreeMap::new(), lost: false });

/// The faults of this process.
#[derive(Default)]
pub(crate) struct Asked {
    failing: Vec<Failing>,
    /// Version of Vulkan that devices offer.
    pub(crate) version: Option<u32>,
    /// No queue computes.
    pub(crate) no_compute: bool,
    /// No queue has a clock.
    pub(crate) no_timestamps: bool,
    /// Bytes of each heap.
    pub(crate) heap: Option<u64>,
}

struct Failing {
    call: String,
    from: u64,
    result: vk::Result,
}

struct State {
    counts: BTreeMap<&'static str, u64>,
    lost: bool,
}

impl Asked {
    /// With what a word asks for.
    fn with(mut self, word: &str) -> Self {
        match word.split_once('=') {
            None if word == "no-compute" => self.no_compute = true,
            None if word == "no-timestamps" => self.no_timestamps = true,
            Some(("version", version)) => self.version = Some(understood(parse_version(version))),
            Some(("heap", bytes)) => self.heap = Some(understood(bytes.parse().ok())),
            Some((call, result)) => self.failing.push(understood(parse_failing(call, result))),
            None => understood(None),
        }
        self
    }
}

/// A word that is none of those documented ends the process: a test that asks for it tests nothing.
fn understood<T>(parsed: Option<T>) -> T {
    parsed.unwrap_or_else(|| std::process::abort())
}

fn parse_version(text: &str) -> Option<u32> {
    let (major, minor) = text.split_once('.')?;
    Some(vk::make_api_version(0, major.parse().ok()?, minor.parse().ok()?, 0))
}

fn parse_failing(call: &str, result: &str) -> Option<Failing> {
    let (call, from) = call.split_once('@')?;
    let result = vk::Result::from_raw(result.parse().ok()?);
    Some(Failing { call: call.to_owned(), from: from.parse().ok()?, result })
}

/// Counts a call, and says what it gives instead of what it does, if anything.
pub(crate) fn fault(call: &'static str) -> Option<vk::Result> {
    let mut state = state();
    let count = state.counts.entry(call).or_default();
    let at = *count;
    *count += 1;
    let asked = ASKED.failing.iter().find(|failing| failing.call == call && at >= failing.from);
    let reports_loss = matches!(
        call,
        "vkQueueSubmit" | "vkWaitForFences" | "vkDeviceWaitIdle" | "vkGetQueryPoolResults"
    );
    let result = match asked {
        Some(failing) => failing.result,
        None if state.lost && reports_loss => vk::Result::ERROR_DEVICE_LOST,
        None => return None,
    };
    state.lost |= result == vk::Result::ERROR_DEVICE_LOST;
    Some(result)
}

/// Writes how often each call was made, where that is asked for.
pub(crate) fn report() {
    let Some(path) = env::var_os(crate::CALLS) else { return };
    let mut text = String::new();
    for (call, count) in &state().counts {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{call} {count}");
    }
    if std::fs::write(path, text).is_err() {
        std::process::abort();
    }
}

fn state() -> MutexGuard<'static, State> {
    STATE.lock().unwrap_or_else(PoisonError::into_inner)
}
