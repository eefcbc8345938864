//! What can go wrong with a device, in words that say what to do about it.

use ash::vk;

/// Everything this crate reports. [`is_no_device`](Self::is_no_device) splits off the cases in
/// which no work was possible at all.
#[derive(Debug, thiserror::Error)]
pub enum GpuError {
    /// There is no Vulkan loader on this machine.
    #[error(
        "the Vulkan loader was not found; install it with a driver (on Debian: apt-get install \
         libvulkan1 mesa-vulkan-drivers) or render with --device reference"
    )]
    NoLoader {
        /// What the dynamic linker said.
        #[source]
        source: ash::LoadingError,
    },
    /// The loader is there, but lists no device.
    #[error(
        "no Vulkan device was found{}{}; install a driver (on Debian: apt-get install libvulkan1 \
         mesa-vulkan-drivers) or render with --device reference",
        chosen_drivers(),
        in_words(loader)
    )]
    NoDevice {
        /// What the loader says of drivers and layers that it cannot use.
        loader: Vec<String>,
    },
    /// The loader itself fails.
    #[error(
        "the Vulkan loader fails in {call}{}{}; mend or remove the file that is at fault \
         (VK_LOADER_DEBUG=all names all that it reads), or render with --device reference",
        chosen_drivers(),
        in_words(loader)
    )]
    Loader {
        /// The function.
        call: &'static str,
        /// What the loader says of drivers and layers that it cannot use.
        loader: Vec<String>,
        /// Its answer.
        #[source]
        source: vk::Result,
    },
    /// No device matches what the user asked for.
    #[error("no device '{asked}'; choose by name or index from: {available}")]
    UnknownDevice {
        /// As typed.
        asked: String,
        /// Every device, with its index.
        available: String,
    },
    /// More than one device matches what the user asked for.
    #[error("'{asked}' names more than one device; choose by index from: {matches}")]
    AmbiguousDevice {
        /// As typed.
        asked: String,
        /// The devices that match, with their indices.
        matches: String,
    },
    /// The device asked for cannot be used, or none of those present can.
    #[error(
        "cannot use device {device}: {reason}; choose another, update its driver, or render with \
         --device reference"
    )]
    UnusableDevice {
        /// Index and name.
        device: String,
        /// What it lacks.
        reason: String,
    },
    /// Validation was requested where the layer cannot do it.
    #[error(
        "validation needs {missing}; install the layer (on Debian: apt-get install \
         vulkan-validationlayers) or run without validation"
    )]
    NoValidation {
        /// The layer or extension that is absent.
        missing: &'static str,
    },
    /// A buffer cannot be bound as one storage buffer.
    #[error(
        "buffer '{name}' needs {needed} bytes but maxStorageBufferRange is {limit}; split it into \
         pages"
    )]
    BufferTooLarge {
        /// The buffer.
        name: &'static str,
        /// Bytes asked for.
        needed: u64,
        /// Bytes allowed.
        limit: u64,
    },
    /// A buffer has more texels than a texel buffer may have.
    #[error(
        "buffer '{name}' has {needed} texels but maxTexelBufferElements is {limit}; bind it as a \
         storage buffer"
    )]
    TexelBufferTooLarge {
        /// The buffer.
        name: &'static str,
        /// Texels in the buffer.
        needed: u64,
        /// Texels allowed.
        limit: u64,
    },
    /// An image has too many pixels on a side.
    #[error(
        "image '{name}' is {width} x {height} pixels but maxImageDimension2D is {limit}; render \
         a smaller picture"
    )]
    ImageTooLarge {
        /// The image.
        name: &'static str,
        /// Pixels in x.
        width: u32,
        /// Pixels in y.
        height: u32,
        /// Pixels allowed on a side.
        limit: u32,
    },
    /// A dispatch has too many workgroups on one axis.
    #[error(
        "pass '{pass}' needs {groups} workgroups along {axis} but maxComputeWorkGroupCount is \
         {limit}; dispatch it in parts"
    )]
    DispatchTooLarge {
        /// The pass.
        pass: &'static str,
        /// x, y or z.
        axis: char,
        /// Workgroups asked for.
        groups: u32,
        /// Workgroups allowed.
        limit: u32,
    },
    /// A kernel wants more of something than the device has.
    #[error(
        "kernel '{kernel}' needs {needed} {what} but {limit_name} is {limit}; choose another device"
    )]
    KernelTooLarge {
        /// The kernel.
        kernel: &'static str,
        /// What it counts, in the plural.
        what: &'static str,
        /// How many it needs.
        needed: u32,
        /// Vulkan's name of the limit.
        limit_name: &'static str,
        /// The limit.
        limit: u32,
    },
    /// A pass lacks what its kernel uses, or is given what does not fit: a fault of this program.
    #[error("pass '{pass}': {binding} {reason}; please report it")]
    Binding {
        /// The kernel.
        pass: &'static str,
        /// By name and number.
        binding: String,
        /// What is wrong with it.
        reason: &'static str,
    },
    /// A pass has other push constants than its kernel: a fault of this program.
    #[error(
        "pass '{pass}': {pushed} bytes of push constants, and the kernel has {expected}; please report it"
    )]
    PushConstants {
        /// The kernel.
        pass: &'static str,
        /// Bytes that were given.
        pushed: usize,
        /// Bytes that it has.
        expected: usize,
    },
    /// A kernel votes in subgroups, which this device cannot.
    #[error("kernel '{kernel}' votes in subgroups, and the device does not; please report it")]
    NoVotes {
        /// The kernel.
        kernel: &'static str,
    },
    /// A module is not one this crate can run.
    #[error("kernel '{kernel}' is not a usable SPIR-V module: {reason}; rebuild the kernels")]
    BadModule {
        /// The kernel.
        kernel: &'static str,
        /// What is wrong.
        reason: String,
    },
    /// The device has no memory left for an object.
    #[error(
        "out of device memory for '{object}', {bytes} bytes; use fewer points or a smaller picture, or \
         render with --device reference"
    )]
    OutOfMemory {
        /// The buffer or image.
        object: &'static str,
        /// How much it needed.
        bytes: u64,
    },
    /// Memory could not be had for another reason.
    #[error(
        "allocating {bytes} bytes for '{object}' failed; use fewer points or a smaller picture, or \
         render with --device reference"
    )]
    Allocation {
        /// The buffer or image.
        object: &'static str,
        /// How much it needed.
        bytes: u64,
        /// The allocator's answer.
        #[source]
        source: gpu_allocator::AllocationError,
    },
    /// The device stopped: a watchdog, a crash of the driver, or a device unplugged.
    #[error("device lost in {work}; rerun with --cells-per-pass 1, or with --device reference")]
    DeviceLost {
        /// The passes or the copy that were under way.
        work: String,
    },
    /// A Vulkan call found no memory, the device's or the machine's.
    #[error(
        "out of memory in {call} for '{object}'; use fewer points or a smaller picture, or render with \
         --device reference"
    )]
    CallOutOfMemory {
        /// The function.
        call: &'static str,
        /// What it was called for.
        object: &'static str,
        /// The driver's answer.
        #[source]
        source: vk::Result,
    },
    /// Any other failure of a Vulkan call.
    #[error(
        "{call} failed for '{object}'; update the device's driver, or render with --device reference"
    )]
    Call {
        /// The function.
        call: &'static str,
        /// What it was called for.
        object: &'static str,
        /// The driver's answer.
        #[source]
        source: vk::Result,
    },
}

impl GpuError {
    /// True where no device could be opened at all: nothing is wrong with the scene, and another
    /// `--device` may work.
    pub fn is_no_device(&self) -> bool {
        matches!(
            self,
            Self::NoLoader { .. }
                | Self::NoDevice { .. }
                | Self::Loader { .. }
                | Self::UnknownDevice { .. }
                | Self::AmbiguousDevice { .. }
                | Self::UnusableDevice { .. }
                | Self::NoValidation { .. }
        )
    }

    /// The error of a failed `call` on `object`, for `map_err`.
    pub(crate) fn call(call: &'static str, object: &'static str) -> impl Fn(vk::Result) -> Self {
        move |source| match source {
            vk::Result::ERROR_DEVICE_LOST => Self::DeviceLost { work: format!("'{object}'") },
            vk::Result::ERROR_OUT_OF_DEVICE_MEMORY | vk::Result::ERROR_OUT_OF_HOST_MEMORY => {
                Self::CallOutOfMemory { call, object, source }
            }
            source => Self::Call { call, object, source },
        }
    }
}

/// The variables that say which drivers the loader looks at, if one is set: all others are then hidden.
fn chosen_drivers() -> String {
    // The order in which the loader looks at them.
    let chosen = ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"].into_iter().find_map(|name| {
        let value = std::env::var_os(name)?;
        Some(format!(" with {name}='{}', which hides all other drivers", value.to_string_lossy()))
    });
    chosen.unwrap_or_default()
}

fn in_words(loader: &[String]) -> String {
    if loader.is_empty() { String::new() } else { format!(" ({})", loader.join("; ")) }
}
