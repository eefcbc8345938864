//! Pipelines: made when a pass first needs one, or ahead of that on another thread, and kept as long as their
//! device, so that no kernel is compiled that nothing asked for, and none twice.

use crate::device::Device;
use crate::error::GpuError;
use crate::kernel::Source;
use ash::vk;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// All pipelines of a device.
#[derive(Default)]
pub(crate) struct Pipelines {
    made: Mutex<HashMap<Arc<PipelineKey>, Made>>,
}

/// A pipeline, once it is made; whoever makes it holds the lock.
type Made = Arc<Mutex<Option<Pipeline>>>;

/// Values of the specialization constants 0 and 1.
pub type Constants = [u32; 2];

/// What a pipeline is made from.
#[derive(Debug, PartialEq, Eq, Hash)]
pub(crate) struct PipelineKey {
    pub(crate) source: Arc<Source>,
    /// Of the specialization constants, where the module has any.
    pub(crate) constants: Option<Constants>,
}

/// A pipeline and what it takes to use it. Lives as long as its device.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Pipeline {
    pub(crate) raw: vk::Pipeline,
    pub(crate) layout: vk::PipelineLayout,
    pub(crate) set_layout: vk::DescriptorSetLayout,
}

impl Pipelines {
    /// The pipeline of this key, made if it is the first time; waited for, if another thread is making it. Threads
    /// that ask for different ones do not wait for each other. `device` is the one that these are of.
    pub(crate) fn get(
        &self,
        device: &Device,
        key: &Arc<PipelineKey>,
    ) -> Result<Pipeline, GpuError> {
        let of_key = Arc::clone(locked(&self.made).entry(Arc::clone(key)).or_default());
        let mut made = locked(&of_key);
        if let Some(pipeline) = *made {
            return Ok(pipeline);
        }
        let mut pipeline = Pipeline::default();
        if let Err(error) = pipeline.create(device, key) {
            pipeline.destroy(&device.raw);
            return Err(error);
        }
        *made = Some(pipeline);
        Ok(pipeline)
    }

    /// How many were asked for.
    pub(crate) fn count(&self) -> usize {
        locked(&self.made).len()
    }

    /// Destroys all of them. No pending work may use one, and none may be used again.
    pub(crate) fn destroy(&self, raw: &ash::Device) {
        for (_, made) in locked(&self.made).drain() {
            if let Some(pipeline) = locked(&made).take() {
                pipeline.destroy(raw);
            }
        }
    }
}

/// A lock that no panic leaves in a bad state.
fn locked<T>(lock: &Mutex<T>) -> MutexGuard<'_, T> {
    lock.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Pipeline {
    fn create(&mut self, device: &Device, key: &PipelineKey) -> Result<(), GpuError> {
        let raw = &device.raw;
        let Source { name, words, module, slots, .. } = &*key.source;
        let bindings: Vec<_> = (slots.iter())
            .map(|slot| {
                vk::DescriptorSetLayoutBinding::default()
                    .binding(slot.binding)
                    .descriptor_type(slot.kind.descriptor_type())
                    .descriptor_count(1)
                    .stage_flags(vk::ShaderStageFlags::COMPUTE)
            })
            .collect();
        let info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
        // SAFETY: the binding numbers differ, as `slots` sees to, and their count is in range.
        self.set_layout = unsafe { raw.create_descriptor_set_layout(&info, None) }
            .map_err(GpuError::call("vkCreateDescriptorSetLayout", name))?;
        device.set_name(self.set_layout, name);

        let set_layouts = [self.set_layout];
        let push = [vk::PushConstantRange::default()
            .stage_flags(vk::ShaderStageFlags::COMPUTE)
            .size(module.push_bytes as u32)];
        // A range may not be empty.
        let push = if module.push_bytes == 0 { &[] } else { &push[..] };
        let info = vk::PipelineLayoutCreateInfo::default()
            .set_layouts(&set_layouts)
            .push_constant_ranges(push);
        // SAFETY: the set layout was just made, and the push constants are within the limit.
        self.layout = unsafe { raw.create_pipeline_layout(&info, None) }
            .map_err(GpuError::call("vkCreatePipelineLayout", name))?;
        device.set_name(self.layout, name);

        let info = vk::ShaderModuleCreateInfo::default().code(words);
        // SAFETY: the module is valid: one of those that `kernels` was built with, or as the caller of `of_words`
        // promises.
        let shader = unsafe { raw.create_shader_module(&info, None) }
            .map_err(GpuError::call("vkCreateShaderModule", name))?;
        device.set_name(shader, name);
        let constants = key.constants.unwrap_or_default();
        let entry = |id: u32| {
            let entry = vk::SpecializationMapEntry::default().size(size_of::<u32>());
            entry.constant_id(id).offset(id * size_of::<u32>() as u32)
        };
        let entries = [entry(0), entry(1)];
        let specialization = vk::SpecializationInfo::default()
            .map_entries(&entries)
            .data(bytemuck::bytes_of(&constants));
        let stage = vk::PipelineShaderStageCreateInfo::default()
            .stage(vk::ShaderStageFlags::COMPUTE)
            .module(shader)
            .name(&module.entry);
        let stage = match key.constants {
            Some(_) => stage.specialization_info(&specialization),
            None => stage,
        };
        let info = vk::ComputePipelineCreateInfo::default().stage(stage).layout(self.layout);
        // SAFETY: the module has this entry point; the layout was just made and holds every
        // binding of the module. A pipeline does not need its shader module once it exists.
        let created = unsafe {
            let created = raw.create_compute_pipelines(vk::PipelineCache::null(), &[info], None);
            raw.destroy_shader_module(shader, None);
            created
        };
        let failed = GpuError::call("vkCreateComputePipelines", name);
        let pipelines = created.map_err(|(_, result)| failed(result))?;
        let pipeline = pipelines.first().copied();
        self.raw = pipeline.ok_or_else(|| failed(vk::Result::ERROR_UNKNOWN))?;
        device.set_name(self.raw, name);
        Ok(())
    }

    fn destroy(self, raw: &ash::Device) {
        // SAFETY: made by this device; the caller says that nothing uses them any more. Descriptor sets of
        // the layout may outlive it as long as nobody updates them. Null handles are ignored.
        unsafe {
            raw.destroy_pipeline(self.raw, None);
            raw.destroy_pipeline_layout(self.layout, None);
            raw.destroy_descriptor_set_layout(self.set_layout, None);
        }
    }
}
