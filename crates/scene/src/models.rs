//! Where scenes find models that are not part of the repository.
//!
//! A path below `models/` (or `../models/`) that is not beside the scene file is looked for in the folder that
//! [`MODELS_VARIABLE`] names, first at the same place, then anywhere below it by name. So one folder of
//! models serves all scenes, however it is arranged.

use crate::{Albedo, ImageFile, Scene};
use std::fs;
use std::path::{Component, Path, PathBuf};

/// The environment variable that names a folder of models.
pub const MODELS_VARIABLE: &str = "POINTILLIST_MODELS";
/// What paths of models begin with.
const PREFIX: &str = "models";
/// Folders below the one named are searched to this depth, so that links in a circle end.
const MAX_DEPTH: u32 = 8;

/// Points the scene's files below `models/` to where they are, if that is in `models`.
pub(crate) fn find(scene: &mut Scene, models: Option<&Path>) {
    let Some(models) = models else { return };
    let locate = |path: &mut PathBuf, written: &str| {
        if let (Some(rest), false) = (below_models(written), path.exists()) {
            *path = found(models, rest).unwrap_or_else(|| path.clone());
        }
    };
    let locate_image = |image: &mut ImageFile| locate(&mut image.path, &image.as_written);
    for object in &mut scene.objects {
        if !object.is_ground() {
            locate(&mut object.points, &object.points_as_written);
        }
        if let Albedo::Texture { file, .. } = &mut object.material.albedo {
            locate_image(file);
        }
    }
    scene.background.environment.as_mut().map(locate_image);
}

/// Where a model is that a path names, relative to a folder or below the folder of [`MODELS_VARIABLE`], if anywhere.
pub(crate) fn model(folder: &Path, written: &str) -> Option<PathBuf> {
    let beside = folder.join(written);
    if beside.is_file() {
        return Some(beside);
    }
    let models = std::env::var_os(MODELS_VARIABLE).filter(|folder| !folder.is_empty())?;
    found(Path::new(&models), below_models(written)?)
}

/// What to do about a file that is missing, if it is one of the models.
pub(crate) fn advice(written: &str, models: Option<&Path>) -> Option<String> {
    let rest = below_models(written)?.display();
    Some(match models {
        Some(folder) => format!(
            "nor '{rest}' below '{}', the folder that {MODELS_VARIABLE} names; fetch it with \
             tools/fetch-models, or name another folder",
            folder.display()
        ),
        None => format!(
            "and {MODELS_VARIABLE} is not set; fetch it with tools/fetch-models, or set \
             {MODELS_VARIABLE} to a folder that holds '{rest}'"
        ),
    })
}

/// The path without `models/`, if it begins with that, whatever folders above it starts from.
fn below_models(written: &str) -> Option<&Path> {
    let mut path = Path::new(written);
    while let Ok(inner) = path.strip_prefix("..") {
        path = inner;
    }
    let rest = path.strip_prefix(PREFIX).ok()?;
    // Nothing outside of the folder of models is one.
    let stays = rest.components().all(|part| matches!(part, Component::Normal(_)));
    rest.file_name().filter(|_| stays).map(|_| rest)
}

fn found(models: &Path, rest: &Path) -> Option<PathBuf> {
    let direct = models.join(rest);
    if direct.is_file() {
        return Some(direct);
    }
    by_name(models, rest, MAX_DEPTH)
}

/// The first file below a folder that ends in `rest`, by name, so that the same folder always gives the
/// same file. A folder that cannot be read holds nothing.
fn by_name(folder: &Path, rest: &Path, depth: u32) -> Option<PathBuf> {
    if depth == 0 {
        return None;
    }
    let mut folders: Vec<PathBuf> = fs::read_dir(folder)
        .ok()?
        .filter_map(|entry| entry.ok().map(|entry| entry.path()))
        .filter(|path| path.is_dir())
        .collect();
    folders.sort();
    let here = folders.iter().map(|inner| inner.join(rest)).find(|path| path.is_file());
    here.or_else(|| folders.iter().find_map(|inner| by_name(inner, rest, depth - 1)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene(folder: &Path) -> Scene {
        let text = "
            [background]\nenvironment = 'models/sky.hdr'
            [[objects]]\npoints = 'models/a.ply'\nmaterial = { texture = 'models/deep/t.png' }
            [[objects]]\npoints = 'points/a.ply'";
        Scene::from_toml(text, &folder.join("s.toml"), &[]).unwrap()
    }

    fn write(path: PathBuf) -> PathBuf {
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(&path, "").unwrap();
        path
    }

    #[test]
    fn models_are_found_beside_the_scene_then_in_the_folder_named_then_below_it() {
        let place = tempfile::tempdir().unwrap();
        let (beside, named) = (place.path().join("scenes"), place.path().join("named"));
        let find_in = |models| {
            let mut scene = scene(&beside);
            find(&mut scene, models);
            scene
        };
        assert_eq!(find_in(None), scene(&beside), "no folder is named");
        assert_eq!(find_in(Some(&named)), scene(&beside), "the folder named does not exist");

        let below = write(named.join("z/y/a.ply"));
        assert_eq!(find_in(Some(&named)).objects[0].points, below);
        let sooner = write(named.join("b/a.ply"));
        assert_eq!(find_in(Some(&named)).objects[0].points, sooner);
        let direct = write(named.join("a.ply"));
        assert_eq!(find_in(Some(&named)).objects[0].points, direct);
        let own = write(beside.join("models/a.ply"));
        assert_eq!(find_in(Some(&named)).objects[0].points, own);

        let [sky, texture] = ["sky.hdr", "x/deep/t.png"].map(|file| write(named.join(file)));
        let scene = find_in(Some(&named));
        assert_eq!(scene.background.environment.unwrap().path, sky);
        let Albedo::Texture { file, .. } = &scene.objects[0].material.albedo else { panic!() };
        assert_eq!(file.path, texture);
        assert_eq!(scene.objects[1].points, beside.join("points/a.ply"), "no model");
    }

    #[test]
    fn advice_is_given_for_models_alone_and_names_file_variable_and_tool() {
        assert_eq!(advice("points/a.ply", None), None);
        assert_eq!(advice("../a.ply", None), None);
        assert_eq!(advice("../models/a.ply", None), advice("models/a.ply", None));
        assert_eq!(advice("models", None), None);
        assert_eq!(advice("models/../a.ply", None), None, "outside of the folder of models");
        for models in [None, Some(Path::new("there"))] {
            let advice = advice("models/a.ply", models).unwrap();
            for word in ["'a.ply'", MODELS_VARIABLE, "tools/fetch-models"] {
                assert!(advice.contains(word), "{advice}");
            }
        }
    }
}
