//! The calls that can fail, and those that describe devices: each is made further down, unless it is its turn.

use crate::faults::{ASKED, fault};
use crate::loader::{next, untyped};
use ash::vk;
use std::ffi::c_void;

type Pointer = *const c_void;
/// Handles of objects other than instances, devices, queues and command buffers.
type Handle = u64;

/// Makes a function of the layer for each call that can fail, the list of all names, and the way from a name
/// to its function.
macro_rules! calls {
    (
        failing { $($name:ident($($argument:ident: $type:ty),*);)* }
        describing { $($described:ident: $pointer:ident = $describe:ident;)* }
    ) => {
        $(
            /// # Safety
            /// As the call of this name.
            #[allow(non_snake_case, reason = "Vulkan's name")]
            unsafe extern "system" fn $name($($argument: $type),*) -> vk::Result {
                let call = stringify!($name);
                let fault = fault(call);
                if let (Some(result), false) = (fault, call == "vkWaitForFences") {
                    return result;
                }
                // SAFETY: the function of this name has this signature, where pointers and handles are as
                // wide as here; for the arguments the caller answers.
                let result = unsafe {
                    next::<unsafe extern "system" fn($($type),*) -> vk::Result>(call)($($argument),*)
                };
                fault.unwrap_or(result)
            }
        )*

        /// The calls that this layer stands in front of.
        pub(crate) const NAMES: &[&str] = &[$(stringify!($name),)* $(stringify!($described)),*];

        /// The function of this layer in front of the named one, if there is one.
        pub(crate) fn named(name: &[u8]) -> vk::PFN_vkVoidFunction {
            $(
                if name == stringify!($name).as_bytes() {
                    let function: unsafe extern "system" fn($($type),*) -> vk::Result = $name;
                    // SAFETY: whoever asked for the function by its name calls it by its own signature.
                    return unsafe { untyped(function) };
                }
            )*
            $(
                if name == stringify!($described).as_bytes() {
                    let function: vk::$pointer = $describe;
                    // SAFETY: as above.
                    return unsafe { untyped(function) };
                }
            )*
            None
        }
    };
}

calls! {
    failing {
        vkEnumeratePhysicalDevices(instance: Pointer, count: Pointer, devices: Pointer);
        vkEnumerateDeviceExtensionProperties(
            device: Pointer, layer: Pointer, count: Pointer, properties: Pointer);
        vkAllocateMemory(device: Pointer, info: Pointer, allocator: Pointer, memory: Pointer);
        vkMapMemory(
            device: Pointer, memory: Handle, offset: u64, size: u64, flags: u32, data: Pointer);
        vkBindBufferMemory(device: Pointer, buffer: Handle, memory: Handle, offset: u64);
        vkBindImageMemory(device: Pointer, image: Handle, memory: Handle, offset: u64);
        vkCreateBuffer(device: Pointer, info: Pointer, allocator: Pointer, buffer: Pointer);
        vkCreateBufferView(device: Pointer, info: Pointer, allocator: Pointer, view: Pointer);
        vkCreateImage(device: Pointer, info: Pointer, allocator: Pointer, image: Pointer);
        vkCreateImageView(device: Pointer, info: Pointer, allocator: Pointer, view: Pointer);
        vkCreateDescriptorSetLayout(device: Pointer, info: Pointer, allocator: Pointer, out: Pointer);
        vkCreateDescriptorPool(device: Pointer, info: Pointer, allocator: Pointer, pool: Pointer);
        vkResetDescriptorPool(device: Pointer, pool: Handle, flags: u32);
        vkAllocateDescriptorSets(device: Pointer, info: Pointer, sets: Pointer);
        vkCreatePipelineLayout(device: Pointer, info: Pointer, allocator: Pointer, layout: Pointer);
        vkCreateShaderModule(device: Pointer, info: Pointer, allocator: Pointer, module: Pointer);
        vkCreateComputePipelines(
            device: Pointer, cache: Handle, count: u32, infos: Pointer, allocator: Pointer,
            pipelines: Pointer);
        vkCreateQueryPool(device: Pointer, info: Pointer, allocator: Pointer, pool: Pointer);
        vkGetQueryPoolResults(
            device: Pointer, pool: Handle, first: u32, count: u32, size: usize, data: Pointer,
            stride: u64, flags: u32);
        vkCreateFence(device: Pointer, info: Pointer, allocator: Pointer, fence: Pointer);
        vkResetFences(device: Pointer, count: u32, fences: Pointer);
        vkWaitForFences(device: Pointer, count: u32, fences: Pointer, all: u32, timeout: u64);
        vkCreateCommandPool(device: Pointer, info: Pointer, allocator: Pointer, pool: Pointer);
        vkResetCommandPool(device: Pointer, pool: Handle, flags: u32);
        vkAllocateCommandBuffers(device: Pointer, info: Pointer, commands: Pointer);
        vkBeginCommandBuffer(commands: Pointer, info: Pointer);
        vkEndCommandBuffer(commands: Pointer);
        vkQueueSubmit(queue: Pointer, count: u32, submits: Pointer, fence: Handle);
        vkDeviceWaitIdle(device: Pointer);
    }
    describing {
        vkGetPhysicalDeviceProperties: PFN_vkGetPhysicalDeviceProperties = properties;
        vkGetPhysicalDeviceQueueFamilyProperties:
            PFN_vkGetPhysicalDeviceQueueFamilyProperties = queue_families;
        vkGetPhysicalDeviceMemoryProperties: PFN_vkGetPhysicalDeviceMemoryProperties = memory;
    }
}

/// # Safety
/// As `vkGetPhysicalDeviceProperties`.
unsafe extern "system" fn properties(
    device: vk::PhysicalDevice,
    out: *mut vk::PhysicalDeviceProperties,
) {
    // SAFETY: the next function has the type that its name says; `out` is good, as the caller promises.
    unsafe {
        next::<vk::PFN_vkGetPhysicalDeviceProperties>("vkGetPhysicalDeviceProperties")(device, out);
        if let Some(version) = ASKED.version {
            (*out).api_version = version;
        }
    }
}

/// # Safety
/// As `vkGetPhysicalDeviceQueueFamilyProperties`.
unsafe extern "system" fn queue_families(
    device: vk::PhysicalDevice,
    count: *mut u32,
    out: *mut vk::QueueFamilyProperties,
) {
    // SAFETY: the next function has the type that its name says; `out` is null or holds as many as `count`
    // says behind the call.
    unsafe {
        next::<vk::PFN_vkGetPhysicalDeviceQueueFamilyProperties>(
            "vkGetPhysicalDeviceQueueFamilyProperties",
        )(device, count, out);
        if out.is_null() {
            return;
        }
        for family in std::slice::from_raw_parts_mut(out, *count as usize) {
            if ASKED.no_compute {
                family.queue_flags &= !vk::QueueFlags::COMPUTE;
            }
            if ASKED.no_timestamps {
                family.timestamp_valid_bits = 0;
            }
        }
    }
}

/// # Safety
/// As `vkGetPhysicalDeviceMemoryProperties`.
unsafe extern "system" fn memory(
    device: vk::PhysicalDevice,
    out: *mut vk::PhysicalDeviceMemoryProperties,
) {
    // SAFETY: the next function has the type that its name says; `out` is good, as the caller promises.
    unsafe {
        next::<vk::PFN_vkGetPhysicalDeviceMemoryProperties>("vkGetPhysicalDeviceMemoryProperties")(
            device, out,
        );
        if let Some(bytes) = ASKED.heap {
            (*out).memory_heaps.iter_mut().for_each(|heap| heap.size = bytes);
        }
    }
}
