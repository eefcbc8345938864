//! Sizes in headers are not believed before the bytes are there.

use std::fs;
use std::io;
use std::path::Path;

/// What nobody is asked for.
const SMALL: u64 = 64 << 20;
/// Bytes of pixels a byte of a file. Deflate, the densest of what PNG, JPEG, OpenEXR and Radiance HDR use, makes 1032;
/// the rest is room for what comes before it, such as blocks of one colour.
const DENSEST: u64 = 10_000;

/// What is wrong with a file that announces so many bytes of pixels, if it is too short for them.
pub(crate) fn too_short_for(pixel_bytes: u64, path: &Path) -> io::Result<Option<String>> {
    let length = fs::metadata(path)?.len();
    Ok((pixel_bytes > SMALL && pixel_bytes / DENSEST > length).then(|| {
        format!("its header announces {pixel_bytes} bytes of pixels, but the file has {length}")
    }))
}
