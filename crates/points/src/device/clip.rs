//! The pass `clip_balls`.

use super::line;
use super::work::Work;
use gpu::{Binding, Buffer, Device, GpuError, Kernel};
use kernels::layout::{BallClip, CLIP_CLIPS, CLIP_POLYNOMIALS, ClipParams, Polynomial};
use kernels::spirv;
use std::sync::Arc;

/// Label and row of the timing table.
const NAME: &str = "clip_balls";

/// Polynomials bound at a time: 64 MiB.
const PAGE: u32 = 1 << 20;

/// Lets trust balls end at rims (method, section 2); most sets have none.
pub(crate) fn clip_balls(
    device: &Arc<Device>,
    rec: &mut Work,
    polynomials: &Buffer,
    clips: &[BallClip],
) -> Result<(), GpuError> {
    if clips.is_empty() {
        return Ok(());
    }
    let bindings = [CLIP_CLIPS, CLIP_POLYNOMIALS].map(|at| (at, Binding::StorageBuffer));
    let kernel =
        Kernel::new(device, NAME, &spirv::clip_balls(), &bindings, size_of::<ClipParams>())?;
    // A page of polynomials at a time, since all of them may be longer than a binding.
    for clips in clips.chunk_by(|a, b| a.slot / PAGE == b.slot / PAGE) {
        let Some(page) = clips.first().map(|clip| clip.slot / PAGE) else { continue };
        let within: Vec<BallClip> =
            clips.iter().map(|clip| BallClip { slot: clip.slot % PAGE, ..*clip }).collect();
        let list = Buffer::from_slice(device, "ball clips", &within)?;
        let params = ClipParams { count: clips.len() as u32 };
        let page_bytes = u64::from(PAGE) * size_of::<Polynomial>() as u64;
        let offset = u64::from(page) * page_bytes;
        let bytes = page_bytes.min(polynomials.bytes() - offset);
        rec.pass(NAME, &kernel)
            .buffer(CLIP_CLIPS, &list)
            .buffer_part(CLIP_POLYNOMIALS, polynomials, offset, bytes)
            .push(&params)
            .dispatch(line(params.count));
    }
    rec.submit()
}
