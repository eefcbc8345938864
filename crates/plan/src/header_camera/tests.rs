//! Tests of cameras from headers: there and back, and as other programs write them.

use super::*;
use crate::View;
use scene::{Camera, Projection};

const SIZE: [u32; 2] = [200, 100];
const ORIGIN: [f64; 3] = [400_000.0, 5_000_000.0, 100.0];
/// Of matrices in 32 bits.
const CLOSE: f64 = 1e-5;

fn camera(projection: Projection) -> Camera {
    Camera {
        eye: [400_003.0, 5_000_002.0, 105.0],
        target: [400_001.0, 5_000_000.0, 101.0],
        up: [0.0, 0.1, 1.0],
        projection,
        aperture: 0.0,
        focus: None,
    }
}

const WIDE: Projection = Projection::Perspective { vertical_fov: 50.0 };
const FLAT: Projection = Projection::Orthographic { height: 4.0 };

fn close(a: [f64; 3], b: [f64; 3]) -> bool {
    (0..3).all(|axis| (a[axis] - b[axis]).abs() < CLOSE)
}

fn is_camera(found: &HeaderCamera, expected: &Camera) {
    let keys = &found.keys;
    assert!(close(keys.eye.expect("an eye"), expected.eye), "{keys:?}");
    let ahead = DVec3::from(expected.target) - DVec3::from(expected.eye);
    let Some(ViewFrom::Along(along)) = keys.view else { panic!("{keys:?}") };
    assert!(close(along, ahead.normalize().into()), "{keys:?}");
    // Up is across the line of sight.
    let right = ahead.cross(expected.up.into()).normalize();
    assert!(close(keys.up.expect("up"), right.cross(ahead).normalize().into()), "{keys:?}");
    match expected.projection {
        Projection::Perspective { vertical_fov } => {
            assert!((keys.vertical_fov.expect("an angle") - vertical_fov).abs() < 1e-3, "{keys:?}");
        }
        Projection::Orthographic { height } => {
            assert!(
                keys.is_orthographic && (keys.height.expect("a height") - height).abs() < CLOSE
            );
        }
    }
    assert!((found.aspect.expect("an aspect") - 2.0).abs() < CLOSE, "{found:?}");
}

#[test]
fn what_this_program_writes_is_read_again() {
    for projection in [WIDE, FLAT] {
        let camera = camera(projection);
        let view = View::new(&camera, SIZE, ORIGIN);
        let found = camera_of_matrices(Some(view.world_to_camera), Some(view.world_to_ndc), ORIGIN);
        is_camera(&found.expect("a camera"), &camera);
    }
    // A perspective is whole in worldToNDC.
    let camera = camera(WIDE);
    let found =
        camera_of_matrices(None, Some(View::new(&camera, SIZE, ORIGIN).world_to_ndc), ORIGIN);
    is_camera(&found.expect("a camera"), &camera);
}

/// OpenEXR's documentation has a left-handed camera that looks along +z; others scale w as they like, or write -1 to 1.
#[test]
fn other_conventions_are_understood() {
    let camera = camera(WIDE);
    let view = View::new(&camera, SIZE, ORIGIN);
    let left_handed = view.world_to_camera.map(|[x, y, z, w]| [x, y, -z, w]);
    let scaled = view.world_to_ndc.map(|row| row.map(|x| -3.0 * x));
    let found = camera_of_matrices(Some(left_handed), Some(scaled), ORIGIN).expect("a camera");
    is_camera(&found, &camera);
    let clip = view.world_to_ndc.map(|[x, y, z, w]| [2.0 * x - w, w - 2.0 * y, z, w]);
    is_camera(&camera_of_matrices(None, Some(clip), ORIGIN).expect("a camera"), &camera);
    is_camera(
        &camera_of_matrices(Some(left_handed), Some(clip), ORIGIN).expect("a camera"),
        &camera,
    );
}

#[test]
fn what_matrices_leave_open_is_left_out() {
    let camera = camera(WIDE);
    let view = View::new(&camera, SIZE, ORIGIN);
    let found = camera_of_matrices(Some(view.world_to_camera), None, ORIGIN).expect("a camera");
    assert!(close(found.keys.eye.expect("an eye"), camera.eye));
    assert_eq!((found.keys.vertical_fov, found.aspect), (None, None));
    let flat = View::new(&self::camera(FLAT), SIZE, ORIGIN);
    let found = camera_of_matrices(None, Some(flat.world_to_ndc), ORIGIN).expect("a camera");
    assert_eq!(found.keys.eye, None);
    let Some(ViewFrom::Along(along)) = found.keys.view else { panic!("{found:?}") };
    let ahead = (DVec3::from(camera.target) - DVec3::from(camera.eye)).normalize();
    assert!(close(along, ahead.into()), "{found:?}");
    let from = DVec3::from(found.keys.target.expect("a target")) - DVec3::from(camera.eye);
    assert!(from.cross(ahead).length() < CLOSE, "the target is not in the middle");
}

#[test]
fn what_is_no_camera_is_an_error() {
    assert!(camera_of_matrices(None, None, ORIGIN).is_err());
    assert!(camera_of_matrices(Some([[0.0; 4]; 4]), None, ORIGIN).is_err());
    assert!(camera_of_matrices(None, Some([[0.0; 4]; 4]), ORIGIN).is_err());
    assert!(camera_of_matrices(None, Some([[f32::NAN; 4]; 4]), ORIGIN).is_err());
    let view = View::new(&camera(WIDE), SIZE, ORIGIN);
    let shifted = view.world_to_ndc.map(|[x, y, z, w]| [x + 0.1 * w, y, z, w]);
    let error = camera_of_matrices(None, Some(shifted), ORIGIN).expect_err("a shifted lens");
    assert!(error.contains("0.600, 0.500"), "{error}");
}
