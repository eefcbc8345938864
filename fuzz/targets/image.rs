//! Textures and environments, which scenes name.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let path = pointillist_fuzz::file_of(bytes, "img");
    if let Ok(image) = film::read_image(&path) {
        let texels = match &image.texels {
            film::Texels::Srgb8(texels) => texels.len(),
            film::Texels::Linear(texels) => texels.len(),
        };
        assert!(texels > 0, "no texel and no error");
        assert_eq!(texels as u64, u64::from(image.width) * u64::from(image.height));
    }
});
