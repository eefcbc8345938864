//! Tests of the sensor's view: closed forms of cameras and scanners, and what has none.

use super::*;
use crate::View;
use std::path::Path;

const SIZE: [u32; 2] = [640, 480];

fn scene(object: &str) -> Scene {
    let text = format!("[[objects]]\npoints = \"a.pcd\"\n{object}");
    Scene::from_toml(&text, Path::new("s.toml"), &[]).expect("a scene")
}

/// A point for each of so many columns and rows, where `direction` leads from a sensor in `position`.
fn image(
    position: [f64; 3],
    axes: [[f64; 3]; 3],
    direction: impl Fn(f64, f64) -> [f64; 3],
) -> Arc<PointSet> {
    let mut set = PointSet::default();
    for i in 0..64 * 48u32 {
        // From -1 to 1, with the edges.
        let (a, b) = (f64::from(i % 64) / 31.5 - 1.0, f64::from(i / 64) / 23.5 - 1.0);
        let reach = 2.0 + f64::from(i % 5);
        let d = direction(a, b);
        // Right, up and ahead of the sensor.
        let at = |k: usize| position[k] + reach * (0..3).map(|j| d[j] * axes[j][k]).sum::<f64>();
        set.positions.push([at(0), at(1), at(2)]);
        set.file_index.push(i);
    }
    let points = 0..set.file_index.len() as u32;
    set.sensors = vec![Sensor { position, axes, points, image: Some([64, 48]) }];
    Arc::new(set)
}

const CAMERA: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]];
const SCANNER: [[f64; 3]; 3] = [[0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]];

fn close(a: [f64; 3], b: [f64; 3]) -> bool {
    (0..3).all(|i| (a[i] - b[i]).abs() < 1e-9)
}

fn view(scene: &Scene, set: &Arc<PointSet>) -> Option<SensorView> {
    let image = scene::ImageSettings { size: SIZE, ..scene.image };
    sensor_view(&Scene { image, ..scene.clone() }, &[Arc::clone(set)])
}

fn fov(view: &SensorView) -> f64 {
    let Projection::Perspective { vertical_fov } = view.camera.projection else { panic!() };
    vertical_fov
}

/// Pixels are where the camera had them, and the outermost lie on the edges of the picture.
#[test]
fn a_depth_image_is_seen_as_its_camera_saw_it() {
    let place = [636_590.0, 4_849_216.0, 440.0];
    let set = image(place, CAMERA, |a, b| [0.6 * a, -0.45 * b, 1.0]);
    let seen = view(&scene(""), &set).expect("a view");
    assert_eq!(seen.camera.eye, place);
    assert_eq!((seen.camera.up, seen.axes), ([0.0, -1.0, 0.0], CAMERA));
    // The tangents of half the angles are 0.45 and 0.6; a step of f64 at 4.8e6 is 1e-9, two metres away.
    let degrees = |tangent: f64| 2.0 * tangent.atan().to_degrees();
    assert!((fov(&seen) - degrees(0.45)).abs() < 1e-6, "{}", fov(&seen));
    assert!((seen.angles[0] - degrees(0.6)).abs() < 1e-6, "{:?}", seen.angles);
    let ndc = View::new(&seen.camera, SIZE, place).world_to_ndc;
    for (p, index) in set.positions.iter().zip(&set.file_index) {
        let v = [p[0] - place[0], p[1] - place[1], p[2] - place[2], 1.0].map(|x| x as f32);
        let [x, y, w] = [0, 1, 3].map(|j| (0..4).map(|i| v[i] * ndc[i][j]).sum::<f32>());
        let expected = [(index % 64) as f32 / 63.0, (index / 64) as f32 / 47.0];
        assert!((x / w - expected[0]).abs() < 1e-4 && (y / w - expected[1]).abs() < 1e-4);
    }
}

#[test]
fn a_wider_or_higher_picture_has_all_of_it() {
    let set = image([0.0; 3], CAMERA, |a, b| [0.6 * a, -0.45 * b, 1.0]);
    let of = |size| {
        let mut scene = scene("");
        scene.image.size = size;
        fov(&sensor_view(&scene, &[Arc::clone(&set)]).expect("a view"))
    };
    let degrees = |tangent: f64| 2.0 * tangent.atan().to_degrees();
    assert!((of([1920, 1080]) - degrees(0.45)).abs() < 1e-9);
    assert!((of([480, 640]) - degrees(0.6 * 640.0 / 480.0)).abs() < 1e-9);
}

/// A scanner that turned from 20 to 120 degrees to its left and looked from 50 degrees below to 10 above.
#[test]
fn a_scanner_looks_at_the_middle_of_its_scan() {
    let direction = |a: f64, b: f64| {
        let (turn, height) = ((70.0 - 50.0 * a).to_radians(), (-20.0 - 30.0 * b).to_radians());
        [-height.cos() * turn.sin(), height.sin(), height.cos() * turn.cos()]
    };
    let set = image([5.0, 6.0, 7.0], SCANNER, direction);
    let seen = view(&scene(""), &set).expect("a view");
    let (turn, height) = (70f64.to_radians(), -20f64.to_radians());
    let ahead = [height.cos() * turn.cos(), height.cos() * turn.sin(), height.sin()];
    assert!(close(seen.axes[2], ahead), "{:?}", seen.axes);
    assert!(close(seen.axes[0], [turn.sin(), -turn.cos(), 0.0]), "{:?}", seen.axes);
    assert_eq!(seen.camera.eye, [5.0, 6.0, 7.0]);
    assert!(fov(&seen) > 60.0 && fov(&seen) < 150.0, "{}", fov(&seen));
}

/// The transform of the object moves and turns its sensor.
#[test]
fn the_view_goes_where_the_object_goes() {
    let set = image([1.0, 2.0, 3.0], CAMERA, |a, b| [0.6 * a, -0.45 * b, 1.0]);
    let transform = "transform = { scale = 2, rotate = [90, 0, 0], translate = [10, 0, 0] }";
    let seen = view(&scene(transform), &set).expect("a view");
    // y becomes z, and z becomes -y.
    assert_eq!(seen.camera.eye, [12.0, -6.0, 4.0]);
    assert!(close(seen.axes[2], [0.0, -1.0, 0.0]) && close(seen.axes[1], [0.0, 0.0, -1.0]));
    assert!((fov(&seen) - 2.0 * 0.45f64.atan().to_degrees()).abs() < 1e-9);
}

#[test]
fn what_is_not_one_image_has_no_view() {
    let set = image([0.0; 3], CAMERA, |a, b| [0.6 * a, -0.45 * b, 1.0]);
    let camera = "[camera]\neye = [0, 0, 9]\ntarget = [0, 0, 0]\n";
    let text = format!("{camera}[[objects]]\npoints = \"a.pcd\"");
    let with_camera = Scene::from_toml(&text, Path::new("s.toml"), &[]).expect("a scene");
    assert_eq!(view(&with_camera, &set), None);
    assert_eq!(view(&scene("units = \"degrees\""), &set), None);
    let but = |change: &dyn Fn(&mut PointSet)| {
        let mut other = PointSet::clone(&set);
        change(&mut other);
        view(&scene(""), &Arc::new(other))
    };
    assert_eq!(but(&|set| set.sensors[0].image = None), None);
    assert_eq!(but(&|set| set.sensors.clear()), None);
    assert_eq!(but(&|set| set.sensors.push(set.sensors[0].clone())), None);
    assert_eq!(but(&|set| set.sensors[0].points = 0..100), None);
    assert_eq!(but(&|set| set.positions.fill([0.0; 3])), None);
    assert_eq!(but(&|set| set.positions.fill([0.0, 0.0, 3.0])), None);
    let around = |a: f64, b: f64| {
        let (turn, height) = (3.1 * a, 0.5 * b);
        [height.cos() * turn.sin(), height.sin(), height.cos() * turn.cos()]
    };
    assert_eq!(view(&scene(""), &image([0.0; 3], SCANNER, around)), None);
    let wide = |a: f64, b: f64| around(1.4 * a / 3.1, b);
    assert_eq!(view(&scene(""), &image([0.0; 3], SCANNER, wide)), None, "160 degrees");
}

/// A few strays, even behind the sensor, do not spoil it.
#[test]
fn strays_do_not_change_the_view() {
    let set = image([0.0; 3], CAMERA, |a, b| [0.6 * a, -0.45 * b, 1.0]);
    let mut other = PointSet::clone(&set);
    other.positions[100] = [1.0, 1.0, -5.0];
    other.positions[2000] = [3.0, 0.0, 0.001];
    let [clean, found] = [set, Arc::new(other)].map(|set| view(&scene(""), &set).expect("a view"));
    assert!((fov(&clean) - fov(&found)).abs() < 1e-9 && clean.camera.up == found.camera.up);
}
