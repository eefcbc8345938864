//! Exclusive prefix sums: the passes `scan_reduce` and `scan_apply`, level over level.

use super::line;
use gpu::{Binding, Buffer, Device, GpuError, Kernel, Recorder};
use kernels::layout::{RUN_LENGTH, SCAN_SUMS, SCAN_VALUES, ScanParams};
use kernels::spirv;
use std::sync::Arc;

/// Turns a buffer of counts into offsets, in place.
#[derive(Debug)]
pub struct Scan {
    reduce: Kernel,
    apply: Kernel,
}

impl Scan {
    /// Builds the pipelines. Fails only if the driver rejects them.
    ///
    /// # Errors
    /// A driver that rejects a pipeline.
    pub fn new(device: &Arc<Device>) -> Result<Self, GpuError> {
        let bindings = [(SCAN_VALUES, Binding::StorageBuffer), (SCAN_SUMS, Binding::StorageBuffer)];
        let params = size_of::<ScanParams>();
        let kernel = |name, module: &[u32]| Kernel::new(device, name, module, &bindings, params);
        Ok(Self {
            reduce: kernel("scan_reduce", &spirv::scan_reduce())?,
            apply: kernel("scan_apply", &spirv::scan_apply())?,
        })
    }

    /// What it takes.
    #[must_use]
    pub fn kernels(&self) -> [Kernel; 2] {
        [self.reduce.clone(), self.apply.clone()]
    }

    /// Space for the sums of runs, level by level, of a list of at most `count` values.
    ///
    /// # Errors
    /// A device without the memory.
    pub fn levels(device: &Arc<Device>, count: u32) -> Result<Vec<Buffer>, GpuError> {
        let mut levels = Vec::new();
        let mut runs = count.div_ceil(RUN_LENGTH).max(1);
        levels.push(Buffer::new(device, "scan sums", u64::from(runs) * 4)?);
        while runs > 1 {
            runs = runs.div_ceil(RUN_LENGTH);
            levels.push(Buffer::new(device, "scan sums", u64::from(runs) * 4)?);
        }
        Ok(levels)
    }

    /// Records the scan of the first `count` of `values`. A sum past `SCAN_LIMIT` is that instead.
    pub fn record(&self, rec: &mut Recorder, values: &Buffer, count: u32, levels: &[Buffer]) {
        let runs = count.div_ceil(RUN_LENGTH);
        let Some((sums, above)) = levels.split_first() else { return };
        let nested = runs > 1;
        if nested {
            rec.pass("scan_reduce", &self.reduce)
                .buffer(SCAN_VALUES, values)
                .buffer(SCAN_SUMS, sums)
                .push(&ScanParams { count, has_base: 0 })
                .dispatch(line(runs));
            self.record(rec, sums, runs, above);
        }
        rec.pass("scan_apply", &self.apply)
            .buffer(SCAN_VALUES, values)
            .buffer(SCAN_SUMS, sums)
            .push(&ScanParams { count, has_base: u32::from(nested) })
            .dispatch(line(runs));
    }
}
