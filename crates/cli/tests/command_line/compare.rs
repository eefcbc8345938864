//! `compare`: what it finds, what it lets pass, and how it ends.

use crate::{Folder, Ran, run_in};
use serde_json::{Value, json};
use std::path::Path;

const SIZE: [u32; 2] = [16, 12];

/// A channel's name, and its value at column and row.
type Plane<'a> = (&'a str, &'a dyn Fn(u32, u32) -> f32);

/// An EXR of these planes, each a function of column and row, over a part of 16 x 12 pixels.
fn exr(folder: &Folder, name: &str, window: [u32; 4], planes: &[Plane<'_>]) {
    let [x, y, width, height] = window;
    let places = || (y..y + height).flat_map(|row| (x..x + width).map(move |column| (column, row)));
    let planes = planes
        .iter()
        .map(|(name, value)| ((*name).to_owned(), places().map(|(x, y)| value(x, y)).collect()));
    let path = folder.path().join(name);
    film::write_planes(SIZE, [x as i32, y as i32], [width, height], planes.collect(), &path)
        .expect("a written file");
}

const WHOLE: [u32; 4] = [0, 0, 16, 12];

fn red(x: u32, y: u32) -> f32 {
    0.25 + 0.03 * x as f32 + 0.01 * y as f32
}

fn green(x: u32, _: u32) -> f32 {
    0.5 + 0.01 * x as f32
}

fn blue(_: u32, y: u32) -> f32 {
    0.75 - 0.02 * y as f32
}

/// Distance, infinite in the first column.
fn depth(x: u32, y: u32) -> f32 {
    if x == 0 { f32::INFINITY } else { 2.0 + y as f32 }
}

/// `name` with R, G, B and Z; R is 0.125 more at column 5, row 7 if `changed`.
fn picture(folder: &Folder, name: &str, changed: bool) {
    let bump = |x: u32, y: u32| if changed && (x, y) == (5, 7) { 0.125 } else { 0.0 };
    let red = |x: u32, y: u32| red(x, y) + bump(x, y);
    exr(folder, name, WHOLE, &[("R", &red), ("G", &green), ("B", &blue), ("Z", &depth)]);
}

/// A folder with a.exr, its copy, and one with a changed pixel.
fn pictures() -> Folder {
    let folder = Folder::new();
    picture(&folder, "a.exr", false);
    picture(&folder, "same.exr", false);
    picture(&folder, "changed.exr", true);
    folder
}

fn compare(folder: &Folder, arguments: &[&str]) -> Ran {
    run_in(folder.path(), &[&["compare"], arguments].concat())
}

/// Exit code and the one object on stdout.
fn compared(folder: &Folder, arguments: &[&str]) -> (i32, Value) {
    let ran = compare(folder, &[arguments, &["--json"]].concat());
    assert_eq!(ran.stderr, "", "{ran:?}");
    let value = serde_json::from_str(&ran.stdout).expect("one JSON object");
    (ran.code.expect("a code"), value)
}

fn float(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("expected a number, found {value}"))
}

#[test]
fn json_has_what_others_rely_on() {
    let folder = pictures();
    let (code, found) = compared(&folder, &["a.exr", "changed.exr"]);
    assert_eq!(code, 0, "no limit, no fault");
    assert_eq!(found["pass"], true);
    let names: Vec<&String> = found["channels"].as_object().expect("an object").keys().collect();
    assert_eq!(names, ["B", "G", "R", "Z"]);
    let r = &found["channels"]["R"];
    assert_eq!(r["max_abs"], 0.125);
    // One pixel of 192, and f32 rounds the sum of red and the difference.
    assert!((float(&r["mean"]) - 0.125 / 192.0).abs() < 1e-9, "{r}");
    assert!((float(&r["rmse"]) - 0.125 / 192f64.sqrt()).abs() < 1e-9, "{r}");
    let psnr = 20.0 * (192f64.sqrt() / 0.125).log10();
    assert!((float(&r["psnr"]) - psnr).abs() < 1e-6, "the peak is 1: {r}");
    let was = f64::from(red(5, 7));
    assert_eq!(r["worst"], json!([5, 7, was, was + 0.125]));
    assert_eq!((&r["differing"], &r["nan"], &r["values"]), (&json!(1), &json!(0), &json!(192)));
    assert_eq!(r["percentiles"], json!({ "50": 0.0, "95": 0.0, "99": 0.0 }));
    assert_eq!(r["region"], json!([0, 0, 16, 12]));
    assert_eq!(found["channels"]["G"]["psnr"], "Infinity", "equal planes");
    assert_eq!(found["layers"]["RGBA"]["worst_channel"], "R");
    assert_eq!(found["layers"]["RGBA"]["max_abs"], 0.125);
    let flip = float(&found["flip"]);
    assert!(flip > 0.0 && flip < 0.1, "{flip}");
    assert_eq!(found["flip_details"]["kind"], "hdr");
    assert!(float(&found["flip_details"]["ldr"]["mean"]) > 0.0);
    assert_eq!(found["size"], json!(SIZE));
    assert_eq!((&found["a"], &found["b"]), (&json!("a.exr"), &json!("changed.exr")));
}

#[test]
fn a_changed_pixel_is_caught_by_every_limit_and_named() {
    let folder = pictures();
    for (limit, value) in
        [("--max-abs", "0.1"), ("--max-abs", "0"), ("--rmse", "0.009"), ("--flip", "1e-4")]
    {
        let ran = compare(&folder, &["a.exr", "changed.exr", limit, value]);
        assert_eq!(ran.code, Some(1), "{limit} {value}: {ran:?}");
        assert_eq!(ran.stderr, "");
        assert!(ran.stdout.contains("fail") && ran.stdout.contains(limit), "{}", ran.stdout);
        let (code, found) = compared(&folder, &["a.exr", "changed.exr", limit, value]);
        assert_eq!((code, &found["pass"]), (1, &json!(false)));
        assert_eq!(found["over"].as_array().map(Vec::len), Some(1), "{found}");
        let equal = compare(&folder, &["a.exr", "same.exr", limit, value]).succeeds();
        assert!(equal.stdout.contains("result   pass\n"), "{}", equal.stdout);
    }
    let ran = compare(&folder, &["a.exr", "changed.exr", "--max-abs", "0.1"]);
    assert!(ran.stdout.contains("R: the largest difference 0.125 is over"), "{}", ran.stdout);
    assert!(ran.stdout.contains("first at 5,7"), "{}", ran.stdout);
    // A limit is what may be reached.
    let at_limits = ["--max-abs", "0.125", "--rmse", "0.0091", "--flip", "1"];
    compare(&folder, &[&["a.exr", "changed.exr"][..], &at_limits].concat()).succeeds();
}

#[test]
fn limits_are_of_the_channels_that_are_named() {
    let folder = pictures();
    let with = |channels: &str| {
        compare(&folder, &["a.exr", "changed.exr", "--max-abs", "0", "--channels", channels]).code
    };
    for (channels, code) in [("G,B,Z", 0), ("R", 1), ("RGB", 1), ("Z", 0), ("Z,R", 1), ("RGBA", 1)]
    {
        assert_eq!(with(channels), Some(code), "{channels}");
    }
    compare(&folder, &["a.exr", "changed.exr", "--channels", "Z,tests"])
        .fails_with(2, &["a.exr", "--channels tests", "in neither file", "R, G, B, Z"]);
    compare(&folder, &["a.exr", "same.exr", "--channels", "Z", "--flip", "1"])
        .fails_with(2, &["--flip needs the channels R, G and B", "found Z"]);
    let (_, found) = compared(&folder, &["a.exr", "same.exr", "--channels", "Z"]);
    assert_eq!((&found["flip"], &found["flip_details"]), (&Value::Null, &Value::Null));
}

#[test]
fn infinities_and_nan_have_their_answers() {
    let folder = pictures();
    let z = |name: &str, at: f32| {
        let value = move |x: u32, y: u32| if (x, y) == (3, 2) { at } else { depth(x, y) };
        exr(&folder, name, WHOLE, &[("Z", &value)]);
    };
    z("nan.exr", f32::NAN);
    z("inf.exr", f32::INFINITY);
    z("minus.exr", f32::NEG_INFINITY);
    z("number.exr", 4.0);
    let limit = ["--max-abs", "1e30"];
    let code = |a: &str, b: &str| compare(&folder, &[&[a, b][..], &limit].concat()).code;
    for same in ["nan.exr", "inf.exr", "minus.exr"] {
        assert_eq!(code(same, same), Some(0), "{same} is itself");
        let (_, found) = compared(&folder, &[same, same, "--max-abs", "0"]);
        assert_eq!(found["channels"]["Z"]["max_abs"], 0.0);
        for other in ["number.exr", "nan.exr", "inf.exr", "minus.exr"] {
            assert_eq!(code(same, other), Some(i32::from(same != other)), "{same} {other}");
            assert_eq!(code(other, same), Some(i32::from(same != other)), "{other} {same}");
        }
    }
    let (code, found) = compared(&folder, &["nan.exr", "number.exr", "--rmse", "1e30"]);
    let z = &found["channels"]["Z"];
    assert_eq!((code, &z["max_abs"], &z["psnr"]), (1, &json!("Infinity"), &json!("-Infinity")));
    assert_eq!((&z["worst"], &z["nan"]), (&json!([3, 2, "NaN", 4.0]), &json!(1)));
    assert_eq!(z["percentiles"]["99"], 0.0);
    let ran = compare(&folder, &["nan.exr", "number.exr", "--rmse", "1e30"]);
    assert!(ran.stdout.contains("Z: 1 pixel is NaN in only one of the files"), "{}", ran.stdout);
    // Without a limit, that is told and no fault.
    compare(&folder, &["nan.exr", "number.exr"]).succeeds();
}

/// Over any limit: also over one of FLIP, which clamps and would not see it in Z.
#[test]
fn nan_against_a_number_is_over_a_limit_of_flip_too() {
    let folder = pictures();
    let z = |x: u32, y: u32| if (x, y) == (3, 2) { f32::NAN } else { depth(x, y) };
    exr(&folder, "nan.exr", WHOLE, &[("R", &red), ("G", &green), ("B", &blue), ("Z", &z)]);
    assert_eq!(compare(&folder, &["a.exr", "nan.exr", "--flip", "1"]).code, Some(1));
}

#[test]
fn a_crop_is_compared_with_the_same_part_of_the_whole() {
    let folder = pictures();
    let planes: [Plane<'_>; 2] = [("R", &red), ("Z", &depth)];
    exr(&folder, "crop.exr", [4, 6, 5, 3], &planes);
    exr(&folder, "other.exr", [0, 0, 4, 12], &planes);
    let (code, found) = compared(&folder, &["a.exr", "crop.exr", "--max-abs", "0"]);
    assert_eq!((code, &found["channels"]["R"]["region"]), (0, &json!([4, 6, 5, 3])));
    assert_eq!(found["only_a"], json!(["B", "G"]));
    let (code, found) = compared(&folder, &["crop.exr", "changed.exr", "--max-abs", "0"]);
    assert_eq!(code, 1);
    let worst = &found["channels"]["R"]["worst"];
    assert_eq!((&worst[0], &worst[1]), (&json!(5), &json!(7)), "of the whole picture: {found}");
    let text = compare(&folder, &["a.exr", "crop.exr"]).succeeds().stdout;
    assert!(text.contains("compared 5x3 at 4,6"), "{text}");
    assert!(text.contains("only a   B, G: not compared"), "{text}");
    compare(&folder, &["crop.exr", "other.exr"])
        .fails_with(2, &["crop.exr and other.exr", "'R'", "5x3 at 4,6", "4x12 at 0,0"]);
}

#[test]
fn files_that_cannot_be_compared_are_2_and_say_why() {
    let folder = pictures();
    folder.write("text.exr", "no picture");
    std::fs::create_dir(folder.path().join("folder.exr")).expect("a folder");
    let whole = std::fs::read(folder.path().join("a.exr")).expect("a picture");
    for (name, length) in [("cut.exr", whole.len() - 9), ("header.exr", 100)] {
        std::fs::write(folder.path().join(name), &whole[..length]).expect("a written file");
    }
    film::write_planes(
        [16, 13],
        [0, 0],
        [1, 1],
        vec![("R".to_owned(), vec![0.0])],
        &folder.path().join("tall.exr"),
    )
    .expect("a written file");
    exr(&folder, "P.exr", WHOLE, &[("P.X", &red)]);
    for (name, words) in [
        ("none.exr", &["none.exr", "cannot read the file", "check its name"][..]),
        ("text.exr", &["text.exr", "expected an image", "found none of these"]),
        ("folder.exr", &["folder.exr", "found a folder"]),
        ("cut.exr", &["cut.exr", "cut off", "export it again"]),
        ("header.exr", &["header.exr", "ends within its header"]),
        ("tall.exr", &["tall.exr", "16x12", "16x13", "equal sizes"]),
        ("P.exr", &["P.exr", "no channel that both have", "P.X", "B, G, R, Z"]),
    ] {
        compare(&folder, &["a.exr", name, "--max-abs", "1"]).fails_with(2, words);
        compare(&folder, &[name, "a.exr", "--json"]).fails_with(2, words);
    }
    for arguments in [
        &["a.exr"][..],
        &["a.exr", "a.exr", "a.exr"],
        &["a.exr", "a.exr", "--max-abs", "-1"],
        &["a.exr", "a.exr", "--rmse", "nan"],
        &["a.exr", "a.exr", "--flip", "inf"],
        &["a.exr", "a.exr", "--flip", "1", "--no-flip"],
    ] {
        compare(&folder, arguments).fails_with(2, &[]);
    }
}

fn png(folder: &Folder, name: &str, color: impl Fn(u32, u32) -> [u8; 3]) {
    let [width, height] = SIZE;
    let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let pixels: Vec<[u8; 3]> = places.map(|(x, y)| color(x, y)).collect();
    film::write_png(SIZE, &pixels, &folder.path().join(name)).expect("a written file");
}

#[test]
fn bytes_are_compared_as_stored_and_against_an_exr_in_linear_light() {
    let folder = pictures();
    png(&folder, "a.png", |x, y| [100, x as u8, y as u8]);
    png(&folder, "b.png", |x, y| [if (x, y) == (9, 4) { 101 } else { 100 }, x as u8, y as u8]);
    let (code, found) = compared(&folder, &["a.png", "b.png", "--max-abs", "0.0039"]);
    let worst = float(&found["channels"]["R"]["max_abs"]);
    assert_eq!((code, &found["encoding"]), (1, &json!("srgb")));
    assert!((worst - 1.0 / 255.0).abs() < 1e-7, "f32 holds the values: {worst}");
    assert_eq!(found["flip_details"]["kind"], "ldr");

    let encoded = |value: f32| film::srgb_byte(value);
    png(&folder, "exr.png", |x, y| [encoded(red(x, y)), encoded(green(x, y)), encoded(blue(x, y))]);
    let (code, found) = compared(&folder, &["a.exr", "exr.png", "--max-abs", "0.005"]);
    assert_eq!((code, &found["encoding"], &found["only_a"]), (0, &json!("linear"), &json!(["Z"])));
    // Half a byte, where the curve is steepest: 1 in sRGB is 2.27 in linear light, over 510.
    assert!(float(&found["channels"]["R"]["max_abs"]) < 2.28 / 510.0, "{found}");
    assert!(float(&found["channels"]["R"]["max_abs"]) > 1e-4, "a byte rounds: {found}");
    assert_eq!(found["flip_details"]["kind"], "ldr");
    compare(&folder, &["a.exr", "exr.png", "--headers"]).fails_with(2, &["exr.png", "--headers"]);
}

#[test]
fn differences_are_written_as_false_colors_and_as_numbers() {
    let folder = pictures();
    let diffs = ["--diff", "d.png", "--diff", "d.exr"];
    let ran = compare(&folder, &[&["a.exr", "changed.exr"][..], &diffs].concat()).succeeds();
    assert!(ran.stderr.contains("d.png: the largest difference of R, G, B"), "{}", ran.stderr);
    assert!(ran.stderr.contains("pale yellow 0.125 and more"), "{}", ran.stderr);
    let colors = film::read_raster(&folder.path().join("d.png")).expect("a PNG");
    assert_eq!(colors.size, SIZE);
    let bright = |pixel: &[f32; 4]| pixel[..3].iter().sum::<f32>() > 2.0;
    let lit: Vec<usize> =
        (0..colors.pixels.len()).filter(|&at| bright(&colors.pixels[at])).collect();
    assert_eq!(lit, [7 * 16 + 5]);
    let numbers = film::read_exr(&folder.path().join("d.exr")).expect("an EXR");
    let names: Vec<&String> = numbers.channels.keys().collect();
    assert_eq!(names, ["B", "G", "R", "Z", "flip"]);
    assert_eq!(numbers.channels["R"][7 * 16 + 5], 0.125);
    assert!(numbers.channels["Z"].iter().all(|d| *d == 0.0), "equal infinities differ by 0");
    assert!(numbers.channels["flip"][7 * 16 + 5] > 0.0);

    let written = folder.names();
    for (diff, words) in [
        ("d.jpg", &["d.jpg", "'.png' or '.exr'"][..]),
        ("nowhere/d.png", &["nowhere/d.png"]),
        ("a.exr", &["a.exr", "also an input"]),
    ] {
        compare(&folder, &["a.exr", "changed.exr", "--diff", diff]).fails_with(2, words);
    }
    assert_eq!(folder.names(), written);
}

/// As of a render: what `render` writes is what `compare` takes.
#[test]
fn renders_are_compared_whole_cropped_and_in_half() {
    let folder = Folder::new();
    folder.write("ball.ply", &crate::sphere(500));
    let render = |arguments: &[&str]| {
        let small = ["--device", "reference", "--size", "64x48", "--quiet"];
        let plain = ["--quality", "draft", "--exposure", "0"];
        let all = [&["render", "ball.ply"], arguments, &small[..], &plain].concat();
        run_in(folder.path(), &all).succeeds()
    };
    render(&["-o", "whole.exr", "-o", "whole.png"]);
    render(&["-o", "crop.exr", "--crop", "20,10,30,25"]);
    render(&["-o", "half.exr", "--half"]);
    compare(&folder, &["whole.exr", "crop.exr", "--max-abs", "0", "--flip", "0"]).succeeds();
    compare(&folder, &["whole.exr", "half.exr", "--max-abs", "0", "--channels", "Z,P,object"])
        .succeeds();
    // Half a unit in the 11th binary digit of values under 1.
    compare(&folder, &["whole.exr", "half.exr", "--max-abs", "2.5e-4"]).succeeds();
    assert_eq!(compare(&folder, &["whole.exr", "half.exr", "--max-abs", "1e-6"]).code, Some(1));
    compare(&folder, &["whole.exr", "whole.png", "--channels", "RGB", "--max-abs", "0.005"])
        .succeeds();
    let written = std::fs::metadata(folder.path().join("half.exr")).expect("a file").len();
    let whole = std::fs::metadata(folder.path().join("whole.exr")).expect("a file").len();
    assert!(written < whole, "{written} against {whole} bytes");
}

/// 3e6 is no colour that 16 bits hold; `--half` alone changes how a file is written.
#[test]
fn half_says_what_it_cannot_hold() {
    let folder = Folder::new();
    folder.write("ball.ply", &crate::sphere(200));
    let arguments =
        ["--device", "reference", "--size", "16x12", "--set", "background.color=[3e6, 0.0, 0.0]"];
    let render = |more: &[&str]| {
        run_in(folder.path(), &[&["render", "ball.ply"], more, &arguments].concat()).succeeds()
    };
    let ran = render(&["-o", "a.exr", "--half"]);
    assert!(
        ran.stderr.contains("warning: --half:") && ran.stderr.contains("65504"),
        "{}",
        ran.stderr
    );
    let red = film::read_exr(&folder.path().join("a.exr")).expect("an EXR").channels["R"].clone();
    assert_eq!(red.into_iter().fold(0.0, f32::max), 65_504.0);
    assert!(!render(&["-o", "b.exr"]).stderr.contains("--half"));
    let ran = render(&["-o", "b.png", "--half"]);
    assert!(ran.stderr.contains("warning: --half is ignored"), "{}", ran.stderr);
}

#[test]
fn layers_are_compared_together_and_by_name() {
    let folder = Folder::new();
    let planes: [Plane<'_>; 4] =
        [("left.R", &red), ("left.G", &green), ("left.B", &blue), ("left.Z", &depth)];
    exr(&folder, "a.exr", WHOLE, &planes);
    let (code, found) =
        compared(&folder, &["a.exr", "a.exr", "--channels", "left", "--max-abs", "0"]);
    assert_eq!((code, &found["flip"]), (0, &json!(0.0)));
    assert_eq!(found["flip_details"]["channels"], json!(["left.R", "left.G", "left.B"]));
    assert_eq!(found["layers"]["left"]["values"], 4 * 16 * 12);
}

#[test]
fn help_names_units_and_answers() {
    let folder = Folder::new();
    let help = run_in(Path::new(folder.path()), &["compare", "--help"]).succeeds().stdout;
    for word in ["--max-abs", "--rmse", "--flip", "unit", "0 to 1", "NaN", "Exit codes"] {
        assert!(help.contains(word), "'{word}' is not in: {help}");
    }
}
