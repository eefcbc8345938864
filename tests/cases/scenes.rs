//! The scenes of the repository: all are valid, and what can be rendered is the same on device and CPU.
#![allow(clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use harness::scenes::{load_small, plan_of_scene, scene_files, stem};
use harness::{Bench, assert_same_bits, render_twin};
use std::path::Path;

/// Columns and rows of a quick picture.
const SMALL: [u32; 2] = [64, 48];

fn shows_models(path: &Path) -> bool {
    read(path).contains("\"models/")
}

#[test]
fn every_scene_is_valid_and_says_first_what_it_shows() {
    for path in scene_files() {
        let text = read(&path);
        let first = text.lines().next().unwrap_or_default();
        let command = format!("cargo run --release -- render scenes/{}.toml", stem(&path));
        assert!(first.starts_with("# Shows ") && first.contains(&command), "{path:?}: {first}");
        let loaded = load_small(&path, SMALL).is_some();
        assert!(loaded || shows_models(&path), "{path:?} lacks a model but names none");
    }
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

#[test]
fn the_gallery_shows_every_scene_with_its_command_and_every_picture_is_there() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let page = read(&root.join("docs/gallery.md"));
    for path in scene_files() {
        let command = format!("render scenes/{}.toml", stem(&path));
        assert!(page.contains(&command), "docs/gallery.md lacks '{command}'");
    }
    for link in page.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
        let (file, _) = link.split_once('#').unwrap_or((link, ""));
        assert!(root.join("docs").join(file).exists(), "docs/gallery.md links '{link}'");
    }
    for file in std::fs::read_dir(root.join("docs/gallery")).expect("pictures") {
        let name = file.expect("an entry").file_name().to_string_lossy().into_owned();
        let shown = |page: &str| read(&root.join(page)).contains(&name);
        let pages = ["docs/gallery.md", "docs/method.md", "docs/convergence.md", "README.md"];
        assert!(pages.into_iter().any(shown), "docs/gallery/{name} is shown on no page");
    }
}

#[test]
fn scenes_of_generated_points_always_run_and_have_siblings_with_models() {
    let generated = scene_files().iter().filter(|path| !shows_models(path)).count();
    let with_models = scene_files().len() - generated;
    assert!(generated >= 7 && with_models >= 6, "{generated} generated, {with_models} with models");
    for path in scene_files().iter().filter(|path| !shows_models(path)) {
        assert!(load_small(path, SMALL).is_some(), "{path:?}");
    }
}

#[test]
fn scenes_are_the_same_to_the_bit_on_device_and_cpu() {
    let bench = Bench::open();
    for path in scene_files() {
        let Some(scene) = load_small(&path, SMALL) else { continue };
        let plan = plan_of_scene(&scene);
        let on_device = bench.render(&plan);
        assert_same_bits(&stem(&path), &on_device, &render_twin(&plan));
        let finite = on_device.film.color.as_flattened().iter().all(|value| value.is_finite());
        assert!(finite, "{path:?}: a colour is no number");
        let lit = on_device.film.color.iter().filter(|color| color.iter().sum::<f32>() > 0.05);
        assert!(lit.count() > 64 * 48 / 2, "{path:?} is mostly black");
    }
}
