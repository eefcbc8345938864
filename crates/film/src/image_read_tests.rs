//! Images written by other means, read back.

use super::*;
use image::{DynamicImage, ImageBuffer, Luma, Rgb, Rgba};
use std::fs;

fn saved(name: &str, image: impl Into<DynamicImage>) -> Result<Image, FilmError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    image.into().save(&path).unwrap();
    read_image(&path)
}

#[test]
fn eight_bits_stay_and_lose_their_alpha() {
    let pixels = ImageBuffer::from_fn(3, 2, |x, y| Rgba([x as u8, y as u8, 200, 7]));
    let image = saved("a.png", pixels).unwrap();
    let expected = (0..6u8).map(|i| [i % 3, i / 3, 200]).collect();
    assert_eq!(image, Image { width: 3, height: 2, texels: Texels::Srgb8(expected) });
    let gray = saved("a.png", ImageBuffer::from_pixel(1, 1, Luma([99u8]))).unwrap();
    assert_eq!(gray.texels, Texels::Srgb8(vec![[99; 3]]));
}

#[test]
fn sixteen_bits_are_decoded_from_srgb() {
    let image = saved("a.png", ImageBuffer::from_pixel(1, 1, Rgb([0u16, 48_191, 65_535]))).unwrap();
    // 48191 / 65535 is the stored value of 0.5: 1.055 * 0.5^(1/2.4) - 0.055 = 0.735357.
    let Texels::Linear(texels) = image.texels else { panic!("{image:?}") };
    assert_eq!((texels[0][0], texels[0][2]), (0.0, 1.0));
    assert!((texels[0][1] - 0.5).abs() < 2e-5, "{texels:?}");
}

#[test]
fn radiance_files_are_linear_whatever_their_name() {
    let pixels = ImageBuffer::from_pixel(2, 1, Rgb([0.25f32, 1.0, 4096.0]));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.hdr");
    DynamicImage::from(pixels).save(&path).unwrap();
    let renamed = folder.path().join("sky.png");
    fs::rename(&path, &renamed).unwrap();
    let image = read_image(&renamed).unwrap();
    // One exponent for three channels: what is 4096 times smaller has no digits left.
    let Texels::Linear(texels) = image.texels else { panic!("{image:?}") };
    assert!(texels.iter().all(|texel| texel[2] == 4096.0 && texel[0] < 16.0), "{texels:?}");
}

/// A crop lies where its data window says, in black.
#[test]
fn exr_files_fill_their_display_window() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    let window = Window { x: 1, y: 2, width: 2, height: 1 };
    let mut film = Film::empty([4, 3], window, false);
    film.color = vec![[1.0, 2.0, 3.0, 1.0], [4.0, f32::INFINITY, -6.0, 1.0]];
    let provenance = Provenance {
        world_to_camera: [[0.0; 4]; 4],
        world_to_ndc: [[0.0; 4]; 4],
        origin: [0.0; 3],
        settings: Vec::new(),
    };
    write(&film, &provenance, &path).unwrap();
    let mut expected = vec![[0.0; 3]; 12];
    expected[9..11].copy_from_slice(&[[1.0, 2.0, 3.0], [4.0, f32::INFINITY, -6.0]]);
    let image = read_image(&path).unwrap();
    assert_eq!(image, Image { width: 4, height: 3, texels: Texels::Linear(expected) });
}

/// A few bytes that would take gigabytes; found by fuzzing.
#[test]
fn sizes_without_bytes_for_them_are_errors_before_memory_is_taken() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a");
    fs::write(&path, "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 60000 +X 60000\n\x02\x02").unwrap();
    let message = read_image(&path).unwrap_err().to_string();
    assert!(message.contains("announces 43200000000 bytes of pixels"), "{message}");

    let exr = folder.path().join("a.exr");
    let plane = vec![0.5; 16];
    let planes = ["R", "G", "B"].map(|name| (name.to_owned(), plane.clone())).to_vec();
    write_planes([4, 4], [0, 0], [4, 4], planes, &exr).unwrap();
    let whole = fs::read(&exr).unwrap();
    for window in ["displayWindow", "dataWindow"] {
        let name = format!("{window}\0box2i\0");
        let at = whole.windows(name.len()).position(|bytes| bytes == name.as_bytes()).unwrap();
        // Behind the name the length, then left, top, right, bottom.
        let right = at + name.len() + 4 + 8;
        let mut bytes = whole.clone();
        bytes[right..right + 8].copy_from_slice(&[0xff, 0xff, 0, 0, 0xff, 0xff, 0, 0]);
        fs::write(&exr, &bytes).unwrap();
        let message = read_image(&exr).unwrap_err().to_string();
        assert!(message.contains("announces"), "{window}: {message}");
    }
}

/// Found by fuzzing: what reads the pixels finds other sizes in this damaged header than what reads the header.
#[test]
fn a_header_that_is_read_in_two_ways_takes_no_memory_either() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    fs::write(&path, include_bytes!("../tests/two-ways.exr")).unwrap();
    let message = read_image(&path).unwrap_err().to_string();
    assert!(message.contains("announces"), "{message}");
}

#[test]
fn files_that_are_no_image_are_errors() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    assert!(matches!(read_image(&path), Err(FilmError::Read { .. })));
    fs::write(&path, "ply\n").unwrap();
    let message = read_image(&path).unwrap_err().to_string();
    assert!(
        message.contains("PNG, JPEG, OpenEXR or Radiance HDR: found none of these"),
        "{message}"
    );
    DynamicImage::from(ImageBuffer::from_pixel(9, 9, Luma([1u8]))).save(&path).unwrap();
    let whole = fs::read(&path).unwrap();
    for length in 0..whole.len() - 13 {
        fs::write(&path, &whole[..length]).unwrap();
        assert!(read_image(&path).is_err(), "{length} bytes");
    }
}
