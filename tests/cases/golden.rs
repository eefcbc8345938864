//! Golden images: what every scene of the repository looked like when somebody last looked.
//!
//! To the bit where devices are exact, else by FLIP. Where a picture differs, a page shows both beside each other;
//! `ACCEPT=1` takes the new ones ([`ACCEPT`]).
#![allow(clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use compare::Flip;
use film::Film;
use harness::scenes::{load_small, plan_of_scene, scene_files, stem};
use harness::{Bench, is_exact, said};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Columns and rows: the fewest rows that FLIP's filters and an eye can do with.
const SIZE: [u32; 2] = [86, 64];
const CHANNELS: [&str; 4] = ["R", "G", "B", "A"];
const ACCEPT: &str = "ACCEPT=1 cargo test -p pointillist-tests --test golden";
/// Mean FLIP on devices whose arithmetic differs in the last bits: a ray in a hundred or two takes another way
/// at an outline or inside of glass, which FLIP sees as a whole pixel; a wrong picture has 0.05 and more.
const MOST_FLIP: f64 = 0.02;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("golden")
}

fn golden_of(name: &str) -> PathBuf {
    folder().join(format!("{name}.exr"))
}

type Pixels = Vec<[f32; 4]>;

/// The golden picture, if there is one of this size.
fn read(name: &str) -> Option<Pixels> {
    let path = golden_of(name);
    if !path.exists() {
        return None;
    }
    let picture = film::read_exr(&path).expect("a golden image");
    if picture.data_size != SIZE {
        return None;
    }
    let planes = CHANNELS.map(|channel| &picture.channels[channel]);
    Some((0..planes[0].len()).map(|at| planes.map(|plane| plane[at])).collect())
}

fn write(name: &str, pixels: &[[f32; 4]]) {
    let plane = |index: usize| pixels.iter().map(|pixel| pixel[index]).collect();
    let planes = (0..).zip(CHANNELS).map(|(index, name)| (name.to_owned(), plane(index))).collect();
    std::fs::create_dir_all(folder()).expect("a folder");
    film::write_planes(SIZE, [0, 0], SIZE, planes, &golden_of(name)).expect("a written file");
}

/// A scene whose picture is not the golden one.
struct Difference {
    name: String,
    golden: Option<Pixels>,
    found: Pixels,
}

impl Difference {
    /// What differs, in words.
    fn words(&self) -> String {
        let Some(golden) = &self.golden else {
            return format!("{}: no golden image of this size", self.name);
        };
        let pixels = golden.len();
        let differing = golden.iter().zip(&self.found).filter(|(a, b)| !same(a, b)).count();
        let far = golden.as_flattened().iter().zip(self.found.as_flattened());
        let far = far.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        let flip = flip(golden, &self.found).mean;
        format!("{}: {differing} of {pixels} pixels, by up to {far}; FLIP {flip:.5}", self.name)
    }

    /// Three cells of a table, whose pictures lie in `folder`.
    fn cells(&self, folder: &Path) -> String {
        let mut cells = String::new();
        let mut cell = |kind: &str, pixels: Vec<[u8; 3]>| {
            let file = format!("{}-{kind}.png", self.name);
            film::write_png(SIZE, &pixels, &folder.join(&file)).expect("a written file");
            write!(cells, "<td><img src=\"{file}\" alt=\"{kind}\"></td>").expect("a string");
        };
        let shown = |pixels: &Pixels| -> Vec<[u8; 3]> {
            pixels.iter().map(|&[r, g, b, _]| [r, g, b].map(film::srgb_byte)).collect()
        };
        match &self.golden {
            Some(golden) => {
                cell("golden", shown(golden));
                cell("found", shown(&self.found));
                let map = flip(golden, &self.found).map;
                let bright = |&value: &f32| [(value.sqrt() * 255.0) as u8; 3];
                cell("flip", map.iter().map(bright).collect());
            }
            None => {
                cell("found", shown(&self.found));
            }
        }
        cells
    }
}

fn same(a: &[f32; 4], b: &[f32; 4]) -> bool {
    a.map(f32::to_bits) == b.map(f32::to_bits)
}

fn flip(a: &Pixels, b: &Pixels) -> Flip {
    let colors = |pixels: &Pixels| -> Vec<[f32; 3]> {
        pixels.iter().map(|&[r, g, b, _]| [r, g, b]).collect()
    };
    Flip::hdr(&colors(a), &colors(b), SIZE.map(|side| side as usize))
}

/// The page that shows both, and how much they differ.
fn page(differences: &[Difference]) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("golden");
    std::fs::create_dir_all(&folder).expect("a folder");
    let mut text = "<!doctype html><meta charset=\"utf-8\"><title>Golden images</title>\n\
        <style>body { background: #222; color: #ddd; font-family: sans-serif }\n\
        img { width: 430px; image-rendering: pixelated }</style>\n"
        .to_owned();
    writeln!(
        text,
        "<p>Golden, found, FLIP (its root). To accept what was found: <code>{ACCEPT}</code>"
    )
    .expect("a string");
    for difference in differences {
        let (words, cells) = (difference.words(), difference.cells(&folder));
        writeln!(text, "<p>{words}<table><tr>{cells}</table>").expect("a string");
    }
    let page = folder.join("index.html");
    std::fs::write(&page, text).expect("a written page");
    page
}

/// Compares, and accepts where that is asked for.
fn settle(differences: &[Difference]) {
    if std::env::var_os("ACCEPT").is_some() {
        for difference in differences {
            write(&difference.name, &difference.found);
            said(&format!("ACCEPTED: {}", difference.words()));
        }
        return;
    }
    if !differences.is_empty() {
        let words: Vec<String> = differences.iter().map(Difference::words).collect();
        let page = page(differences);
        panic!("{}\nlook at {}, then: {ACCEPT}", words.join("\n"), page.display());
    }
}

fn pixels(film: &Film) -> Pixels {
    film.color.clone()
}

#[test]
fn every_scene_is_as_its_golden_image() {
    let bench = Bench::open();
    let mut differences = Vec::new();
    for path in scene_files() {
        let name = stem(&path);
        let Some(scene) = load_small(&path, SIZE) else { continue };
        let found = pixels(&bench.render(&plan_of_scene(&scene)).film);
        let golden = read(&name);
        let equal = golden.as_ref().is_some_and(|golden| {
            let same_bits = golden.iter().zip(&found).all(|(a, b)| same(a, b));
            same_bits || (!is_exact() && flip(golden, &found).mean <= MOST_FLIP)
        });
        if equal && !is_exact() {
            let near =
                Difference { name: name.clone(), golden: golden.clone(), found: found.clone() };
            said(&format!("NEAR: {}", near.words()));
        }
        if !equal {
            differences.push(Difference { name, golden, found });
        }
    }
    settle(&differences);
    let scenes: Vec<String> = scene_files().iter().map(|path| stem(path)).collect();
    for file in std::fs::read_dir(folder()).expect("golden images") {
        let name = stem(&file.expect("an entry").path());
        assert!(scenes.contains(&name), "the golden image {name} has no scene; delete it");
    }
    for name in scenes {
        assert!(golden_of(&name).exists(), "scene {name} has no golden image; {ACCEPT}");
    }
}

/// One value of one channel of one pixel, by one last bit.
#[test]
fn a_changed_pixel_is_a_difference() {
    let golden = read("glass").expect("a golden image");
    let mut found = golden.clone();
    found[1234][2] = f32::from_bits(found[1234][2].to_bits() + 1);
    assert!(!golden.iter().zip(&found).all(|(a, b)| same(a, b)));
    let words = Difference { name: "glass".to_owned(), golden: Some(golden), found }.words();
    assert!(words.starts_with("glass: 1 of 5504 pixels"), "{words}");
}
