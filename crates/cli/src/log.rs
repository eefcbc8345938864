//! What a line on stderr looks like: text, or one JSON object a line with `--log json`.
//!
//! An object has `time` (RFC 3339, UTC), `level` (`info`, `warning`, `error`), `event` and `message`, and what
//! docs/running.md lists for its event.

use serde_json::{Map, Value, json};
use std::fmt::{self, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{SystemTime, UNIX_EPOCH};

static AS_JSON: AtomicBool = AtomicBool::new(false);

/// How much a line matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Level {
    /// What happens.
    Info,
    /// A picture may not be what was meant.
    Warning,
    /// What was asked for is not done.
    Error,
}

impl Level {
    /// As it stands in the objects.
    pub fn name(self) -> &'static str {
        match self {
            Self::Info => "info",
            Self::Warning => "warning",
            Self::Error => "error",
        }
    }

    /// What text begins with.
    fn prefix(self) -> &'static str {
        match self {
            Self::Info => "",
            Self::Warning => "warning: ",
            Self::Error => "error: ",
        }
    }
}

/// Follows what was typed, before it is parsed: what is wrong with it is a line, too.
pub fn follow(arguments: impl Iterator<Item = std::ffi::OsString>) {
    let mut before = std::ffi::OsString::new();
    let mut asked = false;
    for argument in arguments {
        if argument == "--" {
            break;
        }
        asked |= argument == "--log=json" || before == "--log" && argument == "json";
        before = argument;
    }
    AS_JSON.store(asked, Ordering::Relaxed);
}

/// Whether lines are JSON.
pub fn is_json() -> bool {
    AS_JSON.load(Ordering::Relaxed)
}

/// A line, without its end. `fields` are for JSON.
pub fn line(level: Level, event: &str, message: &str, fields: Value) -> String {
    if !is_json() {
        return format!("{}{message}", level.prefix());
    }
    let mut time = String::new();
    // Writing to a string cannot fail.
    let _ = write_time(&mut time, SystemTime::now());
    let mut object = Map::new();
    for (key, value) in [
        ("time", json!(time)),
        ("level", json!(level.name())),
        ("event", json!(event)),
        ("message", json!(message)),
    ] {
        object.insert(key.to_owned(), value);
    }
    if let Value::Object(fields) = fields {
        object.extend(fields);
    }
    Value::Object(object).to_string()
}

/// RFC 3339 in UTC with milliseconds; allocates nothing.
pub fn write_time(to: &mut dyn Write, time: SystemTime) -> fmt::Result {
    let since = time.duration_since(UNIX_EPOCH).unwrap_or_default();
    let (days, second) = (since.as_secs() / 86400, since.as_secs() % 86400);
    // The year begins in March here, so that the day that comes and goes is its last; 400 years are 146097 days.
    let day = days + 719_468;
    let (era, day) = (day / 146_097, day % 146_097);
    let year = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day + 2) / 153;
    let day = day - (153 * month + 2) / 5 + 1;
    let month = if month < 10 { month + 3 } else { month - 9 };
    let year = 400 * era + year + u64::from(month <= 2);
    write!(
        to,
        "{year:04}-{month:02}-{day:02}T{:02}:{:02}:{:02}.{:03}Z",
        second / 3600,
        second / 60 % 60,
        second % 60,
        since.subsec_millis()
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    /// By `date -u -d @SECONDS`: leap days, and years that have none.
    #[test]
    fn times_are_dates() {
        for (seconds, date) in [
            (0, "1970-01-01T00:00:00.000Z"),
            (951_782_399, "2000-02-28T23:59:59.000Z"),
            (951_782_400, "2000-02-29T00:00:00.000Z"),
            (951_868_800, "2000-03-01T00:00:00.000Z"),
            (1_798_675_199, "2026-12-30T23:59:59.000Z"),
            (1_798_761_599, "2026-12-31T23:59:59.000Z"),
            (1_798_761_600, "2027-01-01T00:00:00.000Z"),
            (4_107_542_400, "2100-03-01T00:00:00.000Z"),
        ] {
            let mut text = String::new();
            write_time(&mut text, UNIX_EPOCH + Duration::from_secs(seconds)).expect("a string");
            assert_eq!(text, date);
        }
        let mut text = String::new();
        write_time(&mut text, UNIX_EPOCH + Duration::from_millis(1234)).expect("a string");
        assert_eq!(text, "1970-01-01T00:00:01.234Z");
    }
}
