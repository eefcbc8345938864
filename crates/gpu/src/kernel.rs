//! Compute pipelines.
//!
//! The list of bindings a kernel is made with is checked against its module, so a binding number
//! that moved on one side fails at once and by name, not as a black picture.

use crate::access::Access;
use crate::device::Device;
use crate::error::GpuError;
use crate::next_id;
use crate::spirv::{Module, ResourceKind};
use ash::vk;
use std::fmt;
use std::sync::Arc;
use std::time::Instant;

/// What a kernel expects at a binding.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Binding {
    /// A [`Buffer`](crate::Buffer) as `buffer`.
    StorageBuffer,
    /// An [`Image`](crate::Image) as `image2D` or `uimage2D`.
    StorageImage,
    /// A [`Buffer`](crate::Buffer) as `samplerBuffer`, `isamplerBuffer` or `usamplerBuffer`, with
    /// texels of four values, 16 bytes. Which of the three is read from the module.
    UniformTexelBuffer,
}

/// The type of the four values of a texel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum TexelType {
    Float,
    Int,
    Uint,
}

/// A compute pipeline. Cloning gives another handle to the same pipeline; the last one destroys
/// it.
#[derive(Clone)]
pub struct Kernel {
    pub(crate) inner: Arc<KernelInner>,
}

pub(crate) struct KernelInner {
    pub(crate) pipeline: vk::Pipeline,
    pub(crate) layout: vk::PipelineLayout,
    pub(crate) set_layout: vk::DescriptorSetLayout,
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
    /// Builds the pipeline of a valid SPIR-V module with one compute entry point.
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
        assert!(push_bytes.is_multiple_of(4), "kernel '{name}': {push_bytes} push constant bytes");
        let module =
            Module::read(spirv).map_err(|reason| GpuError::BadModule { kernel: name, reason })?;
        let slots = slots(name, bindings, &module);
        check_limits(device, name, &module, &slots, push_bytes)?;

        // From here on `Drop` cleans up after a failure.
        let mut inner = KernelInner {
            pipeline: vk::Pipeline::null(),
            layout: vk::PipelineLayout::null(),
            set_layout: vk::DescriptorSetLayout::null(),
            name,
            id: next_id(),
            group_size: module.group_size,
            push_bytes,
            slots,
            device: Arc::clone(device),
        };
        inner.create_layouts()?;
        inner.create_pipeline(spirv, &module)?;
        Ok(Self { inner: Arc::new(inner) })
    }

    /// Invocations of one workgroup, as the module has them.
    pub fn group_size(&self) -> [u32; 3] {
        self.inner.group_size
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

    fn create_layouts(&mut self) -> Result<(), GpuError> {
        let raw = &self.device.raw;
        let bindings: Vec<_> = self
            .slots
            .iter()
            .map(|slot| {
                vk::DescriptorSetLayoutBinding::default()
                    .binding(slot.binding)
                    .descriptor_type(slot.kind.descriptor_type())
                    .descriptor_count(1)
                    .stage_flags(vk::ShaderStageFlags::COMPUTE)
            })
            .collect();
        let info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
        // SAFETY: the binding numbers differ, as `slots` asserts, and their count is in range.
        self.set_layout = unsafe { raw.create_descriptor_set_layout(&info, None) }
            .map_err(GpuError::call("vkCreateDescriptorSetLayout", self.name))?;
        self.device.set_name(self.set_layout, self.name);

        let set_layouts = [self.set_layout];
        let push = [vk::PushConstantRange::default()
            .stage_flags(vk::ShaderStageFlags::COMPUTE)
            .size(self.push_bytes as u32)];
        // A range may not be empty.
        let push = if self.push_bytes == 0 { &[] } else { &push[..] };
        let info = vk::PipelineLayoutCreateInfo::default()
            .set_layouts(&set_layouts)
            .push_constant_ranges(push);
        // SAFETY: the set layout was just made, and the push constants are within the limit.
        self.layout = unsafe { raw.create_pipeline_layout(&info, None) }
            .map_err(GpuError::call("vkCreatePipelineLayout", self.name))?;
        self.device.set_name(self.layout, self.name);
        Ok(())
    }

    fn create_pipeline(&mut self, spirv: &[u32], module: &Module) -> Result<(), GpuError> {
        let started = Instant::now();
        let raw = &self.device.raw;
        let info = vk::ShaderModuleCreateInfo::default().code(spirv);
        // SAFETY: the caller of `Kernel::new` gives a valid module, whose head was read.
        let shader = unsafe { raw.create_shader_module(&info, None) }
            .map_err(GpuError::call("vkCreateShaderModule", self.name))?;
        self.device.set_name(shader, self.name);
        let stage = vk::PipelineShaderStageCreateInfo::default()
            .stage(vk::ShaderStageFlags::COMPUTE)
            .module(shader)
            .name(&module.entry);
        let info = vk::ComputePipelineCreateInfo::default().stage(stage).layout(self.layout);
        // SAFETY: the module has this entry point; the layout was just made and holds every
        // binding of the module. A pipeline does not need its shader module once it exists.
        let created = unsafe {
            let created = raw.create_compute_pipelines(vk::PipelineCache::null(), &[info], None);
            raw.destroy_shader_module(shader, None);
            created
        };
        let failed = GpuError::call("vkCreateComputePipelines", self.name);
        let pipelines = created.map_err(|(_, result)| failed(result))?;
        let pipeline = pipelines.first().copied();
        self.pipeline = pipeline.ok_or_else(|| failed(vk::Result::ERROR_UNKNOWN))?;
        self.device.add_pipeline_time(started.elapsed());
        self.device.set_name(self.pipeline, self.name);
        Ok(())
    }
}

impl Drop for KernelInner {
    fn drop(&mut self) {
        let raw = &self.device.raw;
        // SAFETY: created by this device in `new`; a `Recorder` holds an `Arc` of every kernel it
        // used until its fence has signalled, so no pending work refers to it. Descriptor sets of
        // the layout may outlive it as long as nobody updates them, and they are found by the
        // kernel's id. Handles left null by a failed `new` are ignored by all three calls.
        unsafe {
            raw.destroy_pipeline(self.pipeline, None);
            raw.destroy_pipeline_layout(self.layout, None);
            raw.destroy_descriptor_set_layout(self.set_layout, None);
        }
    }
}

impl Binding {
    pub(crate) fn descriptor_type(self) -> vk::DescriptorType {
        match self {
            Self::StorageBuffer => vk::DescriptorType::STORAGE_BUFFER,
            Self::StorageImage => vk::DescriptorType::STORAGE_IMAGE,
            Self::UniformTexelBuffer => vk::DescriptorType::UNIFORM_TEXEL_BUFFER,
        }
    }
}

impl TexelType {
    pub(crate) fn format(self) -> vk::Format {
        match self {
            Self::Float => vk::Format::R32G32B32A32_SFLOAT,
            Self::Int => vk::Format::R32G32B32A32_SINT,
            Self::Uint => vk::Format::R32G32B32A32_UINT,
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
        let (kind, texel) = match resource.kind {
            ResourceKind::StorageBuffer => (Some(Binding::StorageBuffer), slot.texel),
            ResourceKind::StorageImage(texel) => (Some(Binding::StorageImage), texel),
            ResourceKind::UniformTexelBuffer(texel) => (Some(Binding::UniformTexelBuffer), texel),
            ResourceKind::Other => (None, slot.texel),
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
    let texel_buffers = count(Binding::UniformTexelBuffer);
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
