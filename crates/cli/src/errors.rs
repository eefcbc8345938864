//! What goes wrong, and which exit code says so. The codes are chosen here and nowhere else.

use film::FilmError;
use gpu::GpuError;
use plan::PlanError;
use points::PointsError;
use render::RenderError;
use scene::SceneError;
use std::error::Error;

/// How the process ends. Scripts rely on these numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Exit {
    /// 0: done.
    Done,
    /// 1: `compare` found a difference over a limit.
    Difference,
    /// 2: the command line, a scene or an input is at fault.
    Usage,
    /// 3: the Vulkan device that was asked for is not usable.
    NoDevice,
    /// 4: the device or the machine ran out (memory, disk full), or a bug was met.
    Exhausted,
    /// 4 too: the device was lost, and with it all that is still to be done on it.
    Lost,
    /// 130: interrupted, as shells report SIGINT.
    Interrupted,
}

impl Exit {
    /// The number.
    pub fn code(self) -> u8 {
        match self {
            Self::Done => 0,
            Self::Difference => 1,
            Self::Usage => 2,
            Self::NoDevice => 3,
            Self::Exhausted | Self::Lost => 4,
            Self::Interrupted => 130,
        }
    }
}

/// Why the process ends without having done what it was asked for.
#[derive(Debug)]
pub struct Failure {
    /// How it ends.
    pub exit: Exit,
    /// One error a line.
    pub lines: Vec<String>,
}

impl Failure {
    /// A fault of the command line or of an input.
    pub fn usage(message: impl Into<String>) -> Self {
        Self { exit: Exit::Usage, lines: vec![message.into()] }
    }

    /// The user asked for an end.
    pub fn interrupted() -> Self {
        Self { exit: Exit::Interrupted, lines: vec!["interrupted".to_owned()] }
    }

    /// A machine without what the work needs.
    pub fn exhausted(message: impl Into<String>) -> Self {
        Self { exit: Exit::Exhausted, lines: vec![message.into()] }
    }

    /// No device could be opened, whatever the call that said so: the work has not begun, and the
    /// CPU can do it.
    pub fn no_device(error: &GpuError) -> Self {
        let mut line = chain(error);
        if !line.contains("--device reference") {
            line.push_str("; or render on the CPU, without Vulkan, with --device reference");
        }
        Self { exit: Exit::NoDevice, lines: vec![line] }
    }

    /// The same failure, said to be of something.
    pub fn of(mut self, what: &str) -> Self {
        for line in &mut self.lines {
            *line = format!("{what}: {line}");
        }
        self
    }

    fn new(exit: Exit, error: &dyn Error) -> Self {
        Self { exit, lines: vec![chain(error)] }
    }
}

/// The message and what caused it, in one line.
pub fn chain(error: &dyn Error) -> String {
    let mut line = error.to_string();
    let mut source = error.source();
    while let Some(cause) = source {
        let said = cause.to_string();
        // Some causes end with their own cause.
        if !line.ends_with(&said) {
            line.push_str(": ");
            line.push_str(&said);
        }
        source = cause.source();
    }
    line.replace('\n', " ")
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        Self { exit: Exit::Usage, lines: error.lines().to_vec() }
    }
}

impl From<PointsError> for Failure {
    fn from(error: PointsError) -> Self {
        let exit = if error.is_out_of_memory() { Exit::Exhausted } else { Exit::Usage };
        Self::new(exit, &error)
    }
}

impl From<PlanError> for Failure {
    fn from(error: PlanError) -> Self {
        match error {
            PlanError::Interrupted => Self::interrupted(),
            error => Self::new(Exit::Usage, &error),
        }
    }
}

impl From<RenderError> for Failure {
    fn from(error: RenderError) -> Self {
        match error {
            RenderError::Interrupted => Self::interrupted(),
            error @ (RenderError::Images { .. } | RenderError::Memory(_)) => {
                Self::new(Exit::Exhausted, &error)
            }
            RenderError::Gpu(error @ GpuError::DeviceLost { .. }) => Self::new(Exit::Lost, &error),
            // The device was open already, so it is the device that gave up.
            RenderError::Gpu(error) => Self::new(Exit::Exhausted, &error),
        }
    }
}

impl From<FilmError> for Failure {
    fn from(error: FilmError) -> Self {
        let exit = if error.is_out_of_space() { Exit::Exhausted } else { Exit::Usage };
        Self::new(exit, &error)
    }
}
