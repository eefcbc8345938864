//! The scenes of the repository: all are valid, and what can be rendered is the same on device and CPU.
#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "tests panic, and say what they skip"
)]

use harness::{Bench, assert_same_bits, render_twin, said};
use plan::{Plan, SceneImages};
use scene::{Albedo, ImageFile, MODELS_VARIABLE, Scene, Up};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What makes a scene quick: a small picture of few samples.
const SMALL: [&str; 2] = ["image.size=[64, 48]", "image.samples=2"];

fn scene_files() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes");
    let files = std::fs::read_dir(folder).expect("the folder of scenes");
    let mut paths: Vec<PathBuf> = files.map(|file| file.expect("an entry").path()).collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "toml"));
    paths.sort();
    paths
}

fn name(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

/// The scene, or none where it lacks a model; any other fault fails the test.
fn load(path: &Path) -> Option<Scene> {
    let set = SMALL.map(str::to_owned);
    match Scene::load(path, &set) {
        Ok(scene) => Some(scene),
        Err(error) => {
            let model = |line: &String| line.contains(MODELS_VARIABLE);
            assert!(error.lines().iter().all(model), "{error}");
            said(&format!("SKIPPED: {}: {error}", name(path)));
            None
        }
    }
}

fn shows_models(path: &Path) -> bool {
    std::fs::read_to_string(path).expect("a scene").contains("\"models/")
}

fn plan(scene: &Scene) -> Plan {
    let set = |path: &Path| points::read(path, &mut |_, _| {}).expect("a readable point file");
    let sets: Vec<_> = scene.objects.iter().map(|object| Arc::new(set(&object.points))).collect();
    let image = |file: &ImageFile| Arc::new(film::read_image(&file.path).expect("an image"));
    let texture = |albedo: &Albedo| match albedo {
        Albedo::Texture { file, .. } => Some(image(file)),
        _ => None,
    };
    let images = SceneImages {
        environment: scene.background.environment.as_ref().map(image),
        textures: scene.objects.iter().map(|object| texture(&object.material.albedo)).collect(),
    };
    Plan::new(scene, &sets, &images, None, Up::Y).expect("a plan")
}

#[test]
fn every_scene_is_valid_and_says_first_what_it_shows() {
    for path in scene_files() {
        let text = std::fs::read_to_string(&path).expect("a scene");
        let first = text.lines().next().unwrap_or_default();
        let command = format!("cargo run --release -- render scenes/{}.toml", name(&path));
        assert!(first.starts_with("# Shows ") && first.contains(&command), "{path:?}: {first}");
        let loaded = load(&path).is_some();
        assert!(loaded || shows_models(&path), "{path:?} lacks a model but names none");
    }
}

#[test]
fn scenes_of_generated_points_always_run_and_have_siblings_with_models() {
    let generated = scene_files().iter().filter(|path| !shows_models(path)).count();
    let with_models = scene_files().len() - generated;
    assert!(generated >= 7 && with_models >= 6, "{generated} generated, {with_models} with models");
    for path in scene_files().iter().filter(|path| !shows_models(path)) {
        assert!(load(path).is_some(), "{path:?}");
    }
}

#[test]
fn scenes_are_the_same_to_the_bit_on_device_and_cpu() {
    let bench = Bench::open();
    for path in scene_files() {
        let Some(scene) = load(&path) else { continue };
        let plan = plan(&scene);
        let on_device = bench.render(&plan);
        assert_same_bits(&name(&path), &on_device, &render_twin(&plan));
        let finite = on_device.film.color.as_flattened().iter().all(|value| value.is_finite());
        assert!(finite, "{path:?}: a colour is no number");
        let lit = on_device.film.color.iter().filter(|color| color.iter().sum::<f32>() > 0.05);
        assert!(lit.count() > 64 * 48 / 2, "{path:?} is mostly black");
    }
}
