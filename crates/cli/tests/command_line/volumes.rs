//! Point files without a scene: which of them are shown as spheres, and what colours points have.

use crate::{Folder, Ran, run_in};
use serde_json::Value;
use std::fmt::Write;

fn render(folder: &Folder, arguments: &[&str]) -> Ran {
    let small = ["render", "--device", "reference", "--size", "48x36", "-o", "a.png"];
    run_in(folder.path(), &[&small, arguments].concat())
}

/// The hash of a picture, and what was reported.
#[track_caller]
fn pixels(folder: &Folder, arguments: &[&str]) -> (String, String) {
    let ran = render(folder, &[arguments, &["--stats", "a.json"]].concat()).succeeds();
    let text = std::fs::read_to_string(folder.path().join("a.json")).expect("statistics");
    let stats: Value = serde_json::from_str(&text).expect("JSON");
    (stats["pixels"].to_string(), ran.stderr)
}

/// Ten nodes along each axis, half apart, with numbers of which the fourth is the first scalar.
fn lattice(others: &str) -> String {
    let mut text = "x,y,z,id,one,rho,p\n".to_owned();
    for i in 0..1000 {
        let [x, y, z] = [i % 10, i / 10 % 10, i / 100];
        writeln!(
            text,
            "{},{},{},{i},1,{},{y}",
            0.5 * f64::from(x),
            0.5 * f64::from(y),
            0.5 * f64::from(z),
            x * x
        )
        .expect("a string takes all");
    }
    text + others
}

/// Even points of a ball, of this intensity where it varies.
fn ball(intensity: impl Fn(u32) -> u32) -> String {
    let mut text = "x,y,z,intensity\n".to_owned();
    for i in 0..400 {
        let z = 1.0 - (2.0 * f64::from(i) + 1.0) / 400.0;
        let (sin, cos) = (2.399_963_229_728_653 * f64::from(i)).sin_cos();
        let radius = (1.0 - z * z).sqrt();
        writeln!(text, "{:.4},{:.4},{z:.4},{}", radius * cos, radius * sin, intensity(i))
            .expect("a string takes all");
    }
    text
}

/// As if the scene said so: radius and scalar are those of the documentation.
#[test]
fn what_fills_a_volume_is_shown_as_spheres_in_the_colors_of_its_first_scalar() {
    let folder = Folder::new();
    folder.write("grid.csv", &lattice(""));
    let (shown, said) = pixels(&folder, &["grid.csv"]);
    for words in [
        "grid.csv: the points fill a volume (the nodes of a grid of 10 x 10 x 10)",
        "shown as spheres, coloured by 'rho'",
        "--set objects.0.surface.kind=points",
    ] {
        assert!(said.contains(words), "{said}");
    }
    let spheres = [
        "grid.csv",
        "--set",
        "objects.0.surface={ kind = \"spheres\", radius = 0.25 }",
        "--set",
        "objects.0.material.albedo=attribute:rho",
    ];
    assert_eq!(shown, pixels(&folder, &spheres).0);
    let other = [&spheres[..], &["--set", "objects.0.surface.radius=0.24"]].concat();
    assert_ne!(shown, pixels(&folder, &other).0, "the radius shows");
    // A mode that is given wins, and so does a colour.
    let (surface, said) = pixels(&folder, &["grid.csv", "--set", "objects.0.surface.kind=points"]);
    assert!(!said.contains("fill a volume"), "{said}");
    assert_ne!(shown, surface);
    let (other, said) = pixels(&folder, &["grid.csv", "--color", "p"]);
    assert!(said.contains("shown as spheres, coloured by 'p'"), "{said}");
    assert_ne!(shown, other);
    // What the line proposes can be typed.
    let (_, said) = pixels(&folder, &["grid.csv"]);
    let volume = said.split("--set '").nth(1).and_then(|rest| rest.split('\'').next());
    let (volume, said) = pixels(&folder, &["grid.csv", "--set", volume.expect("an option")]);
    assert!(!said.contains("fill a volume"), "{said}");
    assert_ne!(shown, volume);
}

/// It lies off the box by less than the diagonal of that.
#[test]
fn a_droplet_is_a_sphere_too() {
    let folder = Folder::new();
    folder.write("without.csv", &lattice(""));
    folder.write("with.csv", &lattice("2.2,6.4,2.2,2000,1,0,0\n"));
    let fixed = ["--set", "objects.0.surface.kind=spheres"];
    let [(without, _), (with, _)] =
        ["without.csv", "with.csv"].map(|file| pixels(&folder, &[&[file], &fixed[..]].concat()));
    assert_ne!(without, with, "it is seen in the same view");
}

#[test]
fn info_has_what_points_fill() {
    let folder = Folder::new();
    folder.write("grid.csv", &lattice(""));
    folder.write("ball.csv", &ball(|i| i));
    let info = |arguments: &[&str]| {
        run_in(folder.path(), &[&["info"], arguments].concat()).succeeds().stdout
    };
    let text = info(&["grid.csv"]);
    assert!(text.contains("\nshape    a volume: the nodes of a grid of 10 x 10 x 10\n"), "{text}");
    let json: Value = serde_json::from_str(&info(&["grid.csv", "--json"])).expect("JSON");
    assert_eq!(json["shape"]["volume"], true);
    assert!(info(&["ball.csv"]).contains("\nshape    a surface\n"));
}

#[test]
fn points_without_colors_are_shown_by_their_intensity() {
    let folder = Folder::new();
    folder.write("ball.csv", &ball(|i| i));
    let (shown, said) = pixels(&folder, &["ball.csv"]);
    let line =
        "ball.csv: the points have no colours and are shown in grey by 'intensity', white from 391";
    assert!(said.contains(line), "{said}");
    let gray = [
        "ball.csv",
        "--set",
        "objects.0.material={ albedo = \"attribute:intensity\", color_map = \"gray\", value_range = [-183.5, 391] }",
    ];
    assert_eq!(shown, pixels(&folder, &gray).0);
    assert_eq!(shown, pixels(&folder, &["ball.csv", "--color", "intensity"]).0);
    let (plain, said) =
        pixels(&folder, &["ball.csv", "--set", "objects.0.material.albedo=[0.8, 0.8, 0.8]"]);
    assert!(!said.contains("intensity"), "{said}");
    // One intensity says nothing.
    folder.write("same.csv", &ball(|_| 7));
    let (same, said) = pixels(&folder, &["same.csv"]);
    assert!(!said.contains("shown in grey"), "{said}");
    assert_eq!(same, plain);
    render(&folder, &["same.csv", "--color", "intensity"])
        .fails_with(2, &["all intensities are the same"]);
}

/// From the 0.5th to the 99.5th percentile: the third and the 398th of 400.
#[test]
fn height_is_along_the_axis_that_is_up() {
    let folder = Folder::new();
    folder.write("ball.csv", &ball(|i| i));
    let by_height = |up: &str| pixels(&folder, &["ball.csv", "--color", "height", "--up", up]).0;
    let by_axis = |up: &str, axis: &str, range: &str| {
        let material = format!(
            "objects.0.material={{ albedo = \"attribute:{axis}\", value_range = {range} }}"
        );
        pixels(&folder, &["ball.csv", "--up", up, "--set", &material]).0
    };
    assert_eq!(by_height("z"), by_axis("z", "z", "[-0.9875, 0.9875]"));
    let mut heights: Vec<f64> = ball(|i| i)
        .lines()
        .skip(1)
        .filter_map(|line| line.split(',').nth(1)?.parse().ok())
        .collect();
    heights.sort_by(f64::total_cmp);
    let [low, high] = [heights[2], heights[397]];
    assert_eq!(by_height("y"), by_axis("y", "y", &format!("[{low}, {high}]")));
    assert_eq!(by_height("-y"), by_axis("-y", "y", &format!("[{high}, {low}]")));
}

#[test]
fn colors_that_are_not_there_are_named() {
    let folder = Folder::new();
    folder.write("ball.csv", &ball(|i| i));
    folder.write("scene.toml", "[[objects]]\npoints = \"ball.csv\"\n");
    render(&folder, &["ball.csv", "--color", "rho"]).fails_with(
        2,
        &[
            "ball.csv: --color rho: the points have no such attribute",
            "height, x, y, z",
            "intensity",
        ],
    );
    render(&folder, &["ball.csv", "--color", "points"])
        .fails_with(2, &["--color points: the points have no colours"]);
    render(&folder, &["scene.toml", "--color", "height"])
        .fails_with(2, &["--color is for point files", "material.albedo"]);
}
