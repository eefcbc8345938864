//! Where a scene's files are now: below a folder that `--root` names.
//!
//! A picture's header has the scene, not the folder that it was rendered in. A relative path is looked for below the
//! root as it is, then without its first folders one by one; an absolute one by its tail in the same way. What is not
//! there is looked for where it was.

use crate::{Albedo, Scene};
use std::path::{Component, Path, PathBuf};

/// Where a file of a scene is looked for, in this order.
fn places(root: &Path, written: &str) -> Vec<PathBuf> {
    let parts: Vec<Component<'_>> = Path::new(written)
        .components()
        .filter(|part| matches!(part, Component::Normal(_)))
        .collect();
    let tail = |from: usize| root.join(parts[from..].iter().collect::<PathBuf>());
    // A folder above the root is none of its own.
    let direct = Path::new(written).is_relative().then(|| root.join(written));
    let mut places: Vec<PathBuf> = direct.into_iter().chain((0..parts.len()).map(tail)).collect();
    places.dedup();
    places
}

/// Where a file is, if it is below the root.
pub(crate) fn located(root: Option<&Path>, written: &str) -> Option<PathBuf> {
    places(root?, written).into_iter().find(|place| place.is_file())
}

/// Points the scene's files to where they are below the root.
pub(crate) fn find(scene: &mut Scene, root: Option<&Path>) {
    let locate = |path: &mut PathBuf, written: &str| {
        if let Some(found) = located(root, written) {
            *path = found;
        }
    };
    for object in &mut scene.objects {
        if !object.is_ground() {
            locate(&mut object.points, &object.points_as_written);
        }
        if let Albedo::Texture { file, .. } = &mut object.material.albedo {
            locate(&mut file.path, &file.as_written);
        }
    }
    if let Some(image) = &mut scene.background.environment {
        locate(&mut image.path, &image.as_written);
    }
}

/// Where else a file was looked for, or how to say where it is.
pub(crate) fn advice(root: Option<&Path>, written: &str, of_picture: bool) -> Option<String> {
    match (root, of_picture) {
        (Some(root), _) => {
            let places: Vec<String> = places(root, written)
                .iter()
                .map(|place| format!("'{}'", place.display()))
                .collect();
            Some(format!("nor at {}; name the folder that it is in with --root", places.join(", ")))
        }
        (None, true) => Some(
            "where the picture is; --root FOLDER says where the scene's files are now".to_owned(),
        ),
        (None, false) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_below_the_root_as_written_or_by_their_tail() {
        let root = Path::new("r");
        let of = |written| -> Vec<String> {
            places(root, written).iter().map(|place| place.display().to_string()).collect()
        };
        assert_eq!(of("a.ply"), ["r/a.ply"]);
        assert_eq!(of("points/a.ply"), ["r/points/a.ply", "r/a.ply"]);
        assert_eq!(of("../points/a.ply"), ["r/../points/a.ply", "r/points/a.ply", "r/a.ply"]);
        assert_eq!(of("/x/y/a.ply"), ["r/x/y/a.ply", "r/y/a.ply", "r/a.ply"]);
        assert_eq!(located(None, "a.ply"), None);
    }
}
