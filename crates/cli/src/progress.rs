//! Progress on stderr, for stages that last over a second.
//!
//! Work only notes how far it is; a thread of its own draws, so that a stage that reports nothing
//! for a while is shown too, and drawing costs the work nothing. Of a stage that will take over a minute more, the
//! same thread says so in a line, wherever stderr leads.

use crate::args::{ProgressArgs, ProgressWhen};
use crate::errors::Failure;
use crate::log::{self, Level};
use crate::{console, ending, interrupt};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use points::Watch;
use serde_json::{Value, json};
use std::io::{IsTerminal, stderr};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{Builder, JoinHandle};
use std::time::{Duration, Instant};

/// A stage shorter than this is not shown, and lines are at least this far apart.
const PATIENCE: Duration = Duration::from_secs(1);
const REDRAW: Duration = Duration::from_millis(100);
/// How long a stage is watched before a line says how long it will take.
const FORECAST_AFTER: Duration = Duration::from_secs(2);
/// A stage that takes less from then on is none to speak of.
const FORECAST_FROM: Duration = Duration::from_secs(60);

/// Shows how far the work is, and hears of interruptions.
pub struct Progress {
    shared: Arc<Shared>,
    drawing: Option<JoinHandle<()>>,
    quiet: bool,
    warnings: AtomicUsize,
    verbose: bool,
}

struct Shared {
    style: Style,
    state: Mutex<State>,
    closing: Condvar,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Style {
    /// Only what will take long.
    Hidden,
    /// A bar that is drawn over, on a terminal.
    Bar,
    /// A line now and then, where the output is kept.
    Lines,
    /// An object at the beginning and the end of each stage, and now and then in between.
    Json,
}

#[derive(Default)]
struct State {
    /// What the stages are of, where there are several such.
    task: String,
    stage: Option<Stage>,
    bar: Option<ProgressBar>,
    closed: bool,
}

struct Stage {
    name: &'static str,
    total: u64,
    done: u64,
    began: Instant,
    /// When it is shown next.
    due: Instant,
    /// Whether it was said how long it will take.
    forecast: bool,
}

impl Progress {
    /// Follows `--progress` and `--quiet`.
    pub fn new(args: &ProgressArgs) -> Self {
        let style = match (args.quiet, args.progress, stderr().is_terminal()) {
            (true, ..) => Style::Hidden,
            (_, ProgressWhen::Never, _) => Style::Hidden,
            _ if log::is_json() => Style::Json,
            (_, ProgressWhen::Auto, false) => Style::Hidden,
            (_, _, true) => Style::Bar,
            (_, ProgressWhen::Always, false) => Style::Lines,
        };
        let shared = Arc::new(Shared { style, state: Mutex::default(), closing: Condvar::new() });
        let drawing = (!args.quiet).then(|| {
            let shared = Arc::clone(&shared);
            // Where the system has no thread for it, nothing is shown.
            Builder::new().spawn(move || shared.draw_until_closed()).ok()
        });
        Self {
            shared,
            drawing: drawing.flatten(),
            quiet: args.quiet,
            warnings: AtomicUsize::new(0),
            verbose: args.verbose,
        }
    }

    /// Ends the stage: nothing of it stays on a terminal.
    pub fn clear(&self) {
        self.shared.end_stage(&mut self.shared.lock());
    }

    /// Names what the next stages are of, until another is named.
    pub fn task(&self, name: &str) {
        let mut state = self.shared.lock();
        self.shared.end_stage(&mut state);
        state.task = format!("{name}: ");
        match self.shared.style {
            Style::Lines => console::note(name),
            Style::Json => console::say(Level::Info, "task", name, Value::Null),
            Style::Hidden | Style::Bar => {}
        }
    }

    /// Warns on stderr, unless `--quiet`, of a picture that may not be what was meant. `line` says what to do.
    pub fn warn(&self, line: &str) {
        self.warnings.fetch_add(1, Ordering::Relaxed);
        self.say(Level::Warning, "warning", line, Value::Null);
    }

    /// Fails where `--strict` is given and anything was warned of, also under `--quiet`; `what` says what became of the
    /// work.
    pub fn refuse_warnings(&self, is_strict: bool, what: &str) -> Result<(), Failure> {
        let count = match self.warnings.load(Ordering::Relaxed) {
            count if is_strict && count > 0 => count,
            _ => return Ok(()),
        };
        let warnings = if count == 1 { "warning" } else { "warnings" };
        Err(Failure::usage(format!("--strict: {count} {warnings}{what}")))
    }

    /// Says something on stderr, if `--verbose` asks for it.
    pub fn detail(&self, line: &str) {
        if self.verbose {
            self.note(line);
        }
    }

    /// Says something on stderr, unless `--quiet`.
    pub fn note(&self, line: &str) {
        self.say(Level::Info, "note", line, Value::Null);
    }

    /// Says what was done, with these fields where lines are objects.
    pub fn result(&self, line: &str, fields: Value) {
        self.say(Level::Info, "result", line, fields);
    }

    /// The same where only objects are wanted, since the result itself is on stdout.
    pub fn result_object(&self, line: &str, fields: Value) {
        if log::is_json() {
            self.result(line, fields);
        }
    }

    /// Says what the work will take.
    pub fn forecast(&self, line: &str, fields: Value) {
        self.say(Level::Info, "forecast", &format!("forecast: {line}"), fields);
    }

    fn say(&self, level: Level, event: &str, line: &str, fields: Value) {
        if !self.quiet {
            let mut state = self.shared.lock();
            state.hide_bar();
            console::say(level, event, line, fields);
        }
    }
}

impl Watch for Progress {
    fn stage(&self, name: &'static str, total: u64) {
        ending::at(name);
        let mut state = self.shared.lock();
        self.shared.end_stage(&mut state);
        if self.shared.style == Style::Json {
            let message = format!("{}{name}", state.task);
            let fields = json!({ "stage": name, "state": "begin", "total": total });
            console::say(Level::Info, "stage", &message, fields);
        }
        let began = Instant::now();
        let due = began + PATIENCE;
        state.stage = Some(Stage { name, total, done: 0, began, due, forecast: false });
    }

    fn done(&self, units: u64) {
        if let Some(stage) = &mut self.shared.lock().stage {
            stage.done = units;
        }
    }

    fn interrupted(&self) -> bool {
        interrupt::requested()
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        {
            let mut state = self.shared.lock();
            self.shared.end_stage(&mut state);
            state.closed = true;
        }
        self.shared.closing.notify_all();
        if let Some(drawing) = self.drawing.take() {
            // A panic in there was reported by the hook and harms no result.
            let _ = drawing.join();
        }
    }
}

impl Shared {
    /// Every change of the state is complete in itself, so a panic elsewhere does not spoil it.
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn end_stage(&self, state: &mut State) {
        state.hide_bar();
        let Some(stage) = state.stage.take() else { return };
        if self.style == Style::Json {
            let message = format!("{}{}", state.task, stage.name);
            let seconds = rounded(stage.began.elapsed());
            let fields = json!({ "stage": stage.name, "state": "end", "seconds": seconds });
            console::say(Level::Info, "stage", &message, fields);
        }
    }

    fn draw_until_closed(&self) {
        let mut state = self.lock();
        while !state.closed {
            state.draw(self.style);
            state =
                self.closing.wait_timeout(state, REDRAW).unwrap_or_else(PoisonError::into_inner).0;
        }
    }
}

impl State {
    fn draw(&mut self, style: Style) {
        self.say_what_takes_long();
        let Some(stage) = &mut self.stage else { return };
        if style == Style::Hidden || stage.due > Instant::now() {
            return;
        }
        let message = format!("{}{}", self.task, stage.name);
        if style == Style::Bar {
            let bar = self.bar.get_or_insert_with(|| {
                let bar =
                    ProgressBar::with_draw_target(Some(stage.total), ProgressDrawTarget::stderr());
                bar.with_style(bar_style()).with_message(message)
            });
            bar.set_position(stage.done);
            bar.tick();
            console::bar_is_shown(true);
            return;
        }
        stage.due += PATIENCE;
        let percent = 100.0 * stage.done as f64 / stage.total.max(1) as f64;
        let left = stage.left();
        let in_words = left
            .filter(|left| *left >= PATIENCE)
            .map_or_else(String::new, |left| format!(", {} left", duration_in_words(left)));
        console::say(
            Level::Info,
            "progress",
            &format!("{message}: {percent:.0} %{in_words}"),
            json!({
                "stage": stage.name,
                "done": stage.done,
                "total": stage.total,
                "seconds_left": left.map(rounded),
            }),
        );
    }

    /// Once a stage.
    fn say_what_takes_long(&mut self) {
        let Some(stage) = &mut self.stage else { return };
        if stage.forecast || stage.began.elapsed() < FORECAST_AFTER {
            return;
        }
        let Some(left) = stage.left() else { return };
        stage.forecast = true;
        if left < FORECAST_FROM {
            return;
        }
        let elapsed = stage.began.elapsed();
        let share = 100.0 * stage.done as f64 / stage.total.max(1) as f64;
        let message = format!(
            "forecast: {}{} takes about {} more ({share:.2} % are done after {})",
            self.task,
            stage.name,
            duration_in_words(left),
            duration_in_words(elapsed)
        );
        let fields = json!({
            "stage": stage.name,
            "done": stage.done,
            "total": stage.total,
            "seconds_left": rounded(left),
        });
        self.hide_bar();
        console::say(Level::Info, "forecast", &message, fields);
    }

    fn hide_bar(&mut self) {
        if let Some(bar) = self.bar.take() {
            bar.finish_and_clear();
            console::bar_is_shown(false);
        }
    }
}

impl Stage {
    /// How long it will take from now on, by what is done; `None` while nothing is.
    fn left(&self) -> Option<Duration> {
        let to_do = self.total.saturating_sub(self.done);
        let ratio = (self.done > 0).then(|| to_do as f64 / self.done as f64)?;
        Duration::try_from_secs_f64(self.began.elapsed().as_secs_f64() * ratio).ok()
    }
}

/// In seconds, to the millisecond.
fn rounded(duration: Duration) -> f64 {
    duration.as_millis() as f64 / 1000.0
}

/// In the two largest units.
fn duration_in_words(duration: Duration) -> String {
    let seconds = duration.as_secs();
    let of = |size: u64, unit: &str, small: u64, small_unit: &str| {
        let (whole, rest) = (seconds / size, seconds % size / small);
        if rest == 0 {
            format!("{whole} {unit}")
        } else {
            format!("{whole} {unit} {rest} {small_unit}")
        }
    };
    match seconds {
        0..60 => format!("{seconds} s"),
        60..3600 => of(60, "min", 1, "s"),
        3600..86_400 => of(3600, "h", 60, "min"),
        86_400..31_536_000 => of(86_400, "days", 3600, "h"),
        _ => of(31_536_000, "years", 86_400, "days"),
    }
}

fn bar_style() -> ProgressStyle {
    ProgressStyle::with_template("{msg} {wide_bar} {percent:>3} % {elapsed}, {eta} left")
        .unwrap_or_else(|_| ProgressStyle::default_bar())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_are_said_in_two_units() {
        for (seconds, words) in [
            (0, "0 s"),
            (59, "59 s"),
            (60, "1 min"),
            (61, "1 min 1 s"),
            (3600, "1 h"),
            (7380, "2 h 3 min"),
            (90_000, "1 days 1 h"),
            (31_536_000, "1 years"),
            (40_000_000, "1 years 97 days"),
        ] {
            assert_eq!(duration_in_words(Duration::from_secs(seconds)), words);
        }
    }

    #[test]
    fn what_is_left_follows_from_what_is_done() {
        let began = Instant::now().checked_sub(Duration::from_secs(10)).expect("a clock");
        let stage =
            |done| Stage { name: "x", total: 1000, done, began, due: began, forecast: false };
        assert_eq!(stage(0).left(), None);
        let left = stage(100).left().expect("some is done").as_secs_f64();
        // A tenth in ten seconds, and what this test takes.
        assert!((90.0..100.0).contains(&left), "{left}");
        assert_eq!(stage(1000).left(), Some(Duration::ZERO));
    }
}
