//! What the program says of what it chose, and what colours mean: `--verbose`, `--stats`, the header, `--legend`.

use crate::{Folder, Ran, run_in, sphere};
use serde_json::Value;

const SCENE: &str = "image.size = [32, 24]\n[[objects]]\nname = \"ball\"\npoints = \"ball.ply\"\n\
                     material = { albedo = \"attribute:z\", color_map = \"magma\" }\n\
                     surface = { kind = \"spheres\" }\n";

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(300));
    folder.write("s.toml", SCENE);
    folder
}

fn render(folder: &Folder, arguments: &[&str]) -> Ran {
    run_in(folder.path(), &[&["render", "--device", "reference"], arguments].concat())
}

#[test]
fn what_was_chosen_is_the_same_on_stderr_in_the_statistics_and_in_the_header() {
    let folder = folder();
    let ran =
        render(&folder, &["s.toml", "-o", "a.exr", "--stats", "a.json", "--verbose"]).succeeds();
    let text = std::fs::read_to_string(folder.path().join("a.json")).expect("statistics");
    let row: Value = serde_json::from_str(&text).expect("one JSON object");
    let exr = film::read_exr(&folder.path().join("a.exr")).expect("an EXR");
    let header: Vec<&str> = exr.strings["pointillist/chosen"].lines().collect();
    let chosen = row["chosen"].as_array().expect("a list");
    assert_eq!((chosen.len(), header.len()), (2, 2), "{chosen:?} {header:?}");
    for (one, line) in chosen.iter().zip(&header) {
        assert_eq!(one["object"], "ball");
        let key = one["key"].as_str().expect("a key");
        let (path, value) = line.split_once('=').expect("PATH=VALUE");
        assert_eq!(path, format!("objects.0.{key}"));
        let same: Value = serde_json::from_str(value).expect("a number or two");
        assert_eq!(same, one["value"]);
        assert!(ran.stderr.contains(&format!("object 'ball': {key} = {value}")), "{}", ran.stderr);
    }
    // Given, they make the same picture.
    let mut given = vec!["s.toml", "-o", "b.exr"];
    header.iter().for_each(|line| given.extend(["--set", line]));
    let quiet = render(&folder, &given).succeeds();
    assert!(!quiet.stderr.contains("value_range"), "{}", quiet.stderr);
    let again = film::read_exr(&folder.path().join("b.exr")).expect("an EXR");
    assert!(!again.strings.contains_key("pointillist/chosen"));
    assert_eq!(exr.channels, again.channels);
    render(&folder, &["s.toml", "-o", "a.png", "--quiet", "--verbose"])
        .fails_with(2, &["--verbose"]);
}

#[test]
fn world_positions_are_six_channels_that_add_up() {
    let folder = folder();
    let far = "objects.0.transform.translate=[400000.125, 5000000.25, 0]";
    render(&folder, &["s.toml", "-o", "a.exr", "--set", far, "--channels", "world,fit"]).succeeds();
    let exr = film::read_exr(&folder.path().join("a.exr")).expect("an EXR");
    let origin: Vec<f64> = exr.strings["pointillist/origin"]
        .split(' ')
        .map(|x| x.parse().expect("a number"))
        .collect();
    assert!(origin[1] > 4.9e6, "{origin:?}");
    let hits = exr.channels["object"].iter().filter(|object| **object >= 0.0).count();
    assert!(hits > 50, "{hits}");
    for (axis, name) in ["X", "Y", "Z"].into_iter().enumerate() {
        let plane = |layer: &str| &exr.channels[&format!("{layer}.{name}")];
        for (at, object) in exr.channels["object"].iter().enumerate() {
            let of = |layer: &str| f64::from(plane(layer)[at]);
            let world = of("world") + of("worldLow");
            let expected = if *object < 0.0 { 0.0 } else { of("P") + origin[axis] };
            assert!((world - expected).abs() < 1e-6, "{name} of pixel {at}: {world}, {expected}");
        }
    }
    assert!(exr.channels.contains_key("fit"));
}

#[test]
fn a_legend_is_a_picture_of_its_own() {
    let folder = folder();
    render(&folder, &["s.toml", "-o", "a.png", "--legend", "l.png"]).succeeds();
    let legend = film::read_image(&folder.path().join("l.png")).expect("a picture");
    assert!(legend.width >= 60 && legend.height > 360, "{}x{}", legend.width, legend.height);
    let two = format!(
        "{SCENE}[[objects]]\nname = \"fog\"\npoints = \"ball.ply\"\n\
                       volume = {{ scalar = \"z\", color_map = \"gray\", extinction = 1 }}\n"
    );
    folder.write("two.toml", &two);
    render(&folder, &["two.toml", "-o", "a.png", "--legend", "m.png"]).succeeds();
    let both = film::read_image(&folder.path().join("m.png")).expect("a picture");
    assert!(both.width > legend.width, "a bar for each");
}

#[test]
fn a_legend_of_nothing_and_of_another_format_are_errors() {
    let folder = folder();
    let before = folder.names();
    render(&folder, &["s.toml", "-o", "a.png", "--legend", "l.jpg"])
        .fails_with(2, &["--legend l.jpg", ".png"]);
    render(&folder, &["s.toml", "-o", "a.png", "--legend", "a.png"]).fails_with(2, &["a.png"]);
    render(&folder, &["ball.ply", "-o", "a.png", "--legend", "l.png"])
        .fails_with(2, &["--legend", "attribute:NAME"]);
    assert_eq!(folder.names(), before, "nothing is written");
}

/// What only glows has the colours of its emission in its legend, the brightest channel of which is 1.
#[test]
fn a_legend_of_what_glows_shows_its_emission() {
    let folder = folder();
    let stops = "[{ value = 0, emission = [0, 4, 0] }, { value = 1, emission = [2, 0, 0] }]";
    let scene = format!(
        "image.size = [8, 6]\n[[objects]]\npoints = \"ball.ply\"\nvolume = {{ scalar = \"z\", transfer = {stops} }}\n"
    );
    folder.write("glow.toml", &scene);
    render(&folder, &["glow.toml", "-o", "a.png", "--legend", "l.png"]).succeeds();
    let legend = film::read_image(&folder.path().join("l.png")).expect("a picture");
    let film::Texels::Srgb8(texels) = &legend.texels else { panic!("sRGB") };
    assert!(texels.contains(&[0, 255, 0]), "the lower end is green");
    // 2 of 4 is 188 in sRGB.
    assert!(texels.contains(&[188, 0, 0]), "the upper end is red");
}
