//! Storage buffers in device memory.
//!
//! Where device memory is mapped and coherent, as on processors and integrated GPUs, the host
//! writes it directly; elsewhere copies go through the queue's staging buffer. Reading directly
//! also asks for cached memory: uncached reads are slower than a copy.

use crate::device::Device;
use crate::error::GpuError;
use crate::kernel::{Texel, TexelType};
use crate::next_id;
use ash::vk;
use bytemuck::{AnyBitPattern, NoUninit};
use gpu_allocator::MemoryLocation;
use gpu_allocator::vulkan::Allocation;
use std::ffi::c_void;
use std::fmt;
use std::mem::MaybeUninit;
use std::ptr::NonNull;
use std::sync::{Arc, Mutex, PoisonError};

/// Bytes of the largest texel of a buffer bound as [`Binding::UniformTexelBuffer`](crate::Binding).
const TEXEL_BYTES: u64 = 16;

/// A storage buffer. Cloning gives another handle to the same buffer; the last one frees it.
#[derive(Clone)]
pub struct Buffer {
    pub(crate) inner: Arc<BufferInner>,
}

pub(crate) struct BufferInner {
    pub(crate) raw: vk::Buffer,
    pub(crate) bytes: u64,
    pub(crate) id: u64,
    pub(crate) name: &'static str,
    allocation: Option<Allocation>,
    /// By format.
    texel_views: Mutex<Vec<(vk::Format, vk::BufferView)>>,
    device: Arc<Device>,
}

impl Buffer {
    /// A buffer whose content is undefined. Zero bytes become 16, so that an empty list can be
    /// bound like any other.
    pub fn new(device: &Arc<Device>, name: &'static str, bytes: u64) -> Result<Self, GpuError> {
        let limit = device.limits().max_storage_buffer_range;
        if bytes > limit {
            return Err(GpuError::BufferTooLarge { name, needed: bytes, limit });
        }
        Self::paged(device, name, bytes)
    }

    /// The same for one that may be longer than a storage buffer binding: it is bound as texels, or in parts
    /// (`PassBuilder::buffer_part`).
    pub fn paged(device: &Arc<Device>, name: &'static str, bytes: u64) -> Result<Self, GpuError> {
        let bytes = if bytes == 0 { TEXEL_BYTES } else { bytes };
        let raw = &device.raw;
        // Whole texels, so that a texel view reaches the end.
        let info = vk::BufferCreateInfo::default().size(bytes.next_multiple_of(TEXEL_BYTES)).usage(
            vk::BufferUsageFlags::STORAGE_BUFFER
                | vk::BufferUsageFlags::UNIFORM_TEXEL_BUFFER
                | vk::BufferUsageFlags::INDIRECT_BUFFER
                | vk::BufferUsageFlags::TRANSFER_SRC
                | vk::BufferUsageFlags::TRANSFER_DST,
        );
        // SAFETY: the size is above zero and exclusive sharing needs no families.
        let buffer = unsafe { raw.create_buffer(&info, None) }
            .map_err(GpuError::call("vkCreateBuffer", name))?;
        // From here on `Drop` cleans up after a failure.
        let mut inner = BufferInner {
            raw: buffer,
            bytes,
            id: next_id(),
            name,
            allocation: None,
            texel_views: Mutex::default(),
            device: Arc::clone(device),
        };
        device.set_name(buffer, name);
        // SAFETY: `buffer` was made by this device.
        let requirements = unsafe { raw.get_buffer_memory_requirements(buffer) };
        let allocation = device.allocate(name, requirements, MemoryLocation::GpuOnly, true)?;
        let allocation = inner.allocation.insert(allocation);
        // SAFETY: the memory was allocated for this buffer's requirements, nothing was bound to
        // it before, and it is freed after the buffer is destroyed.
        unsafe { raw.bind_buffer_memory(buffer, allocation.memory(), allocation.offset()) }
            .map_err(GpuError::call("vkBindBufferMemory", name))?;
        Ok(Self { inner: Arc::new(inner) })
    }

    /// A buffer that holds `data`.
    pub fn from_slice<T: NoUninit>(
        device: &Arc<Device>,
        name: &'static str,
        data: &[T],
    ) -> Result<Self, GpuError> {
        let buffer = Self::new(device, name, size_of_val(data) as u64)?;
        buffer.write(0, data)?;
        Ok(buffer)
    }

    /// A buffer that holds `data`, and may be longer than a storage buffer binding.
    pub fn paged_from_slice<T: NoUninit>(
        device: &Arc<Device>,
        name: &'static str,
        data: &[T],
    ) -> Result<Self, GpuError> {
        let buffer = Self::paged(device, name, size_of_val(data) as u64)?;
        buffer.write(0, data)?;
        Ok(buffer)
    }

    /// Copies `data` to the buffer, `offset_bytes` from its start, and returns when it is there.
    ///
    /// # Panics
    /// Where `data` does not fit.
    pub fn write<T: NoUninit>(&self, offset_bytes: u64, data: &[T]) -> Result<(), GpuError> {
        let inner = &*self.inner;
        let data: &[u8] = bytemuck::cast_slice(data);
        inner.assert_in_range("write", offset_bytes, data.len() as u64);
        if data.is_empty() {
            return Ok(());
        }
        // Held to the end: the device is idle, and no other thread is at this buffer's memory.
        let mut queue = inner.device.queue();
        if let Some(start) = inner.mapped(vk::MemoryPropertyFlags::HOST_COHERENT) {
            // SAFETY: the mapping is at least `bytes` long and the range was checked; the lock
            // keeps the device and other threads away; `data` is host memory of its own.
            unsafe {
                let to = start.cast::<u8>().as_ptr().add(offset_bytes as usize);
                data.as_ptr().copy_to_nonoverlapping(to, data.len());
            }
            Ok(())
        } else {
            // SAFETY: the buffer is alive, of this device, and the range was checked.
            unsafe { queue.upload(&inner.device, inner.name, inner.raw, offset_bytes, data) }
        }
    }

    /// Copies from the buffer, `offset_bytes` from its start, and fills `out`.
    ///
    /// # Panics
    /// Where the buffer ends before `out` is full.
    pub fn read<T: AnyBitPattern>(&self, offset_bytes: u64, out: &mut [T]) -> Result<(), GpuError> {
        let inner = &*self.inner;
        let length = size_of_val(out);
        inner.assert_in_range("read", offset_bytes, length as u64);
        if length == 0 {
            return Ok(());
        }
        // SAFETY: the same memory as `out`, seen as bytes. Only initialised bytes are written to
        // it below, and `T` accepts any.
        let out = unsafe {
            let start = out.as_mut_ptr().cast::<MaybeUninit<u8>>();
            std::slice::from_raw_parts_mut(start, length)
        };
        // Held to the end, as in `write`.
        let mut queue = inner.device.queue();
        let cached = vk::MemoryPropertyFlags::HOST_COHERENT | vk::MemoryPropertyFlags::HOST_CACHED;
        if let Some(start) = inner.mapped(cached) {
            // SAFETY: as in `write`. What the device wrote is visible, since every submission
            // ends with a barrier towards the host and was waited for.
            unsafe {
                let from = start.cast::<MaybeUninit<u8>>().as_ptr().add(offset_bytes as usize);
                out.as_mut_ptr().copy_from_nonoverlapping(from, length);
            }
            Ok(())
        } else {
            // SAFETY: the buffer is alive, of this device, and the range was checked.
            unsafe { queue.download(&inner.device, inner.name, inner.raw, offset_bytes, out) }
        }
    }

    /// Its length.
    pub fn bytes(&self) -> u64 {
        self.inner.bytes
    }

    /// Its name in messages.
    pub fn name(&self) -> &'static str {
        self.inner.name
    }

    /// A number of its own, shared by its clones.
    pub fn id(&self) -> u64 {
        self.inner.id
    }
}

impl fmt::Debug for Buffer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { inner } = self;
        f.debug_struct("Buffer")
            .field("name", &inner.name)
            .field("bytes", &inner.bytes)
            .finish_non_exhaustive()
    }
}

impl BufferInner {
    /// The device it belongs to.
    pub(crate) fn device(&self) -> &Arc<Device> {
        &self.device
    }

    /// Asserts that a range lies inside the buffer.
    pub(crate) fn assert_in_range(&self, what: &str, offset: u64, bytes: u64) {
        assert!(
            offset.checked_add(bytes).is_some_and(|end| end <= self.bytes),
            "{what} of {bytes} bytes at {offset}: buffer '{}' has {} bytes",
            self.name,
            self.bytes
        );
    }

    /// Where the buffer is mapped, if its memory has these properties.
    fn mapped(&self, wanted: vk::MemoryPropertyFlags) -> Option<NonNull<c_void>> {
        let allocation = self.allocation.as_ref()?;
        let wanted = allocation.memory_properties().contains(wanted);
        if wanted { allocation.mapped_ptr() } else { None }
    }

    /// The buffer seen as texels.
    pub(crate) fn texel_view(
        &self,
        scalar: TexelType,
        texel: Texel,
    ) -> Result<vk::BufferView, GpuError> {
        let needed = self.bytes.div_ceil(texel.bytes());
        let limit = u64::from(self.device.limits().max_texel_buffer_elements);
        if needed > limit {
            return Err(GpuError::TexelBufferTooLarge { name: self.name, needed, limit });
        }
        let mut views = self.texel_views.lock().unwrap_or_else(PoisonError::into_inner);
        let format = scalar.format(texel);
        if let Some(&(_, view)) = views.iter().find(|view| view.0 == format) {
            return Ok(view);
        }
        let info = vk::BufferViewCreateInfo::default()
            .buffer(self.raw)
            .format(format)
            .range(needed * texel.bytes());
        // SAFETY: the buffer is alive, has memory and the usage, holds so many texels, as many as
        // the limit allows, and all devices allow the format.
        let view = unsafe { self.device.raw.create_buffer_view(&info, None) }
            .map_err(GpuError::call("vkCreateBufferView", self.name))?;
        self.device.set_name(view, self.name);
        views.push((format, view));
        Ok(view)
    }
}

impl Drop for BufferInner {
    fn drop(&mut self) {
        let raw = &self.device.raw;
        let views = self.texel_views.get_mut().unwrap_or_else(PoisonError::into_inner);
        // SAFETY: created by this device; a `Recorder` holds an `Arc` of every buffer it used
        // until its fence has signalled, so no pending work refers to it. Descriptor sets that
        // still name it are found by its id, and so never used again.
        unsafe {
            for &mut (_, view) in views {
                raw.destroy_buffer_view(view, None);
            }
            raw.destroy_buffer(self.raw, None);
        }
        self.device.free(self.allocation.take());
    }
}
