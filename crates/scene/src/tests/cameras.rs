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
    let error_eye = error_where("eye = [0.0, 0.4, 3]\n", "");
    assert!(error_eye.contains(":2:1: camera.eye: missing"), "{error_eye}");
}

#[test]
fn each_projection_has_its_own_extent() {
    let scene = read(&orthographic()).unwrap();
    let camera = scene.camera.unwrap();
    assert_eq!(camera.projection, Projection::Orthographic { height: 1.5 });
    // What it writes, it reads.
    let again = Scene::from_toml(&scene.settings_toml(), Path::new("scenes/s.toml"), &[]).unwrap();
    assert_eq!(again.camera, Some(camera));
    let missing = error(&orthographic().replace("height = 1.5\n", ""));
    assert!(missing.contains("camera.height: missing, expected the height"), "{missing}");
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
