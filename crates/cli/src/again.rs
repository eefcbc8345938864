//! Drivers that crash while they are opened: the program begins anew in the same process, without Vulkan.

use crate::engine::Unopened;
use crate::source;
use gpu::process::{self, Again};
use std::env;

/// Says to the program that begins anew why it does, by the number of the process, which stays.
const MARK: &str = "POINTILLIST_DRIVER_CRASHED";

/// Why there is no Vulkan, where a driver crashed in this process.
pub fn crash() -> Option<String> {
    let is_this = env::var(MARK).is_ok_and(|number| number == std::process::id().to_string());
    is_this.then(|| "the Vulkan driver crashed while it was opened; update or remove it".to_owned())
}

/// Opens what nobody asked for by its name, unless that crashed before.
pub fn open_by_default<T>(open: impl FnOnce() -> Result<T, Unopened>) -> Result<T, Unopened> {
    match crash() {
        Some(why) => Err(Unopened::Crashed(why)),
        None => guarding(open),
    }
}

/// Runs what may crash. Not where stdin is read, which cannot be read again, nor where a device is checked.
pub fn guarding<T>(work: impl FnOnce() -> T) -> T {
    let once = source::is_stdin_read() || env::var_os(crate::engine::VALIDATION).is_some();
    match Again::with(MARK, &std::process::id().to_string()).filter(|_| !once) {
        Some(again) => process::guarded(again, work),
        None => work(),
    }
}
