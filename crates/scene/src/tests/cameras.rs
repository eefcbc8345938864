//! Cameras.

use super::{FULL, SMALL, error, error_where, error_with, orthographic, read, read_with};
use crate::*;
use std::path::Path;

#[test]
fn a_camera_needs_a_view() {
    let error_same = error_where("target = [0.1, 0.2, -0.3]", "target = [0, 0.4, 3]");
    assert!(error_same.contains(":4:10: camera.target: found 0 scene units"), "{error_same}");
    let error_up = error_where("up = [0.0, 0.0, 2.0]", "up = [-1, 2, 33]");
    assert!(error_up.contains("camera.up: found a direction parallel"), "{error_up}");
    let error_up = error_with(SMALL, &["camera={ eye = [0, 5, 0], target = [0, 0, 0] }"]);
    assert!(error_up.contains("camera.up: found a direction parallel"), "{error_up}");
}

/// Each key may be left out, and is then none of the scene's; what goes together is checked as far as it is given.
#[test]
fn a_camera_may_be_given_in_part() {
    let keys = |set: &[&str]| read_with(SMALL, set).unwrap().camera;
    assert_eq!(keys(&[]), CameraKeys::default());
    assert_eq!(keys(&["camera.vertical_fov=20"]).vertical_fov, Some(20.0));
    let named = keys(&["camera.view=top"]);
    assert_eq!((named.view, named.whole()), (Some(ViewFrom::Top), None));
    let along = keys(&["camera.view=[0, 0, -2]", "camera.up=[1, 0, 0]"]);
    assert_eq!(
        (along.view, along.up),
        (Some(ViewFrom::Along([0.0, 0.0, -2.0])), Some([1.0, 0.0, 0.0]))
    );
    assert!(keys(&["camera.projection=orthographic"]).is_orthographic);
    for (set, message) in [
        (&["camera.view=above"][..], "camera.view: found the string \"above\", expected"),
        (&["camera.view=[0, 0, 0]"], "camera.view: found"),
        (
            &["camera.view=[0, 2, 0]", "camera.up=[0, -1, 0]"],
            "camera.up: found a direction parallel",
        ),
        (
            &["camera.view=top", "camera.eye=[1, 2, 3]", "camera.target=[0, 0, 0]"],
            "camera.view: belongs to",
        ),
        (&["camera.height=2"], "camera.height: belongs to projection \"orthographic\""),
        (&["camera.aperture=2001", "camera.focus=2"], "camera.aperture: found 2001"),
    ] {
        let found = error_with(SMALL, set);
        assert!(found.contains(message), "{set:?}: {found}");
    }
    // What it writes, it reads.
    for set in [
        &["camera.view=iso"][..],
        &["camera.eye=[1, 2, 3]", "camera.aperture=0.1"],
        &["camera.view=[1, 1, 0]"],
    ] {
        let scene = read_with(SMALL, set).unwrap();
        let again =
            Scene::from_toml(&scene.settings_toml(), Path::new("scenes/s.toml"), &[]).unwrap();
        assert_eq!(again.camera, scene.camera, "{set:?}");
    }
}

#[test]
fn which_keys_overrides_give_is_known_before_a_scene_is() {
    let set = [
        "image.size=[3, 3]",
        "camera.up=[0, 0, 1]",
        "camera={ eye = [1, 2, 3], up = [0, 1, 0] }",
        "camera",
    ];
    let found = camera_keys_set(&set.map(str::to_owned));
    let names: Vec<&str> = found.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["up", "eye"]);
    assert_eq!(found[0].1, "camera.up=[0, 0, 1]");
}

#[test]
fn each_projection_has_its_own_extent() {
    let scene = read(&orthographic()).unwrap();
    let camera = scene.camera.whole().unwrap();
    assert_eq!(camera.projection, Projection::Orthographic { height: 1.5 });
    // What it writes, it reads.
    let again = Scene::from_toml(&scene.settings_toml(), Path::new("scenes/s.toml"), &[]).unwrap();
    assert_eq!(again.camera.whole(), Some(camera));
    let framed = read(&orthographic().replace("height = 1.5\n", "")).unwrap().camera;
    assert_eq!((framed.is_orthographic, framed.height, framed.whole()), (true, None, None));
    let foreign = error(&orthographic().replace("height = 1.5", "vertical_fov = 50"));
    assert!(foreign.contains("camera.vertical_fov: belongs to projection \"perspective\""));
    let foreign = error_where("vertical_fov = 50", "height = 1.5");
    assert!(foreign.contains("camera.height: belongs to projection \"orthographic\""), "{foreign}");
    assert!(error_with(FULL, &["camera.projection=fisheye"]).contains("camera.projection: found"));
}

#[test]
fn a_lens_is_not_much_wider_than_its_focus_is_far() {
    let wide = error_with(FULL, &["camera.aperture=2501"]);
    assert!(wide.contains("camera.aperture: found 2501 scene units with a focus at 2.5"), "{wide}");
    assert!(read_with(FULL, &["camera.aperture=2500"]).is_ok());
    let near = error_with(FULL, &["camera.focus=0"]);
    assert!(near.contains("camera.focus: found 0, expected a number from 1e-12"), "{near}");
}
