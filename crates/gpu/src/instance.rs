//! The Vulkan instance: the loader, the validation layer, and the list of devices.
//!
//! With validation on, messages are collected rather than printed; every test asserts that there
//! are none. `a_broken_rule_is_collected` holds that a message would be seen.

use crate::choice::{self, DefaultDevice, DeviceInfo, DeviceKind};
use crate::error::GpuError;
use ash::{ext, khr, vk};
use std::ffi::{CStr, c_char, c_void};
use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

const VALIDATION_LAYER: &CStr = c"VK_LAYER_KHRONOS_validation";

/// How to make an [`Instance`].
#[derive(Debug, Clone, Copy, Default)]
pub struct InstanceOptions {
    /// Turn on the Khronos validation layer with synchronization validation, collect its
    /// messages, and give every object its name. Several times slower.
    pub validation: bool,
}

/// The Vulkan loader with an instance in it.
pub struct Instance {
    raw: ash::Instance,
    validation: Option<Validation>,
    // Last: it owns the library that `raw` and `validation` call into.
    _entry: ash::Entry,
}

/// The messenger, and the messages it writes. The box keeps them in one place in memory.
struct Validation {
    functions: ext::debug_utils::Instance,
    messenger: vk::DebugUtilsMessengerEXT,
    messages: Box<Messages>,
}

type Messages = Mutex<Vec<String>>;

impl Instance {
    /// Opens the loader and makes an instance.
    ///
    /// Fails with [`GpuError::NoLoader`] where there is none, with [`GpuError::NoDevice`] where
    /// the loader has no driver, and with [`GpuError::NoValidation`] where the layer is missing.
    pub fn new(options: &InstanceOptions) -> Result<Arc<Self>, GpuError> {
        // SAFETY: opens the system's Vulkan loader by its usual name, which has no conditions
        // beyond the loader being one. The library stays open until the entry is dropped, and
        // `Instance` drops it last.
        let entry =
            unsafe { ash::Entry::load() }.map_err(|source| GpuError::NoLoader { source })?;
        let failed = |call| {
            let loader = || loader_errors(&entry);
            move |source| match source {
                vk::Result::ERROR_INCOMPATIBLE_DRIVER | vk::Result::ERROR_INITIALIZATION_FAILED => {
                    GpuError::NoDevice { loader: loader() }
                }
                source => GpuError::Loader { call, loader: loader(), source },
            }
        };

        // SAFETY: enumerating has no conditions.
        let offered = unsafe { entry.enumerate_instance_extension_properties(None) }
            .map_err(failed("vkEnumerateInstanceExtensionProperties"))?;
        let mut layers: Vec<*const c_char> = Vec::new();
        let mut extensions: Vec<*const c_char> = Vec::new();
        let mut flags = vk::InstanceCreateFlags::empty();
        if has_extension(&offered, khr::portability_enumeration::NAME) {
            // Without it the loader hides MoltenVK.
            extensions.push(khr::portability_enumeration::NAME.as_ptr());
            flags |= vk::InstanceCreateFlags::ENUMERATE_PORTABILITY_KHR;
        }
        if options.validation {
            require_validation(&entry, &offered)?;
            layers.push(VALIDATION_LAYER.as_ptr());
            extensions.push(ext::debug_utils::NAME.as_ptr());
            extensions.push(ext::validation_features::NAME.as_ptr());
        }

        let messages: Box<Messages> = Box::default();
        let application = vk::ApplicationInfo::default()
            .application_name(c"pointillist")
            .engine_name(c"pointillist")
            .api_version(vk::API_VERSION_1_2);
        let enabled = [vk::ValidationFeatureEnableEXT::SYNCHRONIZATION_VALIDATION];
        let mut features =
            vk::ValidationFeaturesEXT::default().enabled_validation_features(&enabled);
        // In the chain it also hears what is said while the instance is made and destroyed.
        let mut creation_messenger = messenger_info(&messages);
        let mut info = vk::InstanceCreateInfo::default()
            .flags(flags)
            .application_info(&application)
            .enabled_layer_names(&layers)
            .enabled_extension_names(&extensions);
        if options.validation {
            info = info.push_next(&mut features).push_next(&mut creation_messenger);
        }
        // SAFETY: the names come from null-terminated constants, the extensions are offered by
        // the loader or by the layer, and everything `info` points to lives to the end of this
        // function. `messages` is boxed and outlives the instance: see `Drop`.
        let raw =
            unsafe { entry.create_instance(&info, None) }.map_err(failed("vkCreateInstance"))?;

        let mut instance = Self { raw, validation: None, _entry: entry };
        if options.validation {
            let functions = ext::debug_utils::Instance::new(&instance._entry, &instance.raw);
            // SAFETY: the extension is enabled, and `messages` outlives the messenger.
            let messenger =
                unsafe { functions.create_debug_utils_messenger(&messenger_info(&messages), None) };
            let messenger =
                messenger.map_err(GpuError::call("vkCreateDebugUtilsMessengerEXT", "instance"))?;
            instance.validation = Some(Validation { functions, messenger, messages });
        }
        Ok(Arc::new(instance))
    }

    /// What the loader says of drivers and layers that it finds but cannot use. Empty where it says nothing, and
    /// without a loader.
    pub fn loader_errors() -> Vec<String> {
        // SAFETY: as in `new`.
        unsafe { ash::Entry::load() }.map_or_else(|_| Vec::new(), |entry| loader_errors(&entry))
    }

    /// Every physical device, usable or not, in the order of the driver's list.
    pub fn devices(&self) -> Result<Vec<DeviceInfo>, GpuError> {
        let physical = self.physical_devices()?;
        Ok(physical.iter().enumerate().map(|(index, &raw)| self.describe(index, raw)).collect())
    }

    /// The device that is used when the user names none, with the reason.
    pub fn default_device(&self) -> Result<DefaultDevice, GpuError> {
        choice::choose_default(&self.devices()?)
    }

    /// Warnings and errors of the validation layer so far; empty where validation is off.
    ///
    /// Left out is what carries the type `GENERAL` alone, short of an error: remarks of the
    /// loader and of drivers about the machine, such as a driver file that could not be opened.
    /// Advice on speed is not asked for: it differs from vendor to vendor and is no broken rule.
    pub fn validation_messages(&self) -> Vec<String> {
        let messages = self.validation.as_ref().map(|validation| &validation.messages);
        messages.map_or_else(Vec::new, |messages| lock(messages).clone())
    }

    pub(crate) fn raw(&self) -> &ash::Instance {
        &self.raw
    }

    /// Whether validation, and with it the extension for names and labels, is on.
    pub(crate) fn validates(&self) -> bool {
        self.validation.is_some()
    }

    pub(crate) fn physical_devices(&self) -> Result<Vec<vk::PhysicalDevice>, GpuError> {
        // SAFETY: the instance is alive.
        match unsafe { self.raw.enumerate_physical_devices() } {
            Ok(physical) => Ok(physical),
            // How some loaders say that no driver could be used.
            Err(vk::Result::ERROR_INITIALIZATION_FAILED) => Ok(Vec::new()),
            Err(result) => Err(GpuError::call("vkEnumeratePhysicalDevices", "instance")(result)),
        }
    }

    fn describe(&self, index: usize, raw: vk::PhysicalDevice) -> DeviceInfo {
        // SAFETY: `raw` was listed by this instance.
        let properties = unsafe { self.raw.get_physical_device_properties(raw) };
        let version = properties.api_version;
        let api_version = (
            vk::api_version_major(version),
            vk::api_version_minor(version),
            vk::api_version_patch(version),
        );
        let kind = match properties.device_type {
            vk::PhysicalDeviceType::DISCRETE_GPU => DeviceKind::Discrete,
            vk::PhysicalDeviceType::INTEGRATED_GPU => DeviceKind::Integrated,
            vk::PhysicalDeviceType::VIRTUAL_GPU => DeviceKind::Virtual,
            vk::PhysicalDeviceType::CPU => DeviceKind::Cpu,
            _ => DeviceKind::Other,
        };
        let unusable = if version < vk::API_VERSION_1_1 {
            let (major, minor, _) = api_version;
            Some(format!("it offers Vulkan {major}.{minor} and 1.1 is needed"))
        } else if self.compute_family(raw).is_none() {
            Some("it has no compute queue".to_owned())
        } else {
            None
        };
        let name = properties.device_name_as_c_str().unwrap_or(c"unnamed").to_string_lossy();
        DeviceInfo {
            index,
            name: name.into_owned(),
            kind,
            driver: self.driver(raw, &properties),
            api_version,
            unusable,
        }
    }

    /// Name and version of the driver, in its own words where it has any.
    fn driver(&self, raw: vk::PhysicalDevice, properties: &vk::PhysicalDeviceProperties) -> String {
        let has_driver_properties = properties.api_version >= vk::API_VERSION_1_2
            || properties.api_version >= vk::API_VERSION_1_1
                && self
                    .device_extensions(raw)
                    .is_ok_and(|offered| has_extension(&offered, khr::driver_properties::NAME));
        if !has_driver_properties {
            return format!("version {:#x}", properties.driver_version);
        }
        let mut driver = vk::PhysicalDeviceDriverProperties::default();
        let mut all = vk::PhysicalDeviceProperties2::default().push_next(&mut driver);
        // SAFETY: the device is at least 1.1, which has the call, and knows the chained struct.
        unsafe { self.raw.get_physical_device_properties2(raw, &mut all) };
        let name = driver.driver_name_as_c_str().unwrap_or(c"").to_string_lossy();
        let info = driver.driver_info_as_c_str().unwrap_or(c"").to_string_lossy();
        if !info.is_empty() {
            return format!("{name} {info}").trim().to_owned();
        }
        // SwiftShader has no words for its version.
        let version = properties.driver_version;
        let [major, minor, patch] = [
            vk::api_version_major(version),
            vk::api_version_minor(version),
            vk::api_version_patch(version),
        ];
        let name = if name.is_empty() { "version" } else { &name };
        format!("{name} {major}.{minor}.{patch}")
    }

    pub(crate) fn device_extensions(
        &self,
        raw: vk::PhysicalDevice,
    ) -> Result<Vec<vk::ExtensionProperties>, GpuError> {
        // SAFETY: `raw` was listed by this instance.
        unsafe { self.raw.enumerate_device_extension_properties(raw) }
            .map_err(GpuError::call("vkEnumerateDeviceExtensionProperties", "device"))
    }

    /// The queue family to use with its number of timestamp bits: the first with compute and
    /// timestamps, or else the first with compute.
    pub(crate) fn compute_family(&self, raw: vk::PhysicalDevice) -> Option<(u32, u32)> {
        // SAFETY: `raw` was listed by this instance.
        let families = unsafe { self.raw.get_physical_device_queue_family_properties(raw) };
        let compute = || {
            (0..).zip(&families).filter(|(_, family)| {
                family.queue_count > 0 && family.queue_flags.contains(vk::QueueFlags::COMPUTE)
            })
        };
        let timed = compute().find(|(_, family)| family.timestamp_valid_bits > 0);
        timed
            .or_else(|| compute().next())
            .map(|(index, family)| (index, family.timestamp_valid_bits))
    }
}

impl fmt::Debug for Instance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Instance").field("validation", &self.validates()).finish_non_exhaustive()
    }
}

impl Drop for Instance {
    fn drop(&mut self) {
        // SAFETY: devices hold an `Arc` of their instance, so none is left. The messages and the
        // library, which both calls use, are fields of `self` and dropped after this returns;
        // where `new` failed between instance and messenger, the instance's own messenger may
        // still be called, and `messages` of `new` is dropped after `instance`.
        unsafe {
            if let Some(validation) = &self.validation {
                validation.functions.destroy_debug_utils_messenger(validation.messenger, None);
            }
            self.raw.destroy_instance(None);
        }
    }
}

pub(crate) fn has_extension(offered: &[vk::ExtensionProperties], name: &CStr) -> bool {
    offered.iter().any(|extension| extension.extension_name_as_c_str() == Ok(name))
}

/// Fails unless the layer and both of its extensions are there.
fn require_validation(
    entry: &ash::Entry,
    offered: &[vk::ExtensionProperties],
) -> Result<(), GpuError> {
    // SAFETY: enumerating has no conditions.
    let layers = unsafe { entry.enumerate_instance_layer_properties() }
        .map_err(GpuError::call("vkEnumerateInstanceLayerProperties", "instance"))?;
    if !layers.iter().any(|layer| layer.layer_name_as_c_str() == Ok(VALIDATION_LAYER)) {
        return Err(GpuError::NoValidation { missing: "the layer VK_LAYER_KHRONOS_validation" });
    }
    // SAFETY: the layer was just listed.
    let of_layer = unsafe { entry.enumerate_instance_extension_properties(Some(VALIDATION_LAYER)) }
        .map_err(GpuError::call("vkEnumerateInstanceExtensionProperties", "instance"))?;
    let has = |name| has_extension(offered, name) || has_extension(&of_layer, name);
    if !has(ext::validation_features::NAME) {
        return Err(GpuError::NoValidation { missing: "VK_EXT_validation_features" });
    }
    if !has(ext::debug_utils::NAME) {
        return Err(GpuError::NoValidation { missing: "VK_EXT_debug_utils" });
    }
    Ok(())
}

/// Makes an instance for the sake of what the loader says meanwhile: it tells errors to a messenger in the chain.
fn loader_errors(entry: &ash::Entry) -> Vec<String> {
    let messages: Box<Messages> = Box::default();
    let mut messenger = messenger_info(&messages)
        .message_severity(vk::DebugUtilsMessageSeverityFlagsEXT::ERROR)
        .message_type(vk::DebugUtilsMessageTypeFlagsEXT::GENERAL);
    let extensions = [ext::debug_utils::NAME.as_ptr()];
    let application = vk::ApplicationInfo::default().api_version(vk::API_VERSION_1_2);
    let info = vk::InstanceCreateInfo::default()
        .application_info(&application)
        .enabled_extension_names(&extensions)
        .push_next(&mut messenger);
    // SAFETY: everything `info` points to lives to the end of this function; the loader refuses an extension that
    // it does not have. Nothing was made of the instance.
    unsafe {
        if let Ok(instance) = entry.create_instance(&info, None) {
            instance.destroy_instance(None);
        }
    }
    let told = lock(&messages).drain(..).collect::<Vec<_>>();
    let mut lines: Vec<String> = Vec::new();
    for line in told {
        let line = line.trim_start_matches("error: ").replace('\n', " ");
        if !lines.contains(&line) {
            lines.push(line);
        }
    }
    lines
}

fn messenger_info(messages: &Messages) -> vk::DebugUtilsMessengerCreateInfoEXT<'static> {
    use vk::DebugUtilsMessageSeverityFlagsEXT as Severity;
    use vk::DebugUtilsMessageTypeFlagsEXT as Type;
    vk::DebugUtilsMessengerCreateInfoEXT::default()
        .message_severity(Severity::WARNING | Severity::ERROR)
        .message_type(Type::GENERAL | Type::VALIDATION)
        .pfn_user_callback(Some(collect))
        .user_data(std::ptr::from_ref(messages).cast_mut().cast())
}

/// Appends one message to the list; see [`Instance::validation_messages`] for what is left out.
unsafe extern "system" fn collect(
    severity: vk::DebugUtilsMessageSeverityFlagsEXT,
    types: vk::DebugUtilsMessageTypeFlagsEXT,
    data: *const vk::DebugUtilsMessengerCallbackDataEXT<'_>,
    user_data: *mut c_void,
) -> vk::Bool32 {
    let is_error = severity.contains(vk::DebugUtilsMessageSeverityFlagsEXT::ERROR);
    let is_remark = types == vk::DebugUtilsMessageTypeFlagsEXT::GENERAL && !is_error;
    if !is_remark {
        // SAFETY: `user_data` is the `Messages` of `messenger_info`, which outlives the
        // messenger; the layer passes valid data with a null-terminated or a null message.
        let (messages, message) = unsafe {
            let message = (*data).p_message;
            let message = if message.is_null() { c"" } else { CStr::from_ptr(message) };
            (&*user_data.cast::<Messages>(), message)
        };
        let level = if is_error { "error" } else { "warning" };
        lock(messages).push(format!("{level}: {}", message.to_string_lossy()));
    }
    vk::FALSE // Anything else would make the offending call fail.
}

/// The list is whole after every push, so a panic elsewhere does not spoil it.
fn lock(messages: &Messages) -> std::sync::MutexGuard<'_, Vec<String>> {
    messages.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use crate::tests::device_with_validation;
    use ash::vk;

    /// The tests that expect silence prove nothing unless this one is loud.
    #[test]
    fn a_broken_rule_is_collected() {
        let device = device_with_validation();
        assert_eq!(device.instance().validation_messages(), Vec::<String>::new());
        let info = vk::BufferCreateInfo::default().usage(vk::BufferUsageFlags::STORAGE_BUFFER);
        // SAFETY: breaks the rule that a buffer has a size, on purpose; drivers make an unusable
        // buffer or refuse, and destroying a null handle does nothing.
        unsafe {
            let buffer = device.raw.create_buffer(&info, None).unwrap_or_default();
            device.raw.destroy_buffer(buffer, None);
        }
        let messages = device.instance().validation_messages();
        let found = messages.iter().any(|message| message.contains("VUID-VkBufferCreateInfo-size"));
        assert!(found, "{messages:?}");
    }
}
