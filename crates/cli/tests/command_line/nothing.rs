//! Scenes that render without an error and show nothing: `check` and `render` warn of them, `--strict` refuses them.

use crate::{Folder, Ran, run_in, sphere};
use std::fmt::Write;

const BALL: &str = "[[objects]]\npoints = \"ball.ply\"\n";
const LIT: &str = "[[lights]]\nkind = \"headlight\"\nat_target = [1, 1, 1]\n";
const FRONT: &str = "[camera]\neye = [0, 0, 5]\ntarget = [0, 0, 0]\n";
const VOLUME: &str = "[[objects]]\npoints = \"filled.csv\"\n[objects.volume]\nscalar = \"s\"\n";
const MAP: &str = "color_map = \"viridis\"\nextinction = [0.0, 5.0]\n";
const GLOW: &str =
    "transfer = [{ value = 0, emission = [0, 0, 0] }, { value = 1, emission = [1, 0.3, 0] }]\n";
const SKY: &str = "[background]\nenvironment = \"sky.png\"\n";

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(2000));
    // A ball of a lattice, moved a little, with the distance from the middle.
    let mut filled = String::from("x,y,z,s\n");
    let mut skin = filled.clone();
    for i in 0..4096 {
        let at = |n: i32| f64::from(i / n % 16) / 7.5 - 1.0 + 0.02 * f64::from(i * 7 % 11);
        let (x, y, z) = (at(1), at(16), at(256));
        let s = (x * x + y * y + z * z).sqrt();
        writeln!(filled, "{x},{y},{z},{s}").expect("text");
    }
    for line in sphere(3000).lines().skip(10) {
        let numbers: Vec<&str> = line.split(' ').collect();
        writeln!(skin, "{},{},{},{}", numbers[0], numbers[1], numbers[2], numbers[0])
            .expect("text");
    }
    folder.write("filled.csv", &filled);
    folder.write("skin.csv", &skin);
    let image = image_of_sky();
    std::fs::write(folder.path().join("sky.png"), image).expect("an image");
    folder
}

fn image_of_sky() -> Vec<u8> {
    std::fs::read(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/images/tiles.png"))
        .expect("an image of the repository")
}

fn render(folder: &Folder, arguments: &[&str]) -> Ran {
    let small = ["--device", "reference", "--size", "32x24"];
    run_in(folder.path(), &[&["render"], arguments, &small].concat())
}

fn warnings(ran: &Ran) -> Vec<&str> {
    ran.stderr.lines().filter(|line| line.starts_with("warning: ")).collect()
}

/// Both commands warn in one line that names what to do, and exit with 0; with `--strict` with 2, and nothing is written.
#[test]
fn a_scene_that_shows_nothing_is_named_and_refused() {
    let folder = folder();
    let of = |parts: &[&str]| parts.concat();
    let glass = "material = { kind = \"glass\" }\n";
    for (text, words) in [
        (of(&[BALL]), ["there are no lights", "add [[lights]]"]),
        (of(&[&LIT.replace("[1, 1, 1]", "[0, 0, 0]"), BALL]), ["of every light is 0", "raise"]),
        (of(&[LIT, BALL, glass]), ["glass before a black background", "background.environment"]),
        (
            of(&["[background]\ncolor = [0.1, 0.2, 0.5]\n", LIT, BALL, glass]),
            ["glass before a background of one colour", "background.environment"],
        ),
        (
            of(&[LIT, BALL, "material = { kind = \"mirror\" }\n"]),
            ["a mirror before", "background.environment"],
        ),
        (
            of(&["[render]\nmax_bounces = 0\n", SKY, BALL, glass]),
            ["render.max_bounces is 0", "raise it"],
        ),
        (
            of(&[&FRONT.replace("[0, 0, 0]", "[0, 0, 9]"), LIT, BALL]),
            ["behind the camera", "camera.target"],
        ),
        (
            of(&[&FRONT.replace("[0, 0, 0]", "[9, 0, 5]"), LIT, BALL]),
            ["lie beside it", "camera.target"],
        ),
        // Just beside it: at 5 from the eye, the picture ends at 2.4.
        (
            of(&[&FRONT.replace("[0, 0, 0]", "[5.5, 0, 0]"), LIT, BALL]),
            ["lie beside it", "camera.target"],
        ),
        (
            of(&["[camera]\neye = [3, 2, 5]\nview = \"left\"\n", LIT, BALL]),
            ["the camera looks away", "remove camera.view"],
        ),
        (
            of(&[
                "[camera]\neye = [0, 0, 5]\ntarget = [0, 0, 9]\nprojection = \"orthographic\"\nheight = 3.0\n",
                LIT,
                BALL,
            ]),
            ["behind the camera", "camera.target"],
        ),
        (
            of(&[LIT, VOLUME, "mode = \"isosurface\"\niso = 3.0\n"]),
            ["scalar, 3.0, since 's' goes from", "iso to e.g."],
        ),
        (
            of(&[LIT, VOLUME, "mode = \"isosurface\"\niso = -1.0\n"]),
            ["scalar, -1.0, since", "iso to e.g."],
        ),
        (
            of(&[LIT, VOLUME, "kernel = \"sum\"\nmode = \"isosurface\"\niso = 300.0\n"]),
            ["scalar, 300.0, since the sum of 's' goes to", "iso to e.g."],
        ),
        (
            of(&[VOLUME, MAP, "value_range = [7.0, 9.0]\n"]),
            ["transparent for all values of 's'", "value_range out"],
        ),
        (
            of(&[VOLUME, "color_map = \"viridis\"\nextinction = 0.0\n"]),
            ["transparent for all", "raise objects.0.volume.extinction"],
        ),
        (
            of(&[&VOLUME.replace("filled", "skin"), MAP]),
            ["lie on a surface", "leave objects.0.volume out"],
        ),
        (
            of(&[FRONT, LIT, BALL, "transform = { scale = 1e-6 }\n"]),
            ["pixels wide", "transform.scale"],
        ),
        (
            of(&[FRONT, LIT, BALL, "surface = { kind = \"spheres\", radius = 1e-6 }\n"]),
            ["cover", "objects.0.surface.radius"],
        ),
        (
            of(&[
                "[[lights]]\nkind = \"point\"\nposition = [0, 0, 0]\nintensity = [5, 5, 5]\n",
                BALL,
            ]),
            ["encloses every light", "lights.0.position"],
        ),
    ] {
        folder.write("scene.toml", &text);
        let checked = run_in(folder.path(), &["check", "scene.toml"]).succeeds();
        assert_eq!(checked.stdout, "scene.toml: ok, 1 object\n");
        let rendered = render(&folder, &["scene.toml", "-o", "a.png"]).succeeds();
        for ran in [&checked, &rendered] {
            let found = warnings(ran);
            let [line] = found.as_slice() else { panic!("{text}: {}", ran.stderr) };
            assert!(words.iter().all(|word| line.contains(word)), "{text}: {line}");
        }
        std::fs::remove_file(folder.path().join("a.png")).expect("the picture");
        run_in(folder.path(), &["check", "scene.toml", "--strict"])
            .fails_with(2, &["--strict: 1 warning", words[0]]);
        render(&folder, &["scene.toml", "-o", "a.png", "--strict"])
            .fails_with(2, &["--strict: 1 warning, and nothing was rendered", words[0]]);
        render(&folder, &["scene.toml", "-o", "a.png", "--strict", "--quiet"])
            .fails_with(2, &["--strict: 1 warning"]);
        assert!(!folder.names().contains(&"a.png".to_owned()), "{text}");
    }
}

/// Scenes that differ from those by the one thing that matters.
#[test]
fn a_scene_that_shows_something_passes_strictly() {
    let folder = folder();
    let of = |parts: &[&str]| parts.concat();
    let glass = "material = { kind = \"glass\" }\n";
    let tinted = "[objects.material]\nkind = \"glass\"\nabsorption = [0, 1, 2]\n";
    let grey = "[background]\ncolor = [0.2, 0.2, 0.2]\n";
    for text in [
        of(&[LIT, BALL]),
        of(&[SKY, BALL, glass]),
        of(&[LIT, BALL, glass, BALL, "transform = { translate = [3, 0, 0] }\n"]),
        of(&[grey, BALL, tinted]),
        of(&["[render]\nmax_bounces = 0\n", grey, BALL, tinted, "ior = 1.0\n"]),
        of(&[grey, BALL, "[objects.material]\nkind = \"mirror\"\nreflectance = [0.9, 0.5, 0.1]\n"]),
        of(&["[camera]\neye = [0, 0, 0]\ntarget = [0, 0, 1]\n", LIT, BALL]),
        of(&["[camera]\neye = [0, 0, 1.2]\ntarget = [0, 0, 0]\nvertical_fov = 1.0\n", LIT, BALL]),
        of(&[LIT, VOLUME, "mode = \"isosurface\"\niso = 0.5\n"]),
        of(&[LIT, VOLUME, "kernel = \"sum\"\nmode = \"isosurface\"\niso = 0.5\n"]),
        of(&[VOLUME, MAP]),
        of(&[VOLUME, MAP, "value_range = [0.0, 0.5]\n"]),
        // It sends light and covers nothing.
        of(&[VOLUME, GLOW]),
        of(&[FRONT, SKY, VOLUME, GLOW]),
        of(&[
            "[[lights]]\nkind = \"point\"\nposition = [0, 0, 4]\nintensity = [50, 50, 50]\n",
            BALL,
        ]),
    ] {
        folder.write("scene.toml", &text);
        run_in(folder.path(), &["check", "scene.toml", "--strict"]).succeeds();
        let ran = render(&folder, &["scene.toml", "-o", "a.png", "--strict"]).succeeds();
        assert!(warnings(&ran).is_empty(), "{text}: {}", ran.stderr);
    }
}

/// What only the picture shows: it is written, and `--strict` still exits with 2.
#[test]
fn a_picture_that_shows_nothing_is_named() {
    let folder = folder();
    let sun =
        "[[lights]]\nkind = \"directional\"\ndirection = [0, -1, 0]\nirradiance = [3, 3, 3]\n";
    let inside = "[camera]\neye = [0, 0, 0]\ntarget = [0, 0, 1]\n";
    folder.write("inside.toml", &format!("{inside}{sun}{BALL}"));
    let ran = render(&folder, &["inside.toml", "-o", "a.png"]).succeeds();
    assert!(ran.stderr.contains("warning: the picture is black all over"), "{}", ran.stderr);
    assert!(ran.stderr.contains("the camera may be inside an object"), "{}", ran.stderr);
    let words = ["--strict: 1 warning of the picture, which was written"];
    render(&folder, &["inside.toml", "-o", "b.png", "--strict"]).fails_with(2, &words);
    assert!(folder.names().contains(&"b.png".to_owned()));
    // A corner that was asked for is empty on purpose.
    let corner = ["ball.ply", "-o", "c.png", "--crop", "0,0,6,6", "--strict"];
    let ran = render(&folder, &corner).succeeds();
    assert!(warnings(&ran).is_empty(), "{}", ran.stderr);
}

/// An EXR has what 8 bits do not show, so that the warning is for a PNG or a JPEG only.
#[test]
fn what_eight_bits_do_not_show_is_named() {
    let folder = folder();
    let light = |numbers: &str| {
        format!(
            "{FRONT}[[lights]]\nkind = \"point\"\nposition = [0, 5000, 500]\nintensity = {numbers}\n{BALL}"
        )
    };
    let thin = format!("{VOLUME}color_map = \"viridis\"\nextinction = 1e-7\n");
    let white = "transfer = [{ value = 0, color = [1, 1, 1], extinction = 2 }]\n";
    let white = format!("[background]\ncolor = [1, 1, 1]\n{VOLUME}{white}");
    for (text, words) in [
        (light("[3, 3, 3]"), ["black all over in 8 bits", "give --exposure"]),
        (thin, ["nothing but the background in 8 bits", "raise the extinction"]),
        (white, ["all over", "colo"]),
        (light("[1e12, 1e12, 1e12]"), ["", ""]),
    ] {
        folder.write("scene.toml", &text);
        let ran = render(&folder, &["scene.toml", "-o", "a.png"]).succeeds();
        match warnings(&ran).as_slice() {
            [line] => assert!(words.iter().all(|word| line.contains(word)), "{line}"),
            none => assert!(none.is_empty() && words[0].is_empty(), "{text}: {}", ran.stderr),
        }
        let ran = render(&folder, &["scene.toml", "-o", "a.exr"]).succeeds();
        assert!(!ran.stderr.contains("8 bits"), "{text}: {}", ran.stderr);
    }
    folder.write("scene.toml", &light("[3, 3, 3]"));
    let brighter = ["scene.toml", "-o", "a.png", "--exposure", "24", "--strict"];
    render(&folder, &brighter).succeeds();
}

/// No scene of the repository, and no file of the shared data, brings a warning that it shows nothing.
#[test]
fn no_scene_of_the_repository_is_called_empty() {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes");
    let mut scenes: Vec<_> = std::fs::read_dir(root)
        .expect("the scenes")
        .map(|entry| entry.expect("a scene").path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "toml"))
        .collect();
    scenes.sort();
    let mut checked = 0;
    for scene in &scenes {
        let scene = scene.to_str().expect("a name");
        let ran = run_in(root.as_ref(), &["check", scene]);
        if ran.code != Some(0) {
            crate::said(&format!("skipped {scene}: {}", ran.stderr.trim()));
            continue;
        }
        checked += 1;
        let signs = [
            "is not seen",
            "is black",
            "nothing is in the picture",
            "only the background",
            "lie on a surface",
            "encloses",
        ];
        for line in warnings(&ran) {
            assert!(signs.iter().all(|sign| !line.contains(sign)), "{scene}: {line}");
        }
    }
    assert!(checked >= 10, "{checked} scenes");
}
