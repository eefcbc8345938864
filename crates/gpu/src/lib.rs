//! Pointillist's Vulkan layer: devices, buffers, images, kernels and the recorder.
//!
//! All `unsafe` of the project is in this crate, behind an interface in which only [`Kernel::of_words`] is unsafe. Four rules
//! make its arguments short:
//!
//! * every object holds an `Arc` of its [`Device`], and a device an `Arc` of its [`Instance`], so
//!   nothing outlives what made it;
//! * a [`Recorder`] holds an `Arc` of every kernel, buffer and image it used until its fence has
//!   signalled, so no pending work refers to a destroyed object;
//! * [`Recorder::submit`] waits, and host access to a buffer takes the same lock as a submission,
//!   so the host and the device never touch memory at the same time;
//! * devices are opened with `robustBufferAccess`, so an index out of range in a kernel reads or
//!   writes nothing outside its buffer.
//!
//! SPIR-V is trusted where it is a module of the crate `kernels`, which has no others than its own; for any other
//! there is [`Kernel::of_words`], which is unsafe.
//!
//! Any Vulkan 1.1 device with a compute queue will do. The loader is opened at run time: without
//! one, [`Instance::new`] fails with [`GpuError::NoLoader`] and says what to install.

mod access;
mod buffer;
mod choice;
mod descriptors;
mod device;
mod error;
mod image;
mod instance;
mod kernel;
mod pass;
mod pipelines;
pub mod process;
mod queue;
mod recorder;
mod spirv;
mod timer;

pub use buffer::Buffer;
pub use choice::{DefaultDevice, DeviceChoice, DeviceInfo, DeviceKind};
pub use device::{Device, Limits};
pub use error::GpuError;
pub use image::{Image, ImageFormat};
pub use instance::{Instance, InstanceOptions};
pub use kernel::{Kernel, Texel};
pub use pass::{Bindings, PART_ALIGNMENT, PassBuilder};
pub use pipelines::Constants;
pub use recorder::{Recorder, Timings};

use std::sync::atomic::{AtomicU64, Ordering};

/// A number no other buffer, image or kernel of this process has or will have. Handles are reused
/// by drivers; these are not, so they can be keys of caches that outlive the object.
fn next_id() -> u64 {
    static NEXT: AtomicU64 = AtomicU64::new(1);
    NEXT.fetch_add(1, Ordering::Relaxed)
}

#[cfg(test)]
mod tests {
    use crate::{Device, DeviceChoice, Instance, InstanceOptions};
    use std::sync::Arc;

    /// The default device with validation on. Without one the test fails and says what to install.
    pub(crate) fn device_with_validation() -> Arc<Device> {
        let instance = Instance::new(&InstanceOptions { validation: true });
        let instance = instance.unwrap_or_else(|error| panic!("{error}"));
        Device::open(&instance, &DeviceChoice::Default).unwrap_or_else(|error| panic!("{error}"))
    }
}
