//! Points in degrees: the notes about them, and that their picture is that of the same land in metres.

use crate::{Folder, run_in};
use std::fmt::Write;

const SMALL: [&str; 4] = ["--device", "reference", "--size", "64x48"];
/// Metres a degree at 46° north: M and N of WGS84, from their closed forms.
const NORTH: f64 = 111_151.3;
const EAST: f64 = 77_463.0;

/// 1 km of hills of 60 m about 7.5° E, 46° N, with these numbers for each (east, north, height) in metres.
fn hills(header: &str, numbers: impl Fn(f64, f64, f64) -> [f64; 3]) -> String {
    let mut text = format!("{header}\n");
    for i in 0..50 * 50 {
        let (x, y) = (f64::from(i % 50) * 20.0 - 490.0, f64::from(i / 50) * 20.0 - 490.0);
        let [x, y, z] = numbers(x, y, 500.0 + 30.0 * (x / 90.0).sin() * (y / 120.0).cos());
        let _ = writeln!(text, "{x:.9},{y:.9},{z:.3}");
    }
    text
}

fn degrees(header: &str) -> String {
    hills(header, |x, y, z| [7.5 + x / EAST, 46.0 + y / NORTH, z])
}

#[test]
fn hills_in_degrees_look_like_those_in_metres() {
    let folder = Folder::new();
    folder.write("named.csv", &degrees("lon,lat,height"));
    folder.write("bare.csv", &degrees("x,y,z"));
    folder.write("metres.csv", &hills("x,y,z", |x, y, z| [x, y, z]));
    let render = |arguments: &[&str]| {
        run_in(folder.path(), &[&["render"], arguments, &SMALL].concat()).succeeds()
    };
    let said = render(&["named.csv", "-o", "named.exr"]).stderr;
    for words in [
        "its columns are named lon and lat",
        "objects.0.units=scene",
        "longitude 7.5, latitude 46",
        "+proj=aeqd +lat_0=46 +lon_0=7.5 +ellps=WGS84 +units=m",
    ] {
        assert!(said.contains(words), "'{words}' is not in {said}");
    }
    let said = render(&["metres.csv", "-o", "metres.exr", "--up", "z"]).stderr;
    assert!(!said.contains("degrees"), "{said}");
    // Within 500 m, the plane of the closed forms is 2 cm off: a thousandth of the spacing.
    let limits = ["compare", "named.exr", "metres.exr", "--channels", "R,G,B", "--rmse", "0.01"];
    run_in(folder.path(), &limits).succeeds();
    let said = render(&["bare.csv", "-o", "bare.exr", "--set", "objects.0.units=degrees"]).stderr;
    assert!(!said.contains("look like"), "{said}");
    run_in(folder.path(), &["compare", "named.exr", "bare.exr", "--max-abs", "0"]).succeeds();
    let strings = film::read_exr(&folder.path().join("named.exr")).expect("an EXR").strings;
    assert_eq!(
        strings["pointillist/projection"],
        "+proj=aeqd +lat_0=46 +lon_0=7.5 +ellps=WGS84 +units=m"
    );
}

#[test]
fn numbers_that_look_like_degrees_are_left_and_said_to_be() {
    let folder = Folder::new();
    folder.write("bare.csv", &degrees("x,y,z"));
    let checked = run_in(folder.path(), &["check", "bare.csv"]).succeeds();
    assert!(
        checked.stderr.contains("warning: bare.csv: x and y look like longitude"),
        "{checked:?}"
    );
    assert!(checked.stderr.contains("objects.0.units=degrees"), "{checked:?}");
    let info = run_in(folder.path(), &["info", "bare.csv"]).succeeds();
    assert!(info.stdout.contains("note     x and y look like longitude"), "{info:?}");
    let set = ["check", "bare.csv", "--set", "objects.0.units=scene"];
    assert_eq!(run_in(folder.path(), &set).succeeds().stderr, "");
}

#[test]
fn objects_in_degrees_line_up_and_their_transforms_come_after() {
    let folder = Folder::new();
    folder.write("a.csv", &degrees("lon,lat,height"));
    let east = degrees("lon,lat,height").replace("7.49", "7.59").replace("7.50", "7.60");
    folder.write("b.csv", &east);
    let scene = "[[objects]]\npoints = 'a.csv'\n[[objects]]\npoints = 'b.csv'\ntransform.translate = [0, 0, 1000]\n";
    folder.write("s.toml", scene);
    let info = run_in(folder.path(), &["info", "s.toml", "--json"]).succeeds();
    assert!(info.stdout.contains("+proj=aeqd +lat_0=46 +lon_0=7.55"), "{}", info.stdout);
    let json: serde_json::Value = serde_json::from_str(&info.stdout).expect("JSON");
    let bound =
        |corner: &str, axis: usize| json["bounds"][corner][axis].as_f64().expect("a number");
    // A tenth of a degree apart, and a kilometre wide.
    let width = bound("max", 0) - bound("min", 0);
    assert!((width - 0.1 * EAST - 980.0).abs() < 3.0, "{width}");
    assert!(bound("max", 2) > 1500.0 && bound("min", 2) < 500.0, "{json}");
    // What the file has stays in its own units.
    let points = &json["objects"][0]["points"];
    assert_eq!(points["units"], "degrees");
    assert!(points["bounds"]["max"][0].as_f64().is_some_and(|x| x < 8.0), "{points}");
}

#[test]
fn a_latitude_beyond_the_poles_is_an_error_and_a_filter_leaves_it_out() {
    let folder = Folder::new();
    folder.write("a.csv", &format!("{}7.5,-9999,0\n", degrees("lon,lat,height")));
    let words = ["point 2500 of a.csv has longitude 7.5 and latitude -9999", "y = [-90, 90]"];
    run_in(folder.path(), &["check", "a.csv"]).fails_with(2, &words);
    let filter = "objects.0.filter.range={ x = [-180, 360], y = [-90, 90] }";
    run_in(folder.path(), &["check", "a.csv", "--set", filter]).succeeds();
    folder.write("b.csv", &hills("lat,lon,z", |x, y, z| [117.0 + x / EAST, 46.0 + y / NORTH, z]));
    run_in(folder.path(), &["check", "b.csv"]).fails_with(2, &["latitude 116.9", "look swapped"]);
    folder.write("c.csv", &hills("x,y,z", |x, y, z| [46.0 + x / EAST, 117.0 + y / NORTH, z]));
    let set = ["check", "c.csv", "--set", "objects.0.units=degrees"];
    run_in(folder.path(), &set).fails_with(2, &["look swapped"]);
}

/// A receiver without a fix writes zeros: the centre, the view and the filter that is named stay those of the rest,
/// and the filter is in degrees.
#[test]
fn one_zero_does_not_move_the_rest() {
    let folder = Folder::new();
    folder.write("a.csv", &format!("{}0,0,0\n", degrees("lon,lat,height")));
    let said = run_in(folder.path(), &["check", "a.csv"]).succeeds().stderr;
    assert!(said.contains("+lat_0=46 +lon_0=7.5 "), "{said}");
    let filter = said.split("--set '").nth(1).and_then(|rest| rest.split('\'').next());
    let filter = filter.unwrap_or_else(|| panic!("no filter in {said}"));
    assert!(filter.contains("min = [7.49"), "{filter}");
    let said = run_in(folder.path(), &["check", "a.csv", "--set", filter]).succeeds().stderr;
    assert!(said.contains("kept 2500 of 2501 points"), "{said}");
}
