//! What the loader asks of a layer: version 2 of its interface, as `vk_layer.h` has it.

use crate::{calls, faults};
use ash::vk;
use std::collections::BTreeMap;
use std::ffi::{CStr, CString, c_char, c_void};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// `VkNegotiateLayerInterface`.
#[repr(C)]
pub struct Negotiation {
    kind: u32,
    next: *mut c_void,
    version: u32,
    instance_functions: Option<vk::PFN_vkGetInstanceProcAddr>,
    device_functions: Option<vk::PFN_vkGetDeviceProcAddr>,
    physical_device_functions: Option<vk::PFN_vkGetInstanceProcAddr>,
}

/// `VkLayerInstanceCreateInfo` and `VkLayerDeviceCreateInfo`, as a part of a chain.
#[repr(C)]
struct Link<L> {
    kind: vk::StructureType,
    next: *mut c_void,
    function: u32,
    layers: *mut L,
}

/// `VkLayerInstanceLink`.
#[repr(C)]
struct InstanceLayer {
    next: *mut InstanceLayer,
    functions: vk::PFN_vkGetInstanceProcAddr,
    physical_device_functions: Option<vk::PFN_vkGetInstanceProcAddr>,
}

/// `VkLayerDeviceLink`.
#[repr(C)]
struct DeviceLayer {
    next: *mut DeviceLayer,
    instance_functions: vk::PFN_vkGetInstanceProcAddr,
    functions: vk::PFN_vkGetDeviceProcAddr,
}

/// What lies below.
static BELOW: Mutex<Below> = Mutex::new(Below {
    instance: vk::Instance::null(),
    instance_functions: None,
    device_functions: None,
    table: BTreeMap::new(),
});

struct Below {
    instance: vk::Instance,
    instance_functions: Option<vk::PFN_vkGetInstanceProcAddr>,
    device_functions: Option<vk::PFN_vkGetDeviceProcAddr>,
    /// The functions that this layer stands in front of. Asked for while the instance and the device are being
    /// made: later the loader answers with the first layer's, which would lead back to here.
    table: BTreeMap<CString, unsafe extern "system" fn()>,
}

impl Below {
    /// Keeps those of the layer's functions that are there further down.
    fn fill(&mut self, function: impl Fn(&CStr) -> vk::PFN_vkVoidFunction) {
        let own = ["vkDestroyInstance", "vkDestroyDevice"];
        for name in calls::NAMES.iter().chain(&own) {
            let name = CString::new(*name).unwrap_or_default();
            if let Some(found) = function(&name) {
                self.table.insert(name, found);
            }
        }
    }
}

fn below() -> MutexGuard<'static, Below> {
    BELOW.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The function of this name further down. Without one there is nothing to test.
///
/// # Safety
/// `F` is the type of a pointer to the named function.
pub(crate) unsafe fn next<F>(name: &str) -> F {
    let name = CString::new(name).unwrap_or_default();
    let Some(function) = below().table.get(&name).copied() else { std::process::abort() };
    // SAFETY: pointers to functions are of one size; the type is right, as the caller promises.
    unsafe { std::mem::transmute_copy(&function) }
}

/// A function as it is given out.
///
/// # Safety
/// `F` is a pointer to a function.
pub(crate) unsafe fn untyped<F>(function: F) -> vk::PFN_vkVoidFunction {
    // SAFETY: pointers to functions are of one size, and null is none of them.
    unsafe { std::mem::transmute_copy(&function) }
}

/// The loader's question which functions the layer has.
///
/// # Safety
/// `negotiation` is good: the loader alone calls this.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn vkNegotiateLoaderLayerInterfaceVersion(
    negotiation: *mut Negotiation,
) -> vk::Result {
    // SAFETY: as the caller promises.
    let negotiation = unsafe { &mut *negotiation };
    if negotiation.version < 2 {
        return vk::Result::ERROR_INITIALIZATION_FAILED;
    }
    negotiation.version = 2;
    negotiation.instance_functions = Some(instance_function);
    negotiation.device_functions = Some(device_function);
    negotiation.physical_device_functions = None;
    vk::Result::SUCCESS
}

/// # Safety
/// As `vkGetInstanceProcAddr`.
unsafe extern "system" fn instance_function(
    instance: vk::Instance,
    name: *const c_char,
) -> vk::PFN_vkVoidFunction {
    // SAFETY: the name ends with a null, as the caller promises; each function is given out under its own name.
    unsafe {
        let own = match CStr::from_ptr(name).to_bytes() {
            b"vkGetInstanceProcAddr" => {
                let function: vk::PFN_vkGetInstanceProcAddr = instance_function;
                untyped(function)
            }
            b"vkCreateInstance" => {
                let function: vk::PFN_vkCreateInstance = create_instance;
                untyped(function)
            }
            b"vkDestroyInstance" => {
                let function: vk::PFN_vkDestroyInstance = destroy_instance;
                untyped(function)
            }
            b"vkCreateDevice" => {
                let function: vk::PFN_vkCreateDevice = create_device;
                untyped(function)
            }
            _ => device_function(vk::Device::null(), name),
        };
        let functions = below().instance_functions;
        own.or_else(|| functions?(instance, name))
    }
}

/// # Safety
/// As `vkGetDeviceProcAddr`.
unsafe extern "system" fn device_function(
    device: vk::Device,
    name: *const c_char,
) -> vk::PFN_vkVoidFunction {
    // SAFETY: the name ends with a null, as the caller promises; each function is given out under its own name.
    unsafe {
        let own = match CStr::from_ptr(name).to_bytes() {
            b"vkGetDeviceProcAddr" => {
                let function: vk::PFN_vkGetDeviceProcAddr = device_function;
                untyped(function)
            }
            b"vkDestroyDevice" => {
                let function: vk::PFN_vkDestroyDevice = destroy_device;
                untyped(function)
            }
            bytes => calls::named(bytes),
        };
        let functions = below().device_functions.filter(|_| device != vk::Device::null());
        own.or_else(|| functions?(device, name))
    }
}

/// The loader's link in a chain, by its kind.
///
/// # Safety
/// `chain` is the start of a chain of structures, in which those of this kind are the loader's.
unsafe fn link<L>(chain: *const c_void, kind: vk::StructureType) -> *mut Link<L> {
    const LINK: u32 = 0;
    let mut at = chain.cast_mut().cast::<Link<L>>();
    // SAFETY: every structure of a chain starts with its kind and the next.
    unsafe {
        while !at.is_null() && ((*at).kind != kind || (*at).function != LINK) {
            at = (*at).next.cast();
        }
    }
    at
}

/// # Safety
/// As `vkCreateInstance`.
unsafe extern "system" fn create_instance(
    info: *const vk::InstanceCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    instance: *mut vk::Instance,
) -> vk::Result {
    if let Some(result) = faults::fault("vkCreateInstance") {
        return result;
    }
    // SAFETY: the loader puts its link into the chain, with the layers from this one on.
    unsafe {
        let link: *mut Link<InstanceLayer> =
            link((*info).p_next, vk::StructureType::LOADER_INSTANCE_CREATE_INFO);
        let functions = (*(*link).layers).functions;
        (*link).layers = (*(*link).layers).next;
        let create = functions(vk::Instance::null(), c"vkCreateInstance".as_ptr());
        let create =
            std::mem::transmute::<vk::PFN_vkVoidFunction, vk::PFN_vkCreateInstance>(create);
        let result = create(info, allocator, instance);
        if result == vk::Result::SUCCESS {
            let mut below = below();
            let instance = *instance;
            (below.instance, below.instance_functions) = (instance, Some(functions));
            below.fill(|name| functions(instance, name.as_ptr()));
        }
        result
    }
}

/// # Safety
/// As `vkDestroyInstance`.
unsafe extern "system" fn destroy_instance(
    instance: vk::Instance,
    allocator: *const vk::AllocationCallbacks<'_>,
) {
    faults::report();
    // SAFETY: the function of this name has this type, and the caller answers for the arguments.
    unsafe { next::<vk::PFN_vkDestroyInstance>("vkDestroyInstance")(instance, allocator) };
    below().instance_functions = None;
}

/// # Safety
/// As `vkCreateDevice`.
unsafe extern "system" fn create_device(
    physical: vk::PhysicalDevice,
    info: *const vk::DeviceCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    device: *mut vk::Device,
) -> vk::Result {
    if let Some(result) = faults::fault("vkCreateDevice") {
        return result;
    }
    // SAFETY: as in `create_instance`.
    unsafe {
        let link: *mut Link<DeviceLayer> =
            link((*info).p_next, vk::StructureType::LOADER_DEVICE_CREATE_INFO);
        let layer = &*(*link).layers;
        let (instance_functions, functions) = (layer.instance_functions, layer.functions);
        (*link).layers = layer.next;
        let instance = below().instance;
        let create = instance_functions(instance, c"vkCreateDevice".as_ptr());
        let create = std::mem::transmute::<vk::PFN_vkVoidFunction, vk::PFN_vkCreateDevice>(create);
        let result = create(physical, info, allocator, device);
        if result == vk::Result::SUCCESS {
            let mut below = below();
            let device = *device;
            below.device_functions = Some(functions);
            below.fill(|name| functions(device, name.as_ptr()));
        }
        result
    }
}

/// # Safety
/// As `vkDestroyDevice`.
unsafe extern "system" fn destroy_device(
    device: vk::Device,
    allocator: *const vk::AllocationCallbacks<'_>,
) {
    // SAFETY: the function of this name has this type, and the caller answers for the arguments.
    unsafe { next::<vk::PFN_vkDestroyDevice>("vkDestroyDevice")(device, allocator) };
    below().device_functions = None;
}
