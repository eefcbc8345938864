//! `devices`: what there is to render on.

use crate::console;
use crate::errors::Failure;
use gpu::{DeviceInfo, GpuError, Instance, InstanceOptions};
use std::fmt::Write;

const REFERENCE: &str =
    "reference  the CPU without Vulkan, on all cores: --device reference always works\n";

/// Lists the devices; fails, after saying what works nevertheless, where none is usable.
pub fn run() -> Result<(), Failure> {
    let listed = Instance::new(&InstanceOptions::default())
        .and_then(|instance| Ok((instance.devices()?, instance.default_device())));
    let mut text = String::new();
    let error = match listed {
        Ok((devices, default)) => {
            for device in &devices {
                describe(&mut text, device);
            }
            match default {
                Ok(default) => {
                    // Writing to a string cannot fail; nor below.
                    let _ = writeln!(text, "default    {}: {}", default.index, default.reason);
                    None
                }
                Err(error) => Some(error),
            }
        }
        Err(error) => Some(error),
    };
    // An error of the list has them already.
    if !text.is_empty() {
        for line in Instance::loader_errors() {
            let _ = writeln!(text, "not usable {line}");
        }
    }
    text.push_str(REFERENCE);
    console::result(&text)?;
    error.map_or(Ok(()), |error: GpuError| Err(Failure::no_device(&error)))
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
