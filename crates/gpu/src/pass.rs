//! Passes: what a kernel is given, and how much of it runs.

use crate::access::Access;
use crate::buffer::Buffer;
use crate::descriptors::Bound;
use crate::error::GpuError;
use crate::image::{Image, ImageFormat};
use crate::kernel::{Binding, Kernel, Slot, TexelType, name_of};
use crate::recorder::Recorder;
use ash::vk;
use bytemuck::NoUninit;
use std::sync::Arc;

/// What the offset of a part of a storage buffer must be a multiple of, on any device.
pub const PART_ALIGNMENT: u64 = 256;

/// Bytes of the three workgroup counts of an indirect dispatch.
const INDIRECT_BYTES: u64 = 12;

/// Buffers and images by the numbers of bindings; each pass takes from it what its kernel uses.
#[derive(Debug, Clone, Default)]
pub struct Bindings {
    bound: Vec<Option<Bound>>,
}

impl Bindings {
    /// With nothing in it.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// The same with a buffer at a binding, in place of what was there.
    #[must_use]
    pub fn buffer(mut self, binding: u32, buffer: &Buffer) -> Self {
        self.set(binding, Bound::Buffer(buffer.clone(), [0, buffer.bytes()]));
        self
    }

    /// The same with an image.
    #[must_use]
    pub fn image(mut self, binding: u32, image: &Image) -> Self {
        self.set(binding, Bound::Image(image.clone()));
        self
    }

    /// The same with all of another table, in place of what was there.
    #[must_use]
    pub fn extended(mut self, other: &Self) -> Self {
        for (binding, bound) in (0..).zip(&other.bound) {
            if let Some(bound) = bound {
                self.set(binding, bound.clone());
            }
        }
        self
    }

    fn set(&mut self, binding: u32, bound: Bound) {
        let at = binding as usize;
        self.bound.resize(self.bound.len().max(at + 1), None);
        self.bound[at] = Some(bound);
    }

    fn get(&self, binding: u32) -> Option<&Bound> {
        self.bound.get(binding as usize)?.as_ref()
    }
}

/// A pass under construction. Nothing is recorded until one of the `dispatch` calls. What goes wrong is kept by the
/// recorder, whose next submission returns it.
#[must_use = "a pass is recorded by its dispatch"]
#[derive(Debug)]
pub struct PassBuilder<'a> {
    recorder: &'a mut Recorder,
    /// None where there is none on this device, which the recorder knows.
    kernel: Option<Kernel>,
    /// One for each slot of the kernel.
    bound: Vec<Option<Bound>>,
}

/// How many workgroups run.
enum Groups<'a> {
    Direct([u32; 3]),
    Indirect(&'a Buffer, u64),
}

impl<'a> PassBuilder<'a> {
    pub(crate) fn new(recorder: &'a mut Recorder, kernel: Option<Kernel>) -> Self {
        recorder.push.clear();
        let slots = kernel.as_ref().map_or(0, |kernel| kernel.inner.source().slots.len());
        PassBuilder { bound: vec![None; slots], recorder, kernel }
    }

    /// Binds a buffer, as storage or as texels, whichever the kernel asks for.
    pub fn buffer(self, binding: u32, buffer: &Buffer) -> Self {
        self.buffer_part(binding, buffer, 0, buffer.bytes())
    }

    /// Binds a part of a buffer as storage. Its offset is a multiple of [`PART_ALIGNMENT`].
    ///
    /// # Panics
    /// Where the part leaves the buffer, or begins at another offset.
    pub fn buffer_part(mut self, binding: u32, buffer: &Buffer, offset: u64, bytes: u64) -> Self {
        buffer.inner.assert_in_range("binding", offset, bytes);
        assert!(
            offset.is_multiple_of(PART_ALIGNMENT) && bytes > 0,
            "a part of {bytes} bytes of buffer '{}' at {offset}",
            buffer.name()
        );
        self.bind_one(binding, Bound::Buffer(buffer.clone(), [offset, bytes]));
        self
    }

    /// Binds an image.
    pub fn image(mut self, binding: u32, image: &Image) -> Self {
        self.bind_one(binding, Bound::Image(image.clone()));
        self
    }

    /// Binds what the kernel uses and nothing is bound to yet, from a table.
    pub fn bind(mut self, bindings: &Bindings) -> Self {
        for at in 0..self.bound.len() {
            let slot = self.slots()[at];
            if self.bound[at].is_none()
                && let Some(bound) = bindings.get(slot.binding)
            {
                self.put(at, bound.clone());
            }
        }
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
    pub fn dispatch(self, invocations: [u32; 3]) {
        let Some(kernel) = &self.kernel else { return };
        let limits = self.recorder.device.limits().max_compute_workgroup_count;
        let mut groups = [0; 3];
        for (axis, letter) in ['x', 'y', 'z'].into_iter().enumerate() {
            groups[axis] = invocations[axis].div_ceil(kernel.group_size()[axis]);
            let (pass, groups, limit) = (kernel.name(), groups[axis], limits[axis]);
            if groups > limit {
                let error = GpuError::DispatchTooLarge { pass, axis: letter, groups, limit };
                self.recorder.fail(error);
                return;
            }
        }
        let none = groups.contains(&0);
        self.record(Groups::Direct(groups), none);
    }

    /// Records the pass with the three workgroup counts (not invocations) that the buffer holds
    /// at `offset` when the pass runs. Nothing checks them against the device's limit.
    ///
    /// # Panics
    /// Where the counts are not inside the buffer on a whole word.
    pub fn dispatch_indirect(self, counts: &Buffer, offset: u64) {
        self.recorder.assert_same_device(counts.inner.device(), counts.name());
        counts.inner.assert_in_range("indirect dispatch", offset, INDIRECT_BYTES);
        assert!(offset.is_multiple_of(4), "indirect counts at {offset}");
        self.record(Groups::Indirect(counts, offset), false);
    }

    fn slots(&self) -> &[Slot] {
        self.kernel.as_ref().map_or(&[], |kernel| &kernel.inner.source().slots)
    }

    fn bind_one(&mut self, binding: u32, bound: Bound) {
        match self.slots().iter().position(|slot| slot.binding == binding) {
            Some(at) => self.put(at, bound),
            None if self.kernel.is_some() => {
                self.fail(binding, "is bound, and the kernel does not use it")
            }
            None => {}
        }
    }

    /// Binds what fits the slot.
    fn put(&mut self, at: usize, bound: Bound) {
        let slot = self.slots()[at];
        let wrong = match (&bound, slot.kind) {
            (Bound::Buffer(..), Binding::StorageImage) => {
                Some("is an image, and a buffer is bound")
            }
            (Bound::Image(_), Binding::StorageImage) => None,
            (Bound::Image(_), _) => Some("is a buffer, and an image is bound"),
            (Bound::Buffer(buffer, part), Binding::UniformTexelBuffer(_)) => {
                (*part != [0, buffer.bytes()]).then_some("is read as texels, and a part is bound")
            }
            (Bound::Buffer(..), Binding::StorageBuffer) => None,
        };
        if let Some(wrong) = wrong {
            return self.fail(slot.binding, wrong);
        }
        match &bound {
            Bound::Buffer(buffer, [_, bytes]) => {
                self.recorder.assert_same_device(buffer.inner.device(), buffer.name());
                let limit = self.recorder.device.limits().max_storage_buffer_range;
                if slot.kind == Binding::StorageBuffer && *bytes > limit {
                    let (name, needed) = (buffer.name(), *bytes);
                    self.recorder.fail(GpuError::BufferTooLarge { name, needed, limit });
                }
            }
            Bound::Image(image) => {
                self.recorder.assert_same_device(image.inner.device(), image.name());
                let texel = match image.format() {
                    ImageFormat::Rgba32Uint => TexelType::Uint,
                    ImageFormat::Rgba32Float => TexelType::Float,
                };
                if slot.texel != texel {
                    return self.fail(slot.binding, "has pixels of another format than the image");
                }
            }
        }
        self.bound[at] = Some(bound);
    }

    fn fail(&mut self, binding: u32, reason: &'static str) {
        let pass = self.kernel.as_ref().map_or("", Kernel::name);
        self.recorder.fail(GpuError::Binding { pass, binding: name_of(binding), reason });
    }

    fn record(mut self, groups: Groups<'_>, none: bool) {
        let missing = self.bound.iter().position(Option::is_none);
        if let Some(at) = missing {
            return self.fail(self.slots()[at].binding, "is bound to nothing");
        }
        let Self { recorder, kernel, bound } = self;
        let Some(kernel) = kernel else { return };
        let (pushed, expected) = (recorder.push.len(), kernel.inner.source().module.push_bytes);
        if pushed != expected {
            let pass = kernel.name();
            return recorder.fail(GpuError::PushConstants { pass, pushed, expected });
        }
        if none {
            return;
        }
        let bound: Vec<Bound> = bound.into_iter().flatten().collect();
        recorder.record(|this| record_pass(this, &kernel, &bound, groups));
    }
}

fn record_pass(
    recorder: &mut Recorder,
    kernel: &Kernel,
    bound: &[Bound],
    groups: Groups<'_>,
) -> Result<(), GpuError> {
    let (name, kernel) = (kernel.name(), &kernel.inner);
    let pipeline = kernel.pipeline()?;
    let set = recorder.descriptors.set(kernel, pipeline.set_layout, bound)?;
    recorder.held.entry(kernel.id).or_insert_with(|| Arc::clone(kernel) as _);
    let mut uses = std::mem::take(&mut recorder.uses);
    uses.clear();
    for (slot, bound) in kernel.source().slots.iter().zip(bound) {
        uses.push((bound.id(), slot.access));
        recorder.held.entry(bound.id()).or_insert_with(|| match bound {
            Bound::Buffer(buffer, _) => Arc::clone(&buffer.inner) as _,
            Bound::Image(image) => Arc::clone(&image.inner) as _,
        });
    }
    if let Groups::Indirect(counts, _) = groups {
        recorder.hold_buffer(counts);
        uses.push((counts.id(), Access::Read));
    }
    recorder.order(&uses);
    recorder.uses = uses;

    let (raw, commands) = (&recorder.device.raw, recorder.commands);
    // SAFETY: called from within `record`, so the command buffer has been begun. Kernel, set
    // and resources are of this device and held; the set was made for the kernel's layout;
    // the push constants have the layout's size; the counts are within the device's limits,
    // or in a buffer of at least their length.
    unsafe {
        recorder.device.begin_label(commands, name);
        recorder.timer.begin(commands)?;
        raw.cmd_bind_pipeline(commands, vk::PipelineBindPoint::COMPUTE, pipeline.raw);
        raw.cmd_bind_descriptor_sets(
            commands,
            vk::PipelineBindPoint::COMPUTE,
            pipeline.layout,
            0,
            &[set],
            &[],
        );
        if !recorder.push.is_empty() {
            let stage = vk::ShaderStageFlags::COMPUTE;
            raw.cmd_push_constants(commands, pipeline.layout, stage, 0, &recorder.push);
        }
        match groups {
            Groups::Direct([x, y, z]) => raw.cmd_dispatch(commands, x, y, z),
            Groups::Indirect(counts, offset) => {
                raw.cmd_dispatch_indirect(commands, counts.inner.raw, offset);
            }
        }
        recorder.timer.end(commands)?;
        recorder.device.end_label(commands);
    }
    recorder.names.push(name);
    Ok(())
}
