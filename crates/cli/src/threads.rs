//! How many threads work: `--threads`, or one a core.

use crate::limits::{self, Limit};
use rayon::ThreadPoolBuilder;
use std::sync::{Arc, Mutex, OnceLock};
use std::thread::{self, Builder};

/// Four times the stack of a thread.
const THREAD_BYTES: u64 = 8 << 20;

static COUNT: OnceLock<usize> = OnceLock::new();

/// How many threads compute at once.
pub fn count() -> usize {
    let all = || thread::available_parallelism().map_or(1, Into::into);
    COUNT.get().copied().unwrap_or_else(all)
}

/// Follows `--threads`. To be called before any other thread starts, so that it reaches software drivers, too.
pub fn start(asked: Option<usize>) {
    if let Some(asked) = asked {
        // False only where the system hides how many threads there are: the driver then takes all cores.
        let _ = gpu::process::set_driver_threads(asked);
    }
    let wanted = asked.unwrap_or_else(count);
    let possible = possible(wanted.min(with_room()));
    let _ = COUNT.set(possible.max(1));
    let pool = ThreadPoolBuilder::new()
        .num_threads(possible.max(1))
        .thread_name(|index| format!("worker-{index}"));
    // Where the system has no thread to give, the one that there is does all.
    let pool = if possible == 0 { pool.use_current_thread() } else { pool };
    // Fails where a pool was made already, or where threads were taken by others meanwhile.
    let _ = pool.build_global();
}

/// How many threads the process's own limits of memory have room for, with most of it left for other things. Threads for
/// which there is barely room fail at their start, in ways that end the process.
fn with_room() -> usize {
    let rooms = limits::rooms().into_iter();
    let own = rooms.filter(|room| matches!(room.limit, Limit::AddressSpace | Limit::Data));
    let threads = own.map(|room| room.free / THREAD_BYTES).min();
    threads.and_then(|threads| usize::try_from(threads).ok()).unwrap_or(usize::MAX)
}

/// How many of so many threads the system has to give: under a limit of memory or of processes, fewer.
fn possible(wanted: usize) -> usize {
    let gate = Arc::new(Mutex::new(()));
    let threads: Vec<_> = {
        // All wait here until the last has started.
        let _closed = gate.lock();
        let wait = |_| {
            let gate = Arc::clone(&gate);
            Builder::new().spawn(move || drop(gate.lock())).ok()
        };
        (0..wanted).map_while(wait).collect()
    };
    let started = threads.len();
    for thread in threads {
        // Nothing in it panics.
        let _ = thread.join();
    }
    started
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_few_threads_are_possible() {
        assert_eq!(possible(3), 3);
    }
}
