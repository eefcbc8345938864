//! `devices`: what there is to render on.

use crate::errors::{self, Failure};
use crate::{again, console, ending, memory};
use gpu::{DefaultDevice, DeviceInfo, GpuError, Instance, InstanceOptions};
use std::fmt::Write;

const REFERENCE: &str =
    "reference  the CPU without Vulkan, on all cores: --device reference always works\n";

/// Lists the devices, and says what renders where none is named: where none can be used, the CPU reference.
pub fn run() -> Result<(), Failure> {
    let mut text = String::new();
    let default = match (again::crash(), memory::require_driver(0)) {
        (Some(crash), _) => Err(crash),
        (None, Err(lacking)) => Err(lacking),
        (None, Ok(())) => {
            again::guarding(|| listed(&mut text)).map_err(|error| errors::chain(&error))
        }
    };
    // An error of the list has them already.
    if !text.is_empty() {
        for line in Instance::loader_errors() {
            // Writing to a string cannot fail; nor below.
            let _ = writeln!(text, "not usable {line}");
        }
    }
    text.push_str(REFERENCE);
    let _ = match default {
        Ok(default) => writeln!(text, "default    {}: {}", default.index, default.reason),
        Err(reason) => writeln!(text, "default    reference: {reason}"),
    };
    console::result(&text)
}

/// Describes all devices, and chooses the default of them.
fn listed(text: &mut String) -> Result<DefaultDevice, GpuError> {
    ending::driver_is_there();
    let instance = Instance::new(&InstanceOptions::default())?;
    for device in &instance.devices()? {
        describe(text, device);
    }
    instance.default_device()
}

fn describe(text: &mut String, device: &DeviceInfo) {
    let DeviceInfo { index, name, kind, driver, api_version: (major, minor, patch), .. } = device;
    let _ = writeln!(text, "{index:<9}  {name}");
    let _ = writeln!(text, "           {kind}, {driver}, Vulkan {major}.{minor}.{patch}");
    let _ = match &device.unusable {
        None => writeln!(text, "           usable"),
        Some(reason) => writeln!(text, "           not usable: {reason}"),
    };
}
