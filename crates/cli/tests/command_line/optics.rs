//! What the program says of the glass that the eye is inside, and what files hold of pixels with several samples.

use crate::{Folder, ply, run_in, sphere};

const SMALL: [&str; 4] = ["--device", "reference", "--size", "32x24"];

/// A sheet that is no closed surface, and an eye among its waves.
fn lake(folder: &Folder, camera: &str) {
    let place = |i: u32| {
        let [x, z] = [f64::from(i % 40) / 20.0 - 1.0, f64::from(i / 40) / 20.0 - 1.0];
        format!("{x} {} {z}", 0.3 * (4.0 * x).sin() * (3.0 * z).cos())
    };
    let points: Vec<String> = (0..1600).map(place).collect();
    let points: Vec<&str> = points.iter().map(String::as_str).collect();
    folder.write("lake.ply", &ply(&points));
    folder.write("ball.ply", &sphere(200));
    folder.write(
        "lake.toml",
        &format!(
            "[camera]\neye = [0.0, 0.01, 0.0]\ntarget = [1.0, 0.0, 0.3]\n{camera}\n\
             [background]\ncolor = [1, 1, 1]\n\
             [[objects]]\npoints = \"lake.ply\"\nmaterial = {{ kind = \"glass\" }}\n\
             [[objects]]\npoints = \"ball.ply\"\ntransform.translate = [9, 0, 0]\n"
        ),
    );
}

fn rendered(folder: &Folder, more: &[&str]) -> crate::Ran {
    run_in(folder.path(), &[&["render", "lake.toml", "-o", "a.png"], &SMALL[..], more].concat())
}

/// In doubt there is a line that says what to do; where it is given, there is none.
#[test]
fn a_doubt_about_the_eye_is_said() {
    let folder = Folder::new();
    lake(&folder, "");
    let ran = rendered(&folder, &[]).succeeds();
    assert!(ran.stderr.contains("'lake'") && ran.stderr.contains("camera.inside"), "{ran:?}");
    for given in ["lake", "[\"lake\"]", "[]"] {
        let ran = rendered(&folder, &["--set", &format!("camera.inside={given}")]).succeeds();
        assert!(!ran.stderr.contains("camera.inside"), "{given}: {ran:?}");
    }
}

/// Names of nothing, and of what is no glass, are errors that say what there is.
#[test]
fn strange_names_of_glass_are_errors() {
    let folder = Folder::new();
    for (given, words) in [
        ("inside = \"pond\"", &["lake.toml:4", "camera.inside", "'pond'", "'lake'"][..]),
        ("inside = [\"lake\", \"ball\"]", &["camera.inside", "'ball'", "'lake'"]),
        ("inside = 3", &["camera.inside", "the name of an object of glass"]),
        ("inside = [1]", &["camera.inside"]),
    ] {
        lake(&folder, given);
        rendered(&folder, &[]).fails_with(2, words);
    }
}

/// What an EXR has beside colours is the same with any number of samples; and its colours are those that a render has
/// whose files hold nothing else.
#[test]
fn surfaces_in_files_do_not_depend_on_samples() {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(400));
    let render = |samples: &str, outputs: &[&str]| {
        let arguments = [&["render", "ball.ply", "--samples", samples], outputs, &SMALL[..]];
        run_in(folder.path(), &arguments.concat()).succeeds();
    };
    let all = ["--channels", "point,tests,cells,iterations,trust,fit"];
    render("1", &[&["-o", "one.exr"], &all[..]].concat());
    render("5", &[&["-o", "five.exr", "-o", "five.png"], &all[..]].concat());
    let named = "Z,P.X,P.Y,P.Z,N.X,N.Y,N.Z,object,point,tests,cells,iterations,trust,fit";
    let limits = ["--channels", named, "--max-abs", "0"];
    run_in(folder.path(), &[&["compare", "one.exr", "five.exr"], &limits[..]].concat()).succeeds();
    render("5", &["-o", "only.png"]);
    let [with, only] = ["five.png", "only.png"]
        .map(|name| std::fs::read(folder.path().join(name)).expect("a picture"));
    assert_eq!(with, only);
}
