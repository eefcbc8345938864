//! Writes to stdout and stderr. Results go to stdout and are alone there; all else goes to stderr.
//!
//! Whoever reads may stop reading (`pointillist schema | head`): a closed pipe is no error, and
//! nothing here panics. Names from files and of files may hold anything: a terminal is not told to obey it.

use crate::errors::{Exit, Failure};
use crate::log::{self, Level};
use crate::source;
use serde_json::{Value, json};
use std::borrow::Cow;
use std::io::{self, ErrorKind, Write};
use std::sync::atomic::{AtomicBool, Ordering};

/// Whether a bar is on the terminal's last line.
static BAR: AtomicBool = AtomicBool::new(false);

/// Writes a result to stdout.
pub fn result(text: &str) -> Result<(), Failure> {
    result_bytes(source::without_folder(printable(text).into_owned()).as_bytes())
}

/// The same of bytes as they are. Whoever reads may stop reading.
pub fn result_bytes(bytes: &[u8]) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    let written = stdout.write_all(bytes).and_then(|()| stdout.flush());
    match written {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::exhausted(format!("stdout: cannot write the result: {error}")))
        }
        _ => Ok(()),
    }
}

/// Writes one line to stderr. There is nowhere to report that this failed.
pub fn note(line: &str) {
    say(Level::Info, "note", line, Value::Null);
}

/// Writes one line to stderr: as text, or as an object with these fields.
pub fn say(level: Level, event: &str, message: &str, fields: Value) {
    let line =
        log::line(level, event, &source::without_folder(printable(message).into_owned()), fields);
    let _ = writeln!(io::stderr().lock(), "{line}");
}

/// Says whether a bar is on the terminal's last line.
pub fn bar_is_shown(shown: bool) {
    BAR.store(shown, Ordering::Relaxed);
}

/// Clears the line that a bar is on, for one that is not written by this module.
pub fn leave_bar(line: &mut impl std::fmt::Write) {
    if BAR.load(Ordering::Relaxed) {
        // It is cut off where there is no room.
        let _ = line.write_str("\r\x1b[2K");
    }
}

/// Clears the line that a bar is on, before a process ends that others draw it in.
pub fn clear_bar() {
    if BAR.load(Ordering::Relaxed) {
        let _ = write!(io::stderr().lock(), "\r\x1b[2K");
    }
}

/// The text with control characters other than line ends written out.
fn printable(text: &str) -> Cow<'_, str> {
    let obeyed = |c: char| c.is_control() && c != '\n';
    if !text.contains(obeyed) {
        return Cow::Borrowed(text);
    }
    let mut printable = String::with_capacity(text.len());
    for c in text.chars() {
        if obeyed(c) {
            printable.extend(c.escape_default());
        } else {
            printable.push(c);
        }
    }
    Cow::Owned(printable)
}

/// Writes why the process ends.
pub fn errors(failure: &Failure) {
    for line in &failure.lines {
        say(Level::Error, "error", line, json!({ "exit": failure.exit.code() }));
    }
}

/// Prints help, the version, or what is wrong with the command line.
pub fn clap_answer(answer: &clap::Error) -> Exit {
    if !answer.use_stderr() {
        // A closed pipe is no error here either.
        let _ = answer.print();
        return Exit::Done;
    }
    if log::is_json() {
        let text = answer.render().to_string();
        let lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
        let message = lines.collect::<Vec<_>>().join(" ");
        let message = message.strip_prefix("error: ").unwrap_or(&message);
        say(Level::Error, "error", message, json!({ "exit": Exit::Usage.code() }));
    } else {
        let _ = answer.print();
    }
    Exit::Usage
}

/// A panic is a bug; it is reported in one line, without a backtrace.
pub fn announce_panics() {
    std::panic::set_hook(Box::new(|info| {
        let payload = info.payload();
        let message = (payload.downcast_ref::<&str>().copied())
            .or_else(|| payload.downcast_ref::<String>().map(String::as_str))
            .unwrap_or("no message");
        let place = info.location().map_or_else(String::new, |place| format!(" at {place}"));
        let message = message.replace('\n', " ");
        let message = format!("this is a bug in pointillist, please report it: {message}{place}");
        say(Level::Error, "error", &message, Value::Null);
    }));
}
