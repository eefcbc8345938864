#![no_main]
libfuzzer_sys::fuzz_target!(|bytes: &[u8]| pointillist_fuzz::read_points(bytes, "fuzz.xyz.gz"));
