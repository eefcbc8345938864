//! Tests of the automatic camera: every point is in the picture whatever is given, and what is given stays.

use super::*;
use crate::View;

const LOW: [f64; 3] = [-3.0, 10.0, 0.5];
const HIGH: [f64; 3] = [1.0, 11.0, 2.0];
const SIZES: [[u32; 2]; 2] = [[640, 480], [100, 400]];

fn corners() -> Vec<[f64; 3]> {
    (0..8)
        .map(|i| [0, 1, 2].map(|axis| if i >> axis & 1 == 0 { LOW[axis] } else { HIGH[axis] }))
        .collect()
}

fn framed(keys: CameraKeys, image_size: [u32; 2], up: Up) -> Result<Camera, PlanError> {
    let sets = [World::new(corners())];
    complete(&keys, &Subject { sets: &sets, bounds: [LOW, HIGH], image_size, up })
}

/// Where the corners are in the picture, from (0, 0) to (1, 1).
fn seen(camera: &Camera, size: [u32; 2]) -> Vec<[f64; 2]> {
    let m = View::new(camera, size, [0.0; 3]).world_to_ndc;
    let place = |corner: [f64; 3]| {
        let at = |j: usize| {
            let product = |i: usize| corner[i] * f64::from(m[i][j]);
            product(0) + product(1) + product(2) + f64::from(m[3][j])
        };
        [at(0) / at(3), at(1) / at(3)]
    };
    corners().into_iter().map(place).collect()
}

fn ends(places: &[[f64; 2]], axis: usize) -> [f64; 2] {
    let all = || places.iter().map(|place| place[axis]);
    [all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max)]
}

/// The picture's rim that stays free; matrices are in 32 bits.
const MARGIN: f64 = 0.5 - 0.5 * FRAMING_FILL;
const CLOSE: f64 = 1e-4;

fn sight(camera: &Camera) -> DVec3 {
    (DVec3::from(camera.target) - DVec3::from(camera.eye)).normalize()
}

/// Every point is inside the picture, along one axis both sides are reached, and along the other both are as far.
#[test]
fn framing_holds_every_point_and_wastes_no_room() {
    let views = std::iter::once(None).chain(ViewFrom::NAMED.map(Some));
    let parts = views.flat_map(|view| [None, Some(2.0), Some(120.0)].map(|fov| (view, fov)));
    for (view, vertical_fov) in parts {
        for is_orthographic in [false, true] {
            let vertical_fov = vertical_fov.filter(|_| !is_orthographic);
            let keys = CameraKeys { view, vertical_fov, is_orthographic, ..CameraKeys::default() };
            for (up, size) in [(Up::Y, SIZES[0]), (Up::Z, SIZES[0]), (Up::MinusY, SIZES[1])] {
                let camera = framed(keys, size, up).expect("a camera");
                let places = seen(&camera, size);
                let mut is_tight = false;
                for axis in 0..2 {
                    let [low, high] = ends(&places, axis);
                    assert!(
                        low > MARGIN - CLOSE && high < 1.0 - MARGIN + CLOSE,
                        "{keys:?} {places:?}"
                    );
                    assert!((low + high - 1.0).abs() < 2.0 * CLOSE, "{keys:?} {up:?} {places:?}");
                    is_tight |= low < MARGIN + CLOSE;
                }
                // From steep angles, the extremes of both sides may lie at different depths: then neither is reached.
                assert!(is_tight || vertical_fov == Some(120.0), "{keys:?} {up:?} {places:?}");
                let depths = corners()
                    .into_iter()
                    .map(|p| (DVec3::from(p) - DVec3::from(camera.eye)).dot(sight(&camera)));
                assert!(
                    depths.fold(f64::INFINITY, f64::min) > 0.0,
                    "{keys:?}: a point behind the eye"
                );
            }
        }
    }
}

/// Even points of a ball.
fn ball() -> Vec<[f64; 3]> {
    let turn = std::f64::consts::PI * (3.0 - 5f64.sqrt());
    let of = |i: u32| {
        let z = 1.0 - (2.0 * f64::from(i) + 1.0) / 3000.0;
        let (sin, cos) = (turn * f64::from(i)).sin_cos();
        let across = (1.0 - z * z).sqrt();
        [across * cos, across * sin, z]
    };
    (0..3000).map(of).collect()
}

/// Wide angles and wide pictures are filled as others are, though the eye is near then; it is outside the points.
#[test]
fn wide_angles_and_wide_pictures_are_filled() {
    let rod: Vec<[f64; 3]> =
        (0..100).map(|i| [f64::from(i) / 50.0 - 0.99, 0.02 * f64::from(i % 2), 0.0]).collect();
    let cases = [
        (ball(), 40.0, [128, 128]),
        (ball(), 72.0, [128, 128]),
        (ball(), 90.0, [128, 128]),
        (ball(), 120.0, [64, 48]),
        (ball(), 160.0, [64, 48]),
        (rod, 40.0, [640, 80]),
    ];
    for (points, fov, size) in cases {
        let bounds = [f64::min as fn(f64, f64) -> f64, f64::max].map(|of| {
            [0, 1, 2].map(|axis| points.iter().map(|p| p[axis]).reduce(of).expect("points"))
        });
        let sets = [World::new(points.clone())];
        let subject = Subject { sets: &sets, bounds, image_size: size, up: Up::Y };
        let keys = CameraKeys {
            vertical_fov: Some(fov),
            view: Some(ViewFrom::Front),
            ..CameraKeys::default()
        };
        let camera = complete(&keys, &subject).expect("a camera");
        let [right, above, ahead] = frame_of(sight(&camera), camera.up.into());
        let tangent = (0.5 * fov.to_radians()).tan();
        let aspect = f64::from(size[0]) / f64::from(size[1]);
        let mut fullest = 0.0f64;
        for point in points {
            let p = DVec3::from(point) - DVec3::from(camera.eye);
            let depth = p.dot(ahead);
            assert!(depth > 0.0, "{fov} {size:?}: {point:?} is not ahead");
            let reach = (p.dot(right).abs() / aspect).max(p.dot(above).abs()) / (tangent * depth);
            fullest = fullest.max(reach);
        }
        assert!((fullest - FRAMING_FILL).abs() < 0.02, "{fov} {size:?}: {fullest}");
    }
}

#[test]
fn without_keys_the_view_is_the_usual_one() {
    let camera = framed(CameraKeys::default(), SIZES[0], Up::Z).expect("a camera");
    let expected = -DVec3::new(0.45, -1.0, 0.35).normalize();
    assert!((sight(&camera) - expected).length() < 1e-12);
    assert_eq!(camera.up, [0.0, 0.0, 1.0]);
    assert_eq!(camera.projection, Projection::Perspective { vertical_fov: 40.0 });
}

/// Along which axis each view looks, and what is up in its picture: the table of docs/scene.md.
#[test]
fn each_view_looks_along_its_axis() {
    let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z];
    for (up, rows) in [
        (Up::Y, [(-z, y), (z, y), (x, y), (-x, y), (-y, -z), (y, z)]),
        (Up::Z, [(y, z), (-y, z), (x, z), (-x, z), (-z, y), (z, -y)]),
        (Up::MinusY, [(z, -y), (-z, -y), (x, -y), (-x, -y), (y, z), (-y, -z)]),
    ] {
        for (view, (ahead, above)) in ViewFrom::NAMED.into_iter().zip(rows) {
            let keys = CameraKeys { view: Some(view), ..CameraKeys::default() };
            let camera = framed(keys, SIZES[0], up).expect("a camera");
            assert!((sight(&camera) - ahead).length() < 1e-12, "{view:?} with {up:?}: {camera:?}");
            assert_eq!(DVec3::from(camera.up), above, "{view:?} with {up:?}");
            // An axis that is given goes before, and means the same.
            let axis = match up {
                Up::Y => y,
                Up::Z => z,
                Up::MinusY => -y,
            };
            let same = framed(CameraKeys { up: Some(axis.into()), ..keys }, SIZES[0], Up::Y);
            assert_eq!(same.expect("a camera"), camera);
        }
    }
    let keys = CameraKeys { view: Some(ViewFrom::Iso), ..CameraKeys::default() };
    let camera = framed(keys, SIZES[0], Up::Z).expect("a camera");
    assert!((sight(&camera) - DVec3::new(-1.0, 1.0, -1.0).normalize()).length() < 1e-12);
}

/// An `up` between axes turns the view of the nearest one by as little as it can.
#[test]
fn any_up_has_its_views() {
    let up = DVec3::new(0.1, 0.2, 0.9);
    let keys = |view| CameraKeys { up: Some(up.into()), view: Some(view), ..CameraKeys::default() };
    let front = sight(&framed(keys(ViewFrom::Front), SIZES[0], Up::Y).expect("a camera"));
    assert!(front.dot(up).abs() < 1e-12 && front.dot(DVec3::Y) > 0.95, "{front}");
    let top = sight(&framed(keys(ViewFrom::Top), SIZES[0], Up::Y).expect("a camera"));
    assert!((top + up.normalize()).length() < 1e-12);
    for up in [DVec3::X, -DVec3::X, -DVec3::Z] {
        let [right, above, back] = axes_of(up);
        assert_eq!((above, right.cross(above)), (up, back));
    }
}

#[test]
fn what_is_given_of_a_place_stays() {
    let [eye, target] = [[20.0, 12.0, 5.0], [0.0, 10.5, 1.0]];
    let middle = [-1.0, 10.5, 1.25];
    // The eye alone looks at the middle, as wide as the points need.
    let camera = framed(CameraKeys { eye: Some(eye), ..CameraKeys::default() }, SIZES[0], Up::Y);
    let camera = camera.expect("a camera");
    assert_eq!((camera.eye, camera.target), (eye, middle));
    let places = seen(&camera, SIZES[0]);
    let reach = places.iter().flatten().map(|at| (at - 0.5).abs()).fold(0.0, f64::max);
    assert!((reach - 0.5 * FRAMING_FILL).abs() < CLOSE, "{reach}");
    // From among the points, no angle is wide enough.
    let keys = CameraKeys { eye: Some([0.0, 10.5, 1.0]), ..CameraKeys::default() };
    let camera = framed(keys, SIZES[0], Up::Y).expect("a camera");
    assert_eq!(camera.projection, Projection::Perspective { vertical_fov: WIDEST });
    // With an angle, that counts; in the middle itself, the usual way is ahead.
    let keys = CameraKeys { eye: Some(middle), vertical_fov: Some(70.0), ..CameraKeys::default() };
    let camera = framed(keys, SIZES[0], Up::Y).expect("a camera");
    assert_eq!(camera.projection, Projection::Perspective { vertical_fov: 70.0 });
    assert!((sight(&camera) + DVec3::from(FRAMING_DIRECTION).normalize()).length() < 1e-12);
    // The target alone is in the middle, and everything is in the picture.
    for is_orthographic in [false, true] {
        let keys = CameraKeys { target: Some(target), is_orthographic, ..CameraKeys::default() };
        let camera = framed(keys, SIZES[0], Up::Y).expect("a camera");
        assert_eq!(camera.target, target);
        let places = seen(&camera, SIZES[0]);
        let reach = places.iter().flatten().map(|at| (at - 0.5).abs()).fold(0.0, f64::max);
        assert!((reach - 0.5 * FRAMING_FILL).abs() < CLOSE, "{reach}");
    }
    // Eye and target with parallel rays: the height is what holds the points.
    let keys = CameraKeys {
        eye: Some(eye),
        target: Some(target),
        is_orthographic: true,
        ..CameraKeys::default()
    };
    let camera = framed(keys, SIZES[0], Up::Y).expect("a camera");
    assert_eq!((camera.eye, camera.target), (eye, target));
    let places = seen(&camera, SIZES[0]);
    let reach = places.iter().flatten().map(|at| (at - 0.5).abs()).fold(0.0, f64::max);
    assert!((reach - 0.5 * FRAMING_FILL).abs() < CLOSE, "{reach}");
    let keys = CameraKeys { height: Some(0.25), is_orthographic: true, ..CameraKeys::default() };
    let camera = framed(keys, SIZES[0], Up::Y).expect("a camera");
    assert_eq!(camera.projection, Projection::Orthographic { height: 0.25 });
}

#[test]
fn a_lens_and_its_focus_go_along() {
    let keys = CameraKeys { aperture: 0.5, ..CameraKeys::default() };
    let camera = framed(keys, SIZES[0], Up::Y).expect("a camera");
    assert_eq!((camera.aperture, camera.focus), (0.5, None));
    let view = View::new(&camera, SIZES[0], [0.0; 3]);
    let distance = (DVec3::from(camera.target) - DVec3::from(camera.eye)).length();
    assert_eq!(view.params.focus, distance as f32);
    let wide = framed(CameraKeys { aperture: 1e5, ..CameraKeys::default() }, SIZES[0], Up::Y);
    assert!(wide.expect_err("too wide").to_string().starts_with("camera.aperture: found 100000"));
}

#[test]
fn an_up_along_the_line_of_sight_is_an_error_only_where_it_is_given() {
    let above = Some([-1.0, 50.0, 1.25]);
    let camera = framed(CameraKeys { eye: above, ..CameraKeys::default() }, SIZES[0], Up::Y);
    assert_eq!(camera.expect("a camera").up, [0.0, 0.0, -1.0]);
    let keys = CameraKeys { eye: above, up: Some([0.0, 1.0, 0.0]), ..CameraKeys::default() };
    let camera = framed(keys, SIZES[0], Up::Y);
    assert_eq!(camera.expect("a camera").up, [0.0, 0.0, -1.0]);
}

#[test]
fn a_single_point_has_a_finite_view() {
    let point = [3.0; 3];
    let sets = [World::new(vec![point])];
    let subject = Subject { sets: &sets, bounds: [point; 2], image_size: [64, 48], up: Up::Y };
    let eye = Some([3.0, 3.0, 4.0]);
    for keys in [
        CameraKeys::default(),
        CameraKeys { is_orthographic: true, ..CameraKeys::default() },
        CameraKeys { eye, ..CameraKeys::default() },
        CameraKeys { eye, is_orthographic: true, ..CameraKeys::default() },
        CameraKeys { eye: Some(point), ..CameraKeys::default() },
        CameraKeys { target: Some(point), ..CameraKeys::default() },
    ] {
        let camera = complete(&keys, &subject).expect("a camera");
        assert!(camera.eye.iter().chain(&camera.target).all(|x| x.is_finite()), "{camera:?}");
        assert_ne!(camera.eye, camera.target);
    }
}

/// In the usual views the key light is exactly the one that it was, from any other side it comes from the same side of the
/// camera.
#[test]
fn the_key_light_follows_the_camera() {
    let light = |keys: CameraKeys, up| {
        let camera = framed(keys, SIZES[0], up).expect("a camera");
        (key_direction(&camera), camera)
    };
    for (up, usual) in
        [(Up::Y, [-0.5, -1.0, -0.6]), (Up::Z, [-0.5, 0.6, -1.0]), (Up::MinusY, [-0.5, 1.0, 0.6])]
    {
        assert_eq!(light(CameraKeys::default(), up).0, DVec3::from(usual));
        let fov = CameraKeys { vertical_fov: Some(20.0), ..CameraKeys::default() };
        assert_eq!(light(fov, up).0, DVec3::from(usual));
    }
    let seen = |(key, camera): (DVec3, Camera)| {
        let [right, above, ahead] = frame_of(sight(&camera), camera.up.into());
        DVec3::new(key.dot(right), key.dot(above), key.dot(ahead))
    };
    let usual = seen(light(CameraKeys::default(), Up::Y));
    for view in ViewFrom::NAMED {
        for up in [Up::Y, Up::Z, Up::MinusY] {
            let keys = CameraKeys { view: Some(view), ..CameraKeys::default() };
            assert!((seen(light(keys, up)) - usual).length() < 1e-9, "{view:?} {up:?}");
        }
    }
    // Only the light that is the key light is turned.
    let fixed = Light::Directional { direction: [1.0, 2.0, 3.0], irradiance: [1.0; 3], angle: 0.0 };
    let camera = framed(CameraKeys::default(), SIZES[0], Up::Y).expect("a camera");
    let lights = [fixed; 2];
    let turned = lights_for(&lights, Some(1), &camera);
    assert!(turned[0] == fixed && turned[1] != fixed);
    assert_eq!(lights_for(&lights, None, &camera), lights);
}
