//! The pass `clip_balls`.

use super::line;
use super::work::Work;
use gpu::{Buffer, Device, GpuError};
use kernels::layout::{BallClip, CLIPS, ClipParams, POLYNOMIALS, Polynomial};
use kernels::spirv;
use std::sync::Arc;

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
        rec.pass(spirv::clip_balls())
            .buffer(CLIPS, &list)
            .buffer_part(POLYNOMIALS, polynomials, offset, bytes)
            .push(&params)
            .dispatch(line(params.count));
    }
    rec.submit()
}
