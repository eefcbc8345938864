//! Progress on stderr, for stages that last over a second.
//!
//! Work only notes how far it is; a thread of its own draws, so that a stage that reports nothing
//! for a while is shown too, and drawing costs the work nothing.

use crate::args::{ProgressArgs, ProgressWhen};
use crate::{console, interrupt};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use points::Watch;
use std::io::{IsTerminal, stderr};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// A stage shorter than this is not shown, and lines are at least this far apart.
const PATIENCE: Duration = Duration::from_secs(1);
const REDRAW: Duration = Duration::from_millis(100);

/// Shows how far the work is, and hears of interruptions.
pub struct Progress {
    shared: Arc<Shared>,
    drawing: Option<JoinHandle<()>>,
    quiet: bool,
    verbose: bool,
}

struct Shared {
    style: Style,
    state: Mutex<State>,
    closing: Condvar,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Style {
    Hidden,
    /// A bar that is drawn over, on a terminal.
    Bar,
    /// A line now and then, where the output is kept.
    Lines,
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
    /// When it is shown next.
    due: Instant,
}

impl Progress {
    /// Follows `--progress` and `--quiet`.
    pub fn new(args: &ProgressArgs) -> Self {
        let style = match (args.quiet, args.progress, stderr().is_terminal()) {
            (true, ..) | (_, ProgressWhen::Never, _) | (_, ProgressWhen::Auto, false) => {
                Style::Hidden
            }
            (false, _, true) => Style::Bar,
            (false, ProgressWhen::Always, false) => Style::Lines,
        };
        let shared = Arc::new(Shared { style, state: Mutex::default(), closing: Condvar::new() });
        let drawing = (style != Style::Hidden).then(|| {
            let shared = Arc::clone(&shared);
            std::thread::spawn(move || shared.draw_until_closed())
        });
        Self { shared, drawing, quiet: args.quiet, verbose: args.verbose }
    }

    /// Ends the stage: nothing of it stays on a terminal.
    pub fn clear(&self) {
        self.shared.lock().end_stage();
    }

    /// Names what the next stages are of, until another is named.
    pub fn task(&self, name: &str) {
        let mut state = self.shared.lock();
        state.end_stage();
        state.task = format!("{name}: ");
        if self.shared.style == Style::Lines {
            console::note(name);
        }
    }

    /// Warns on stderr, unless `--quiet`, of a picture that may not be what was meant. `line` says what to do.
    pub fn warn(&self, line: &str) {
        self.note(&format!("warning: {line}"));
    }

    /// Says something on stderr, if `--verbose` asks for it.
    pub fn detail(&self, line: &str) {
        if self.verbose {
            self.note(line);
        }
    }

    /// Says something on stderr, unless `--quiet`.
    pub fn note(&self, line: &str) {
        if !self.quiet {
            let mut state = self.shared.lock();
            state.hide_bar();
            console::note(line);
        }
    }
}

impl Watch for Progress {
    fn stage(&self, name: &'static str, total: u64) {
        let mut state = self.shared.lock();
        state.end_stage();
        state.stage = Some(Stage { name, total, done: 0, due: Instant::now() + PATIENCE });
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
            state.end_stage();
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
        let Some(stage) = &mut self.stage else { return };
        if stage.due > Instant::now() {
            return;
        }
        if style == Style::Lines {
            stage.due += PATIENCE;
            let percent = 100.0 * stage.done as f64 / stage.total.max(1) as f64;
            console::note(&format!("{}{}: {percent:.0} %", self.task, stage.name));
            return;
        }
        let bar = self.bar.get_or_insert_with(|| {
            let bar =
                ProgressBar::with_draw_target(Some(stage.total), ProgressDrawTarget::stderr());
            bar.with_style(bar_style()).with_message(format!("{}{}", self.task, stage.name))
        });
        bar.set_position(stage.done);
        bar.tick();
    }

    fn end_stage(&mut self) {
        self.hide_bar();
        self.stage = None;
    }

    fn hide_bar(&mut self) {
        if let Some(bar) = self.bar.take() {
            bar.finish_and_clear();
        }
    }
}

fn bar_style() -> ProgressStyle {
    ProgressStyle::with_template("{msg} {wide_bar} {percent:>3} % {elapsed}")
        .unwrap_or_else(|_| ProgressStyle::default_bar())
}
