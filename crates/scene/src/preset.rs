//! `render.preset`: other defaults for several keys.
//!
//! They are put into the document where a key is not written, before it is checked. So whatever the scene says wins,
//! wherever it says it, and the checks and the header of a picture see one scene.

use crate::document::{Entry, Node, Value, parse_value};

/// Keys of `[render]` and of `[objects.surface]` with the values that they have in the paper (Tejada, Schafhitzel, Ertl
/// 2007), where the defaults are others.
const PAPER: [&[(&str, &str)]; 2] = [
    &[
        ("cells_per_pass", "1"),
        ("loop", "\"images\""),
        ("grid_resolution", "\"paper\""),
        ("primary", "\"discs\""),
        ("secondary", "\"grid\""),
        ("fresnel", "\"transmit\""),
        ("shadows", "\"opaque\""),
    ],
    &[
        ("neighbors", "16"),
        ("polynomial", "\"incomplete\""),
        ("feature_size", "\"adaptive\""),
        ("trust", "0.6"),
        ("close_gaps", "false"),
        ("boundary_clip", "false"),
        ("normals", "\"polynomial\""),
    ],
];

/// Puts the values of a preset into the document. A name that there is not is left to the checks.
pub(crate) fn apply(document: &mut Node) {
    let preset = document.get("render").and_then(|render| render.get("preset"));
    let Some((Value::Text(name), origin)) = preset.map(|node| (&node.value, node.origin)) else {
        return;
    };
    let [render, surface] = match name.as_str() {
        "paper" => PAPER,
        _ => return,
    };
    let node = |text: &str| parse_value(text, origin);
    if let Some(table) = document.get_mut("render") {
        add(table, render, &node);
    }
    let Some(Node { value: Value::List(objects), .. }) = document.get_mut("objects") else {
        return;
    };
    for object in objects {
        if object.get("surface").is_none()
            && let Value::Table(entries) = &mut object.value
        {
            entries.push(Entry { name: "surface".into(), origin, node: Node::empty_table(origin) });
        }
        let Some(table) = object.get_mut("surface") else { continue };
        let says = |key: &str, word: &str| matches!(table.get(key).map(|node| &node.value), Some(Value::Text(text)) if text == word);
        // Spheres and discs are not fitted.
        if says("kind", "spheres") || says("kind", "discs") {
            continue;
        }
        // Whoever wants noise smoothed says so by one of these, and a number of neighbours would deny it.
        let smoothed = table.get("accuracy").is_some() || says("neighbors", "auto");
        let smoothing = ["neighbors", "feature_size"];
        let keys: Vec<(&str, &str)> = (surface.iter().copied())
            .filter(|(key, _)| !smoothed || !smoothing.contains(key))
            .collect();
        add(table, &keys, &node);
    }
}

/// Adds what a table lacks.
fn add(table: &mut Node, keys: &[(&str, &str)], node: &dyn Fn(&str) -> Option<Node>) {
    let Value::Table(entries) = &mut table.value else { return };
    for (name, value) in keys {
        let written = entries.iter().any(|entry| entry.name == *name);
        if let (false, Some(node)) = (written, node(value)) {
            entries.push(Entry { name: (*name).to_owned(), origin: node.origin, node });
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::{FeatureSize, Fresnel, GridResolution, Neighbors, Normals, Polynomial};
    use crate::{Primary, RayLoop, Refine, Scene, Secondary, Shadows};
    use std::path::Path;

    const OBJECTS: &str = "[[objects]]\npoints = 'a.ply'\n[[objects]]\npoints = 'b.ply'\n";

    fn scene(text: &str, set: &[&str]) -> Scene {
        let set: Vec<String> = set.iter().map(|&set| set.to_owned()).collect();
        Scene::from_toml(text, Path::new("s.toml"), &set).unwrap()
    }

    #[test]
    fn the_paper_is_what_its_keys_spelled_out_are() {
        let preset = scene(&format!("[render]\npreset = 'paper'\n{OBJECTS}"), &[]);
        let render = "[render]\ncells_per_pass = 1\nloop = 'images'\nprimary = 'discs'\nsecondary = 'grid'\n\
                      grid_resolution = 'paper'\nshadows = 'opaque'\n";
        let surface = "[objects.surface]\nneighbors = 16\npolynomial = 'incomplete'\nclose_gaps = false\n\
                       boundary_clip = false\nnormals = 'polynomial'\n";
        let spelled = OBJECTS.replace("ply'\n", &format!("ply'\n{surface}"));
        assert_eq!(preset, scene(&format!("{render}{spelled}"), &[]));
        assert_eq!(preset, scene(OBJECTS, &["render.preset=paper"]));

        let r = &preset.render;
        assert_eq!((r.cells_per_pass, r.ray_loop, r.primary), (1, RayLoop::Images, Primary::Discs));
        assert_eq!((r.secondary, r.fresnel), (Secondary::Grid, Fresnel::Transmit));
        assert_eq!(r.shadows, Shadows::Opaque);
        for object in &preset.objects {
            let s = &object.surface;
            assert_eq!((s.neighbors, s.trust), (Neighbors::Count(16), 0.6));
            assert_eq!(s.polynomial, Polynomial::Incomplete);
            assert_eq!((s.feature_size, s.weight_width), (FeatureSize::Adaptive, 1.0));
            assert_eq!((s.normals, s.refine), (Normals::Polynomial, Refine::None));
            assert_eq!((s.close_gaps, s.boundary_clip), (false, false));
        }
    }

    #[test]
    fn single_keys_win_over_the_preset_wherever_they_are_written() {
        let text = format!(
            "{OBJECTS}[objects.surface]\npolynomial = 'full'\n[render]\npreset = 'paper'\nloop = 'queue'\n"
        );
        let found = scene(&text, &["objects.0.surface.trust=0.8", "render.cells_per_pass=0"]);
        let polynomials = [0, 1].map(|i| found.objects[i].surface.polynomial);
        assert_eq!(polynomials, [Polynomial::Incomplete, Polynomial::Full]);
        assert_eq!([0, 1].map(|i| found.objects[i].surface.trust), [0.8, 0.6]);
        assert_eq!((found.render.ray_loop, found.render.cells_per_pass), (RayLoop::Queue, 0));
        assert_eq!(found.render.grid_resolution, GridResolution::Paper);

        let smoothed = scene(
            OBJECTS,
            &[
                "render.preset=paper",
                "objects.0.surface.accuracy=5",
                "objects.1.surface.neighbors=auto",
            ],
        );
        let neighbors = [0, 1].map(|i| smoothed.objects[i].surface.neighbors);
        assert_eq!(neighbors, [5.0, 2.5].map(|accuracy| Neighbors::Auto { accuracy }));
    }

    /// What changes a picture is written out, so the header needs no preset.
    #[test]
    fn the_settings_hold_the_resulting_scene() {
        let preset = scene(OBJECTS, &["render.preset=paper", "objects.1.surface.kind=spheres"]);
        let settings = preset.settings_toml();
        assert!(!settings.contains("preset"), "{settings}");
        let again = scene(&settings, &[]);
        assert_eq!(again.settings_toml(), settings);
        assert_eq!(again.objects, preset.objects);
        assert_eq!(again.render.grid_resolution, GridResolution::Paper);
    }

    #[test]
    fn an_unknown_preset_is_an_error_that_names_those_there_are() {
        let set = ["render.preset=papr".to_owned()];
        let error = Scene::from_toml(OBJECTS, Path::new("s.toml"), &set).unwrap_err().to_string();
        for word in ["render.preset", "papr", "\"paper\""] {
            assert!(error.contains(word), "{error}");
        }
    }

    /// A share of 35 000 points has that share of 20³ cells.
    #[test]
    fn cells_grow_with_the_points() {
        let cells = |points| GridResolution::Paper.cells(points);
        assert_eq!([35_000, 280_000, 4_375, 1, 0].map(cells), [20, 40, 10, 1, 1]);
        assert_eq!(cells(u64::MAX), 1024);
        assert_eq!(GridResolution::Cells(0).cells(35_000), 0);
    }
}
