//! EXR files in 16 bits, and planes and pictures that are no film.

use super::*;

fn provenance() -> Provenance {
    Provenance {
        world_to_camera: [[0.0; 4]; 4],
        world_to_ndc: [[0.0; 4]; 4],
        origin: [0.0; 3],
        settings: Vec::new(),
    }
}

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().unwrap()
}

/// 16 bits have 11 digits of two: 2049 lies between 2048 and 2050, 65520 would be infinite.
#[test]
fn half_rounds_what_is_looked_at_and_keeps_what_is_measured() {
    let folder = folder();
    let path = folder.path().join("a.exr");
    let mut film = Film::empty([3, 1], Window::whole([3, 1]), false);
    film.color[0] = [2049.0, 65_520.0, -1e30, 1.0];
    film.color[1] = [f32::INFINITY, f32::NEG_INFINITY, f32::NAN, 0.5];
    film.color[2] = [65_504.0, 65_519.0, 1e-9, 0.0];
    film.position[0] = [2049.0; 3];
    film.depth[0] = 1e6 + 0.5;
    film.object[0] = 2049.0;
    film.normal[0] = [0.6, -0.8, 0.0];
    film.extra.push(("point".to_owned(), vec![16_777_216.0, -1.0, 2049.0]));
    let style = Style { half: true, ..Style::default() };
    write_styled(&film, &provenance(), style, &path).unwrap();
    let file = read_exr_file(&path).unwrap();
    let channels = &file.parts[0].channels;
    for (name, samples) in channels {
        let shown = ["R", "G", "B", "A", "N.X", "N.Y", "N.Z"].contains(&name.as_str());
        assert_eq!(samples.kind(), if shown { "half" } else { "float" }, "{name}");
    }
    let value = |name: &str, at: usize| channels[name].at(at);
    assert_eq!(value("R", 0), 2048.0);
    assert_eq!((value("G", 0), value("B", 0)), (65_504.0, -65_504.0));
    assert_eq!((value("R", 1), value("G", 1)), (f64::INFINITY, f64::NEG_INFINITY));
    assert!(value("B", 1).is_nan());
    assert_eq!((value("R", 2), value("G", 2), value("B", 2)), (65_504.0, 65_504.0, 0.0));
    assert_eq!(
        (value("P.X", 0), value("object", 0), value("point", 0)),
        (2049.0, 2049.0, 16_777_216.0)
    );
    assert_eq!((value("Z", 0), value("Z", 1)), (1e6 + 0.5, f64::INFINITY));
    assert!((value("N.X", 0) - 0.6).abs() < 2.5e-4, "half a unit in the 11th digit of two");
    assert_eq!(beyond_half(&film), 3, "65520, -1e30 and 65519; infinities are what they are");
}

#[test]
fn two_writes_in_half_are_equal_to_the_byte() {
    let folder = folder();
    let film = Film::empty([9, 40], Window::whole([9, 40]), false);
    let style = Style { half: true, ..Style::default() };
    let written: Vec<Vec<u8>> = ["a.exr", "b.exr"]
        .map(|name| {
            let path = folder.path().join(name);
            write_styled(&film, &provenance(), style, &path).unwrap();
            std::fs::read(path).unwrap()
        })
        .into();
    assert!(written[0] == written[1]);
}

#[test]
fn planes_lie_where_they_are_put_even_outside_of_the_display_window() {
    let folder = folder();
    let path = folder.path().join("a.exr");
    let plane: Vec<f32> = (0..6).map(|i| i as f32).collect();
    write_planes([8, 8], [-1, 7], [2, 3], vec![("flip".to_owned(), plane.clone())], &path).unwrap();
    let picture = read_exr(&path).unwrap();
    assert_eq!((picture.data_origin, picture.data_size), ([-1, 7], [2, 3]));
    assert_eq!((picture.display_origin, picture.display_size), ([0, 0], [8, 8]));
    assert_eq!(picture.channels["flip"], plane);
}

#[test]
fn rasters_keep_their_bits_and_their_alpha() {
    let folder = folder();
    let path = folder.path().join("a.png");
    write_png([2, 1], &[[0, 128, 255], [1, 2, 3]], &path).unwrap();
    let raster = read_raster(&path).unwrap();
    assert_eq!((raster.size, raster.bits, raster.linear, raster.alpha), ([2, 1], 8, false, false));
    assert_eq!(raster.pixels[0], [0.0, 128.0 / 255.0, 1.0, 1.0]);

    image::ImageBuffer::from_pixel(1, 1, image::LumaA([51u16, 13_107])).save(&path).unwrap();
    let raster = read_raster(&path).unwrap();
    assert_eq!((raster.bits, raster.alpha), (16, true));
    let grey = (51.0f64 / 65_535.0) as f32;
    assert_eq!(raster.pixels[0], [grey, grey, grey, 0.2]);

    let path = folder.path().join("a.hdr");
    image::ImageBuffer::from_pixel(1, 1, image::Rgb([0.5f32, 2.0, 64.0])).save(&path).unwrap();
    let raster = read_raster(&path).unwrap();
    assert_eq!((raster.bits, raster.linear, raster.alpha), (32, true, false));
    assert_eq!(raster.pixels[0], [0.5, 2.0, 64.0, 1.0]);
    assert!(matches!(read_raster(folder.path()), Err(FilmError::Read { .. })));
    assert!(matches!(is_exr(folder.path()), Err(FilmError::IsFolder { .. })));
}
