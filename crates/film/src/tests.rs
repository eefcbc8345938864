//! What is written against what is read back, by this crate and by others.

use super::*;
use std::fs;
use std::path::PathBuf;
use std::process::Command;

/// A crop of a larger image with a different value in every sample, over three blocks of lines.
fn film() -> Film {
    let window = Window { x: 3, y: 5, width: 7, height: 37 };
    let mut film = Film::empty([20, 50], window, false);
    for i in 0..window.pixels() {
        let v = i as f32;
        film.color[i] = [v, v + 0.25, v + 0.5, 1.0 / (v + 1.0)];
        film.position[i] = [-v, v * 1e-20, v * 1e20];
        film.normal[i] = [v.sin(), v.cos(), -0.0];
        if i % 3 == 0 {
            film.depth[i] = v + 0.125;
            film.object[i] = (i % 5) as f32;
        }
    }
    film
}

fn provenance() -> Provenance {
    Provenance {
        world_to_camera: [
            [1.0, 2.0, 3.0, 0.0],
            [5.0, 6.0, 7.0, 0.0],
            [9.0, 10.0, 11.0, 0.0],
            [13.5, 14.5, 15.5, 1.0],
        ],
        world_to_ndc: std::array::from_fn(|i| std::array::from_fn(|j| (10 * i + j) as f32)),
        origin: [0.1, -515_368.123_456_789, 1e300],
        settings: [
            ("camera.eye", "[0.0, 0.4, 3.0]"),
            ("objects.0.surface.feature_size.long_enough_for_a_long_name", "adaptive"),
            ("objects.0.name", "Würfel, 点"),
            ("image.samples", "1"),
            ("empty", ""),
            ("render.seed", "0"),
        ]
        .map(|(key, value)| (key.to_owned(), value.to_owned()))
        .into(),
    }
}

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().unwrap()
}

fn names_in(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

/// Without NaN, equal bits; `==` would take −0 for 0.
fn bits(values: &[f32]) -> Vec<u32> {
    values.iter().map(|value| value.to_bits()).collect()
}

#[test]
fn exr_gives_back_every_channel_and_header_of_a_crop() {
    let folder = folder();
    let path = folder.path().join("crop.EXR");
    let (film, provenance) = (film(), provenance());
    write(&film, &provenance, &path).unwrap();

    let picture = read_exr(&path).unwrap();
    assert_eq!((picture.display_origin, picture.display_size), ([0, 0], [20, 50]));
    assert_eq!((picture.data_origin, picture.data_size), ([3, 5], [7, 37]));

    let names: Vec<&str> = picture.channels.keys().map(String::as_str).collect();
    let expected = ["A", "B", "G", "N.X", "N.Y", "N.Z", "P.X", "P.Y", "P.Z", "R", "Z", "object"];
    assert_eq!(names, expected);
    let check = |name: &str, value: &dyn Fn(usize) -> f32| {
        let expected: Vec<f32> = (0..film.window.pixels()).map(value).collect();
        assert_eq!(bits(&picture.channels[name]), bits(&expected), "channel {name}");
    };
    for (c, name) in ["R", "G", "B", "A"].into_iter().enumerate() {
        check(name, &|i| film.color[i][c]);
    }
    for (c, axis) in ["X", "Y", "Z"].into_iter().enumerate() {
        check(&format!("P.{axis}"), &|i| film.position[i][c]);
        check(&format!("N.{axis}"), &|i| film.normal[i][c]);
    }
    check("Z", &|i| film.depth[i]);
    check("object", &|i| film.object[i]);

    assert_eq!(picture.world_to_camera, Some(provenance.world_to_camera));
    assert_eq!(picture.world_to_ndc, Some(provenance.world_to_ndc));
    assert!(picture.strings["software"].starts_with("Pointillist "));
    for (key, value) in &provenance.settings {
        assert_eq!(&picture.strings[&format!("pointillist/{key}")], value);
    }
    let origin: Vec<f64> = picture.strings["pointillist/origin"]
        .split(' ')
        .map(|number| number.parse().unwrap())
        .collect();
    assert_eq!(origin, provenance.origin);
}

#[test]
fn exr_gives_back_extra_channels_beside_the_others() {
    let folder = folder();
    let path = folder.path().join("a.exr");
    let plain = film();
    let mut film = plain.clone();
    for (factor, name) in [(-1.0, "tests"), (0.5, "Above.all"), (1e9, "fit")] {
        let plane = (0..film.window.pixels()).map(|i| i as f32 * factor).collect();
        film.extra.push((name.to_owned(), plane));
    }
    write(&film, &provenance(), &path).unwrap();
    let picture = read_exr(&path).unwrap();
    assert_eq!(picture.channels.len(), 15);
    for (name, plane) in &film.extra {
        assert_eq!(bits(&picture.channels[name]), bits(plane), "channel {name}");
    }
    write(&plain, &provenance(), &path).unwrap();
    for (name, plane) in &read_exr(&path).unwrap().channels {
        assert_eq!(bits(&picture.channels[name]), bits(plane), "channel {name}");
    }
}

#[test]
fn pictures_of_eight_bits_leave_extra_channels_out() {
    let folder = folder();
    let mut film = film();
    let written = |film: &Film, name: &str| {
        let path = folder.path().join(name);
        write(film, &provenance(), &path).unwrap();
        fs::read(path).unwrap()
    };
    let plain = ["a.png", "a.jpg"].map(|name| written(&film, name));
    film.extra.push(("tests".to_owned(), vec![7.0; film.window.pixels()]));
    assert!(plain == ["b.png", "b.jpg"].map(|name| written(&film, name)));
}

#[test]
#[should_panic(expected = "'P.X' is not free")]
fn two_channels_of_one_name_are_the_callers_mistake() {
    let mut film = film();
    film.extra.push(("P.X".to_owned(), vec![0.0; film.window.pixels()]));
    let _ = write(&film, &provenance(), Path::new("a.exr"));
}

/// The OpenEXR library's own tool prints matrices row by row, and lists attributes and channels.
#[test]
fn exrheader_prints_what_was_written() {
    let folder = folder();
    let path = folder.path().join("crop.exr");
    write(&film(), &provenance(), &path).unwrap();
    let output = match Command::new("exrheader").arg(&path).output() {
        Ok(output) => output,
        Err(error) => {
            // Not eprintln!, which the test runner swallows where a test passes.
            let line =
                format!("SKIPPED: exrheader_prints_what_was_written: no exrheader here: {error}\n");
            std::io::Write::write_all(&mut std::io::stderr(), line.as_bytes()).unwrap();
            return;
        }
    };
    assert!(output.status.success(), "exrheader rejects the file");
    let printed = String::from_utf8(output.stdout).unwrap();
    let squeezed: String = printed.split_whitespace().collect::<Vec<_>>().join(" ");
    for expected in [
        "worldToCamera (type m44f): (1 2 3 0 5 6 7 0 9 10 11 0 13.5 14.5 15.5 1)",
        "worldToNDC (type m44f): (0 1 2 3 10 11 12 13 20 21 22 23 30 31 32 33)",
        "dataWindow (type box2i): (3 5) - (9 41)",
        "displayWindow (type box2i): (0 0) - (19 49)",
        "compression (type compression): zip, multi-scanline blocks",
        "lineOrder (type lineOrder): increasing y",
        "red (0.64 0.33) green (0.3 0.6) blue (0.15 0.06) white (0.3127 0.329)",
        "pointillist/image.samples (type string): \"1\"",
        "pointillist/objects.0.name (type string): \"Würfel, 点\"",
        "object, 32-bit floating-point, sampling 1 1",
        "Z, 32-bit floating-point, sampling 1 1",
    ] {
        assert!(squeezed.contains(expected), "no '{expected}' in\n{printed}");
    }
}

/// Hash maps order six attributes alike with a chance of 1 in 720, so eight writes tell.
#[test]
fn two_writes_are_equal_to_the_byte() {
    let folder = folder();
    for extension in ["exr", "png", "jpg"] {
        let written: Vec<Vec<u8>> = (0..8)
            .map(|i| {
                let path = folder.path().join(format!("{i}.{extension}"));
                write(&film(), &provenance(), &path).unwrap();
                fs::read(path).unwrap()
            })
            .collect();
        assert!(written.iter().all(|bytes| *bytes == written[0]), "{extension}");
    }
}

#[test]
fn png_holds_the_window_in_srgb() {
    let folder = folder();
    let path = folder.path().join("a.png");
    let mut film = film();
    film.color[0] = [0.0, 0.5, 1.0, 0.0];
    film.color[7] = [-1.0, 2.0, 0.003_130_8, 0.0];
    write(&film, &provenance(), &path).unwrap();

    let bytes = fs::read(&path).unwrap();
    assert!(bytes.windows(4).any(|chunk| chunk == b"sRGB"), "no sRGB chunk");
    let image = image::load_from_memory(&bytes).unwrap();
    assert_eq!(image.color(), image::ColorType::Rgb8);
    let image = image.to_rgb8();
    assert_eq!(image.dimensions(), (7, 37));
    assert_eq!(image.get_pixel(0, 0).0, [0, 188, 255]);
    assert_eq!(image.get_pixel(0, 1).0, [0, 255, 10]);
}

#[test]
fn transparent_png_holds_straight_colors() {
    let folder = folder();
    let path = folder.path().join("a.png");
    let mut film = Film::empty([2, 1], Window::whole([2, 1]), true);
    film.color[1] = [0.25, 0.5, 0.0, 0.5];
    write(&film, &provenance(), &path).unwrap();

    let image = image::open(&path).unwrap();
    assert_eq!(image.color(), image::ColorType::Rgba8);
    let image = image.to_rgba8();
    assert_eq!(image.get_pixel(0, 0).0, [0, 0, 0, 0]);
    assert_eq!(image.get_pixel(1, 0).0, [188, 255, 0, 128]); // 0.5 * 255 = 127.5
}

#[test]
fn alpha_by_channel_is_written_by_name_and_its_mean_is_a_png_s() {
    let folder = folder();
    let mut film = Film::empty([1, 1], Window::whole([1, 1]), true);
    film.color[0] = [0.25, 0.5, 0.0, 1.0];
    film.channel_alpha = Some(vec![[0.25, 0.5, 0.75]]);
    let path = folder.path().join("a.exr");
    write(&film, &provenance(), &path).unwrap();
    let read = read_exr(&path).unwrap();
    for (name, value) in [("A", 1.0), ("AR", 0.25), ("AG", 0.5), ("AB", 0.75)] {
        assert_eq!(read.channels[name], [value], "{name}");
    }
    let path = folder.path().join("a.png");
    write(&film, &provenance(), &path).unwrap();
    // Straight: half of red, all of green, by an alpha of one half.
    let image = image::open(&path).unwrap().to_rgba8();
    assert_eq!(image.get_pixel(0, 0).0, [188, 255, 0, 128]);
}

#[test]
fn transparent_jpeg_is_over_black() {
    let folder = folder();
    let path = folder.path().join("a.jpeg");
    let mut film = Film::empty([16, 8], Window::whole([16, 8]), true);
    film.color.fill([0.5, 0.5, 0.5, 0.5]);
    write(&film, &provenance(), &path).unwrap();

    let image = image::open(&path).unwrap().to_rgb8();
    assert_eq!(image.dimensions(), (16, 8));
    // A flat grey survives JPEG up to rounding of its one coefficient.
    assert!(image.pixels().all(|pixel| pixel.0.iter().all(|&v| v.abs_diff(188) <= 1)));
}

#[test]
fn format_is_told_by_the_extension_in_either_case() {
    let of = |name: &str| FileFormat::from_path(Path::new(name));
    assert_eq!(of("a.exr").unwrap(), FileFormat::Exr);
    assert_eq!(of("b/a.b.PNG").unwrap(), FileFormat::Png);
    assert_eq!(of("a.jpg").unwrap(), FileFormat::Jpeg);
    assert_eq!(of("a.Jpeg").unwrap(), FileFormat::Jpeg);
    for name in ["a.tiff", "a", ".png"] {
        let message = of(name).unwrap_err().to_string();
        assert!(
            message.contains(name) && message.contains("'.exr', '.png' or '.jpg'"),
            "{message}"
        );
    }
}

fn error_of(path: &Path) -> FilmError {
    write(&film(), &provenance(), path).unwrap_err()
}

#[test]
fn folders_as_outputs_are_named_and_nothing_is_left_behind() {
    let folder = folder();
    let path = folder.path().join("a.png");
    fs::create_dir(&path).unwrap();
    assert!(matches!(error_of(&path), FilmError::IsFolder { .. }));

    let missing = folder.path().join("b/c.exr");
    let error = error_of(&missing);
    assert!(matches!(error, FilmError::NoFolder { .. }), "{error}");
    assert!(error.to_string().contains("c.exr") && error.to_string().contains("/b'"), "{error}");

    assert_eq!(names_in(folder.path()), ["a.png"]);
}

#[test]
fn a_setting_with_an_overlong_name_is_an_error() {
    let folder = folder();
    let path = folder.path().join("a.exr");
    let mut provenance = provenance();
    provenance.settings.push(("k".repeat(244), String::new()));
    let error = write(&film(), &provenance, &path).unwrap_err();
    assert!(matches!(error, FilmError::Header { .. }), "{error}");
    provenance.settings.pop();
    provenance.settings.push(("k".repeat(243), String::new()));
    write(&film(), &provenance, &path).unwrap();
    assert_eq!(names_in(folder.path()), ["a.exr"]);
}

#[test]
fn jpeg_that_is_too_wide_is_an_error() {
    let folder = folder();
    let path = folder.path().join("a.jpg");
    let size = [65_536, 1];
    let film = Film::empty(size, Window::whole(size), false);
    let error = write(&film, &provenance(), &path).unwrap_err();
    assert!(matches!(error, FilmError::Encode { .. }), "{error}");
    assert!(names_in(folder.path()).is_empty());
}

#[test]
fn files_that_are_no_exr_are_errors() {
    let folder = folder();
    let missing = read_exr(&folder.path().join("none.exr")).unwrap_err();
    assert!(matches!(missing, FilmError::Read { .. }), "{missing}");

    let path = folder.path().join("a.exr");
    write(&film(), &provenance(), &path).unwrap();
    let whole = fs::read(&path).unwrap();
    for length in [0, 3, 8, 100, whole.len() / 2, whole.len() - 1] {
        fs::write(&path, &whole[..length]).unwrap();
        assert!(read_exr(&path).is_err(), "{length} bytes");
    }
    fs::write(&path, b"no picture at all").unwrap();
    let text = read_exr(&path).unwrap_err();
    assert!(matches!(text, FilmError::NotExr { .. }), "{text}");
}

#[test]
#[should_panic(expected = "leaves the image")]
fn a_window_outside_the_image_is_the_callers_mistake() {
    let film = Film::empty([4, 4], Window { x: 1, y: 0, width: 4, height: 4 }, false);
    let _ = write(&film, &provenance(), Path::new("a.exr"));
}

#[cfg(unix)]
mod unix {
    use super::*;
    use std::os::unix::fs::{PermissionsExt, symlink};

    fn mode(path: &Path) -> u32 {
        fs::metadata(path).unwrap().permissions().mode() & 0o777
    }

    #[test]
    fn new_files_have_the_permissions_of_any_new_file() {
        let folder = folder();
        let (ours, theirs) = (folder.path().join("a.png"), folder.path().join("b"));
        write(&film(), &provenance(), &ours).unwrap();
        fs::write(&theirs, []).unwrap();
        assert_eq!(mode(&ours), mode(&theirs));
    }

    #[test]
    fn replaced_files_keep_their_permissions() {
        let folder = folder();
        let path = folder.path().join("a.png");
        fs::write(&path, b"old").unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
        write(&film(), &provenance(), &path).unwrap();
        assert_eq!(mode(&path), 0o640);
        assert!(fs::read(&path).unwrap().len() > 3);
    }

    #[test]
    fn write_protected_files_stay() {
        let folder = folder();
        let path = folder.path().join("a.png");
        fs::write(&path, b"old").unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o444)).unwrap();
        assert!(matches!(error_of(&path), FilmError::WriteProtected { .. }));
        assert_eq!(fs::read(&path).unwrap(), b"old");
    }

    #[test]
    fn links_are_written_through() {
        let folder = folder();
        fs::create_dir(folder.path().join("far")).unwrap();
        for (link, target) in [("new.png", "far/new.png"), ("old.png", "far/old.png")] {
            symlink(target, folder.path().join(link)).unwrap();
        }
        fs::write(folder.path().join("far/old.png"), b"old").unwrap();
        for link in ["new.png", "old.png"] {
            write(&film(), &provenance(), &folder.path().join(link)).unwrap();
            assert!(folder.path().join(link).is_symlink());
            image::open(folder.path().join("far").join(link)).unwrap();
        }
        assert_eq!(names_in(&folder.path().join("far")), ["new.png", "old.png"]);
    }

    #[test]
    fn a_loop_of_links_is_an_error() {
        let folder = folder();
        let path: PathBuf = folder.path().join("a.png");
        symlink("a.png", &path).unwrap();
        assert!(matches!(error_of(&path), FilmError::Write { .. }));
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn a_full_disk_is_told_apart() {
        let folder = folder();
        let path = folder.path().join("a.exr");
        symlink("/dev/full", &path).unwrap();
        let error = error_of(&path);
        assert!(error.is_out_of_space(), "{error:?}");
        assert!(!error_of(&folder.path().join("b/a.exr")).is_out_of_space());
    }
}

#[test]
fn a_tone_changes_eight_bit_files_alone() {
    let folder = folder();
    let written = |tone: Tone, name: &str| {
        let path = folder.path().join(name);
        let mut film = Film::empty([2, 1], Window::whole([2, 1]), true);
        film.color[1] = [0.25, 0.125, 0.0, 0.5];
        write_styled(&film, &provenance(), Style { tone, ..Style::default() }, &path).unwrap();
        fs::read(path).unwrap()
    };
    let brighter = Tone { exposure: 1.0, curve: ToneCurve::Reinhard };
    assert!(written(Tone::default(), "a.exr") == written(brighter, "b.exr"));
    let image = image::load_from_memory(&written(brighter, "a.png")).unwrap().to_rgba8();
    // 0.25 / 0.5 a stop brighter is 1, and 1 / (1 + 1) is 0.5; coverage stays.
    assert_eq!(image.get_pixel(1, 0).0, [188, srgb_byte(1.0 / 3.0), 0, 128]);
    assert_eq!(image.get_pixel(0, 0).0, [0, 0, 0, 0]);
    assert!(written(Tone::default(), "a.jpg") != written(brighter, "b.jpg"));
}
