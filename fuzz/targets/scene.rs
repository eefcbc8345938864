//! Scene files. What is accepted is read again from its own settings.
#![no_main]

use scene::Scene;
use std::path::Path;

libfuzzer_sys::fuzz_target!(|text: &str| {
    // A folder that does not exist: no file that the text may name is opened.
    let file = Path::new("/nonexistent/scene.toml");
    match Scene::from_toml(text, file, &[]) {
        Ok(scene) => assert!(!scene.settings_toml().is_empty()),
        Err(error) => {
            for line in error.lines() {
                assert!(line.starts_with("/nonexistent/scene.toml"), "{line:?}");
                assert!(!line.contains('\n'), "{line:?}");
            }
        }
    }
});
