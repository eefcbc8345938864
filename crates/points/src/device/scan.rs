//! Exclusive prefix sums: the passes `scan_reduce` and `scan_apply`, level over level.

use super::line;
use gpu::{Buffer, Device, GpuError, Recorder};
use kernels::layout::{RUN_LENGTH, SCAN_SUMS, SCAN_VALUES, ScanParams};
use kernels::spirv::{self, Module};
use std::sync::Arc;

/// Turns a buffer of counts into offsets, in place.
#[derive(Debug)]
pub struct Scan;

impl Scan {
    /// What it takes.
    #[must_use]
    pub fn modules() -> [&'static Module; 2] {
        [spirv::scan_reduce(), spirv::scan_apply()]
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
    pub fn record(rec: &mut Recorder, values: &Buffer, count: u32, levels: &[Buffer]) {
        let runs = count.div_ceil(RUN_LENGTH);
        let Some((sums, above)) = levels.split_first() else { return };
        let nested = runs > 1;
        if nested {
            rec.pass(spirv::scan_reduce())
                .buffer(SCAN_VALUES, values)
                .buffer(SCAN_SUMS, sums)
                .push(&ScanParams { count, has_base: 0 })
                .dispatch(line(runs));
            Self::record(rec, sums, runs, above);
        }
        rec.pass(spirv::scan_apply())
            .buffer(SCAN_VALUES, values)
            .buffer(SCAN_SUMS, sums)
            .push(&ScanParams { count, has_base: u32::from(nested) })
            .dispatch(line(runs));
    }
}
