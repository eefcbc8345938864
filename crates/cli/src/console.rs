//! Writes to stdout and stderr. Results go to stdout and are alone there; all else goes to stderr.
//!
//! Whoever reads may stop reading (`pointillist schema | head`): a closed pipe is no error, and
//! nothing here panics. Names from files and of files may hold anything: a terminal is not told to obey it.

use crate::errors::{Exit, Failure};
use std::borrow::Cow;
use std::io::{self, ErrorKind, Write};

/// Writes a result to stdout.
pub fn result(text: &str) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    let written = stdout.write_all(printable(text).as_bytes()).and_then(|()| stdout.flush());
    match written {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::exhausted(format!("stdout: cannot write the result: {error}")))
        }
        _ => Ok(()),
    }
}

/// Writes one line to stderr. There is nowhere to report that this failed.
pub fn note(line: &str) {
    let _ = writeln!(io::stderr().lock(), "{}", printable(line));
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
        note(&format!("error: {line}"));
    }
}

/// Prints help, the version, or what is wrong with the command line.
pub fn clap_answer(answer: &clap::Error) -> Exit {
    // A closed pipe is no error here either.
    let _ = answer.print();
    if answer.use_stderr() { Exit::Usage } else { Exit::Done }
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
        note(&format!("error: this is a bug in pointillist, please report it: {message}{place}"));
    }));
}
