//! Descriptor sets, written once for each combination of kernel and resources.
//!
//! A render dispatches the same few kernels on the same few buffers over and over, so sets are
//! kept from one submission to the next and found by ids. Ids are never used twice: a set that
//! names a destroyed object is never found again, and goes when the cache is emptied.

use crate::buffer::Buffer;
use crate::device::Device;
use crate::error::GpuError;
use crate::image::Image;
use crate::kernel::{Binding, KernelInner, Texel};
use ash::vk;
use std::collections::HashMap;
use std::sync::Arc;

/// Sets of one pool, which has room for [`POOL_DESCRIPTORS`] descriptors of each kind.
const POOL_SETS: u32 = 64;
const POOL_DESCRIPTORS: u32 = 8 * POOL_SETS;

/// Sets after which the cache is emptied between two submissions.
const MAX_SETS: usize = 1024;

/// What is bound at a slot of a kernel.
#[derive(Debug, Clone)]
pub(crate) enum Bound {
    /// And which part of it, where it is bound as storage: first byte and length.
    Buffer(Buffer, [u64; 2]),
    Image(Image),
}

impl Bound {
    pub(crate) fn id(&self) -> u64 {
        match self {
            Self::Buffer(buffer, _) => buffer.id(),
            Self::Image(image) => image.id(),
        }
    }
}

/// The sets of one recorder.
pub(crate) struct Descriptors {
    pools: Vec<vk::DescriptorPool>,
    /// The first pool that may have room.
    open_pool: usize,
    /// By kernel id and then the resources' ids, with their parts, in the order of the kernel's slots.
    sets: HashMap<Vec<u64>, vk::DescriptorSet>,
    /// The key of the set looked for, kept for its memory.
    key: Vec<u64>,
    device: Arc<Device>,
}

impl Descriptors {
    pub(crate) fn new(device: &Arc<Device>) -> Self {
        Self {
            pools: Vec::new(),
            open_pool: 0,
            sets: HashMap::new(),
            key: Vec::new(),
            device: Arc::clone(device),
        }
    }

    /// The set that binds `bound` to the kernel's slots, one for one, in the layout of its pipeline.
    pub(crate) fn set(
        &mut self,
        kernel: &KernelInner,
        layout: vk::DescriptorSetLayout,
        bound: &[Bound],
    ) -> Result<vk::DescriptorSet, GpuError> {
        self.key.clear();
        self.key.push(kernel.id);
        for bound in bound {
            self.key.push(bound.id());
            if let Bound::Buffer(_, part) = bound {
                self.key.extend(part);
            }
        }
        if let Some(&set) = self.sets.get(&self.key) {
            return Ok(set);
        }
        let set = self.allocate(kernel, layout)?;
        self.write(set, kernel, bound)?;
        self.sets.insert(self.key.clone(), set);
        Ok(set)
    }

    /// Empties the cache if it has grown large. Call it only when no recorded or pending work
    /// uses a set.
    pub(crate) fn trim(&mut self) -> Result<(), GpuError> {
        if self.sets.len() <= MAX_SETS {
            return Ok(());
        }
        self.sets.clear();
        self.open_pool = 0;
        for &pool in &self.pools {
            let flags = vk::DescriptorPoolResetFlags::empty();
            // SAFETY: made by this device; nothing uses its sets, as the caller promises, and
            // none can be found any more.
            unsafe { self.device.raw.reset_descriptor_pool(pool, flags) }
                .map_err(GpuError::call("vkResetDescriptorPool", "descriptors"))?;
        }
        Ok(())
    }

    fn allocate(
        &mut self,
        kernel: &KernelInner,
        layout: vk::DescriptorSetLayout,
    ) -> Result<vk::DescriptorSet, GpuError> {
        let layouts = [layout];
        let failed = GpuError::call("vkAllocateDescriptorSets", kernel.source().name);
        loop {
            let is_new = self.open_pool == self.pools.len();
            if is_new {
                let pool = self.new_pool(kernel)?;
                self.pools.push(pool);
            }
            let info = vk::DescriptorSetAllocateInfo::default()
                .descriptor_pool(self.pools[self.open_pool])
                .set_layouts(&layouts);
            // SAFETY: pool and layout are alive and of this device; the pool is used here alone.
            match unsafe { self.device.raw.allocate_descriptor_sets(&info) } {
                Ok(sets) => {
                    let set = sets.first().copied();
                    return set.ok_or_else(|| failed(vk::Result::ERROR_UNKNOWN));
                }
                Err(vk::Result::ERROR_OUT_OF_POOL_MEMORY | vk::Result::ERROR_FRAGMENTED_POOL)
                    if !is_new =>
                {
                    self.open_pool += 1
                }
                Err(result) => return Err(failed(result)),
            }
        }
    }

    /// A pool with room for `kernel`'s set, and for many of the usual size.
    fn new_pool(&self, kernel: &KernelInner) -> Result<vk::DescriptorPool, GpuError> {
        let count = POOL_DESCRIPTORS.max(kernel.source().slots.len() as u32);
        let of_kind = |kind: Binding| {
            vk::DescriptorPoolSize::default().ty(kind.descriptor_type()).descriptor_count(count)
        };
        let sizes = [
            of_kind(Binding::StorageBuffer),
            of_kind(Binding::StorageImage),
            of_kind(Binding::UniformTexelBuffer(Texel::Four)),
        ];
        let info = vk::DescriptorPoolCreateInfo::default().max_sets(POOL_SETS).pool_sizes(&sizes);
        // SAFETY: the counts are above zero.
        let pool = unsafe { self.device.raw.create_descriptor_pool(&info, None) }
            .map_err(GpuError::call("vkCreateDescriptorPool", "descriptors"))?;
        self.device.set_name(pool, "descriptors");
        Ok(pool)
    }

    fn write(
        &self,
        set: vk::DescriptorSet,
        kernel: &KernelInner,
        bound: &[Bound],
    ) -> Result<(), GpuError> {
        for (slot, bound) in kernel.source().slots.iter().zip(bound) {
            let write = vk::WriteDescriptorSet::default()
                .dst_set(set)
                .dst_binding(slot.binding)
                .descriptor_type(slot.kind.descriptor_type());
            let (buffer, view, image);
            let write = match (slot.kind, bound) {
                (Binding::UniformTexelBuffer(texel), Bound::Buffer(bound, _)) => {
                    view = [bound.inner.texel_view(slot.texel, texel)?];
                    write.texel_buffer_view(&view)
                }
                (_, Bound::Buffer(bound, [offset, bytes])) => {
                    buffer = [vk::DescriptorBufferInfo::default()
                        .buffer(bound.inner.raw)
                        .offset(*offset)
                        .range(*bytes)];
                    write.buffer_info(&buffer)
                }
                (_, Bound::Image(bound)) => {
                    image = [vk::DescriptorImageInfo::default()
                        .image_view(bound.inner.view)
                        .image_layout(vk::ImageLayout::GENERAL)];
                    write.image_info(&image)
                }
            };
            // SAFETY: the set is new, so no work uses it; the recorder asserted that what is
            // bound fits the slot's kind and is of this device, and holds it while it is used.
            unsafe { self.device.raw.update_descriptor_sets(&[write], &[]) };
        }
        Ok(())
    }
}

impl Drop for Descriptors {
    fn drop(&mut self) {
        for &pool in &self.pools {
            // SAFETY: created by this device; the recorder that owns the sets waited for every
            // submission, so no pending work refers to them.
            unsafe { self.device.raw.destroy_descriptor_pool(pool, None) };
        }
    }
}
