//! Volumes and their transfer functions.

use super::{SMALL, error, read};
use crate::*;

#[test]
fn a_volume_says_once_what_a_scalar_looks_like() {
    let with = |keys: &str| format!("{SMALL}[objects.volume]\nscalar = \"s\"\n{keys}");
    let stops = "transfer = [{ value = 0, color = [1, 1, 1], extinction = 1 }]\n";
    let cases = [
        (String::new(), "transfer: missing, and so is color_map"),
        (format!("{stops}color_map = \"gray\""), "color_map: found both transfer and color_map"),
        ("color_map = \"gray\"".into(), "extinction: missing, expected the extinction"),
        (format!("{stops}value_range = [0, 1]"), "value_range: belongs to color_map"),
        (format!("{stops}extinction = [1, 2]"), "extinction: found two numbers beside transfer"),
        (format!("{stops}scale = \"log\""), "scale: belongs to color_map"),
        (
            "color_map = \"gray\"\nextinction = \"auto\"\nmode = \"maximum\"".into(),
            "extinction: \"auto\" belongs to mode \"emission\"",
        ),
        (
            "color_map = \"gray\"\nextinction = 1\nscale = \"log\"\nvalue_range = [0, 1]".into(),
            "value_range: found 0 beside scale = \"log\"",
        ),
        (
            "mode = \"isosurface\"\niso = 1\nextinction = 1".into(),
            "extinction: belongs to color_map",
        ),
        (format!("{stops}iso = 1"), "iso: belongs to mode \"isosurface\""),
        (format!("{stops}mass = 1"), "mass: belongs to kernel \"sph\""),
        (
            format!("{stops}radius = \"adaptive\"\nsmoothing = 0.01"),
            "smoothing: found a number beside radius = \"adaptive\"",
        ),
        (
            format!("{stops}radius = \"uneven\""),
            "radius: found the string \"uneven\", expected \"auto\" or \"adaptive\"",
        ),
        (format!("{stops}mode = \"isosurface\""), "iso: missing"),
        ("mode = \"isosurface\"\niso = 1\nboundary = \"all\"".into(), "boundary: found \"all\""),
        (
            "mode = \"isosurface\"\niso = 0\nkernel = \"sum\"".into(),
            "iso: found 0, expected more than 0",
        ),
        (
            "mode = \"isosurface\"\niso = 1\nshading = \"scatter\"".into(),
            "shading: belongs to mode \"emission\"",
        ),
    ];
    for (keys, expected) in cases {
        let found = error(&with(&keys));
        assert!(found.contains(&format!("objects[0].volume.{expected}")), "{found}");
    }
    let constant = with("color_map = \"gray\"\nextinction = 2.5");
    let scene = read(&constant).unwrap();
    let map = Transfer::Map { color_map: ColorMap::Gray, range: None, extinction: [2.5, 2.5] };
    let volume = scene.objects[0].volume.as_ref();
    assert_eq!(volume.and_then(|volume| volume.transfer.as_ref()), Some(&map));
}

#[test]
fn a_transfer_function_comes_from_a_file_of_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("a.ply", "");
    write(
        "hot.toml",
        "transfer = [\n  { value = 1, color = [1, 0, 0], extinction = 2 },\n  { value = 3, color = [1, 1, 0], \
         extinction = 4 },\n]\n",
    );
    let text = format!("{SMALL}[objects.volume]\nscalar = \"s\"\ntransfer = \"hot.toml\"\n");
    write("s.toml", &text);
    let scene_file = folder.path().join("s.toml");
    let scene = Scene::load(&scene_file, &[]).unwrap();
    let stop = |value, color, extinction| Stop { value, color, extinction, emission: [0.0; 3] };
    let stops = vec![stop(1.0, [1.0, 0.0, 0.0], 2.0), stop(3.0, [1.0, 1.0, 0.0], 4.0)];
    let found = scene.objects[0].volume.as_ref().and_then(|volume| volume.transfer.clone());
    assert_eq!(found, Some(Transfer::Stops(stops)));
    // A picture's settings do not depend on the file.
    let settings = scene.settings_toml();
    assert!(settings.contains("value = 3.0") && !settings.contains("hot.toml"), "{settings}");

    let cases = [
        (
            "transfer = [\n  { value = 1, color = [1, 0, 0], extinction = -2 },\n]",
            "hot.toml:2:",
            "found -2, expected a number from 0",
        ),
        (
            "transfer = [{ value = 2, color = [1, 0, 0], extinction = 2 }, { value = 1, color = [1, 0, 0], \
          extinction = 2 }]",
            "hot.toml:1:",
            "expected stops that ascend",
        ),
        ("stops = []", "hot.toml:1:", "unknown key"),
        ("transfer = [", "hot.toml:1:", "not valid TOML"),
    ];
    for (text, place, expected) in cases {
        write("hot.toml", text);
        let found = Scene::load(&scene_file, &[]).unwrap_err().to_string();
        assert!(found.contains(place) && found.contains(expected), "{found}");
    }
    std::fs::remove_file(folder.path().join("hot.toml")).unwrap();
    let found = Scene::load(&scene_file, &[]).unwrap_err().to_string();
    assert!(found.contains("s.toml:5:") && found.contains("found no file at"), "{found}");
}

/// A stop has a colour and an extinction, an emission, or all three, in the scene or in a file; and the settings of a
/// picture read back as the same scene.
#[test]
fn stops_have_an_emission_beside_or_without_extinction() {
    let with = |stops: &str| {
        format!("{SMALL}[objects.volume]\nscalar = \"s\"\ntransfer = [\n{stops}\n]\n")
    };
    let all = "{ value = 1, emission = [3, 2, 1] },\n{ value = 2, extinction = 4, emission = [0, 0, 0] },\n\
               { value = 3, color = [1, 0, 0], extinction = 2, emission = [0.5, 0, 0] },\n\
               { value = 4, color = [1, 0, 0], extinction = 2 }";
    let stop = |value, color, extinction, emission| Stop { value, color, extinction, emission };
    let expected = vec![
        stop(1.0, [0.0; 3], 0.0, [3.0, 2.0, 1.0]),
        stop(2.0, [0.0; 3], 4.0, [0.0; 3]),
        stop(3.0, [1.0, 0.0, 0.0], 2.0, [0.5, 0.0, 0.0]),
        stop(4.0, [1.0, 0.0, 0.0], 2.0, [0.0; 3]),
    ];
    let transfer =
        |scene: &Scene| scene.objects[0].volume.as_ref().and_then(|volume| volume.transfer.clone());
    let scene = read(&with(all)).unwrap();
    assert_eq!(transfer(&scene), Some(Transfer::Stops(expected.clone())));
    assert_eq!(read(&scene.settings_toml()).unwrap().objects, scene.objects);

    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("a.ply", "");
    write("glow.toml", &format!("transfer = [\n{all}\n]\n"));
    write(
        "s.toml",
        &format!("{SMALL}[objects.volume]\nscalar = \"s\"\ntransfer = \"glow.toml\"\n"),
    );
    let loaded = Scene::load(&folder.path().join("s.toml"), &[]).unwrap();
    assert_eq!(transfer(&loaded), Some(Transfer::Stops(expected)));

    for (stops, expected) in [
        ("{ value = 1, extinction = 2 }", "transfer[0].color: missing, expected three numbers"),
        ("{ value = 1, color = [1, 1, 1] }", "transfer[0].extinction: missing, expected a number"),
        ("{ value = 1 }", "transfer[0].color: missing"),
        ("{ value = 1, emission = [-1, 0, 0] }", "transfer[0].emission[0]: found -1, expected"),
        ("{ value = 1, emission = 3 }", "transfer[0].emission: found 3, expected three numbers"),
    ] {
        let found = error(&with(stops));
        assert!(found.contains(expected), "{found}");
    }
}

/// The colours of an integral need a range, or the word that takes it from the data; an extinction is not needed.
#[test]
fn an_integral_has_a_range() {
    let with = |keys: &str| {
        format!(
            "{SMALL}[objects.volume]\nscalar = \"s\"\nmode = \"integral\"\ncolor_map = \"gray\"\n{keys}"
        )
    };
    let found = error(&with(""));
    assert!(
        found.contains("value_range: missing, expected for the colours of mode \"integral\""),
        "{found}"
    );
    let ranges = [("value_range = \"auto\"", None), ("value_range = [0, 5]", Some([0.0, 5.0]))];
    for (keys, expected) in ranges {
        let scene = read(&with(keys)).unwrap();
        let volume = scene.objects[0].volume.as_ref().unwrap();
        assert_eq!(volume.mode, VolumeMode::Integral);
        let Some(Transfer::Map { range, extinction, .. }) = &volume.transfer else { panic!() };
        assert_eq!((*range, extinction[0] > 69.0), (expected, true), "opaque");
        assert_eq!(read(&scene.settings_toml()).unwrap().objects, scene.objects);
    }
    let found = error(&with("value_range = \"all\""));
    assert!(found.contains("value_range: found the string \"all\", expected"), "{found}");
}
