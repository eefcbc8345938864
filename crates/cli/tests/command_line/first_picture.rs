//! The first picture of a point file: its quality, its exposure, and the ground below it.

use crate::{Folder, Ran, run_in, sphere};
use film::ExrPicture;

fn render(folder: &Folder, arguments: &[&str]) -> Ran {
    let more = ["--device", "reference", "--size", "64x48"];
    run_in(folder.path(), &[&["render"], arguments, &more[..]].concat()).succeeds()
}

fn exr(folder: &Folder, name: &str) -> ExrPicture {
    film::read_exr(&folder.path().join(name)).expect("an EXR")
}

fn bytes(folder: &Folder, name: &str) -> Vec<u8> {
    std::fs::read(folder.path().join(name)).expect("a picture")
}

fn header(folder: &Folder, name: &str, key: &str) -> Option<String> {
    film::exr_text(&folder.path().join(name), &format!("pointillist/{key}")).expect("an EXR")
}

/// Mean luminance of the pixels of a PNG that the EXR of the same picture says are covered by an object.
fn mean_in_png(folder: &Folder, png: &str, of: &ExrPicture, object: f32) -> f64 {
    let raster = film::read_raster(&folder.path().join(png)).expect("a PNG");
    let luminance = |pixel: &[f32; 4]| {
        let linear = |i: usize| film::linear_from_srgb(pixel[i].into());
        0.2126 * linear(0) + 0.7152 * linear(1) + 0.0722 * linear(2)
    };
    let covered = of.channels["object"].iter().zip(&of.channels["A"]);
    let own = raster.pixels.iter().zip(covered);
    let own = own.filter(|(_, (index, alpha))| **index == object && **alpha >= 0.5);
    let all: Vec<f64> = own.map(|(pixel, _)| luminance(pixel)).collect();
    all.iter().sum::<f64>() / all.len() as f64
}

/// A byte of sRGB near mid-grey is 0.003 of linear light wide, and its error averages out over a thousand pixels; the
/// exposure itself is rounded to 0.05 %. So 1 % is far outside of both.
#[test]
fn the_subject_of_a_point_file_is_mid_grey_in_eight_bits() {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(2000));
    let ran = render(&folder, &["ball.ply", "-o", "a.exr", "-o", "a.png"]);
    let stops = header(&folder, "a.exr", "exposure").expect("an exposure");
    assert!(ran.stderr.contains(&format!("exposed by {stops} stops")), "{}", ran.stderr);
    let mean = mean_in_png(&folder, "a.png", &exr(&folder, "a.exr"), 0.0);
    assert!((mean - 0.18).abs() < 0.0018, "{mean}");

    // The number can be typed, and another one wins; the EXR has the numbers as they are.
    render(&folder, &["ball.ply", "-o", "b.exr", "-o", "b.png", "--exposure", &stops]);
    assert!(bytes(&folder, "b.png") == bytes(&folder, "a.png"));
    assert!(bytes(&folder, "b.exr") == bytes(&folder, "a.exr"));
    render(&folder, &["ball.ply", "-o", "c.exr", "-o", "c.png", "--exposure", "0"]);
    assert!(exr(&folder, "c.exr").channels == exr(&folder, "a.exr").channels);
    assert!(bytes(&folder, "c.png") != bytes(&folder, "a.png"));
    assert_eq!(header(&folder, "c.exr", "exposure"), None);

    // A picture is rendered again as it was, and exposed so.
    render(&folder, &["a.exr", "-o", "d.exr", "-o", "d.png"]);
    assert!(bytes(&folder, "d.exr") == bytes(&folder, "a.exr"));
    assert!(bytes(&folder, "d.png") == bytes(&folder, "a.png"));
}

#[test]
fn a_scene_is_exposed_when_asked_and_what_is_unlit_never() {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(2000));
    let object = "[[objects]]\npoints = \"ball.ply\"\n";
    let light = "[[lights]]\nkind = \"headlight\"\nat_target = [0.1, 0.1, 0.1]\n";
    folder.write("scene.toml", &format!("{object}{light}"));
    folder.write("dark.toml", object);
    render(&folder, &["scene.toml", "-o", "plain.exr"]);
    assert_eq!(header(&folder, "plain.exr", "exposure"), None);
    render(&folder, &["scene.toml", "-o", "a.exr", "-o", "a.png", "--exposure", "auto"]);
    let mean = mean_in_png(&folder, "a.png", &exr(&folder, "a.exr"), 0.0);
    assert!((mean - 0.18).abs() < 0.0018, "{mean}");
    render(&folder, &["dark.toml", "-o", "dark.exr", "--exposure", "auto"]);
    assert_eq!(header(&folder, "dark.exr", "exposure"), None);
    for wrong in ["automatic", "nan", "101", ""] {
        let arguments = ["render", "ball.ply", "-o", "a.png", "--exposure", wrong];
        run_in(folder.path(), &arguments).fails_with(2, &["--exposure", "auto", "-100 to 100"]);
    }
}

#[test]
fn quality_is_samples_of_a_scene_and_gives_way() {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(200));
    folder.write("scene.toml", "image.samples = 3\n[[objects]]\npoints = \"ball.ply\"\n");
    let samples = |input: &str, options: &[&str]| {
        let size = ["--set", "image.size=[8, 6]", "--quiet", "--device", "reference"];
        let render = [&["render", input, "-o", "a.exr"], &size[..], options].concat();
        run_in(folder.path(), &render).succeeds();
        let scene = header(&folder, "a.exr", "scene").expect("a scene");
        let line = scene.lines().find(|line| line.starts_with("samples")).expect("samples");
        let integrator = scene.lines().find(|line| line.starts_with("integrator"));
        (line.to_owned(), integrator.unwrap_or_default().to_owned())
    };
    let of_scene = |options: &[&str]| samples("scene.toml", options).0;
    assert_eq!(of_scene(&[]), "samples = 3");
    for (quality, count) in [("draft", 1), ("good", 16), ("best", 256)] {
        assert_eq!(of_scene(&["--quality", quality]), format!("samples = {count}"));
        assert_eq!(of_scene(&["--quality", quality, "--samples", "2"]), "samples = 2");
        let set = ["--set", "image.samples=5", "--quality", quality];
        assert_eq!(of_scene(&set), "samples = 5");
    }
    let good = samples("ball.ply", &[]);
    assert_eq!(good, samples("ball.ply", &["--quality", "good"]));
    assert_eq!(good.1, "integrator = \"sky\"");
    let draft = ("samples = 1".to_owned(), "integrator = \"direct\"".to_owned());
    assert_eq!(samples("ball.ply", &["--quality", "draft"]), draft);
    let best = samples("ball.ply", &["--quality", "best", "--samples", "2"]);
    assert_eq!(best, ("samples = 2".to_owned(), "integrator = \"path\"".to_owned()));
}

/// What is seen of the subject is the same to the bit with a ground and without.
#[test]
fn a_ground_is_one_more_object_and_changes_no_framing() {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(2000));
    let object = "[[objects]]\npoints = \"ball.ply\"\n";
    let light = "[[lights]]\nkind = \"headlight\"\nat_target = [1, 1, 1]\n";
    folder.write("scene.toml", &format!("{object}{light}"));
    for (input, up) in [
        ("ball.ply", &[][..]),
        ("ball.ply", &["--up", "z"]),
        ("ball.ply", &["--view", "top", "--ortho"]),
        ("scene.toml", &[]),
    ] {
        let quality = ["--quality", "draft"];
        render(&folder, &[&[input, "-o", "a.exr", "-o", "a.png"], up, &quality[..]].concat());
        let ground = [up, &quality[..], &["--ground"]].concat();
        render(&folder, &[&[input, "-o", "b.exr", "-o", "b.png"], &ground[..]].concat());
        let (without, with) = (exr(&folder, "a.exr"), exr(&folder, "b.exr"));
        let mut seen = [0, 0];
        for (at, object) in without.channels["object"].iter().enumerate() {
            let own = with.channels["object"][at];
            assert!(if *object == 0.0 { own == 0.0 } else { [-1.0, 1.0].contains(&own) });
            seen[usize::from(own == 1.0)] += 1;
            for channel in ["Z", "P.X", "P.Y", "P.Z", "N.X", "N.Y", "N.Z"] {
                let values = [&without, &with].map(|of| of.channels[channel][at].to_bits());
                assert!(*object < 0.0 || values[0] == values[1], "{input}: {channel} at {at}");
            }
            // It is exactly plane, and faces the viewer.
            let normal = ["N.X", "N.Y", "N.Z"].map(|channel| with.channels[channel][at].abs());
            let is_axis = normal.iter().filter(|x| **x == 1.0).count() == 1;
            assert!(own != 1.0 || is_axis, "{normal:?}");
        }
        assert!(seen[0] > 300 && seen[1] > 300, "{input} {up:?}: {seen:?}");
        // Nor does it take part in the exposure; its shadow is none of the subject's.
        assert_eq!(header(&folder, "b.exr", "exposure"), header(&folder, "a.exr", "exposure"));
        render(&folder, &["b.exr", "-o", "c.exr", "-o", "c.png"]);
        assert!(bytes(&folder, "c.exr") == bytes(&folder, "b.exr"), "{input} {up:?}");
        assert!(bytes(&folder, "c.png") == bytes(&folder, "b.png"), "{input} {up:?}");
        // One ground is enough.
        render(&folder, &["b.exr", "--ground", "-o", "c.exr"]);
        assert!(exr(&folder, "c.exr").channels == with.channels, "{input} {up:?}");
    }
}

#[test]
fn a_ground_is_an_object_of_a_scene_with_values_of_its_own() {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(500));
    let object = "[[objects]]\npoints = \"ball.ply\"\n";
    let ground = "[[objects]]\npoints = \"@ground:-z\"\nmaterial.albedo = [0.1, 0.2, 0.3]\n";
    folder.write("scene.toml", &format!("{object}{ground}"));
    let ran = run_in(folder.path(), &["check", "scene.toml"]).succeeds();
    assert!(ran.stdout.contains("2 objects"), "{}", ran.stdout);
    run_in(folder.path(), &["info", "scene.toml"]).succeeds();
    folder.write("only-ground.toml", ground);
    run_in(folder.path(), &["check", "only-ground.toml"])
        .fails_with(2, &["only @ground", "add one"]);
    folder.write("axis.toml", &format!("{object}[[objects]]\npoints = \"@ground:w\"\n"));
    run_in(folder.path(), &["check", "axis.toml"])
        .fails_with(2, &["axis.toml:4", "@ground:w", "-z"]);
    // The ground of a point file is its second object.
    let set = ["--ground", "--set", "objects.1.material.albedo=[0.5, 0.1, 0.1]", "-o", "a.exr"];
    render(&folder, &[&["ball.ply", "--quality", "draft"], &set[..]].concat());
    let scene = header(&folder, "a.exr", "scene").expect("a scene");
    assert!(scene.contains("albedo = [0.5, 0.1, 0.1]"), "{scene}");
    assert!(scene.contains("points = \"ball.ply\"") && scene.contains("points = \"@ground:y\""));
    assert!(header(&folder, "a.exr", "points.1.sha256").is_none());
}
