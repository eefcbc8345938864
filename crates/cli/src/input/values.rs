//! Options of the command line that stand for values of the scene.

use super::{columns_of_scene, is_scene_file};
use crate::args::Overrides;
use crate::errors::Failure;
use points::{Column, Columns};
use scene::Quality;
use serde_json::json;
use std::path::{Path, PathBuf};

/// Options of the command line that stand for values of the scene, later ones over earlier ones.
#[derive(Debug, Default)]
pub struct SceneValues {
    /// `PATH=VALUE`, and the option as typed where it was not `--set`.
    pub(super) entries: Vec<(String, Option<String>)>,
    /// Where the files of a scene are looked for first.
    pub(super) root: Option<PathBuf>,
    /// Of the scene that a point file means.
    pub(super) quality: Quality,
}

impl SceneValues {
    /// Only `--set`.
    pub fn set(set: &[String]) -> Self {
        let entries = set.iter().map(|entry| (entry.clone(), None)).collect();
        Self { entries, ..Self::default() }
    }

    /// With `--root`.
    pub fn below(mut self, root: Option<&Path>) -> Self {
        self.root = root.map(Path::to_path_buf).or(self.root);
        self
    }

    /// With `--preset`, which is one more value of the scene.
    pub fn add_preset(&mut self, preset: Option<&str>) {
        if let Some(name) = preset {
            self.add("render.preset", &json!(name).to_string(), &format!("--preset {name}"));
        }
    }

    /// `--set`, `--size` and `--cells-per-pass`.
    pub fn new(overrides: &Overrides) -> Self {
        let mut values = Self::default();
        values.append(overrides);
        values
    }

    /// The same over what there is already.
    pub fn append(&mut self, overrides: &Overrides) {
        self.entries.extend(Self::set(&overrides.set).entries);
        self.add_preset(overrides.preset.as_deref());
        if let Some(root) = &overrides.root {
            self.root = Some(root.clone());
        }
        if let Some(size) = overrides.size {
            self.add(
                "image.size",
                &format!("[{}, {}]", size.0, size.1),
                &format!("--size {}x{}", size.0, size.1),
            );
        }
        if let Some(cells) = overrides.cells_per_pass {
            self.add(
                "render.cells_per_pass",
                &cells.to_string(),
                &format!("--cells-per-pass {cells}"),
            );
        }
    }

    /// `--columns`, which is for point files.
    pub fn add_columns(&mut self, path: &Path, columns: &Columns) -> Result<(), Failure> {
        if is_scene_file(path) {
            return Err(columns_of_scene(path));
        }
        let column = |of: &Column| match of {
            Column::Name(name) => json!(name).to_string(),
            Column::Number(number) => number.to_string(),
        };
        let named =
            columns.named.iter().map(|(name, of)| format!("{} = {}", json!(name), column(of)));
        let left_out = format!("_ = {:?}", columns.left_out);
        let all: Vec<String> = named.chain([left_out]).collect();
        self.add("objects.0.columns", &format!("{{ {} }}", all.join(", ")), "--columns");
        Ok(())
    }

    /// `--quality`: what scene a point file means, of others how many samples, beneath what the other values say.
    pub fn in_quality(mut self, path: &Path, quality: Quality) -> Self {
        self.quality = quality;
        if is_scene_file(path) {
            let name = match quality {
                Quality::Draft => "draft",
                Quality::Good => "good",
                Quality::Best => "best",
            };
            let value = format!("image.samples={}", quality.samples());
            self.entries.insert(0, (value, Some(format!("--quality {name}"))));
        }
        self
    }

    /// `--ground`, before all values, which may change it.
    pub fn on_ground(mut self) -> Self {
        let value = "objects.+={ points = \"@ground\" }".to_owned();
        self.entries.insert(0, (value, Some("--ground".to_owned())));
        self
    }

    /// The scene of point files that is lit by lights only, one ray a pixel.
    pub fn in_draft(mut self) -> Self {
        self.quality = Quality::Draft;
        self
    }

    /// One option.
    pub fn add(&mut self, path: &str, value: &str, option: &str) {
        self.entries.push((format!("{path}={value}"), Some(option.to_owned())));
    }

    /// As the scene takes them.
    pub fn as_set(&self) -> Vec<String> {
        self.entries.iter().map(|entry| entry.0.clone()).collect()
    }

    /// The scene knows only `--set`; messages name what was typed.
    pub(super) fn name_options(&self, mut failure: Failure) -> Failure {
        for (value, option) in &self.entries {
            let Some(option) = option else { continue };
            for line in &mut failure.lines {
                *line = line.replace(&format!("--set {value}"), option);
            }
        }
        failure
    }
}

/// Fails where `--preset` and `--set` give different presets: neither is to be passed over without a word.
pub fn check_preset(preset: Option<&str>, set: &[String]) -> Result<(), Failure> {
    let Some(preset) = preset else { return Ok(()) };
    for text in set {
        let Some((path, value)) = text.split_once('=') else { continue };
        let value = value.trim().trim_matches(['"', '\'']);
        if path.trim() == "render.preset" && value != preset {
            return Err(Failure::usage(format!(
                "--preset {preset} and --set {text} give different presets; leave one out"
            )));
        }
    }
    Ok(())
}
