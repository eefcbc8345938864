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
        (format!("{stops}extinction = 1"), "extinction: belongs to color_map"),
        (format!("{stops}iso = 1"), "iso: belongs to mode \"isosurface\""),
        (format!("{stops}mass = 1"), "mass: belongs to kernel \"sph\""),
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
    let stop = |value, color, extinction| Stop { value, color, extinction };
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
