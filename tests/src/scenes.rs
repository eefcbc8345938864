//! The scenes of the repository, small.

use crate::said;
use plan::{Plan, SceneImages};
use scene::{Albedo, ImageFile, Scene, Up};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

/// Scenes that were said to be skipped: each is said once.
static SKIPPED: Mutex<Vec<String>> = Mutex::new(Vec::new());

/// Every scene of the repository, by name.
#[must_use]
pub fn scene_files() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes");
    let files = std::fs::read_dir(folder).expect("the folder of scenes");
    let mut paths: Vec<PathBuf> = files.map(|file| file.expect("an entry").path()).collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "toml"));
    paths.sort();
    paths
}

/// The name of a file without its folder and extension.
#[must_use]
pub fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

/// The scene with a small picture of two samples a pixel; none, said loudly, where it lacks a model. Any
/// other fault fails the test.
#[must_use]
pub fn load_small(path: &Path, size: [u32; 2]) -> Option<Scene> {
    let set = [format!("image.size={size:?}"), "image.samples=2".to_owned()];
    match Scene::load(path, &set) {
        Ok(scene) => Some(scene),
        Err(error) if error.lacks_models_alone() => {
            let name = stem(path);
            let mut skipped = SKIPPED.lock().expect("no test panicked here");
            if !skipped.contains(&name) {
                let advice = "tools/fetch-models, or POINTILLIST_MODELS=FOLDER, gives it";
                said(&format!("SKIPPED: scene {name} lacks a model; {advice}"));
                skipped.push(name);
            }
            None
        }
        Err(error) => panic!("{error}"),
    }
}

/// The plan of a scene and the files that it names.
#[must_use]
pub fn plan_of_scene(scene: &Scene) -> Plan {
    let set = |object: &scene::Object| {
        let options = plan::read_options(object);
        points::read_with(&object.points, &options, &mut |_, _| {}).expect("a readable point file")
    };
    let sets: Vec<_> = scene.objects.iter().map(|object| Arc::new(set(object))).collect();
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
