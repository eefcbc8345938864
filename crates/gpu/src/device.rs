//! The opened device: its limits, its memory and its one queue.
//!
//! The queue sits behind a lock that is held from a submission until its fence has signalled, and
//! host access to buffers takes the same lock: see [`crate::queue`].

use crate::choice::{self, DeviceChoice, DeviceInfo};
use crate::error::GpuError;
use crate::instance::{Instance, has_extension};
use crate::pipelines::Pipelines;
use crate::queue::Queue;
use ash::{ext, khr, vk};
use gpu_allocator::vulkan::{
    Allocation, AllocationCreateDesc, AllocationScheme, Allocator, AllocatorCreateDesc,
};
use gpu_allocator::{AllocationError, AllocationSizes, AllocatorDebugSettings, MemoryLocation};
use std::ffi::{CString, c_char};
use std::fmt;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

const MIB: u64 = 1 << 20;

/// The limits a render plans with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Bytes of one storage buffer binding, and so of one [`Buffer`](crate::Buffer).
    pub max_storage_buffer_range: u64,
    /// Pixels on one side of an [`Image`](crate::Image).
    pub max_image_dimension_2d: u32,
    /// Bytes of push constants.
    pub max_push_constants_size: u32,
    /// Workgroups of one dispatch along each axis.
    pub max_compute_workgroup_count: [u32; 3],
    /// Nanoseconds of one step of a timestamp; zero where the queue has no timestamps.
    pub timestamp_period: f32,
    /// Texels of a buffer bound as [`Binding::UniformTexelBuffer`](crate::Binding).
    pub max_texel_buffer_elements: u32,
    /// Invocations that run together and can vote in a compute kernel; zero where they cannot.
    pub subgroup_size: u32,
    /// Bytes of the largest memory heap that is local to the device.
    pub heap_bytes: u64,
}

/// An open device.
pub struct Device {
    pub(crate) raw: ash::Device,
    pub(crate) physical: vk::PhysicalDevice,
    pub(crate) queue_family: u32,
    /// The bits of a timestamp that count; zero where the queue has none.
    pub(crate) timestamp_mask: u64,
    pub(crate) vk_limits: vk::PhysicalDeviceLimits,
    info: DeviceInfo,
    limits: Limits,
    debug: Option<ext::debug_utils::Device>,
    /// Nanoseconds that passes waited for pipelines.
    pipeline_nanos: AtomicU64,
    pub(crate) pipelines: Pipelines,
    queue: Mutex<Queue>,
    /// `None` only while the device is being made or dropped.
    allocator: Mutex<Option<Allocator>>,
    // Last: the device must be gone before its instance.
    instance: Arc<Instance>,
}

impl Device {
    /// Opens a device with one compute queue.
    pub fn open(instance: &Arc<Instance>, choice: &DeviceChoice) -> Result<Arc<Self>, GpuError> {
        let mut devices = instance.devices()?;
        let info = devices.swap_remove(choice::choose(&devices, choice)?);
        let unusable = |reason: &str| GpuError::UnusableDevice {
            device: format!("{} '{}'", info.index, info.name),
            reason: reason.to_owned(),
        };
        let physical = instance.physical_devices()?.get(info.index).copied();
        let physical = physical.ok_or_else(|| unusable("it has disappeared"))?;
        let (queue_family, timestamp_bits) =
            instance.compute_family(physical).ok_or_else(|| unusable("it has no compute queue"))?;

        let mut extensions: Vec<*const c_char> = Vec::new();
        let offered = instance.device_extensions(physical)?;
        if has_extension(&offered, khr::portability_subset::NAME) {
            // Where it is offered it must be enabled; nothing here uses what it takes away.
            extensions.push(khr::portability_subset::NAME.as_ptr());
        }
        let queues = [vk::DeviceQueueCreateInfo::default()
            .queue_family_index(queue_family)
            .queue_priorities(&[1.0])];
        // Every device has this feature.
        let features = vk::PhysicalDeviceFeatures::default().robust_buffer_access(true);
        let create = vk::DeviceCreateInfo::default()
            .queue_create_infos(&queues)
            .enabled_extension_names(&extensions)
            .enabled_features(&features);
        // SAFETY: `physical` belongs to this instance, which the device will hold; the family
        // exists and has a queue; the extension is offered; the feature is one all devices have.
        let raw = unsafe { instance.raw().create_device(physical, &create, None) }
            .map_err(GpuError::call("vkCreateDevice", "device"))?;

        // SAFETY: the queue was asked for just above.
        let queue = unsafe { raw.get_device_queue(queue_family, 0) };
        // SAFETY: `physical` belongs to this instance.
        let vk_limits = unsafe { instance.raw().get_physical_device_properties(physical) }.limits;
        let debug =
            instance.validates().then(|| ext::debug_utils::Device::new(instance.raw(), &raw));
        // From here on `Drop` cleans up after a failure.
        let device = Self {
            raw,
            physical,
            queue_family,
            timestamp_mask: u64::MAX.checked_shr(64 - timestamp_bits.min(64)).unwrap_or(0),
            limits: limits(instance, physical, &vk_limits, timestamp_bits > 0),
            vk_limits,
            info,
            debug,
            pipeline_nanos: AtomicU64::new(0),
            pipelines: Pipelines::default(),
            queue: Mutex::new(Queue::new(queue)),
            allocator: Mutex::new(None),
            instance: Arc::clone(instance),
        };
        device.queue().prepare(&device)?;
        let allocator = Allocator::new(&AllocatorCreateDesc {
            instance: instance.raw().clone(),
            device: device.raw.clone(),
            physical_device: physical,
            debug_settings: AllocatorDebugSettings::default(),
            buffer_device_address: false,
            // Small at first, since a small render should fit into a small machine.
            allocation_sizes: AllocationSizes::new(16 * MIB, 16 * MIB)
                .with_max_device_memblock_size(256 * MIB)
                .with_max_host_memblock_size(64 * MIB),
        })
        .map_err(|source| GpuError::Allocation {
            object: "allocator",
            bytes: 0,
            source,
        })?;
        *device.allocator() = Some(allocator);
        Ok(Arc::new(device))
    }

    /// What it is.
    pub fn info(&self) -> &DeviceInfo {
        &self.info
    }

    /// What it can.
    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    /// How long passes have waited for the driver to make their pipelines since the device was opened. What was
    /// [made ahead](crate::Kernel::make_ahead) is not in it, nor what some drivers compile at the first dispatch.
    pub fn pipeline_time(&self) -> Duration {
        Duration::from_nanos(self.pipeline_nanos.load(Ordering::Relaxed))
    }

    /// How many pipelines it has been asked for.
    pub fn pipeline_count(&self) -> usize {
        self.pipelines.count()
    }

    /// Adds to [`pipeline_time`](Self::pipeline_time).
    pub(crate) fn add_pipeline_time(&self, time: Duration) {
        let nanos = u64::try_from(time.as_nanos()).unwrap_or(u64::MAX);
        self.pipeline_nanos.fetch_add(nanos, Ordering::Relaxed);
    }

    /// The instance it belongs to.
    pub fn instance(&self) -> &Arc<Instance> {
        &self.instance
    }

    /// The queue, locked: nothing runs on the device while the guard is held, except what its
    /// holder submits and waits for.
    pub(crate) fn queue(&self) -> MutexGuard<'_, Queue> {
        // `Queue` waits in every path, so it is idle whenever a panic lets go of the lock.
        self.queue.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn allocator(&self) -> MutexGuard<'_, Option<Allocator>> {
        self.allocator.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Memory for a buffer (`linear`) or an image.
    pub(crate) fn allocate(
        &self,
        object: &'static str,
        requirements: vk::MemoryRequirements,
        location: MemoryLocation,
        linear: bool,
    ) -> Result<Allocation, GpuError> {
        let bytes = requirements.size;
        let mut allocator = self.allocator();
        let Some(allocator) = allocator.as_mut() else {
            return Err(GpuError::OutOfMemory { object, bytes });
        };
        let allocation = allocator.allocate(&AllocationCreateDesc {
            name: object,
            requirements,
            location,
            linear,
            allocation_scheme: AllocationScheme::GpuAllocatorManaged,
        });
        allocation.map_err(|source| match source {
            AllocationError::OutOfMemory => GpuError::OutOfMemory { object, bytes },
            source => GpuError::Allocation { object, bytes, source },
        })
    }

    /// Gives memory back. Whatever was bound to it is destroyed already.
    pub(crate) fn free(&self, allocation: Option<Allocation>) {
        if let (Some(allocation), Some(allocator)) = (allocation, self.allocator().as_mut()) {
            // Fails only for an allocation of another allocator.
            let freed = allocator.free(allocation);
            debug_assert!(freed.is_ok(), "allocation of another device: {freed:?}");
        }
    }

    /// Names an object in validation messages and captures; does nothing without validation.
    pub(crate) fn set_name<H: vk::Handle>(&self, handle: H, name: &str) {
        let (Some(debug), Ok(name)) = (&self.debug, CString::new(name)) else { return };
        let info =
            vk::DebugUtilsObjectNameInfoEXT::default().object_handle(handle).object_name(&name);
        // SAFETY: callers pass a handle of this device that they have just made and not yet
        // shared. The call can only run out of memory, and then the name is missing.
        let _ = unsafe { debug.set_debug_utils_object_name(&info) };
    }

    /// Opens a labelled region in a command buffer; does nothing without validation.
    ///
    /// # Safety
    /// `commands` is of this device, in the recording state.
    pub(crate) unsafe fn begin_label(&self, commands: vk::CommandBuffer, name: &str) {
        let (Some(debug), Ok(name)) = (&self.debug, CString::new(name)) else { return };
        let label = vk::DebugUtilsLabelEXT::default().label_name(&name);
        // SAFETY: as the caller promises.
        unsafe { debug.cmd_begin_debug_utils_label(commands, &label) };
    }

    /// Closes the region.
    ///
    /// # Safety
    /// As for [`begin_label`](Self::begin_label), which was called on `commands` with a name that
    /// has no null in it.
    pub(crate) unsafe fn end_label(&self, commands: vk::CommandBuffer) {
        if let Some(debug) = &self.debug {
            // SAFETY: as the caller promises.
            unsafe { debug.cmd_end_debug_utils_label(commands) };
        }
    }
}

impl fmt::Debug for Device {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Device").field("info", &self.info).finish_non_exhaustive()
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        let mut queue = self.queue();
        let staging = queue.destroy(&self.raw);
        drop(queue);
        self.free(staging);
        self.pipelines.destroy(&self.raw);
        // The allocator gives its memory back to the device, so it goes first.
        drop(self.allocator().take());
        // SAFETY: every object of this crate holds an `Arc` of its device, so all are destroyed;
        // every submission was waited for, so the device is idle.
        unsafe { self.raw.destroy_device(None) };
    }
}

fn limits(
    instance: &Instance,
    physical: vk::PhysicalDevice,
    limits: &vk::PhysicalDeviceLimits,
    has_timestamps: bool,
) -> Limits {
    // SAFETY: `physical` belongs to this instance.
    let memory = unsafe { instance.raw().get_physical_device_memory_properties(physical) };
    let mut subgroups = vk::PhysicalDeviceSubgroupProperties::default();
    let mut properties = vk::PhysicalDeviceProperties2::default().push_next(&mut subgroups);
    // SAFETY: as above; devices below Vulkan 1.1 are not opened.
    unsafe { instance.raw().get_physical_device_properties2(physical, &mut properties) };
    let can_vote = subgroups.supported_stages.contains(vk::ShaderStageFlags::COMPUTE)
        && subgroups.supported_operations.contains(vk::SubgroupFeatureFlags::BALLOT);
    let local = memory
        .memory_heaps_as_slice()
        .iter()
        .filter(|heap| heap.flags.contains(vk::MemoryHeapFlags::DEVICE_LOCAL));
    Limits {
        max_storage_buffer_range: u64::from(limits.max_storage_buffer_range),
        max_image_dimension_2d: limits.max_image_dimension2_d,
        max_push_constants_size: limits.max_push_constants_size,
        max_compute_workgroup_count: limits.max_compute_work_group_count,
        timestamp_period: if has_timestamps { limits.timestamp_period } else { 0.0 },
        max_texel_buffer_elements: limits.max_texel_buffer_elements,
        subgroup_size: if can_vote { subgroups.subgroup_size } else { 0 },
        heap_bytes: local.map(|heap| heap.size).max().unwrap_or(0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::device_with_validation;

    #[test]
    fn memory_beyond_the_heap_is_refused_by_name_and_size() {
        let device = device_with_validation();
        let size = device.limits().heap_bytes + 1;
        let requirements =
            vk::MemoryRequirements { size, alignment: 16, memory_type_bits: u32::MAX };
        let refused = device.allocate("points", requirements, MemoryLocation::GpuOnly, true);
        let message = refused.unwrap_err().to_string();
        assert!(message.contains("'points'"), "{message}");
        assert!(message.contains(&size.to_string()), "{message}");
        assert_eq!(device.instance().validation_messages(), Vec::<String>::new());
    }
}
