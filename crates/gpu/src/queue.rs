//! The device's one queue, used by one caller at a time.
//!
//! Whoever holds the lock around it submits, waits for the fence, and only then lets go. Host
//! access to buffers happens under the same lock: so the host never touches memory that the
//! device is working on, whatever threads do. The price is that nothing overlaps, and nothing
//! here would: a pass depends on the one before it.

use crate::access;
use crate::device::Device;
use crate::error::GpuError;
use ash::vk;
use gpu_allocator::MemoryLocation;
use gpu_allocator::vulkan::Allocation;
use std::ffi::c_void;
use std::mem::MaybeUninit;
use std::ptr::NonNull;

/// Bytes that go through the staging buffer at a time.
pub(crate) const STAGING_BYTES: usize = 16 << 20;

/// The queue, with what it takes to run small jobs of its own. Belongs to a [`Device`], which
/// calls [`destroy`](Self::destroy): no `Drop`, since it cannot hold the device that holds it.
pub(crate) struct Queue {
    raw: vk::Queue,
    pool: vk::CommandPool,
    commands: vk::CommandBuffer,
    fence: vk::Fence,
    staging: Option<Staging>,
}

/// A mapped buffer for copies to and from memory that the host cannot see.
struct Staging {
    buffer: vk::Buffer,
    allocation: Allocation,
}

impl Queue {
    /// All handles but the queue's are null until [`prepare`](Self::prepare).
    pub(crate) fn new(raw: vk::Queue) -> Self {
        Self {
            raw,
            pool: vk::CommandPool::null(),
            commands: vk::CommandBuffer::null(),
            fence: vk::Fence::null(),
            staging: None,
        }
    }

    /// Makes the queue's own command buffer and fence.
    pub(crate) fn prepare(&mut self, device: &Device) -> Result<(), GpuError> {
        device.set_name(self.raw, "compute queue");
        self.pool = command_pool(device, "transfers")?;
        self.commands = command_buffer(device, self.pool, "transfers")?;
        self.fence = fence(device, "transfers")?;
        Ok(())
    }

    /// Submits a recorded command buffer and waits until it is done. The error names the call.
    ///
    /// # Safety
    /// `commands` is executable, `fence` is in use by nothing else, both are of `raw`, whose
    /// queue this is, and whatever the commands use is alive.
    pub(crate) unsafe fn run(
        &mut self,
        raw: &ash::Device,
        commands: vk::CommandBuffer,
        fence: vk::Fence,
    ) -> Result<(), (&'static str, vk::Result)> {
        let commands = [commands];
        let submit = vk::SubmitInfo::default().command_buffers(&commands);
        // SAFETY: the handles are good, as the caller promises; `&mut self` makes this the only
        // thread at the queue.
        unsafe {
            raw.reset_fences(&[fence]).map_err(|result| ("vkResetFences", result))?;
            raw.queue_submit(self.raw, &[submit], fence)
                .map_err(|result| ("vkQueueSubmit", result))?;
            let waited = raw.wait_for_fences(&[fence], true, u64::MAX);
            if waited.is_err() {
                // The caller will free what the work uses: try harder to see its end. A lost
                // device answers at once, and its objects may then be destroyed.
                let _ = raw.device_wait_idle();
            }
            waited.map_err(|result| ("vkWaitForFences", result))
        }
    }

    /// Records one small job for `object`, runs it and waits for it.
    ///
    /// # Safety
    /// What `record` records is valid in a primary command buffer outside a render pass, and uses
    /// live objects of `device`, whose queue this is.
    pub(crate) unsafe fn once(
        &mut self,
        device: &Device,
        object: &'static str,
        record: impl FnOnce(vk::CommandBuffer),
    ) -> Result<(), GpuError> {
        let raw = &device.raw;
        let begin = vk::CommandBufferBeginInfo::default()
            .flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
        // SAFETY: pool, command buffer and fence were made by `prepare` and are used here alone;
        // the previous job was waited for, so the pool may be reset. For the rest the caller
        // answers.
        unsafe {
            raw.reset_command_pool(self.pool, vk::CommandPoolResetFlags::empty())
                .map_err(GpuError::call("vkResetCommandPool", object))?;
            raw.begin_command_buffer(self.commands, &begin)
                .map_err(GpuError::call("vkBeginCommandBuffer", object))?;
            record(self.commands);
            access::release(raw, self.commands);
            raw.end_command_buffer(self.commands)
                .map_err(GpuError::call("vkEndCommandBuffer", object))?;
            self.run(raw, self.commands, self.fence)
                .map_err(|(call, result)| GpuError::call(call, object)(result))
        }
    }

    /// Writes bytes to a buffer that the host cannot see.
    ///
    /// # Safety
    /// `buffer` is alive, of `device`, whose queue this is, may be a copy's destination, and is
    /// at least `offset + bytes.len()` long.
    pub(crate) unsafe fn upload(
        &mut self,
        device: &Device,
        name: &'static str,
        buffer: vk::Buffer,
        offset: u64,
        bytes: &[u8],
    ) -> Result<(), GpuError> {
        let (staging, mapped) = self.staging(device)?;
        let mut to = offset;
        for chunk in bytes.chunks(STAGING_BYTES) {
            let copy = [vk::BufferCopy { src_offset: 0, dst_offset: to, size: chunk.len() as u64 }];
            // SAFETY: the staging buffer is mapped, coherent, at least as long as a chunk, and
            // idle, since every job is waited for. The copy stays inside both buffers.
            unsafe {
                let chunk_start = chunk.as_ptr();
                chunk_start.copy_to_nonoverlapping(mapped.cast().as_ptr(), chunk.len());
                self.once(device, name, |commands| {
                    device.raw.cmd_copy_buffer(commands, staging, buffer, &copy);
                })?;
            }
            to += chunk.len() as u64;
        }
        Ok(())
    }

    /// Reads bytes of a buffer that the host cannot see. On success all of `out` is written.
    ///
    /// # Safety
    /// `buffer` is alive, of `device`, whose queue this is, may be a copy's source, and is at
    /// least `offset + out.len()` long.
    pub(crate) unsafe fn download(
        &mut self,
        device: &Device,
        name: &'static str,
        buffer: vk::Buffer,
        offset: u64,
        out: &mut [MaybeUninit<u8>],
    ) -> Result<(), GpuError> {
        let (staging, mapped) = self.staging(device)?;
        let mut from = offset;
        for chunk in out.chunks_mut(STAGING_BYTES) {
            let size = chunk.len() as u64;
            let copy = [vk::BufferCopy { src_offset: from, dst_offset: 0, size }];
            // SAFETY: as in `upload`; `once` ends with the barrier that shows the host what was
            // written, and has waited for the fence when it returns.
            unsafe {
                self.once(device, name, |commands| {
                    device.raw.cmd_copy_buffer(commands, buffer, staging, &copy);
                })?;
                let chunk_start = chunk.as_mut_ptr();
                chunk_start.copy_from_nonoverlapping(mapped.cast().as_ptr(), chunk.len());
            }
            from += size;
        }
        Ok(())
    }

    /// The staging buffer and where it is mapped, made on first use.
    fn staging(&mut self, device: &Device) -> Result<(vk::Buffer, NonNull<c_void>), GpuError> {
        let staging = match self.staging.take() {
            Some(staging) => staging,
            None => Staging::new(device)?,
        };
        let staging = self.staging.insert(staging);
        // The allocator promises coherent, mapped memory for this location.
        let mapped = staging.allocation.mapped_ptr().ok_or(GpuError::Call {
            call: "vkMapMemory",
            object: Staging::NAME,
            source: vk::Result::ERROR_MEMORY_MAP_FAILED,
        })?;
        Ok((staging.buffer, mapped))
    }

    /// Destroys everything but the staging buffer's memory, which is handed back to be freed.
    pub(crate) fn destroy(&mut self, raw: &ash::Device) -> Option<Allocation> {
        let staging = self.staging.take();
        // SAFETY: called once, by the device's `Drop`, with the device that made these handles.
        // Every job was waited for. Handles left null by a failed `prepare` are ignored.
        unsafe {
            if let Some(staging) = &staging {
                raw.destroy_buffer(staging.buffer, None);
            }
            raw.destroy_fence(self.fence, None);
            raw.destroy_command_pool(self.pool, None);
        }
        staging.map(|staging| staging.allocation)
    }
}

impl Staging {
    const NAME: &'static str = "staging";

    fn new(device: &Device) -> Result<Self, GpuError> {
        let raw = &device.raw;
        let info = vk::BufferCreateInfo::default()
            .size(STAGING_BYTES as u64)
            .usage(vk::BufferUsageFlags::TRANSFER_SRC | vk::BufferUsageFlags::TRANSFER_DST);
        // SAFETY: the size is above zero and exclusive sharing needs no families.
        let buffer = unsafe { raw.create_buffer(&info, None) }
            .map_err(GpuError::call("vkCreateBuffer", Self::NAME))?;
        device.set_name(buffer, Self::NAME);
        // SAFETY: `buffer` was made just above; if there is no memory for it nothing else knows
        // it, so it can be destroyed.
        unsafe {
            let requirements = raw.get_buffer_memory_requirements(buffer);
            // Cached where there is a choice: reading uncached memory is far slower than writing
            // cached memory.
            let location = MemoryLocation::GpuToCpu;
            let allocation = device
                .allocate(Self::NAME, requirements, location, true)
                .inspect_err(|_| raw.destroy_buffer(buffer, None))?;
            let bound = raw.bind_buffer_memory(buffer, allocation.memory(), allocation.offset());
            if let Err(result) = bound {
                raw.destroy_buffer(buffer, None);
                device.free(Some(allocation));
                return Err(GpuError::call("vkBindBufferMemory", Self::NAME)(result));
            }
            Ok(Self { buffer, allocation })
        }
    }
}

/// A pool for one command buffer, which is recorded anew for every submission.
pub(crate) fn command_pool(
    device: &Device,
    name: &'static str,
) -> Result<vk::CommandPool, GpuError> {
    let info = vk::CommandPoolCreateInfo::default()
        .flags(vk::CommandPoolCreateFlags::TRANSIENT)
        .queue_family_index(device.queue_family);
    // SAFETY: the device was opened with a queue of this family.
    let pool = unsafe { device.raw.create_command_pool(&info, None) }
        .map_err(GpuError::call("vkCreateCommandPool", name))?;
    device.set_name(pool, name);
    Ok(pool)
}

/// The pool's command buffer, freed with the pool.
pub(crate) fn command_buffer(
    device: &Device,
    pool: vk::CommandPool,
    name: &'static str,
) -> Result<vk::CommandBuffer, GpuError> {
    let info = vk::CommandBufferAllocateInfo::default().command_pool(pool).command_buffer_count(1);
    let failed = GpuError::call("vkAllocateCommandBuffers", name);
    // SAFETY: the pool was made by this device, and its owner alone uses it.
    let commands = unsafe { device.raw.allocate_command_buffers(&info) }.map_err(&failed)?;
    let commands = commands.first().copied();
    let commands = commands.ok_or_else(|| failed(vk::Result::ERROR_UNKNOWN))?;
    device.set_name(commands, name);
    Ok(commands)
}

/// A fence that has not signalled.
pub(crate) fn fence(device: &Device, name: &'static str) -> Result<vk::Fence, GpuError> {
    // SAFETY: nothing is asked of the fence.
    let fence = unsafe { device.raw.create_fence(&vk::FenceCreateInfo::default(), None) }
        .map_err(GpuError::call("vkCreateFence", name))?;
    device.set_name(fence, name);
    Ok(fence)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Buffer;
    use crate::tests::device_with_validation;

    /// Where all memory is mapped no buffer takes this path by itself.
    #[test]
    fn staging_carries_more_than_one_chunk_both_ways() {
        let device = device_with_validation();
        let length = 2 * STAGING_BYTES + 5;
        let bytes: Vec<u8> = (0..length).map(|i| (i % 251) as u8).collect();
        let buffer = Buffer::new(&device, "target", length as u64 + 3).unwrap();
        let inner = &buffer.inner;
        let mut copy = vec![MaybeUninit::new(0_u8); length];
        // SAFETY: the buffer is alive and of this device, and both ranges end with it.
        unsafe {
            device.queue().upload(&device, "target", inner.raw, 3, &bytes).unwrap();
            device.queue().download(&device, "target", inner.raw, 3, &mut copy).unwrap();
        }
        // SAFETY: made with zeros, so initialised whatever was written since.
        let copied = copy.iter().map(|byte| unsafe { byte.assume_init() });
        assert!(copied.eq(bytes.iter().copied()), "staged copies differ");
        let mut direct = vec![0_u8; length];
        buffer.read(3, &mut direct).unwrap();
        assert!(direct == bytes, "staged and direct reads differ");
        drop(buffer);
        let instance = std::sync::Arc::clone(device.instance());
        drop(device);
        assert_eq!(instance.validation_messages(), Vec::<String>::new());
    }
}
