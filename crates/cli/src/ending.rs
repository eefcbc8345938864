//! How the process ends where memory runs out in the middle of something, or a driver crashes: with one line and exit
//! code 4, and without half-written files.

use crate::errors::Exit;
use crate::log::{self, Level};
use crate::{console, limits, temporary};
use gpu::process::{self, Ending, Line, Order};
use std::fmt::{self, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, OnceLock};
use std::time::SystemTime;

/// What the program is at.
static STAGE: Mutex<&'static str> = Mutex::new("starting");
/// Whether a Vulkan driver is in the process.
static HAS_DRIVER: AtomicBool = AtomicBool::new(false);
/// By what memory is limited, in words.
static LIMIT: OnceLock<String> = OnceLock::new();

/// To be called first.
pub fn prepare() {
    if limits::limits_address_space() {
        process::share_one_heap();
    }
    if let Some(room) = limits::own() {
        let _ = LIMIT.set(format!("{} bytes {}", room.all, room.limit));
    }
    let order = Order { word, clean, code: Exit::Exhausted.code().into() };
    process::end_in_order(order);
}

fn clean() {
    film::remove_unfinished_at_once();
    temporary::remove_all_at_once();
}

/// Says what the program is at, for the line.
pub fn at(stage: &'static str) {
    if let Ok(mut at) = STAGE.lock() {
        *at = stage;
    }
}

/// Says that a Vulkan driver is in the process from now on.
pub fn driver_is_there() {
    HAS_DRIVER.store(true, Ordering::Relaxed);
}

/// Allocates nothing.
fn word(ending: Ending, line: &mut Line) {
    // A line that is cut off is better than none.
    let _ = write_line(ending, line);
}

fn write_line(ending: Ending, line: &mut Line) -> fmt::Result {
    if !log::is_json() {
        console::leave_bar(line);
        line.write_str("error: ")?;
        return write_message(ending, line);
    }
    line.write_str("{\"time\":\"")?;
    log::write_time(line, SystemTime::now())?;
    write!(line, "\",\"level\":\"{}\",\"event\":\"error\",\"message\":\"", Level::Error.name())?;
    // Nothing in the message needs to be escaped.
    write_message(ending, line)?;
    line.write_str("\"}")
}

fn write_message(ending: Ending, line: &mut Line) -> fmt::Result {
    let stage = STAGE.try_lock().map_or("working", |stage| *stage);
    let has_driver = HAS_DRIVER.load(Ordering::Relaxed);
    let limit = LIMIT.get();
    match ending {
        Ending::Memory(bytes) => {
            write!(line, "out of memory while {stage}: {bytes} bytes more could not be had")?;
        }
        Ending::Crash(signal) => {
            let name = match signal {
                6 => "SIGABRT",
                11 => "SIGSEGV",
                _ => "a signal",
            };
            write!(line, "the process crashed ({name} while {stage}), ")?;
            line.write_str(match (has_driver, limit) {
                (true, Some(_)) => "most likely since the Vulkan driver found no memory",
                (true, None) => "most likely in the Vulkan driver",
                (false, Some(_)) => "most likely since there was no memory",
                (false, None) => "which is a bug in pointillist; please report it",
            })?;
        }
    }
    if let Some(limit) = limit {
        write!(line, " (this process may have {limit} in all)")?;
    }
    line.write_str(match (ending, has_driver, limit) {
        (Ending::Crash(_), false, None) => "",
        (Ending::Crash(_), true, None) => "; update the driver, or render with --device reference",
        (_, true, Some(_)) => {
            "; raise the limit, use fewer points or a smaller picture, or render with --device reference, which \
             takes less"
        }
        (_, false, Some(_)) => "; raise the limit, or use fewer points or a smaller picture",
        (Ending::Memory(_), _, None) => {
            "; use fewer points, a smaller picture, or a machine with more memory"
        }
    })
}
