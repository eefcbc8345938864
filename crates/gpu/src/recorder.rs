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
use crate::descriptors::Descriptors;
use crate::device::Device;
use crate::error::GpuError;
use crate::image::{Image, ImageFormat};
use crate::kernel::Kernel;
use crate::pass::PassBuilder;
use crate::pipelines::Constants;
use crate::queue;
use crate::timer::Timer;
use ash::vk;
use kernels::spirv::Module;
use std::any::Any;
use std::collections::HashMap;
use std::fmt;
use std::sync::Arc;

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
    pub(crate) commands: vk::CommandBuffer,
    fence: vk::Fence,
    is_recording: bool,
    /// The first thing that went wrong since the last submission.
    error: Option<GpuError>,
    /// Passes recorded.
    pub(crate) names: Vec<&'static str>,
    hazards: Hazards,
    /// What the recording uses, by id.
    pub(crate) held: HashMap<u64, Arc<dyn Any + Send + Sync>>,
    pub(crate) descriptors: Descriptors,
    pub(crate) timer: Timer,
    /// Memory of passes under construction, kept for the next.
    pub(crate) push: Vec<u8>,
    pub(crate) uses: Vec<(u64, Access)>,
    /// Kernels that passes have asked for, by module and constants.
    kernels: HashMap<(&'static str, Option<Constants>), Kernel>,
    constants: Option<Constants>,
    #[cfg(test)]
    skip_barriers: bool,
    pub(crate) device: Arc<Device>,
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
            kernels: HashMap::new(),
            constants: None,
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

    /// Kernels of the project's modules are specialized by these values from now on, where their modules have such constants.
    pub fn specialize(&mut self, constants: Constants) {
        self.constants = Some(constants);
    }

    /// Begins a pass of one of the project's modules: bind what it needs, then dispatch. The kernel's name is the pass's
    /// debug label and its row in the timings.
    pub fn pass(&mut self, module: &'static Module) -> PassBuilder<'_> {
        self.pass_specialized(module, self.constants)
    }

    /// The same with values of the specialization constants for this pass only.
    pub fn pass_specialized(
        &mut self,
        module: &'static Module,
        constants: Option<Constants>,
    ) -> PassBuilder<'_> {
        let kernel = match self.kernels.get(&(module.name(), constants)) {
            Some(kernel) => Some(kernel.clone()),
            None => match Kernel::new(&self.device, module, constants) {
                Ok(kernel) => {
                    self.kernels.insert((module.name(), constants), kernel.clone());
                    Some(kernel)
                }
                Err(error) => {
                    self.fail(error);
                    None
                }
            },
        };
        PassBuilder::new(self, kernel)
    }

    /// Begins a pass of any kernel.
    pub fn pass_of(&mut self, kernel: &Kernel) -> PassBuilder<'_> {
        self.assert_same_device(kernel.inner.device(), kernel.name());
        PassBuilder::new(self, Some(kernel.clone()))
    }

    /// Keeps what went wrong, if nothing did before.
    pub(crate) fn fail(&mut self, error: GpuError) {
        self.error.get_or_insert(error);
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
    pub(crate) fn record(&mut self, commands: impl FnOnce(&mut Self) -> Result<(), GpuError>) {
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
    pub(crate) fn order(&mut self, uses: &[(u64, Access)]) {
        let needs_barrier = self.hazards.command(uses);
        #[cfg(test)]
        let needs_barrier = needs_barrier && !self.skip_barriers;
        if needs_barrier {
            // SAFETY: called from within `record`, so the command buffer has been begun.
            unsafe { access::barrier(&self.device.raw, self.commands) };
        }
    }

    pub(crate) fn hold_buffer(&mut self, buffer: &Buffer) {
        self.held.entry(buffer.id()).or_insert_with(|| Arc::clone(&buffer.inner) as _);
    }

    pub(crate) fn assert_same_device(&self, device: &Arc<Device>, object: &str) {
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
