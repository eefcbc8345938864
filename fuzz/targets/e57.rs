#![no_main]

use pointillist_fuzz::{read_points, with_checksums};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    read_points(&with_checksums(bytes), "fuzz.e57");
    // As it is, for what is looked at before checksums are.
    read_points(bytes, "fuzz.e57");
});
