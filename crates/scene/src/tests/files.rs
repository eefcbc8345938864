//! Scene files, point files, and the files that scenes name.

use super::SMALL;
use crate::*;
use std::path::Path;

#[test]
fn load_reads_a_file_and_finds_its_points_beside_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("s.toml");
    std::fs::write(&path, SMALL).unwrap();
    let error = Scene::load(&path, &[]).unwrap_err().to_string();
    let points = folder.path().join("a.ply");
    let place = format!("{}:2:10: objects[0].points: found no file at '", path.display());
    assert!(error.starts_with(&place) && error.contains(points.to_str().unwrap()), "{error}");
    std::fs::write(&points, "").unwrap();
    let scene = Scene::load(&path, &[]).unwrap();
    assert_eq!(scene.objects[0].points, points);
    let set = ["objects.0.points=b.ply".to_owned()];
    let error = Scene::load(&path, &set).unwrap_err().to_string();
    assert!(error.contains("--set objects.0.points=b.ply: objects[0].points: found no"), "{error}");
    let set = ["objects.0.points=\"a\\u0000\"".to_owned()];
    assert!(Scene::load(&path, &set).is_err(), "a NUL byte is no path");
    let set = ["objects.0.points=.".to_owned()];
    let error = Scene::load(&path, &set).unwrap_err().to_string();
    assert!(error.contains("found a folder"), "{error}");
}

#[test]
fn what_is_no_scene_file_is_a_clear_error() {
    let folder = tempfile::tempdir().unwrap();
    let load = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        Scene::load(&path, &[]).unwrap_err().to_string()
    };
    let error = load("latin.toml", b"[image]\n# caf\xe9\n");
    assert!(error.contains("latin.toml:2:6: found byte 0xe9, expected UTF-8"), "{error}");
    assert!(load("empty.toml", b"").contains("empty.toml:1:1: objects: missing"));
    let huge = load("huge.toml", &vec![b'#'; (16 << 20) + 1]);
    assert!(huge.contains("found more than 16777216 bytes"), "{huge}");
    let error = Scene::load(folder.path(), &[]).unwrap_err().to_string();
    assert!(error.contains("found a folder, expected a scene file"), "{error}");
    let error = Scene::load(&folder.path().join("none.toml"), &[]).unwrap_err().to_string();
    assert!(error.ends_with("none.toml: no such file; check the path"), "{error}");
}

#[test]
fn a_point_file_is_a_scene_of_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let points = folder.path().join("a \"b\" \\.ply");
    let error = Scene::for_point_file(&points, Up::Y, Quality::Draft, &[]).unwrap_err().to_string();
    assert!(error.contains("found no file at"), "{error}");
    std::fs::write(&points, "").unwrap();
    let set = ["objects.0.surface.polynomial=\"incomplete\"".to_owned()];
    let scene = Scene::for_point_file(&points, Up::Y, Quality::Draft, &set).unwrap();
    assert_eq!(
        (scene.camera, scene.lights.len(), scene.objects.len()),
        (CameraKeys::default(), 2, 1)
    );
    assert_eq!(scene.objects[0].points, points);
    assert_eq!(scene.objects[0].name, "a \"b\" \\");
    assert_eq!(scene.objects[0].surface.polynomial, Polynomial::Incomplete);
    // A scene file's lights stay where they are; here the first is the key light, until its direction is given.
    let fixed = Scene { key_light: None, ..scene.clone() };
    assert_eq!(Scene::from_toml(&scene.settings_toml(), Path::new(""), &[]), Ok(fixed));
    assert_eq!(scene.key_light, Some(0));
    for (set, key_light) in [
        ("lights.0.irradiance=[1, 1, 1]", Some(0)),
        ("lights.0.direction=[1, 1, 1]", None),
        ("lights=[]", None),
    ] {
        let scene =
            Scene::for_point_file(&points, Up::Y, Quality::Draft, &[set.to_owned()]).unwrap();
        assert_eq!(scene.key_light, key_light, "{set}");
    }
    let set = ["image.sizes=3".to_owned()];
    let error =
        Scene::for_point_file(&points, Up::Y, Quality::Draft, &set).unwrap_err().to_string();
    assert!(error.contains("--set image.sizes=3: image.sizes: unknown key"), "{error}");
}

/// What is set wins; direct light, or a preset made for it, takes the lights that leave nothing black.
#[test]
fn quality_says_how_a_point_file_is_lit() {
    let folder = tempfile::tempdir().unwrap();
    let points = folder.path().join("a.ply");
    std::fs::write(&points, "").unwrap();
    let scene = |quality, set: &[&str]| {
        let set: Vec<String> = set.iter().map(|text| (*text).to_owned()).collect();
        let scene = Scene::for_point_file(&points, Up::Y, quality, &set).unwrap();
        let text = scene.settings_toml();
        let again = Scene::from_toml(&text, Path::new(""), &[]).unwrap();
        assert_eq!((again.settings_toml(), &again.lights), (text, &scene.lights));
        assert_eq!(scene.key_light, Some(0));
        scene
    };
    let [draft, good, best] =
        [Quality::Draft, Quality::Good, Quality::Best].map(|quality| scene(quality, &[]));
    let integrators = [&draft, &good, &best].map(|scene| scene.render.integrator);
    assert_eq!(integrators, [Integrator::Direct, Integrator::Sky, Integrator::Path]);
    assert_eq!((draft.image.samples, best.image.samples), (1, 256));
    assert!(good.image.samples > 1 && good.lights == best.lights);
    assert!(matches!(good.lights[0], Light::Directional { angle, .. } if angle > 10.0));
    assert_eq!((draft.lights.len(), &good.objects), (2, &draft.objects));
    assert_eq!(scene(Quality::Good, &["image.samples=2"]).image.samples, 2);
    assert_eq!(scene(Quality::Best, &["render.integrator=\"direct\""]), draft);
    assert_eq!(scene(Quality::Good, &["render.preset=\"paper\""]).lights, draft.lights);
    let sky = ["render.preset=\"paper\"", "render.integrator=\"sky\""];
    assert_eq!(scene(Quality::Good, &sky).lights, good.lights);
}

/// The light falls from above: against y, or against z.
#[test]
fn up_turns_the_light_of_a_point_file() {
    let folder = tempfile::tempdir().unwrap();
    let points = folder.path().join("a.ply");
    std::fs::write(&points, "").unwrap();
    let direction = |up| {
        let lights = Scene::for_point_file(&points, up, Quality::Draft, &[]).unwrap().lights;
        let [Light::Directional { direction, .. }, Light::Headlight { .. }] = lights[..] else {
            panic!("{lights:?}")
        };
        direction
    };
    let turn = Transform { rotate: [90.0, 0.0, 0.0], ..Transform::IDENTITY };
    let [x, y, z] = direction(Up::Y);
    assert_eq!(direction(Up::Z), turn.rotate([x, y, z]));
    assert_eq!(direction(Up::MinusY), [x, -y, -z]);
    assert!(y < 0.0);
}

#[cfg(unix)]
#[test]
fn a_point_files_name_need_not_be_utf8() {
    use std::os::unix::ffi::OsStrExt;
    let folder = tempfile::tempdir().unwrap();
    let points = folder.path().join(std::ffi::OsStr::from_bytes(b"a\xff.ply"));
    std::fs::write(&points, "").unwrap();
    assert_eq!(
        Scene::for_point_file(&points, Up::Y, Quality::Draft, &[]).unwrap().objects[0].points,
        points
    );
}

/// The background of a point file rendered directly is nobody's wish, so an environment replaces it.
#[test]
fn a_point_file_takes_an_environment() {
    let folder = tempfile::tempdir().unwrap();
    let points = folder.path().join("a.ply");
    std::fs::write(&points, "").unwrap();
    let sky = folder.path().join("sky.hdr");
    std::fs::write(&sky, "").unwrap();
    let set = format!("background.environment={}", sky.display());
    let scene = Scene::for_point_file(&points, Up::Y, Quality::Good, &[set]).unwrap();
    assert_eq!(scene.background.environment.map(|image| image.path), Some(sky));
    for made in [
        "background.sky={}",
        "background.gradient=[[0, 0, 0], [1, 1, 1]]",
        "background.color=[0.5, 0.5, 0.5]",
    ] {
        let scene =
            Scene::for_point_file(&points, Up::Y, Quality::Good, &[made.to_owned()]).unwrap();
        let Background { color, sky, gradient, .. } = scene.background;
        let is_typed = gradient == Some([[0.0; 3], [1.0; 3]]) || color == [0.5; 3];
        assert!(is_typed || (sky.is_some() && gradient.is_none()), "{made}");
    }
}

/// A missing image is found before points are read, at its line.
#[test]
fn images_that_are_missing_are_found_by_line() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("s.toml");
    std::fs::write(folder.path().join("a.ply"), "").unwrap();
    let text = "background.environment = \"no.exr\"\n[[objects]]\npoints = \"a.ply\"\n\
                material.texture = \"no.png\"\n";
    std::fs::write(&scene, text).unwrap();
    let error = Scene::load(&scene, &[]).unwrap_err().to_string();
    let lines: Vec<&str> = error.lines().collect();
    assert_eq!(lines.len(), 2, "{error}");
    assert!(lines[0].contains(":1:26: background.environment: found no file at"), "{error}");
    assert!(lines[1].contains(":4:20: objects[0].material.texture: found no file at"), "{error}");
}

/// Of files of all kinds that are missing each is named once, at its line, and beside what else is wrong.
#[test]
fn all_files_that_are_missing_are_named_once() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("s.toml");
    let text = "background.environment = \"env.exr\"\n[[objects]]\npoints = \"a.ply\"\nmaterial.texture = \"tex.png\"\n\
                [[objects]]\npoints = \"b.ply\"\nvolume = { scalar = \"s\", transfer = \"tr.toml\" }\n";
    std::fs::write(&path, text).unwrap();
    for root in [None, Some(folder.path())] {
        let error = Scene::load_below(&path, &[], root).unwrap_err();
        let lines = error.lines();
        assert_eq!(lines.len(), 5, "{lines:?}");
        for (line, (place, name)) in lines.iter().zip([
            (":1:", "env.exr"),
            (":3:", "a.ply"),
            (":4:", "tex.png"),
            (":6:", "b.ply"),
            (":7:", "tr.toml"),
        ]) {
            assert!(line.contains(place) && line.contains("found no file at '"), "{line}");
            assert!(line.contains(name), "{line}");
        }
    }
    let set = ["image.size=3".to_owned()];
    let both = Scene::load(&path, &set).unwrap_err();
    assert!(both.lines().len() == 2, "{:?}", both.lines());
}

/// Angles turn an environment; without one they would be passed over.
#[test]
fn a_background_of_one_color_is_not_turned() {
    let of = |background: &str| {
        Scene::from_toml(&format!("{SMALL}[background]\n{background}\n"), Path::new("s.toml"), &[])
    };
    let error = of("color = [0.1, 0.2, 0.3]\nrotate = [0, 0, 90]").unwrap_err().to_string();
    assert!(
        error.contains("background.rotate: found angles") && error.contains("environment"),
        "{error}"
    );
    assert!(of("rotate = [0, 0, 90]").is_err());
    assert!(of("color = [0.1, 0.2, 0.3]\nrotate = [0, 0, 0]").is_ok());
    assert!(of("environment = \"sky.exr\"\nrotate = [0, 0, 90]").is_ok());
}
