//! A recorder that keeps what each kernel of a build took.

use gpu::{Device, GpuError, Recorder};
use std::ops::{Deref, DerefMut};
use std::sync::Arc;

/// Records, runs and adds up.
pub(crate) struct Work {
    recorder: Recorder,
    /// Milliseconds of each kernel by the device's clock, in the order of first use.
    pub kernels: Vec<(&'static str, f64)>,
}

impl Work {
    pub fn new(device: &Arc<Device>) -> Result<Self, GpuError> {
        Ok(Self { recorder: Recorder::new(device)?, kernels: Vec::new() })
    }

    /// Runs what was recorded and waits for it.
    pub fn submit(&mut self) -> Result<(), GpuError> {
        for (name, milliseconds) in self.recorder.submit()?.passes {
            match self.kernels.iter_mut().find(|kernel| kernel.0 == name) {
                Some(kernel) => kernel.1 += milliseconds,
                None => self.kernels.push((name, milliseconds)),
            }
        }
        Ok(())
    }
}

impl Deref for Work {
    type Target = Recorder;

    fn deref(&self) -> &Recorder {
        &self.recorder
    }
}

impl DerefMut for Work {
    fn deref_mut(&mut self) -> &mut Recorder {
        &mut self.recorder
    }
}
