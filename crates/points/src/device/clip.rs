//! The pass `clip_balls`.

use super::line;
use gpu::{Binding, Buffer, Device, GpuError, Kernel, Recorder};
use kernels::layout::{BallClip, CLIP_CLIPS, CLIP_POLYNOMIALS, ClipParams};
use kernels::spirv;
use std::sync::Arc;

/// Label and row of the timing table.
const NAME: &str = "clip_balls";

/// Lets trust balls end at rims (method, section 2); most sets have none.
pub(crate) fn clip_balls(
    device: &Arc<Device>,
    polynomials: &Buffer,
    clips: &[BallClip],
) -> Result<(), GpuError> {
    if clips.is_empty() {
        return Ok(());
    }
    let bindings = [CLIP_CLIPS, CLIP_POLYNOMIALS].map(|at| (at, Binding::StorageBuffer));
    let kernel =
        Kernel::new(device, NAME, &spirv::clip_balls(), &bindings, size_of::<ClipParams>())?;
    let list = Buffer::from_slice(device, "ball clips", clips)?;
    let params = ClipParams { count: clips.len() as u32 };
    let mut recorder = Recorder::new(device)?;
    recorder
        .pass(NAME, &kernel)
        .buffer(CLIP_CLIPS, &list)
        .buffer(CLIP_POLYNOMIALS, polynomials)
        .push(&params)
        .dispatch(line(params.count));
    recorder.submit()?;
    Ok(())
}
