//! Compute pipelines.
//!
//! The list of bindings a kernel is made with is checked against its module, so a binding number
//! that moved on one side fails at once and by name, not as a black picture.

use crate::access::Access;
use crate::device::Device;
use crate::error::GpuError;
use crate::next_id;
use crate::pipelines::{Pipeline, PipelineKey};
use crate::spirv::{Module, ResourceKind};
use ash::vk;
use std::fmt;
use std::sync::{Arc, OnceLock};
use std::time::Instant;

/// What a kernel expects at a binding.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Binding {
    /// A [`Buffer`](crate::Buffer) as `buffer`.
    StorageBuffer,
    /// An [`Image`](crate::Image) as `image2D` or `uimage2D`.
    StorageImage,
    /// A [`Buffer`](crate::Buffer) as `samplerBuffer`, `isamplerBuffer` or `usamplerBuffer`, with
    /// texels of so many values of 4 bytes. Which of the three is read from the module.
    UniformTexelBuffer(Texel),
}

/// How many values a texel of a buffer has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Texel {
    /// One: a list of words.
    One,
    /// Two: a list of pairs.
    Two,
    /// Four: records of 16 bytes, or of multiples of that.
    Four,
}

impl Texel {
    /// Of a texel.
    #[must_use]
    pub fn bytes(self) -> u64 {
        match self {
            Self::One => 4,
            Self::Two => 8,
            Self::Four => 16,
        }
    }
}

/// The type of a texel's values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum TexelType {
    Float,
    Int,
    Uint,
}

/// A compute kernel. Its pipeline is made when a pass first uses it, or by [`make_ahead`](Self::make_ahead), and then
/// kept by the device for every kernel like it; cloning gives another handle.
#[derive(Clone)]
pub struct Kernel {
    pub(crate) inner: Arc<KernelInner>,
}

pub(crate) struct KernelInner {
    pipeline: OnceLock<Pipeline>,
    key: Arc<PipelineKey>,
    pub(crate) name: &'static str,
    pub(crate) id: u64,
    pub(crate) group_size: [u32; 3],
    pub(crate) push_bytes: usize,
    pub(crate) slots: Vec<Slot>,
    device: Arc<Device>,
}

/// One binding, as the list and the module agree on it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Slot {
    pub(crate) binding: u32,
    pub(crate) kind: Binding,
    /// Meaningless for storage buffers and where the module does not use the binding.
    pub(crate) texel: TexelType,
    pub(crate) access: Access,
    pub(crate) is_in_module: bool,
}

impl Kernel {
    /// A kernel of a valid SPIR-V module with one compute entry point. What the driver finds wrong with it
    /// is an error of the submission that first uses it.
    ///
    /// All bindings are in set 0. One that the module does not use may be listed all the same.
    ///
    /// # Panics
    /// Where `bindings` lists a number twice, or lacks or contradicts one of the module's; where
    /// `push_bytes` is not a multiple of four.
    pub fn new(
        device: &Arc<Device>,
        name: &'static str,
        spirv: &[u32],
        bindings: &[(u32, Binding)],
        push_bytes: usize,
    ) -> Result<Self, GpuError> {
        Self::specialized(device, name, spirv, bindings, push_bytes, None)
    }

    /// The same with a value for the module's specialization constant 0, an integer of 32 bits. Code that it
    /// rules out is not compiled. Without a value, the module's own counts.
    ///
    /// # Panics
    /// As [`Kernel::new`].
    pub fn specialized(
        device: &Arc<Device>,
        name: &'static str,
        spirv: &[u32],
        bindings: &[(u32, Binding)],
        push_bytes: usize,
        constant: Option<u32>,
    ) -> Result<Self, GpuError> {
        assert!(push_bytes.is_multiple_of(4), "kernel '{name}': {push_bytes} push constant bytes");
        let module =
            Module::read(spirv).map_err(|reason| GpuError::BadModule { kernel: name, reason })?;
        let slots = slots(name, bindings, &module);
        check_limits(device, name, &module, &slots, push_bytes)?;

        let key = PipelineKey {
            name,
            spirv: spirv.to_vec(),
            entry: module.entry,
            bindings: bindings.to_vec(),
            push_bytes,
            constant,
        };
        let inner = KernelInner {
            pipeline: OnceLock::new(),
            key: Arc::new(key),
            name,
            id: next_id(),
            group_size: module.group_size,
            push_bytes,
            slots,
            device: Arc::clone(device),
        };
        Ok(Self { inner: Arc::new(inner) })
    }

    /// Invocations of one workgroup, as the module has them.
    pub fn group_size(&self) -> [u32; 3] {
        self.inner.group_size
    }

    /// Makes its pipeline, if there is none yet, so that no pass has to wait for it. Meant for another thread than
    /// the one that records passes: they may work on different pipelines at once.
    ///
    /// # Errors
    /// A driver that rejects the pipeline. A pass that uses it will say so too.
    pub fn make_ahead(&self) -> Result<(), GpuError> {
        let KernelInner { device, key, .. } = &*self.inner;
        device.pipelines.get(device, key).map(|_| ())
    }

    /// Its name in messages.
    pub fn name(&self) -> &'static str {
        self.inner.name
    }
}

impl fmt::Debug for Kernel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { inner } = self;
        f.debug_struct("Kernel")
            .field("name", &inner.name)
            .field("group_size", &inner.group_size)
            .finish_non_exhaustive()
    }
}

impl KernelInner {
    /// The device it belongs to.
    pub(crate) fn device(&self) -> &Arc<Device> {
        &self.device
    }

    /// Its pipeline, made if this is the first time that any kernel of the device like it is asked.
    pub(crate) fn pipeline(&self) -> Result<Pipeline, GpuError> {
        if let Some(pipeline) = self.pipeline.get() {
            return Ok(*pipeline);
        }
        let asked = Instant::now();
        let made = self.device.pipelines.get(&self.device, &self.key)?;
        self.device.add_pipeline_time(asked.elapsed());
        Ok(*self.pipeline.get_or_init(|| made))
    }
}

impl Binding {
    pub(crate) fn descriptor_type(self) -> vk::DescriptorType {
        match self {
            Self::StorageBuffer => vk::DescriptorType::STORAGE_BUFFER,
            Self::StorageImage => vk::DescriptorType::STORAGE_IMAGE,
            Self::UniformTexelBuffer(_) => vk::DescriptorType::UNIFORM_TEXEL_BUFFER,
        }
    }
}

impl TexelType {
    /// All devices allow these for uniform texel buffers.
    pub(crate) fn format(self, texel: Texel) -> vk::Format {
        match (self, texel) {
            (Self::Float, Texel::One) => vk::Format::R32_SFLOAT,
            (Self::Float, Texel::Two) => vk::Format::R32G32_SFLOAT,
            (Self::Float, Texel::Four) => vk::Format::R32G32B32A32_SFLOAT,
            (Self::Int, Texel::One) => vk::Format::R32_SINT,
            (Self::Int, Texel::Two) => vk::Format::R32G32_SINT,
            (Self::Int, Texel::Four) => vk::Format::R32G32B32A32_SINT,
            (Self::Uint, Texel::One) => vk::Format::R32_UINT,
            (Self::Uint, Texel::Two) => vk::Format::R32G32_UINT,
            (Self::Uint, Texel::Four) => vk::Format::R32G32B32A32_UINT,
        }
    }
}

/// The listed bindings with what the module says of them.
fn slots(name: &str, bindings: &[(u32, Binding)], module: &Module) -> Vec<Slot> {
    let mut slots: Vec<Slot> = Vec::with_capacity(bindings.len());
    for &(binding, kind) in bindings {
        let is_new = slots.iter().all(|slot| slot.binding != binding);
        assert!(is_new, "kernel '{name}': binding {binding} is listed twice");
        let (texel, access) = (TexelType::Float, Access::Read);
        slots.push(Slot { binding, kind, texel, access, is_in_module: false });
    }
    for resource in &module.resources {
        let binding = resource.binding;
        assert_eq!(resource.set, 0, "kernel '{name}': set of binding {binding}");
        let slot = slots.iter_mut().find(|slot| slot.binding == binding);
        assert!(slot.is_some(), "kernel '{name}': binding {binding} is not listed");
        let Some(slot) = slot else { continue };
        let (kind, texel) = match (resource.kind, slot.kind) {
            (ResourceKind::StorageBuffer, _) => (Some(Binding::StorageBuffer), slot.texel),
            (ResourceKind::StorageImage(texel), _) => (Some(Binding::StorageImage), texel),
            // How many values a texel has is not in the module.
            (ResourceKind::UniformTexelBuffer(texel), Binding::UniformTexelBuffer(_)) => {
                (Some(slot.kind), texel)
            }
            (ResourceKind::UniformTexelBuffer(_) | ResourceKind::Other, _) => (None, slot.texel),
        };
        assert_eq!(
            kind,
            Some(slot.kind),
            "kernel '{name}': binding {binding} in the module, and in the list"
        );
        slot.texel = texel;
        slot.is_in_module = true;
        if resource.access == Access::Write {
            // Two variables may share a binding; one that writes is enough.
            slot.access = Access::Write;
        }
    }
    slots
}

fn check_limits(
    device: &Device,
    kernel: &'static str,
    module: &Module,
    slots: &[Slot],
    push_bytes: usize,
) -> Result<(), GpuError> {
    let limits = &device.vk_limits;
    let count = |kind| slots.iter().filter(|slot| slot.kind == kind).count() as u32;
    let buffers = count(Binding::StorageBuffer);
    let images = count(Binding::StorageImage);
    let is_texels = |slot: &&Slot| matches!(slot.kind, Binding::UniformTexelBuffer(_));
    let texel_buffers = slots.iter().filter(is_texels).count() as u32;
    let [x, y, z] = module.group_size;
    let invocations = [y, z].into_iter().fold(x, u32::saturating_mul);
    let [max_x, max_y, max_z] = limits.max_compute_work_group_size;
    let size = "maxComputeWorkGroupSize";
    let checks = [
        (
            "storage buffers",
            buffers,
            "maxPerStageDescriptorStorageBuffers",
            limits.max_per_stage_descriptor_storage_buffers,
        ),
        (
            "storage images",
            images,
            "maxPerStageDescriptorStorageImages",
            limits.max_per_stage_descriptor_storage_images,
        ),
        (
            "texel buffers",
            texel_buffers,
            "maxPerStageDescriptorSampledImages",
            limits.max_per_stage_descriptor_sampled_images,
        ),
        (
            "bindings",
            buffers + images + texel_buffers,
            "maxPerStageResources",
            limits.max_per_stage_resources,
        ),
        (
            "push constant bytes",
            u32::try_from(push_bytes).unwrap_or(u32::MAX),
            "maxPushConstantsSize",
            limits.max_push_constants_size,
        ),
        (
            "invocations in a workgroup",
            invocations,
            "maxComputeWorkGroupInvocations",
            limits.max_compute_work_group_invocations,
        ),
        ("invocations along x of a workgroup", x, size, max_x),
        ("invocations along y of a workgroup", y, size, max_y),
        ("invocations along z of a workgroup", z, size, max_z),
    ];
    for (what, needed, limit_name, limit) in checks {
        if needed > limit {
            return Err(GpuError::KernelTooLarge { kernel, what, needed, limit_name, limit });
        }
    }
    Ok(())
}
