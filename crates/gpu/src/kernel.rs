//! Compute kernels: what a module says of its bindings and push constants, and its pipeline.

use crate::access::Access;
use crate::device::Device;
use crate::error::GpuError;
use crate::next_id;
use crate::pipelines::{Constants, Pipeline, PipelineKey};
use crate::spirv::{Reflection, ResourceKind};
use ash::vk;
use kernels::layout;
use kernels::spirv::Module;
use std::borrow::Cow;
use std::collections::HashMap;
use std::fmt;
use std::hash::{Hash, Hasher};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::Instant;

/// What a kernel expects at a binding.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Binding {
    /// A [`Buffer`](crate::Buffer) as `buffer`.
    StorageBuffer,
    /// An [`Image`](crate::Image) as `image2D` or `uimage2D`.
    StorageImage,
    /// A [`Buffer`](crate::Buffer) as `samplerBuffer`, `isamplerBuffer` or `usamplerBuffer`, with
    /// texels of so many values of 4 bytes.
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
    pub(crate) id: u64,
    device: Arc<Device>,
}

/// A module as it was read, once a run.
#[derive(Debug)]
pub(crate) struct Source {
    id: u64,
    pub(crate) name: &'static str,
    pub(crate) words: Cow<'static, [u32]>,
    pub(crate) module: Reflection,
    pub(crate) slots: Vec<Slot>,
}

impl PartialEq for Source {
    fn eq(&self, other: &Self) -> bool {
        self.id == other.id
    }
}

impl Eq for Source {}

impl Hash for Source {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.id.hash(state);
    }
}

/// One binding of a module.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Slot {
    pub(crate) binding: u32,
    pub(crate) kind: Binding,
    /// Meaningless for storage buffers.
    pub(crate) texel: TexelType,
    pub(crate) access: Access,
}

impl Source {
    fn new(
        name: &'static str,
        words: Cow<'static, [u32]>,
        texel: impl Fn(u32) -> Option<Texel>,
    ) -> Result<Self, GpuError> {
        let bad = |reason| GpuError::BadModule { kernel: name, reason };
        let module = Reflection::read(&words).map_err(bad)?;
        let slots = slots(&module, texel).map_err(bad)?;
        Ok(Self { id: next_id(), name, words, module, slots })
    }

    /// Of one of the project's modules; read when it is first asked for.
    fn of(module: &'static Module) -> Result<Arc<Self>, GpuError> {
        static READ: Mutex<Option<HashMap<&'static str, Arc<Source>>>> = Mutex::new(None);
        let mut read = READ.lock().unwrap_or_else(PoisonError::into_inner);
        let read = read.get_or_insert_default();
        if let Some(found) = read.get(module.name()) {
            return Ok(Arc::clone(found));
        }
        let words = Cow::Borrowed(module.words());
        let texel = |number| match layout::binding(number)?.texel {
            1 => Some(Texel::One),
            2 => Some(Texel::Two),
            4 => Some(Texel::Four),
            _ => None,
        };
        let source = Arc::new(Self::new(module.kernel(), words, texel)?);
        read.insert(module.name(), Arc::clone(&source));
        Ok(source)
    }
}

impl Kernel {
    /// A kernel of one of the project's modules. Where that has specialization constants 0 and 1, integers of 32 bits,
    /// `constants` are their values, and code that these rule out is not compiled; without any the module's own count. What
    /// the driver finds wrong is an error of the submission that first uses it.
    ///
    /// # Errors
    /// A device whose limits it is over.
    pub fn new(
        device: &Arc<Device>,
        module: &'static Module,
        constants: Option<Constants>,
    ) -> Result<Self, GpuError> {
        Self::of_source(device, Source::of(module)?, constants)
    }

    /// A kernel of any module, all of whose texel buffers have texels of so many values.
    ///
    /// # Errors
    /// Words that are no module of one compute kernel with all bindings in set 0; a device whose limits it is over.
    ///
    /// # Safety
    /// The words are valid SPIR-V for a Vulkan 1.1 device with the features that [`Device::open`] turns on.
    pub unsafe fn of_words(
        device: &Arc<Device>,
        name: &'static str,
        words: Vec<u32>,
        texel: Texel,
    ) -> Result<Self, GpuError> {
        let source = Source::new(name, Cow::Owned(words), |_| Some(texel))?;
        Self::of_source(device, Arc::new(source), None)
    }

    fn of_source(
        device: &Arc<Device>,
        source: Arc<Source>,
        constants: Option<Constants>,
    ) -> Result<Self, GpuError> {
        check_limits(device, &source)?;
        let constants = constants.filter(|_| source.module.is_specialized);
        let inner = KernelInner {
            pipeline: OnceLock::new(),
            key: Arc::new(PipelineKey { source, constants }),
            id: next_id(),
            device: Arc::clone(device),
        };
        Ok(Self { inner: Arc::new(inner) })
    }

    /// Invocations of one workgroup, as the module has them.
    pub fn group_size(&self) -> [u32; 3] {
        self.inner.source().module.group_size
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
        self.inner.source().name
    }
}

impl fmt::Debug for Kernel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { inner } = self;
        f.debug_struct("Kernel")
            .field("name", &inner.source().name)
            .field("group_size", &inner.source().module.group_size)
            .finish_non_exhaustive()
    }
}

impl KernelInner {
    /// Its module.
    pub(crate) fn source(&self) -> &Source {
        &self.key.source
    }

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

/// The bindings of a module. `texel` says how many values a texel has, which is not in the module.
fn slots(module: &Reflection, texel: impl Fn(u32) -> Option<Texel>) -> Result<Vec<Slot>, String> {
    let mut slots: Vec<Slot> = Vec::with_capacity(module.resources.len());
    for resource in &module.resources {
        let binding = resource.binding;
        if resource.set != 0 {
            return Err(format!("{} is in set {}, not 0", name_of(binding), resource.set));
        }
        let no_texels = || format!("{} is read as texels, and has none", name_of(binding));
        let (kind, of_texel) = match resource.kind {
            ResourceKind::StorageBuffer => (Binding::StorageBuffer, TexelType::Float),
            ResourceKind::StorageImage(texel) => (Binding::StorageImage, texel),
            ResourceKind::UniformTexelBuffer(value) => {
                (Binding::UniformTexelBuffer(texel(binding).ok_or_else(no_texels)?), value)
            }
            ResourceKind::Other => {
                return Err(format!("{} is neither a buffer nor an image", name_of(binding)));
            }
        };
        let access = resource.access;
        match slots.iter_mut().find(|slot| slot.binding == binding) {
            // Two variables may share a binding; one that writes is enough.
            Some(slot) if slot.kind == kind && slot.texel == of_texel => {
                slot.access = if access == Access::Write { access } else { slot.access };
            }
            Some(_) => return Err(format!("{} is of two kinds", name_of(binding))),
            None => slots.push(Slot { binding, kind, texel: of_texel, access }),
        }
    }
    Ok(slots)
}

/// Of a binding, for messages.
pub(crate) fn name_of(binding: u32) -> String {
    let known = layout::binding(binding);
    known
        .map_or_else(|| format!("binding {binding}"), |known| format!("{} ({binding})", known.name))
}

fn check_limits(device: &Device, source: &Source) -> Result<(), GpuError> {
    let Source { name: kernel, module, slots, .. } = source;
    let push_bytes = module.push_bytes;
    if module.votes && device.limits().subgroup_size == 0 {
        return Err(GpuError::NoVotes { kernel });
    }
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
