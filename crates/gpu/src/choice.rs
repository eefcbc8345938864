//! Which device to use: the user's word for it, or the default order.
//!
//! Pure: it sees descriptions of devices and gives back an index, so the rules are tested on
//! machines that have none of these devices.

use crate::GpuError;
use std::fmt;

/// What sort of device the driver says it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum DeviceKind {
    /// A GPU with memory of its own.
    Discrete,
    /// A GPU that shares the processor's memory.
    Integrated,
    /// A GPU lent to a virtual machine.
    Virtual,
    /// The processor, by a software driver.
    Cpu,
    /// Anything else.
    Other,
}

impl fmt::Display for DeviceKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Discrete => "discrete GPU",
            Self::Integrated => "integrated GPU",
            Self::Virtual => "virtual GPU",
            Self::Cpu => "CPU",
            Self::Other => "device of another kind",
        })
    }
}

/// One physical device, as the user is told about it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DeviceInfo {
    /// Position in the driver's list, and the number the user may type.
    pub index: usize,
    /// The driver's name for it.
    pub name: String,
    /// What sort of device.
    pub kind: DeviceKind,
    /// Name and version of the driver.
    pub driver: String,
    /// Vulkan version of the device: major, minor, patch.
    pub api_version: (u32, u32, u32),
    /// Why it cannot be used; `None` where it can.
    pub unusable: Option<String>,
}

/// Which device to open.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum DeviceChoice {
    /// Discrete, then integrated, then virtual, then CPU; the first of its kind.
    #[default]
    Default,
    /// As the user typed it: an index where it is all digits, else a part of the name in any
    /// case. A full name wins over names that contain it.
    Named(String),
}

/// What [`DeviceChoice::Default`] means on this machine.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DefaultDevice {
    /// Index of the device.
    pub index: usize,
    /// Why this one, in one line.
    pub reason: String,
}

/// The index of the device to open, which is always a usable one.
pub(crate) fn choose(devices: &[DeviceInfo], choice: &DeviceChoice) -> Result<usize, GpuError> {
    match choice {
        DeviceChoice::Default => choose_default(devices).map(|default| default.index),
        DeviceChoice::Named(asked) => choose_named(devices, asked.trim()),
    }
}

/// The first device of the most wanted kind.
pub(crate) fn choose_default(devices: &[DeviceInfo]) -> Result<DefaultDevice, GpuError> {
    let usable = || devices.iter().filter(|device| device.unusable.is_none());
    let Some(best) = usable().min_by_key(|device| (rank(device.kind), device.index)) else {
        return Err(devices.first().map_or_else(no_device, unusable));
    };
    let others = usable().count() - 1;
    let twins = usable().filter(|device| device.kind == best.kind).count() - 1;
    let reason = match (others, twins) {
        (0, _) => format!("the only usable device, a {}", best.kind),
        (_, 0) => format!("the only {} among {} usable devices", best.kind, others + 1),
        _ => format!("the first {} of {}", best.kind, twins + 1),
    };
    Ok(DefaultDevice { index: best.index, reason })
}

fn choose_named(devices: &[DeviceInfo], asked: &str) -> Result<usize, GpuError> {
    if devices.is_empty() {
        return Err(no_device());
    }
    let unknown =
        || GpuError::UnknownDevice { asked: asked.to_owned(), available: list(devices.iter()) };
    if asked.is_empty() {
        return Err(unknown());
    }
    let found = if asked.bytes().all(|byte| byte.is_ascii_digit()) {
        // A number too large to parse is no device's index either.
        let index = asked.parse().unwrap_or(usize::MAX);
        devices.iter().find(|device| device.index == index).ok_or_else(unknown)?
    } else {
        let asked_lower = asked.to_lowercase();
        let matching = |whole: bool| -> Vec<&DeviceInfo> {
            let is_match = |name: &str| match whole {
                true => name == asked_lower,
                false => name.contains(&asked_lower),
            };
            devices.iter().filter(|device| is_match(&device.name.to_lowercase())).collect()
        };
        let mut matches = matching(true);
        if matches.is_empty() {
            matches = matching(false);
        }
        match matches[..] {
            [] => return Err(unknown()),
            [one] => one,
            _ => {
                return Err(GpuError::AmbiguousDevice {
                    asked: asked.to_owned(),
                    matches: list(matches.into_iter()),
                });
            }
        }
    };
    if found.unusable.is_some() { Err(unusable(found)) } else { Ok(found.index) }
}

fn no_device() -> GpuError {
    GpuError::NoDevice { loader: Vec::new() }
}

fn rank(kind: DeviceKind) -> u32 {
    match kind {
        DeviceKind::Discrete => 0,
        DeviceKind::Integrated => 1,
        DeviceKind::Virtual => 2,
        DeviceKind::Cpu => 3,
        DeviceKind::Other => 4,
    }
}

fn list<'a>(devices: impl Iterator<Item = &'a DeviceInfo>) -> String {
    devices.map(label).collect::<Vec<_>>().join(", ")
}

fn label(device: &DeviceInfo) -> String {
    format!("{} '{}'", device.index, device.name)
}

fn unusable(device: &DeviceInfo) -> GpuError {
    let reason = device.unusable.clone().unwrap_or_default();
    GpuError::UnusableDevice { device: label(device), reason }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn device(index: usize, name: &str, kind: DeviceKind) -> DeviceInfo {
        DeviceInfo {
            index,
            name: name.to_owned(),
            kind,
            driver: "driver 1".to_owned(),
            api_version: (1, 3, 0),
            unusable: None,
        }
    }

    fn machine() -> Vec<DeviceInfo> {
        let mut old = device(3, "Ancient GT", DeviceKind::Discrete);
        old.unusable = Some("it offers Vulkan 1.0 and 1.1 is needed".to_owned());
        vec![
            device(0, "llvmpipe", DeviceKind::Cpu),
            device(1, "Turbo 3080", DeviceKind::Discrete),
            device(2, "Turbo 3080 Ti", DeviceKind::Discrete),
            old,
        ]
    }

    fn named(asked: &str) -> Result<usize, GpuError> {
        choose(&machine(), &DeviceChoice::Named(asked.to_owned()))
    }

    #[test]
    fn default_is_the_first_usable_device_of_the_best_kind() {
        let chosen = choose_default(&machine()).unwrap();
        assert_eq!(chosen.index, 1);
        assert_eq!(chosen.reason, "the first discrete GPU of 2");
        let only = choose_default(&machine()[..1]).unwrap();
        assert_eq!((only.index, &*only.reason), (0, "the only usable device, a CPU"));
    }

    #[test]
    fn digits_are_an_index_and_words_part_of_a_name() {
        assert_eq!(named("2").unwrap(), 2);
        assert_eq!(named(" LLVM ").unwrap(), 0);
        assert_eq!(named("3080 ti").unwrap(), 2);
        assert_eq!(named("turbo 3080").unwrap(), 1, "a full name wins");
    }

    #[test]
    fn unknown_and_ambiguous_names_list_the_devices() {
        for asked in ["voodoo", "9", "99999999999999999999999", ""] {
            let message = named(asked).unwrap_err().to_string();
            assert!(message.contains(&format!("'{asked}'")), "{message}");
            assert!(message.contains("0 'llvmpipe', 1 'Turbo 3080', 2"), "{message}");
        }
        let message = named("turbo").unwrap_err().to_string();
        assert!(message.contains("1 'Turbo 3080', 2 'Turbo 3080 Ti'"), "{message}");
        assert!(!message.contains("llvmpipe"), "{message}");
    }

    #[test]
    fn an_unusable_device_is_never_chosen_and_says_why() {
        let error = named("ancient").unwrap_err();
        assert!(error.is_no_device());
        let message = error.to_string();
        assert!(message.contains("3 'Ancient GT'") && message.contains("Vulkan 1.0"), "{message}");
        assert!(matches!(choose_default(&machine()[3..]), Err(GpuError::UnusableDevice { .. })));
    }

    #[test]
    fn a_machine_without_devices_names_the_packages() {
        for choice in [DeviceChoice::Default, DeviceChoice::Named("0".to_owned())] {
            let message = choose(&[], &choice).unwrap_err().to_string();
            assert!(message.contains("mesa-vulkan-drivers"), "{message}");
            assert!(message.contains("--device reference"), "{message}");
        }
    }
}
