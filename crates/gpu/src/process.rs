//! What a process has to arrange for itself by `unsafe` means: an end in good order where memory runs out or a driver
//! crashes, how many threads a software driver starts, and how much address space threads reserve.
//!
//! An allocation that fails ends a Rust process with SIGABRT, and a driver that finds no memory often with SIGSEGV.
//! With [`Allocator`] as the global allocator and after [`end_in_order`], both end with an exit code and one line that
//! the program words itself ([`Ending`]).

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::ffi::{CString, OsString, c_char};
use std::fmt;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicPtr, Ordering};

/// Why the process ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ending {
    /// An allocation of so many bytes failed.
    Memory(usize),
    /// A thread met this signal: SIGSEGV, SIGBUS, SIGILL or SIGABRT.
    Crash(i32),
}

/// A line that is written without allocating.
pub struct Line {
    bytes: [u8; Self::ROOM],
    length: usize,
}

/// How the program ends in order.
#[derive(Debug, Clone, Copy)]
pub struct Order {
    /// Words the line, without its end. Allocates nothing, and waits for no lock.
    pub word: fn(Ending, &mut Line),
    /// Removes what is half done. Waits for no lock; where it needs memory and there is none, the process ends.
    pub clean: fn(),
    /// The exit code.
    pub code: i32,
}

static ORDER: OnceLock<Order> = OnceLock::new();
static ENDING: AtomicBool = AtomicBool::new(false);

thread_local! {
    /// Whether the thread deals with failed allocations itself.
    static FALLIBLE: Cell<bool> = const { Cell::new(false) };
}

/// The system's allocator, which ends the process in order where it has nothing more to give.
#[derive(Debug, Clone, Copy, Default)]
pub struct Allocator;

impl Line {
    const ROOM: usize = 2048;

    fn new() -> Self {
        Self { bytes: [0; Self::ROOM], length: 0 }
    }
}

impl fmt::Write for Line {
    /// What does not fit is left out.
    fn write_str(&mut self, text: &str) -> fmt::Result {
        let free = self.bytes.len() - self.length;
        let mut count = text.len().min(free);
        while !text.is_char_boundary(count) {
            count -= 1;
        }
        self.bytes[self.length..self.length + count].copy_from_slice(&text.as_bytes()[..count]);
        self.length += count;
        Ok(())
    }
}

impl fmt::Debug for Line {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&String::from_utf8_lossy(&self.bytes[..self.length]))
    }
}

/// Runs work in which failed allocations are values, such as those of `try_reserve`.
pub fn fallible<T>(work: impl FnOnce() -> T) -> T {
    let before = FALLIBLE.replace(true);
    let result = work();
    FALLIBLE.set(before);
    result
}

// SAFETY: every call is passed on to the system's allocator with the arguments of the caller, who keeps to the rules
// of `GlobalAlloc`; its answer is passed back as it is, or the process ends.
unsafe impl GlobalAlloc for Allocator {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as the caller promises.
        given(unsafe { System.alloc(layout) }, layout.size())
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as the caller promises.
        given(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    unsafe fn realloc(&self, place: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: as the caller promises.
        given(unsafe { System.realloc(place, layout, size) }, size)
    }

    unsafe fn dealloc(&self, place: *mut u8, layout: Layout) {
        // SAFETY: as the caller promises.
        unsafe { System.dealloc(place, layout) }
    }
}

/// What the system gave. Nothing is passed on where the thread wants to know, or where no order is set.
fn given(place: *mut u8, bytes: usize) -> *mut u8 {
    // A thread that is ending has its variables no more, and then allocates little.
    if place.is_null() && !FALLIBLE.try_with(Cell::get).unwrap_or(false) {
        end(Ending::Memory(bytes));
    }
    place
}

/// Writes the line and ends the process, if an order is set.
fn end(ending: Ending) {
    let Some(order) = ORDER.get() else { return };
    if ENDING.swap(true, Ordering::SeqCst) {
        // Another thread is at it and will end the process; or it is this one, whose cleaning found no memory.
        // Whichever: what is left is not worth more than this moment.
        platform::wait();
        platform::exit(order.code);
    }
    if matches!(ending, Ending::Crash(_)) {
        // SAFETY: it is null, or of a box that is never freed.
        if let Some(again) = unsafe { AGAIN.load(Ordering::SeqCst).as_ref() } {
            (order.clean)();
            platform::begin_anew(again);
        }
    }
    let mut line = Line::new();
    (order.word)(ending, &mut line);
    let _ = fmt::Write::write_str(&mut line, "\n");
    if line.length == Line::ROOM {
        line.bytes[Line::ROOM - 1] = b'\n';
    }
    platform::write_error(&line.bytes[..line.length]);
    (order.clean)();
    platform::exit(order.code);
}

/// From now on the process ends in this order where an allocation fails (with [`Allocator`]), or where a thread
/// crashes. Once a process; a second order changes nothing.
pub fn end_in_order(order: Order) {
    if ORDER.set(order).is_ok() {
        platform::take_over_crashes();
    }
}

/// A program in place of one that crashes.
#[derive(Debug)]
pub struct Again {
    program: CString,
    arguments: Texts,
    environment: Texts,
}

/// Texts as the system takes them.
#[derive(Debug)]
struct Texts {
    _held: Vec<CString>,
    /// Where each begins, and null at the end.
    list: Vec<*const c_char>,
}

impl FromIterator<CString> for Texts {
    fn from_iter<I: IntoIterator<Item = CString>>(texts: I) -> Self {
        let held: Vec<CString> = texts.into_iter().collect();
        let ends = [std::ptr::null()];
        Self { list: held.iter().map(|text| text.as_ptr()).chain(ends).collect(), _held: held }
    }
}

static AGAIN: AtomicPtr<Again> = AtomicPtr::new(std::ptr::null_mut());

impl Again {
    /// The same program with the same arguments, and one more variable in its environment. `None` where the system does
    /// not say which program it is.
    #[must_use]
    pub fn with(name: &str, value: &str) -> Option<Self> {
        let text = |text: OsString| CString::new(text.into_encoded_bytes()).ok();
        let entry = |(name, value): (OsString, OsString)| {
            let mut entry = name;
            entry.push("=");
            entry.push(value);
            text(entry)
        };
        let others = std::env::vars_os().filter(|(known, _)| known != name);
        let added = (OsString::from(name), OsString::from(value));
        Some(Self {
            program: text(std::env::current_exe().ok()?.into_os_string())?,
            arguments: std::env::args_os().map(text).collect::<Option<_>>()?,
            environment: others.chain([added]).map(entry).collect::<Option<_>>()?,
        })
    }
}

/// Runs `work`. Where the process crashes meanwhile, the program is begun anew in its place, after what is half done was
/// removed ([`Order::clean`]); where the system cannot do that, the process ends in order as it would.
pub fn guarded<T>(again: Again, work: impl FnOnce() -> T) -> T {
    // Never freed: a thread that crashes may be about to read it.
    AGAIN.store(Box::into_raw(Box::new(again)), Ordering::SeqCst);
    let result = work();
    AGAIN.store(std::ptr::null_mut(), Ordering::SeqCst);
    result
}

/// Tells the allocator of the C library to share one heap among all threads, instead of reserving 64 MiB of address
/// space for each: where address space is limited, that is most of what a software driver takes.
pub fn share_one_heap() {
    platform::share_one_heap();
}

/// Sets how many threads Mesa's software drivers start. Returns false, and does nothing, if other threads run already
/// or the system does not say so.
#[must_use]
pub fn set_driver_threads(count: usize) -> bool {
    let threads = std::fs::read_dir("/proc/self/task").map(Iterator::count);
    if !matches!(threads, Ok(1)) {
        return false;
    }
    // SAFETY: this is the only thread of the process, so nobody reads the environment meanwhile.
    unsafe { std::env::set_var("LP_NUM_THREADS", count.to_string()) };
    true
}

#[cfg(unix)]
mod platform {
    use super::{Again, Ending, ORDER, end};
    use std::sync::atomic::{AtomicBool, Ordering};

    const CRASHES: [libc::c_int; 4] = [libc::SIGSEGV, libc::SIGBUS, libc::SIGILL, libc::SIGABRT];

    pub fn take_over_crashes() {
        for signal in CRASHES {
            // SAFETY: the struct is plain data, for which zeros are valid; the handler below is one of the kind
            // that the flags announce, and does only what a handler may: it writes to the stack, to atomics and to
            // a file descriptor, and ends the process. (The cleaning in between may call more than that: it is
            // the last line of defence of a process that has crashed, and a crash in it ends the process.)
            // SA_ONSTACK: the standard library gives its threads a stack for this.
            unsafe {
                let mut action: libc::sigaction = std::mem::zeroed();
                action.sa_sigaction = crashed as *const () as libc::sighandler_t;
                action.sa_flags = libc::SA_ONSTACK | libc::SA_NODEFER;
                libc::sigemptyset(&raw mut action.sa_mask);
                libc::sigaction(signal, &raw const action, std::ptr::null_mut());
            }
        }
    }

    extern "C" fn crashed(signal: libc::c_int) {
        static AGAIN: AtomicBool = AtomicBool::new(false);
        if AGAIN.swap(true, Ordering::SeqCst) {
            // Of this thread while it cleans up, or of another for the same reason.
            wait();
            exit(ORDER.get().map_or(4, |order| order.code));
        }
        end(Ending::Crash(signal));
        exit(4);
    }

    /// Gives the thread that writes the line a moment for it.
    pub fn wait() {
        let moment = libc::timespec { tv_sec: 0, tv_nsec: 200_000_000 };
        // SAFETY: the struct lives as long as the call, and nothing is written back.
        unsafe { libc::nanosleep(&raw const moment, std::ptr::null_mut()) };
    }

    pub fn write_error(mut bytes: &[u8]) {
        while !bytes.is_empty() {
            // SAFETY: the pointer and the length are of one slice.
            let written = unsafe { libc::write(2, bytes.as_ptr().cast(), bytes.len()) };
            match usize::try_from(written) {
                Ok(count @ 1..) => bytes = bytes.get(count..).unwrap_or_default(),
                // Nobody is left to read it.
                _ => return,
            }
        }
    }

    pub fn exit(code: i32) -> ! {
        // SAFETY: ends the process at once, and calls nothing in it.
        unsafe { libc::_exit(code) }
    }

    /// Does not return where the system does it. Allocates nothing, and needs little of the stack.
    pub fn begin_anew(again: &Again) {
        let Again { program, arguments, environment } = again;
        // SAFETY: the set is plain data; both lists end with null, and their texts live as long as `again`. Threads of
        // drivers block signals, which the new program would inherit.
        unsafe {
            let mut none: libc::sigset_t = std::mem::zeroed();
            libc::sigemptyset(&raw mut none);
            libc::pthread_sigmask(libc::SIG_SETMASK, &raw const none, std::ptr::null_mut());
            libc::execve(program.as_ptr(), arguments.list.as_ptr(), environment.list.as_ptr());
        }
    }

    pub fn share_one_heap() {
        #[cfg(all(target_os = "linux", target_env = "gnu"))]
        // SAFETY: sets a number in the allocator, under its own lock.
        unsafe {
            libc::mallopt(libc::M_ARENA_MAX, 1);
        }
    }
}

#[cfg(not(unix))]
mod platform {
    use std::io::Write;

    pub fn take_over_crashes() {}

    pub fn begin_anew(_: &super::Again) {}

    pub fn wait() {}

    pub fn write_error(bytes: &[u8]) {
        let _ = std::io::stderr().write_all(bytes);
    }

    pub fn exit(code: i32) -> ! {
        std::process::exit(code)
    }

    pub fn share_one_heap() {}
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fmt::Write;

    #[test]
    fn a_line_takes_what_fits() {
        let mut line = Line::new();
        let (bytes, name) = (12, "ä");
        write!(line, "{bytes} bytes of '{name}'").unwrap();
        assert_eq!(format!("{line:?}"), "12 bytes of 'ä'");
        for _ in 0..Line::ROOM {
            line.write_str("ä").unwrap();
        }
        assert!(
            line.length <= Line::ROOM && std::str::from_utf8(&line.bytes[..line.length]).is_ok()
        );
    }

    /// A test runs beside others, so the environment stays as it is.
    #[test]
    fn the_environment_is_left_alone_beside_other_threads() {
        std::thread::scope(|scope| {
            let (go, end) = std::sync::mpsc::channel::<()>();
            scope.spawn(move || end.recv());
            assert!(!set_driver_threads(1));
            drop(go);
        });
    }
}
