//! `--set`, one a line, over a scene that has every table.
#![no_main]

use scene::Scene;
use std::path::Path;

const SCENE: &str = include_str!("../seeds/scene/everything.toml");

libfuzzer_sys::fuzz_target!(|text: &str| {
    let overrides: Vec<String> = text.lines().map(str::to_owned).collect();
    let file = Path::new("/nonexistent/scene.toml");
    match Scene::from_toml(SCENE, file, &overrides) {
        Ok(scene) => {
            for object in &scene.objects {
                let moved = object.transform.apply([1.0, 2.0, 3.0]);
                assert!(moved.iter().all(|x| !x.is_nan()), "{:?}: {moved:?}", object.transform);
            }
        }
        Err(error) => {
            let lines = error.lines();
            assert!(!lines.is_empty() && lines.iter().all(|line| !line.contains('\n')), "{lines:?}");
        }
    }
});
