//! Records passes, puts barriers between them, runs them and times them.
//!
//! A recorder is made once and used for every submission: command buffer, fence, descriptor sets
//! and queries stay, so that in the steady state a submission makes no Vulkan object. Whatever a
//! recording uses is held until it has been waited for, so callers may drop buffers, images and
//! kernels at any time.
//!
//! Recording cannot fail at the call: what goes wrong is kept, further commands are ignored, and
//! [`submit`](Recorder::submit) returns the first error without running anything.

use crate::access::{self, Access, Hazards};
use crate::buffer::Buffer;
use crate::descriptors::{Bound, Descriptors};
use crate::device::Device;
use crate::error::GpuError;
use crate::image::{Image, ImageFormat};
use crate::kernel::{Binding, Kernel, TexelType};
use crate::queue;
use crate::timer::Timer;
use ash::vk;
use bytemuck::NoUninit;
use std::any::Any;
use std::collections::HashMap;
use std::fmt;
use std::sync::Arc;

/// What the offset of a part of a storage buffer must be a multiple of, on any device.
pub const PART_ALIGNMENT: u64 = 256;

/// Bytes of the three workgroup counts of an indirect dispatch.
const INDIRECT_BYTES: u64 = 12;

/// GPU time of the passes of one submission.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Timings {
    /// Name and milliseconds of each pass, in the order of recording; empty where the device's
    /// queue has no timestamps or timing is off. A pass that follows another directly is charged
    /// from the other's end, so times add up.
    pub passes: Vec<(&'static str, f64)>,
}

/// Records compute passes, fills and copies, and runs them.
pub struct Recorder {
    pool: vk::CommandPool,
    commands: vk::CommandBuffer,
    fence: vk::Fence,
    is_recording: bool,
    /// The first thing that went wrong since the last submission.
    error: Option<GpuError>,
    /// Passes recorded.
    names: Vec<&'static str>,
    hazards: Hazards,
    /// What the recording uses, by id.
    held: HashMap<u64, Arc<dyn Any + Send + Sync>>,
    descriptors: Descriptors,
    timer: Timer,
    /// Memory of passes under construction, kept for the next.
    push: Vec<u8>,
    uses: Vec<(u64, Access)>,
    #[cfg(test)]
    skip_barriers: bool,
    device: Arc<Device>,
}

impl Recorder {
    /// An empty recorder.
    pub fn new(device: &Arc<Device>) -> Result<Self, GpuError> {
        // From here on `Drop` cleans up after a failure.
        let mut recorder = Self {
            pool: vk::CommandPool::null(),
            commands: vk::CommandBuffer::null(),
            fence: vk::Fence::null(),
            is_recording: false,
            error: None,
            names: Vec::new(),
            hazards: Hazards::default(),
            held: HashMap::new(),
            descriptors: Descriptors::new(device),
            timer: Timer::new(device),
            push: Vec::new(),
            uses: Vec::new(),
            #[cfg(test)]
            skip_barriers: false,
            device: Arc::clone(device),
        };
        recorder.pool = queue::command_pool(device, "recorder")?;
        recorder.commands = queue::command_buffer(device, recorder.pool, "recorder")?;
        recorder.fence = queue::fence(device, "recorder")?;
        Ok(recorder)
    }

    /// Turns the timing of passes off or on; a new recorder has it on, where the queue has
    /// timestamps. Software drivers wait at each timestamp: on lavapipe an empty pass takes 75 µs
    /// with timing and 30 µs without.
    ///
    /// # Panics
    /// Where something is recorded already.
    pub fn set_timing(&mut self, on: bool) {
        assert!(!self.is_recording, "timing is turned in the middle of a recording");
        self.timer.turn(on);
    }

    /// Begins a pass: bind what the kernel needs, then dispatch. `name` is its debug label and
    /// its row in the timings.
    pub fn pass<'a>(&'a mut self, name: &'static str, kernel: &'a Kernel) -> PassBuilder<'a> {
        self.assert_same_device(kernel.inner.device(), name);
        self.push.clear();
        PassBuilder { bound: vec![None; kernel.inner.slots.len()], recorder: self, kernel, name }
    }

    /// Fills a range of a buffer with copies of `value`.
    ///
    /// # Panics
    /// Where the range leaves the buffer, or is not of whole, aligned words.
    pub fn fill(&mut self, buffer: &Buffer, offset: u64, bytes: u64, value: u32) {
        self.assert_same_device(buffer.inner.device(), buffer.name());
        buffer.inner.assert_in_range("fill", offset, bytes);
        assert!(
            offset.is_multiple_of(4) && bytes.is_multiple_of(4),
            "fill of {bytes} bytes at {offset}: buffer '{}' is filled by words",
            buffer.name()
        );
        if bytes == 0 {
            return;
        }
        self.record(|this| {
            this.timer.interrupt();
            this.hold_buffer(buffer);
            this.order(&[(buffer.id(), Access::Write)]);
            let raw = &this.device.raw;
            // SAFETY: `record` has begun the command buffer; the buffer is of this device, held,
            // and the range was checked.
            unsafe { raw.cmd_fill_buffer(this.commands, buffer.inner.raw, offset, bytes, value) };
            Ok(())
        });
    }

    /// Copies a range of one buffer to another, or to another place of the same buffer.
    ///
    /// # Panics
    /// Where a range leaves its buffer, or the two overlap.
    pub fn copy(
        &mut self,
        from: &Buffer,
        from_offset: u64,
        to: &Buffer,
        to_offset: u64,
        bytes: u64,
    ) {
        self.assert_same_device(from.inner.device(), from.name());
        self.assert_same_device(to.inner.device(), to.name());
        from.inner.assert_in_range("copy", from_offset, bytes);
        to.inner.assert_in_range("copy", to_offset, bytes);
        assert!(
            from.id() != to.id() || from_offset.abs_diff(to_offset) >= bytes,
            "copy of {bytes} bytes from {from_offset} to {to_offset} of '{}' overlaps",
            from.name()
        );
        if bytes == 0 {
            return;
        }
        self.record(|this| {
            this.timer.interrupt();
            this.hold_buffer(from);
            this.hold_buffer(to);
            this.order(&[(from.id(), Access::Read), (to.id(), Access::Write)]);
            let region =
                [vk::BufferCopy { src_offset: from_offset, dst_offset: to_offset, size: bytes }];
            let (source, target) = (from.inner.raw, to.inner.raw);
            // SAFETY: `record` has begun the command buffer; both buffers are of this device,
            // held, and the ranges were checked.
            unsafe { this.device.raw.cmd_copy_buffer(this.commands, source, target, &region) };
            Ok(())
        });
    }

    /// Copies all pixels of an image to a buffer, 16 bytes each, row after row.
    ///
    /// # Panics
    /// Where they do not fit, or `to_offset` is not a multiple of 16.
    pub fn copy_image(&mut self, from: &Image, to: &Buffer, to_offset: u64) {
        self.assert_same_device(from.inner.device(), from.name());
        self.assert_same_device(to.inner.device(), to.name());
        to.inner.assert_in_range("copy", to_offset, from.inner.packed_bytes());
        assert!(
            to_offset.is_multiple_of(ImageFormat::PIXEL_BYTES),
            "copy of image '{}' to {to_offset}: not on a pixel of buffer '{}'",
            from.name(),
            to.name()
        );
        self.record(|this| {
            this.timer.interrupt();
            this.held.entry(from.id()).or_insert_with(|| Arc::clone(&from.inner) as _);
            this.hold_buffer(to);
            this.order(&[(from.id(), Access::Read), (to.id(), Access::Write)]);
            let [width, height] = from.size();
            let region = [vk::BufferImageCopy::default()
                .buffer_offset(to_offset)
                .image_subresource(vk::ImageSubresourceLayers {
                    aspect_mask: vk::ImageAspectFlags::COLOR,
                    mip_level: 0,
                    base_array_layer: 0,
                    layer_count: 1,
                })
                .image_extent(vk::Extent3D { width, height, depth: 1 })];
            // SAFETY: `record` has begun the command buffer; image and buffer are of this device,
            // held, and the buffer is long enough; images are in layout GENERAL.
            unsafe {
                this.device.raw.cmd_copy_image_to_buffer(
                    this.commands,
                    from.inner.raw,
                    vk::ImageLayout::GENERAL,
                    to.inner.raw,
                    &region,
                );
            }
            Ok(())
        });
    }

    /// Runs what was recorded and waits for it, then begins anew. With nothing recorded it does
    /// nothing.
    ///
    /// Returns the first error of recording, if there was one, and then runs nothing.
    pub fn submit(&mut self) -> Result<Timings, GpuError> {
        let result = self.run();
        self.error = None;
        self.is_recording = false;
        self.names.clear();
        self.hazards.clear();
        self.held.clear();
        self.timer.clear();
        result
    }

    fn run(&mut self) -> Result<Timings, GpuError> {
        if let Some(error) = self.error.take() {
            return Err(error);
        }
        if !self.is_recording {
            return Ok(Timings::default());
        }
        let raw = &self.device.raw;
        // SAFETY: the command buffer is in the recording state, and executable after its end;
        // the fence is this recorder's own; what the commands use is in `held`.
        let ran = unsafe {
            access::release(raw, self.commands);
            raw.end_command_buffer(self.commands)
                .map_err(GpuError::call("vkEndCommandBuffer", "recorder"))?;
            self.device.queue().run(raw, self.commands, self.fence)
        };
        ran.map_err(|(call, source)| match source {
            vk::Result::ERROR_DEVICE_LOST => GpuError::DeviceLost { work: describe(&self.names) },
            source => GpuError::call(call, "recorder")(source),
        })?;
        let milliseconds = self.timer.read()?;
        self.descriptors.trim()?;
        Ok(Timings { passes: self.names.iter().copied().zip(milliseconds).collect() })
    }

    /// Runs `commands` with the command buffer in the recording state, unless something went
    /// wrong before, and keeps what goes wrong now.
    fn record(&mut self, commands: impl FnOnce(&mut Self) -> Result<(), GpuError>) {
        if self.error.is_none() {
            self.error = self.begin().and_then(|()| commands(self)).err();
        }
    }

    fn begin(&mut self) -> Result<(), GpuError> {
        if self.is_recording {
            return Ok(());
        }
        let raw = &self.device.raw;
        let info = vk::CommandBufferBeginInfo::default()
            .flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
        // SAFETY: pool and command buffer are this recorder's own, and the last submission was
        // waited for.
        unsafe {
            raw.reset_command_pool(self.pool, vk::CommandPoolResetFlags::empty())
                .map_err(GpuError::call("vkResetCommandPool", "recorder"))?;
            raw.begin_command_buffer(self.commands, &info)
                .map_err(GpuError::call("vkBeginCommandBuffer", "recorder"))?;
        }
        self.is_recording = true;
        Ok(())
    }

    /// Records the barrier that the next command needs, if it needs one.
    fn order(&mut self, uses: &[(u64, Access)]) {
        let needs_barrier = self.hazards.command(uses);
        #[cfg(test)]
        let needs_barrier = needs_barrier && !self.skip_barriers;
        if needs_barrier {
            // SAFETY: called from within `record`, so the command buffer has been begun.
            unsafe { access::barrier(&self.device.raw, self.commands) };
        }
    }

    fn hold_buffer(&mut self, buffer: &Buffer) {
        self.held.entry(buffer.id()).or_insert_with(|| Arc::clone(&buffer.inner) as _);
    }

    fn assert_same_device(&self, device: &Arc<Device>, object: &str) {
        assert!(Arc::ptr_eq(&self.device, device), "'{object}' and the recorder: two devices");
    }
}

impl fmt::Debug for Recorder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Recorder").field("names", &self.names).finish_non_exhaustive()
    }
}

impl Drop for Recorder {
    fn drop(&mut self) {
        let raw = &self.device.raw;
        // SAFETY: created by this device for this recorder alone; every submission was waited
        // for. Handles left null by a failed `new` are ignored.
        unsafe {
            raw.destroy_fence(self.fence, None);
            raw.destroy_command_pool(self.pool, None);
        }
    }
}

/// A pass under construction. Nothing is recorded until one of the `dispatch` calls.
#[must_use = "a pass is recorded by its dispatch"]
#[derive(Debug)]
pub struct PassBuilder<'a> {
    recorder: &'a mut Recorder,
    kernel: &'a Kernel,
    name: &'static str,
    /// One for each slot of the kernel.
    bound: Vec<Option<Bound>>,
}

/// How many workgroups run.
enum Groups<'a> {
    Direct([u32; 3]),
    Indirect(&'a Buffer, u64),
}

impl PassBuilder<'_> {
    /// Binds a buffer, as storage or as texels, whichever the kernel's list says.
    ///
    /// # Panics
    /// Where the kernel has no such binding, an image there, or the binding is taken.
    pub fn buffer(self, binding: u32, buffer: &Buffer) -> Self {
        self.buffer_part(binding, buffer, 0, buffer.bytes())
    }

    /// Binds a part of a buffer as storage. Its offset is a multiple of [`PART_ALIGNMENT`].
    ///
    /// # Panics
    /// As [`buffer`](Self::buffer), and where the part leaves the buffer, begins at another offset, or is not
    /// the whole and the kernel reads texels.
    pub fn buffer_part(mut self, binding: u32, buffer: &Buffer, offset: u64, bytes: u64) -> Self {
        self.recorder.assert_same_device(buffer.inner.device(), buffer.name());
        let slot = self.slot(binding);
        let kind = self.kernel.inner.slots[slot].kind;
        let is_buffer = kind != Binding::StorageImage;
        assert!(is_buffer, "pass '{}': binding {binding} is an image", self.name);
        buffer.inner.assert_in_range("binding", offset, bytes);
        assert!(
            offset.is_multiple_of(PART_ALIGNMENT) && bytes > 0,
            "pass '{}': a part of {bytes} bytes of buffer '{}' at {offset}",
            self.name,
            buffer.name()
        );
        if matches!(kind, Binding::UniformTexelBuffer(_)) {
            assert!(bytes == buffer.bytes(), "pass '{}': texels are bound as a whole", self.name);
        } else {
            let limit = self.recorder.device.limits().max_storage_buffer_range;
            if bytes > limit {
                let error = GpuError::BufferTooLarge { name: buffer.name(), needed: bytes, limit };
                self.recorder.error.get_or_insert(error);
            }
        }
        self.bound[slot] = Some(Bound::Buffer(buffer.clone(), [offset, bytes]));
        self
    }

    /// Binds an image.
    ///
    /// # Panics
    /// Where the kernel has no such binding, a buffer there or an image of another format, or the
    /// binding is taken.
    pub fn image(mut self, binding: u32, image: &Image) -> Self {
        self.recorder.assert_same_device(image.inner.device(), image.name());
        let slot = self.slot(binding);
        let expected = &self.kernel.inner.slots[slot];
        let is_image = expected.kind == Binding::StorageImage;
        assert!(is_image, "pass '{}': binding {binding} is a buffer", self.name);
        let texel = match image.format() {
            ImageFormat::Rgba32Uint => TexelType::Uint,
            ImageFormat::Rgba32Float => TexelType::Float,
        };
        assert!(
            !expected.is_in_module || expected.texel == texel,
            "pass '{}': binding {binding} has pixels of {:?}, image '{}' of {texel:?}",
            self.name,
            expected.texel,
            image.name()
        );
        self.bound[slot] = Some(Bound::Image(image.clone()));
        self
    }

    /// Sets the push constants.
    pub fn push<T: NoUninit>(self, value: &T) -> Self {
        self.recorder.push.clear();
        self.recorder.push.extend_from_slice(bytemuck::bytes_of(value));
        self
    }

    /// Records the pass with at least this many invocations along each axis, rounded up to whole
    /// workgroups: the kernel ignores those beyond the edge. With none along an axis it records
    /// nothing.
    ///
    /// # Panics
    /// Where a binding of the kernel is missing, or the push constants have another size.
    pub fn dispatch(self, invocations: [u32; 3]) {
        self.assert_complete();
        let limits = self.recorder.device.limits().max_compute_workgroup_count;
        let mut groups = [0; 3];
        for (axis, letter) in ['x', 'y', 'z'].into_iter().enumerate() {
            groups[axis] = invocations[axis].div_ceil(self.kernel.inner.group_size[axis]);
            let (pass, groups, limit) = (self.name, groups[axis], limits[axis]);
            if groups > limit {
                let error = GpuError::DispatchTooLarge { pass, axis: letter, groups, limit };
                self.recorder.error.get_or_insert(error);
                return;
            }
        }
        if !groups.contains(&0) {
            self.record(Groups::Direct(groups));
        }
    }

    /// Records the pass with the three workgroup counts (not invocations) that the buffer holds
    /// at `offset` when the pass runs. Nothing checks them against the device's limit.
    ///
    /// # Panics
    /// As [`dispatch`](Self::dispatch), and where the counts are not inside the buffer on a
    /// whole word.
    pub fn dispatch_indirect(self, counts: &Buffer, offset: u64) {
        self.assert_complete();
        self.recorder.assert_same_device(counts.inner.device(), counts.name());
        counts.inner.assert_in_range("indirect dispatch", offset, INDIRECT_BYTES);
        assert!(offset.is_multiple_of(4), "pass '{}': indirect counts at {offset}", self.name);
        self.record(Groups::Indirect(counts, offset));
    }

    /// The slot of a binding, which must be free.
    fn slot(&self, binding: u32) -> usize {
        let slots = &self.kernel.inner.slots;
        let slot = slots.iter().position(|slot| slot.binding == binding).unwrap_or(slots.len());
        assert!(slot < slots.len(), "pass '{}': no binding {binding} in its kernel", self.name);
        assert!(self.bound[slot].is_none(), "pass '{}': binding {binding} bound twice", self.name);
        slot
    }

    fn assert_complete(&self) {
        let Self { name, kernel, .. } = self;
        for (slot, bound) in kernel.inner.slots.iter().zip(&self.bound) {
            assert!(bound.is_some(), "pass '{name}': binding {} is missing", slot.binding);
        }
        let (pushed, expected) = (self.recorder.push.len(), kernel.inner.push_bytes);
        assert_eq!(pushed, expected, "pass '{name}': bytes of push constants");
    }

    fn record(self, groups: Groups<'_>) {
        let Self { recorder, kernel, name, bound } = self;
        let bound: Vec<Bound> = bound.into_iter().flatten().collect();
        recorder.record(|this| this.record_pass(name, kernel, &bound, groups));
    }
}

impl Recorder {
    fn record_pass(
        &mut self,
        name: &'static str,
        kernel: &Kernel,
        bound: &[Bound],
        groups: Groups<'_>,
    ) -> Result<(), GpuError> {
        let kernel = &kernel.inner;
        let pipeline = kernel.pipeline()?;
        let set = self.descriptors.set(kernel, pipeline.set_layout, bound)?;
        self.held.entry(kernel.id).or_insert_with(|| Arc::clone(kernel) as _);
        let mut uses = std::mem::take(&mut self.uses);
        uses.clear();
        for (slot, bound) in kernel.slots.iter().zip(bound) {
            uses.push((bound.id(), slot.access));
            self.held.entry(bound.id()).or_insert_with(|| match bound {
                Bound::Buffer(buffer, _) => Arc::clone(&buffer.inner) as _,
                Bound::Image(image) => Arc::clone(&image.inner) as _,
            });
        }
        if let Groups::Indirect(counts, _) = groups {
            self.hold_buffer(counts);
            uses.push((counts.id(), Access::Read));
        }
        self.order(&uses);
        self.uses = uses;

        let (raw, commands) = (&self.device.raw, self.commands);
        // SAFETY: called from within `record`, so the command buffer has been begun. Kernel, set
        // and resources are of this device and held; the set was made for the kernel's layout;
        // the push constants have the layout's size; the counts are within the device's limits,
        // or in a buffer of at least their length.
        unsafe {
            self.device.begin_label(commands, name);
            self.timer.begin(commands)?;
            raw.cmd_bind_pipeline(commands, vk::PipelineBindPoint::COMPUTE, pipeline.raw);
            raw.cmd_bind_descriptor_sets(
                commands,
                vk::PipelineBindPoint::COMPUTE,
                pipeline.layout,
                0,
                &[set],
                &[],
            );
            if !self.push.is_empty() {
                let stage = vk::ShaderStageFlags::COMPUTE;
                raw.cmd_push_constants(commands, pipeline.layout, stage, 0, &self.push);
            }
            match groups {
                Groups::Direct([x, y, z]) => raw.cmd_dispatch(commands, x, y, z),
                Groups::Indirect(counts, offset) => {
                    raw.cmd_dispatch_indirect(commands, counts.inner.raw, offset);
                }
            }
            self.timer.end(commands)?;
            self.device.end_label(commands);
        }
        self.names.push(name);
        Ok(())
    }
}

/// The passes of a recording in words, each name once.
fn describe(names: &[&str]) -> String {
    let mut unique: Vec<&str> = Vec::new();
    for name in names {
        if !unique.contains(name) {
            unique.push(name);
        }
    }
    let quoted: Vec<String> = unique.iter().map(|name| format!("'{name}'")).collect();
    match quoted.len() {
        0 => "fills and copies".to_owned(),
        1 => format!("pass {}", quoted[0]),
        _ => format!("one of the passes {}", quoted.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::device_with_validation;

    /// The tests that expect silence prove nothing unless this one is loud.
    #[test]
    fn a_missing_barrier_is_collected() {
        let device = device_with_validation();
        let [a, b] = ["a", "b"].map(|name| Buffer::new(&device, name, 64).unwrap());
        let mut rec = Recorder::new(&device).unwrap();
        for skip_barriers in [false, true] {
            rec.skip_barriers = skip_barriers;
            rec.fill(&a, 0, 64, 1);
            rec.copy(&a, 0, &b, 0, 64);
            rec.submit().unwrap();
            let messages = device.instance().validation_messages();
            let has_hazard = messages.iter().any(|message| message.contains("HAZARD"));
            assert_eq!(has_hazard, skip_barriers, "{messages:?}");
        }
    }

    #[test]
    fn a_lost_device_names_each_pass_once() {
        assert_eq!(describe(&[]), "fills and copies");
        assert_eq!(describe(&["trace", "trace"]), "pass 'trace'");
        assert_eq!(describe(&["a", "b", "a"]), "one of the passes 'a', 'b'");
    }
}
