//! The automatic camera from outside: single keys of it, `--view`, `--ortho`, `--camera-from`, and the lights that follow.

use crate::{Folder, Ran, ply, run_in, sphere};
use scene::{CameraKeys, Light, Projection, Scene};
use std::fmt::Write;
use std::path::Path;

fn render(folder: &Folder, arguments: &[&str]) -> Ran {
    let small = ["--device", "reference", "--size", "32x24"];
    run_in(folder.path(), &[&["render"], arguments, &small].concat())
}

/// The scene of a picture's header.
fn settings(folder: &Folder, name: &str) -> String {
    let picture = film::read_exr(&folder.path().join(name)).expect("an EXR");
    picture.strings["pointillist/scene"].clone()
}

fn scene_of(folder: &Folder, arguments: &[&str]) -> Scene {
    render(folder, &[arguments, &["-o", "seen.exr"]].concat()).succeeds();
    Scene::from_toml(&settings(folder, "seen.exr"), Path::new("seen.toml"), &[]).expect("a scene")
}

fn camera_of(folder: &Folder, arguments: &[&str]) -> scene::Camera {
    scene_of(folder, arguments).camera.whole().expect("the whole camera")
}

fn bytes(folder: &Folder, name: &str) -> Vec<u8> {
    std::fs::read(folder.path().join(name)).expect("the picture")
}

/// Of unit length.
fn ahead(camera: &scene::Camera) -> [f64; 3] {
    let way = [0, 1, 2].map(|axis| camera.target[axis] - camera.eye[axis]);
    let length = way.iter().map(|x| x * x).sum::<f64>().sqrt();
    way.map(|x| x / length)
}

fn close(a: [f64; 3], b: [f64; 3], tolerance: f64) -> bool {
    (0..3).all(|axis| (a[axis] - b[axis]).abs() < tolerance)
}

const DIRECTION: [f64; 3] = [-0.390_91, -0.304_04, -0.868_69];

/// Pixels of a picture that show an object, by row and column.
fn shown(folder: &Folder, name: &str) -> Vec<bool> {
    let picture = film::read_exr(&folder.path().join(name)).expect("an EXR");
    picture.channels["A"].iter().map(|alpha| *alpha > 0.0).collect()
}

#[test]
fn one_key_of_the_automatic_camera_can_be_given() {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(400));
    folder.write(
        "framed.toml",
        "[camera]\nvertical_fov = 20.0\n[[objects]]\npoints = \"ball.ply\"\n",
    );
    let automatic = camera_of(&folder, &["ball.ply"]);
    assert!(close(ahead(&automatic), DIRECTION, 1e-4), "{automatic:?}");
    for input in [&["ball.ply", "--set", "camera.vertical_fov=20"][..], &["framed.toml"]] {
        let narrow = camera_of(&folder, input);
        assert_eq!(narrow.projection, Projection::Perspective { vertical_fov: 20.0 });
        assert!(close(ahead(&narrow), ahead(&automatic), 1e-12), "{narrow:?}");
        // The ball is as large in the picture: sin of half its angle is 1/distance.
        let distance = |camera: &scene::Camera| {
            (0..3).map(|i| (camera.eye[i] - camera.target[i]).powi(2)).sum::<f64>().sqrt()
        };
        let tangent = |camera| (1.0 / (f64::powi(distance(camera), 2) - 1.0)).sqrt();
        let share = |camera, fov: f64| tangent(camera) / (0.5 * fov).to_radians().tan();
        // 400 points stand for the ball.
        assert!((share(&narrow, 20.0) / share(&automatic, 40.0) - 1.0).abs() < 0.02);
    }
    let given = |set: &str| camera_of(&folder, &["ball.ply", "--set", set]);
    let above = given("camera.up=[0, 0, 1]");
    assert!(close(ahead(&above), [DIRECTION[0], -DIRECTION[2], DIRECTION[1]], 1e-4), "{above:?}");
    let eye = given("camera.eye=[0, 0, 5]");
    assert_eq!(eye.eye, [0.0, 0.0, 5.0]);
    assert!(close(eye.target, [0.0; 3], 0.01), "{eye:?}");
    let target = given("camera.target=[0.5, 0, 0]");
    assert_eq!(target.target, [0.5, 0.0, 0.0]);
    assert!(close(ahead(&target), ahead(&automatic), 1e-12));
    let parallel = given("camera.projection=orthographic");
    let Projection::Orthographic { height } = parallel.projection else { panic!("{parallel:?}") };
    assert!((height - 2.0 / 0.88).abs() < 0.02, "{height}");
    let lens = given("camera.aperture=0.25");
    assert_eq!((lens.aperture, lens.focus), (0.25, None));
    assert_eq!(given("camera.focus=2").focus, Some(2.0));
    assert_eq!(given("camera.view=top").up, [0.0, 0.0, -1.0]);
    render(&folder, &["ball.ply", "-o", "a.png", "--set", "camera.view=[0, 0, 0]"])
        .fails_with(2, &["--set camera.view=[0, 0, 0]", "front"]);
}

/// Each side shows what is on it: a ball with a small one beside it along each axis, which a picture shows at its rim.
#[test]
fn views_show_their_side_of_a_file() {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(400));
    let y_up = [
        ("front", [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]),
        ("back", [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]),
        ("left", [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
        ("right", [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
        ("top", [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]),
        ("bottom", [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]),
        ("iso", [-0.577_350_27; 3], [0.0, 1.0, 0.0]),
    ];
    for (side, expected, above) in y_up {
        let camera = camera_of(&folder, &["ball.ply", "--view", side]);
        assert!(close(ahead(&camera), expected, 1e-8), "{side}: {camera:?}");
        assert!(close(camera.up, above, 1e-12), "{side}: {camera:?}");
        // From y up to z up is a quarter turn about x.
        let turned = |[x, y, z]: [f64; 3]| [x, -z, y];
        let camera = camera_of(&folder, &["ball.ply", "--view", side, "--up", "z"]);
        assert!(close(ahead(&camera), turned(expected), 1e-8), "{side}: {camera:?}");
        assert!(close(camera.up, turned(above), 1e-12), "{side}: {camera:?}");
    }
    // They take the place of a scene's camera, but keep its angle and lens.
    let camera = "[camera]\neye = [5, 6, 7]\ntarget = [0, 0, 1]\nup = [0, 0, 1]\nvertical_fov = 25.0\naperture = 0.1\n";
    folder.write("scene.toml", &format!("{camera}[[objects]]\npoints = \"ball.ply\"\n"));
    let left = camera_of(&folder, &["scene.toml", "--view", "left"]);
    assert!(close(ahead(&left), [1.0, 0.0, 0.0], 1e-8), "{left:?}");
    assert_eq!(left.projection, Projection::Perspective { vertical_fov: 25.0 });
    assert_eq!((left.up, left.aperture), ([0.0, 0.0, 1.0], 0.1));
}

#[test]
fn parallel_rays_keep_the_direction_and_show_everything() {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(400));
    let camera = "[camera]\neye = [0, 0, 1.5]\ntarget = [0, 0.2, 1.0]\n";
    folder.write("scene.toml", &format!("{camera}[[objects]]\npoints = \"ball.ply\"\n"));
    let near = camera_of(&folder, &["scene.toml"]);
    let all = camera_of(&folder, &["scene.toml", "--ortho"]);
    assert!(close(ahead(&all), ahead(&near), 1e-12), "{all:?}");
    let Projection::Orthographic { height } = all.projection else { panic!("{all:?}") };
    assert!((height - 2.0 / 0.88).abs() < 0.02, "{height}");
    // One ray a pixel, so that no pixel beside it has any of it.
    let top = camera_of(&folder, &["ball.ply", "--ortho", "--view", "top", "--quality", "draft"]);
    assert!(close(ahead(&top), [0.0, -1.0, 0.0], 1e-12), "{top:?}");
    // The disc of a ball, 0.88 of 24 rows high.
    let seen = shown(&folder, "seen.exr");
    let rows = (0..24).filter(|row| seen[row * 32..][..32].contains(&true)).count();
    assert!((20..=22).contains(&rows), "{rows} rows");
    let height = ["--set", "camera.height=4.0"];
    let low = camera_of(&folder, &[&["ball.ply", "--ortho"], &height[..]].concat());
    assert_eq!(low.projection, Projection::Orthographic { height: 4.0 });
}

/// The same scene through its own header is the same file, to the byte.
#[test]
fn a_camera_is_taken_from_a_picture() {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(300));
    let camera = "[camera]\neye = [0.3, 1.7, 4.0]\ntarget = [0.1, 0, 0]\nup = [0.1, 1, 0]\nvertical_fov = 33.3\n\
                  aperture = 0.2\nfocus = 3.1\n[image]\nsamples = 3\n";
    let rest = "[[lights]]\nkind = \"headlight\"\nat_target = [1, 1, 1]\n[[objects]]\npoints = \"ball.ply\"\n";
    folder.write("scene.toml", &format!("{camera}{rest}"));
    let flat = camera.replace("vertical_fov = 33.3", "projection = \"orthographic\"\nheight = 2.3");
    folder.write("flat.toml", &format!("{flat}{rest}"));
    for scene in ["scene.toml", "flat.toml", "ball.ply"] {
        render(&folder, &[scene, "-o", "a.exr"]).succeeds();
        let said = render(&folder, &[scene, "-o", "b.exr", "--camera-from", "a.exr"]).succeeds();
        assert_eq!(bytes(&folder, "a.exr"), bytes(&folder, "b.exr"), "{scene}: {}", said.stderr);
    }
    // Another object through the same camera, and its automatic lights follow.
    render(&folder, &["scene.toml", "-o", "a.exr"]).succeeds();
    let of_file = camera_of(&folder, &["ball.ply", "--camera-from", "a.exr"]);
    let expected =
        CameraKeys::from_toml(&settings(&folder, "a.exr"), Path::new("a")).expect("keys");
    assert_eq!(Some(of_file), expected.whole());
    // What a header's scene says renders the same again; the exposure is none of the scene's.
    let iso = ["ball.ply", "-o", "a.exr", "--view", "iso", "--ortho", "--exposure", "0"];
    render(&folder, &iso).succeeds();
    folder.write("again.toml", &settings(&folder, "a.exr"));
    render(&folder, &["again.toml", "-o", "b.exr"]).succeeds();
    assert_eq!(bytes(&folder, "a.exr"), bytes(&folder, "b.exr"));
}

/// Without the scene in the header, the standard attributes determine a camera as far as 32 bits go.
#[test]
fn a_camera_is_taken_from_a_picture_of_another_program() {
    let folder = Folder::new();
    // Far out, so that the origin counts.
    let far: Vec<String> = (0..8)
        .map(|i| format!("{} {} {}", 400_000 + i % 2, 5_000_000 + i / 2 % 2, 100 + i / 4))
        .collect();
    folder.write("far.ply", &ply(&far.iter().map(String::as_str).collect::<Vec<_>>()));
    let sets = ["--set", "objects.0.surface.kind=spheres", "--up", "z"];
    let own = camera_of(&folder, &[&["far.ply"], &sets[..]].concat());
    let without = |names: &[&str], file: &str| {
        let mut bytes = bytes(&folder, "seen.exr");
        for name in names {
            let place = bytes.windows(name.len()).position(|at| at == name.as_bytes());
            bytes[place.expect("the attribute")] = b'_';
        }
        std::fs::write(folder.path().join(file), bytes).expect("a file");
    };
    without(&["pointillist/scene\0"], "other.exr");
    without(&["pointillist/scene\0", "worldToNDC\0"], "place.exr");
    without(&["pointillist/scene\0", "worldToNDC\0", "worldToCamera\0"], "none.exr");
    let from = |file| ["far.ply", "--set", "objects.0.surface.kind=spheres", "--camera-from", file];
    let other = camera_of(&folder, &from("other.exr"));
    assert!(
        close(other.eye, own.eye, 1e-5) && close(ahead(&other), ahead(&own), 1e-6),
        "{other:?}"
    );
    let Projection::Perspective { vertical_fov } = other.projection else { panic!("{other:?}") };
    assert!((vertical_fov - 40.0).abs() < 1e-4, "{vertical_fov}");
    let place = camera_of(&folder, &from("place.exr"));
    assert!(close(place.eye, own.eye, 1e-5), "{place:?}");
    let said = render(&folder, &[&from("place.exr")[..], &["-o", "a.png"]].concat()).succeeds();
    assert!(said.stderr.contains("place.exr: has no worldToNDC"), "{}", said.stderr);
    render(&folder, &[&from("none.exr")[..], &["-o", "a.png"]].concat())
        .fails_with(2, &["--camera-from none.exr", "worldToCamera", "worldToNDC"]);
    render(&folder, &[&from("far.ply")[..], &["-o", "a.png"]].concat()).fails_with(2, &["far.ply"]);
    // Other proportions are said.
    let wide = [
        "render",
        "far.ply",
        "-o",
        "a.png",
        "--camera-from",
        "other.exr",
        "--size",
        "48x24",
        "--device",
    ];
    let said = run_in(folder.path(), &[&wide[..], &["reference"]].concat()).succeeds();
    assert!(
        said.stderr.contains("1.3333 times as wide as high")
            && said.stderr.contains("more at the sides")
    );
}

#[test]
fn what_contradicts_itself_is_named() {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(300));
    render(&folder, &["ball.ply", "-o", "a.exr"]).succeeds();
    let scene = "[camera]\nup = [0, 0, 1]\n[[objects]]\npoints = \"ball.ply\"\n";
    folder.write("up.toml", scene);
    for (arguments, words) in [
        (&["ball.ply", "--camera-from", "a.exr", "--view", "top"][..], ["--camera-from", "--view"]),
        (&["ball.ply", "--camera-from", "a.exr", "--ortho"], ["--camera-from", "--ortho"]),
        (&["ball.ply", "--camera-from", "a.exr", "--up", "z"], ["--camera-from", "--up"]),
        (
            &["ball.ply", "--camera-from", "a.exr", "--set", "camera.vertical_fov=20"],
            ["--camera-from a.exr", "camera.vertical_fov=20"],
        ),
        (
            &["ball.ply", "--view", "top", "--set", "camera.eye=[1, 2, 3]"],
            ["--view", "--set camera.eye=[1, 2, 3]"],
        ),
        (
            &["ball.ply", "--view", "top", "--set", "camera={ view = \"left\" }"],
            ["--view", "--set camera={"],
        ),
        (
            &["ball.ply", "--ortho", "--set", "camera.vertical_fov=20"],
            ["--ortho", "camera.vertical_fov=20"],
        ),
        (
            &["ball.ply", "--ortho", "--set", "camera.projection=perspective"],
            ["--ortho", "camera.projection"],
        ),
        (
            &["ball.ply", "--up", "z", "--set", "camera.up=[0, 0, 1]"],
            ["--up", "--set camera.up=[0, 0, 1]"],
        ),
        (&["up.toml", "--up", "z"], ["up.toml", "--up"]),
        (&["ball.ply", "--view", "above"], ["--view", "iso"]),
    ] {
        render(&folder, &[arguments, &["-o", "b.png"]].concat()).fails_with(2, &words);
    }
    assert_eq!(folder.names(), ["a.exr", "ball.ply", "up.toml"]);
    // `check` has them too, and what goes together does.
    run_in(folder.path(), &["check", "ball.ply", "--view", "top", "--ortho", "--up", "z"])
        .succeeds();
    run_in(
        folder.path(),
        &["check", "up.toml", "--view", "top", "--set", "camera.target=[0, 1, 0]"],
    )
    .succeeds();
}

#[test]
fn automatic_lights_follow_the_camera_until_they_are_given() {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(300));
    let key = |arguments: &[&str]| {
        let scene = scene_of(&folder, &[&["ball.ply"], arguments].concat());
        let Some(Light::Directional { direction, .. }) = scene.lights.first() else { panic!() };
        *direction
    };
    assert_eq!(key(&[]), [-0.5, -1.0, -0.6]);
    assert_eq!(key(&["--set", "camera.vertical_fov=20"]), [-0.5, -1.0, -0.6]);
    assert_eq!(key(&["--up", "z"]), [-0.5, 0.6, -1.0]);
    // Where the camera looks from the back, the light comes from there: the picture of a ball is as bright as from the front.
    let [front, back] = [key(&["--view", "front"]), key(&["--view", "back"])];
    assert!(close(back, [-front[0], front[1], -front[2]], 1e-9), "{front:?} {back:?}");
    let camera = "camera={ eye = [0, 0, -4], target = [0, 0, 0] }";
    assert!(close(key(&["--set", camera]), back, 1e-9));
    let given = key(&["--view", "back", "--set", "lights.0.direction=[1, 2, 3]"]);
    assert_eq!(given, [1.0, 2.0, 3.0]);
    let weak = key(&["--view", "back", "--set", "lights.0.irradiance=[1, 1, 1]"]);
    assert!(close(weak, back, 1e-9));
}

/// A ball is framed the same, whatever else the file has that filters leave out, or that lies far from all of it.
#[test]
fn what_filters_left_is_framed() {
    let folder = Folder::new();
    let row = |x: f64, class: u32| {
        sphere(400).lines().skip(10).fold(String::new(), |mut text, line| {
            let numbers: Vec<f64> = line.split(' ').map(|n| n.parse().expect("a number")).collect();
            writeln!(text, "{},{},{},{class}", numbers[0] + x, numbers[1], numbers[2])
                .expect("text");
            text
        })
    };
    let head = "x,y,z,classification\n";
    folder.write("one.csv", &format!("{head}{}", row(0.0, 2)));
    folder.write("two.csv", &format!("{head}{}{}", row(0.0, 2), row(7.0, 6)));
    folder.write("stray.csv", &format!("{head}{}900,0,0,2\n", row(0.0, 2)));
    let expected = camera_of(&folder, &["one.csv"]);
    let bounds = "objects.0.filter.box={ min = [-2, -2, -2], max = [2, 2, 2] }";
    let class = "objects.0.filter.classification=[2]";
    let range = "objects.0.filter.range={ x = [-2, 2] }";
    for (file, set) in [
        ("two.csv", bounds),
        ("two.csv", class),
        ("two.csv", range),
        ("stray.csv", "image.samples=1"),
    ] {
        assert_eq!(camera_of(&folder, &[file, "--set", set]), expected, "{file} {set}");
    }
    assert_ne!(camera_of(&folder, &["two.csv"]), expected);
    // A few points near enough to be no strays are dropped as isolated ones.
    let lone = format!("{head}{}3,0,0,2\n0,3,0,2\n", row(0.0, 2));
    folder.write("lone.csv", &lone);
    let isolated = ["--set", "objects.0.surface.drop_isolated=3"];
    assert_eq!(camera_of(&folder, &[&["lone.csv"], &isolated[..]].concat()), expected);
}

/// The sensor's view too: one key is given, the rest stays the sensor's, and its light with it.
#[test]
fn the_view_of_a_sensor_takes_single_keys() {
    let folder = Folder::new();
    let image = (0..32 * 24).fold(String::new(), |mut text, i| {
        let (column, row) = (f64::from(i % 32) - 15.5, f64::from(i / 32) - 11.5);
        let z = if column.abs() < 5.0 && row > 0.0 { 2.0 } else { 3.0 };
        writeln!(text, "{} {} {z}", column / 31.0 * z, row / 31.0 * z).expect("text");
        text
    });
    let head = "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 32\nHEIGHT 24\nVIEWPOINT 0 0 0 1 0 0 0\n";
    folder.write("depth.pcd", &format!("{head}DATA ascii\n{image}"));
    let own = scene_of(&folder, &["depth.pcd"]);
    let fov = scene_of(&folder, &["depth.pcd", "--set", "camera.vertical_fov=30"]);
    let [own_camera, fov_camera] = [&own, &fov].map(|scene| scene.camera.whole().expect("whole"));
    assert_eq!(fov_camera.projection, Projection::Perspective { vertical_fov: 30.0 });
    assert_eq!((own_camera.eye, own_camera.target), (fov_camera.eye, fov_camera.target));
    assert_eq!(own.lights, fov.lights);
    let outside = scene_of(&folder, &["depth.pcd", "--view", "front"]);
    assert!(outside.camera.eye != Some([0.0; 3]) && outside.lights != own.lights);
}
