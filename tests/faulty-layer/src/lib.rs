//! A Vulkan layer that lets calls fail, so that tests meet faults that no healthy driver has: a lost
//! device, memory that runs out at any call, a driver that is too old.
//!
//! The program under test is the one that users have: the loader puts this library between it and the
//! driver ([`environment`]). What fails is in [`FAULTS`], whole words with commas between:
//!
//! * `CALL@N=RESULT`: the N-th call (from 0) of `CALL` and all later ones give `RESULT`, a number of
//!   `VkResult`. Waits wait first, so that nothing runs on a device that is called lost. Once a call has
//!   given `VK_ERROR_DEVICE_LOST`, so do all that submit or wait.
//! * `version=1.0`: the version of Vulkan that devices offer.
//! * `no-compute`: no queue computes.
//! * `no-timestamps`: no queue has a clock.
//! * `heap=BYTES`: what each heap of a device has.
//!
//! One instance and one device a process, one after another: that is all that the program opens. The calls
//! made are counted into the file that [`CALLS`] names when the instance is destroyed.

mod calls;
mod faults;
mod loader;

use std::path::{Path, PathBuf};

/// The variable that says what fails.
pub const FAULTS: &str = "POINTILLIST_FAULTS";
/// The variable that names a file for the calls that can fail, one a line with how often it was made.
pub const CALLS: &str = "POINTILLIST_CALLS";
/// The layer's name.
const NAME: &str = "VK_LAYER_POINTILLIST_faulty";

/// Writes the layer's manifest to a folder, and gives the variables that make the loader use it there.
/// `library` is this crate's as a shared library.
///
/// # Errors
/// A folder that cannot be written to.
pub fn environment(folder: &Path, library: &Path) -> std::io::Result<[(&'static str, PathBuf); 2]> {
    let manifest = format!(
        "{{ \"file_format_version\": \"1.1.0\", \"layer\": {{ \"name\": \"{NAME}\", \"type\": \"GLOBAL\", \
         \"library_path\": \"{}\", \"api_version\": \"1.3.0\", \"implementation_version\": \"1\", \
         \"description\": \"lets calls fail\" }} }}",
        library.display()
    );
    std::fs::write(folder.join("faulty_layer.json"), manifest)?;
    // Not VK_LAYER_PATH, which would hide the validation layer.
    Ok([("VK_ADD_LAYER_PATH", folder.to_owned()), ("VK_INSTANCE_LAYERS", PathBuf::from(NAME))])
}
