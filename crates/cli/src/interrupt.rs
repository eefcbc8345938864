//! Ctrl-C, SIGTERM and SIGHUP.
//!
//! The first signal asks work that looks for it (see [`held`]) to stop; anything else has nothing to
//! clean up and ends at once, or as soon as threads [`beside`] it may be cut off. The second signal ends the
//! process at once, but lets a file that is being written be finished, for two seconds: half-written files are
//! never left behind.

use crate::errors::{Exit, Failure};
use crate::{console, temporary};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::mpsc;
use std::time::Duration;

static REQUESTED: AtomicBool = AtomicBool::new(false);
/// Pieces of work under way that look at `REQUESTED`, or that must not be cut off.
static HELD: AtomicU32 = AtomicU32::new(0);
/// Files being written.
static WRITING: AtomicU32 = AtomicU32::new(0);

/// Whether the line that says so is written.
static SAID: AtomicBool = AtomicBool::new(false);
/// How long a reader of stderr that takes nothing may hold up the end.
const PATIENCE: Duration = Duration::from_millis(500);

/// Whether the caller is to write the line that says that the process was interrupted: once.
pub fn is_to_be_said() -> bool {
    !SAID.swap(true, Ordering::SeqCst)
}

/// Takes over the signals.
pub fn install() -> Result<(), Failure> {
    ctrlc::set_handler(|| {
        let again = REQUESTED.swap(true, Ordering::SeqCst);
        if again {
            // A file is written in moments; one that never ends must not hold the user up.
            for _ in 0..200 {
                if WRITING.load(Ordering::SeqCst) == 0 {
                    break;
                }
                std::thread::sleep(Duration::from_millis(10));
            }
        } else if HELD.load(Ordering::SeqCst) > 0 {
            return;
        }
        end();
    })
    .map_err(|error| Failure::exhausted(format!(
            "the thread that waits for interruptions cannot start: {error}; raise the limits of memory and processes"
        )))
}

/// Whether an end was asked for.
pub fn requested() -> bool {
    REQUESTED.load(Ordering::SeqCst)
}

/// Runs work that ends soon after [`requested`] turns true.
pub fn held<T>(work: impl FnOnce() -> Result<T, Failure>) -> Result<T, Failure> {
    let held = Counted::new(&HELD);
    let result = work();
    if requested() {
        // It counts to the end, which its caller goes to now: nobody else may end the process meanwhile.
        std::mem::forget(held);
        return result.and(Err(Failure::interrupted()));
    }
    result
}

/// Runs short work of a thread beside the one that does what the user asked for: it is not cut off, and ends the
/// process where an end was asked for meanwhile and no other work will see to it. `None` once an end was asked for.
pub fn beside<T>(work: impl FnOnce() -> T) -> Option<T> {
    let held = Counted::new(&HELD);
    // Looked at once it is held: whoever ends the process sees the one or lets this see the other.
    let result = (!requested()).then(work);
    drop(held);
    if requested() && HELD.load(Ordering::SeqCst) == 0 {
        end();
    }
    result
}

/// Says that what the user asked for is done, or has failed: what is left is taking down the driver, in which a process
/// that ends may crash. A signal changes nothing from now on; the second ends the process all the same.
pub fn finished() {
    std::mem::forget(Counted::new(&HELD));
}

fn end() -> ! {
    if is_to_be_said() {
        let (said, is_said) = mpsc::channel();
        let says = move || {
            console::clear_bar();
            console::errors(&Failure::interrupted());
            // Nobody waits for it any more where this took long.
            let _ = said.send(());
        };
        if std::thread::Builder::new().spawn(says).is_ok() {
            let _ = is_said.recv_timeout(PATIENCE);
        }
    }
    film::remove_unfinished();
    temporary::remove_all();
    std::process::exit(i32::from(Exit::Interrupted.code()))
}

/// Runs work that writes a file.
pub fn writing<T>(work: impl FnOnce() -> Result<T, Failure>) -> Result<T, Failure> {
    held(|| {
        let _writing = Counted::new(&WRITING);
        if requested() { Err(Failure::interrupted()) } else { work() }
    })
}

/// Runs work that writes a file of what there is, also where an end was asked for: the second signal waits for it.
pub fn keeping<T>(work: impl FnOnce() -> Result<T, Failure>) -> Result<T, Failure> {
    let _writing = Counted::new(&WRITING);
    work()
}

/// Counts itself, also while a panic unwinds.
struct Counted(&'static AtomicU32);

impl Counted {
    fn new(counter: &'static AtomicU32) -> Self {
        counter.fetch_add(1, Ordering::SeqCst);
        Self(counter)
    }
}

impl Drop for Counted {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::SeqCst);
    }
}
