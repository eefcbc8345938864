//! What is written of a scene, and the schema.

use super::{FULL, SMALL, error_with, orthographic, read, read_with};
use crate::keys::{Absent, Kind, SCENE, Table};
use crate::not_built::not_built;
use crate::*;

#[test]
fn settings_parse_to_the_same_scene_and_the_same_bytes() {
    let mut scene = read(FULL).unwrap();
    let settings = scene.settings_toml();
    let again = read(&settings).unwrap();
    (scene.render.cells_per_pass, scene.render.ray_loop) = (0, RayLoop::Auto);
    scene.render.primary = Primary::Auto;
    scene.render.secondary = Secondary::Auto;
    assert_eq!(again, scene);
    assert_eq!(again.settings_toml(), settings);
    let small = read(SMALL).unwrap();
    assert_eq!(read(&small.settings_toml()), Ok(small));
}

/// Glass blocked light before there was a key for it, and a header says nothing of it.
#[test]
fn a_header_of_earlier_days_says_what_was_done_then() {
    for scene in [read(FULL).unwrap(), read(SMALL).unwrap()] {
        let settings = scene.settings_toml();
        assert_eq!(settings_of_header(&settings), settings);
        let line = settings.lines().find(|line| line.starts_with("shadows = ")).unwrap();
        let earlier = settings.replace(&format!("{line}\n"), "");
        assert_ne!(earlier, settings);
        let again = read(&settings_of_header(&earlier)).unwrap();
        assert_eq!(
            again.render,
            RenderSettings { shadows: Shadows::Opaque, ..read(&settings).unwrap().render }
        );
    }
    for other in ["", "[render]", "[image]\nsize = [4, 3]\n"] {
        assert_eq!(settings_of_header(other), other);
    }
}

#[test]
fn settings_state_every_built_key() {
    fn names(table: &Table, path: &str, out: &mut Vec<(&'static str, String)>) {
        for key in table.keys {
            let path = check::joined(path, key.name);
            match key.kind {
                _ if not_built(&path).is_some() => {}
                Kind::Table(inner) | Kind::Tables { table: inner, .. } => names(inner, &path, out),
                _ => out.push((key.name, path)),
            }
        }
    }
    let mut keys = Vec::new();
    names(&SCENE, "", &mut keys);
    // No camera has the keys of both projections.
    let mut settings =
        read(FULL).unwrap().settings_toml() + &read(&orthographic()).unwrap().settings_toml();
    // Instead of the colour that FULL has.
    let sky = read(&format!("background.environment = \"sky.exr\"\n{SMALL}"));
    settings += &sky.unwrap().settings_toml();
    // Instead of that, and the sun's direction instead of its angles.
    for made in ["sky={}", "sky.sun=[0, 1, 0]", "gradient=[[0, 0, 0], [1, 1, 1]]"] {
        settings += &read_with(SMALL, &[&format!("background.{made}")]).unwrap().settings_toml();
    }
    // Instead of a volume along the way.
    let iso = "[objects.volume]\nscalar = \"s\"\nmode = \"isosurface\"\niso = 0.5\n";
    settings += &read(&format!("{SMALL}{iso}")).unwrap().settings_toml();
    // Of a kind that FULL has not.
    let lamp = "[[lights]]\nkind = \"headlight\"\nat_target = [1, 1, 1]\n";
    settings += &read(&format!("{lamp}{SMALL}")).unwrap().settings_toml();
    // Only where somebody says so.
    let glass = format!("camera = {{ eye = [0, 0, 1], target = [0, 0, 0], inside = [] }}\n{SMALL}");
    settings += &read(&glass).unwrap().settings_toml();
    // Of a camera that is framed.
    settings += &read_with(SMALL, &["camera.view=top"]).unwrap().settings_toml();
    for (name, path) in keys {
        // Columns have names of their own, below the key as a header.
        let is_stated =
            |line: &str| line.starts_with(&format!("{name} = ")) || line == format!("[{path}]");
        let stated = settings.lines().any(is_stated);
        // Four change no picture; the Abbe number is in the indices.
        let unseen = [
            // What it stands for is stated.
            "render.preset",
            "render.cells_per_pass",
            "render.loop",
            "render.primary",
            "render.secondary",
            "objects.material.abbe",
        ]
        .contains(&path.as_str());
        assert_eq!(stated, !unseen, "{path}");
    }
}

#[test]
fn settings_keep_every_bit_of_a_number() {
    let mut scene = read(FULL).unwrap();
    for value in [0.1 + 0.2, f64::MIN_POSITIVE, 5e-324, 1.0 / 3.0, 1e15, 123_456_789.123_456_79] {
        scene.background.color = [value, 0.0, 0.7];
        let again = read(&scene.settings_toml()).unwrap();
        assert_eq!(again.background.color.map(f64::to_bits), [value, 0.0, 0.7].map(f64::to_bits));
    }
}

#[test]
fn schema_states_every_key_and_allows_no_other() {
    fn compare(table: &Table, schema: &serde_json::Value) {
        assert_eq!(schema["additionalProperties"], false, "{}", table.header);
        let properties = schema["properties"].as_object().unwrap();
        assert_eq!(properties.len(), table.keys.len(), "{}", table.header);
        for key in table.keys {
            let property = &properties[key.name];
            assert!(property["description"].is_string(), "{}", key.name);
            match (&key.kind, key.absent) {
                (Kind::Table(inner), _) => compare(inner, property),
                (Kind::Tables { table: inner, in_file, .. }, _) => {
                    let list = if *in_file { &property["anyOf"][0] } else { property };
                    compare(inner, &list["items"]);
                }
                (_, Absent::Value(_)) => assert!(!property["default"].is_null(), "{}", key.name),
                _ => {}
            }
        }
    }
    let schema = json_schema();
    compare(&SCENE, &schema);
    let trust =
        &schema["properties"]["objects"]["items"]["properties"]["surface"]["properties"]["trust"];
    assert_eq!((&trust["minimum"], &trust["maximum"]), (&0.5.into(), &1.0.into()));
    assert_eq!(trust["default"], 0.6);
    let ray_loop = &schema["properties"]["render"]["properties"]["loop"];
    assert_eq!(ray_loop["enum"], serde_json::json!(["images", "queue", "auto"]));
}

/// The background lights wherever the integrator has a use for it, unless the scene says no; where only lights count, it
/// may not be told to.
#[test]
fn the_background_lights_where_it_can() {
    let with = |set: &[&str]| read_with(SMALL, set).map(|scene| scene.background_lights());
    assert_eq!(with(&[]).ok(), Some(false));
    for integrator in ["render.integrator=sky", "render.integrator=path"] {
        assert_eq!(with(&[integrator]).ok(), Some(true));
        assert_eq!(with(&[integrator, "background.lights=false"]).ok(), Some(false));
    }
    assert_eq!(with(&["background.lights=false"]).ok(), Some(false));
    let error = error_with(SMALL, &["background.lights=true"]);
    assert!(error.contains("background.lights: found true, expected false where"), "{error}");
}

/// Skies and gradients come back to the bit, the sun as it was said.
#[test]
fn backgrounds_that_are_made_are_written_and_read_again() {
    for set in [
        "sky={}",
        "sky={ sun = [0.1, 2.0, -3.0], sun_angle = 0, turbidity = 1, ground = [0.1, 0.2, 0.3] }",
        "sky={ elevation = 3, azimuth = -120.5, sun_angle = 10, turbidity = 9.75, ground = 0.25 }",
        "gradient=[[0.1, 0.2, 0.3], [1, 2.5, 1e-7]]",
    ] {
        let scene =
            read_with(SMALL, &[&format!("background.{set}"), "render.integrator=sky"]).unwrap();
        assert!(scene.background.sky.is_some() != scene.background.gradient.is_some());
        let lit = read_with(&scene.settings_toml(), &["background.lights=true"]).unwrap();
        assert_eq!(lit.background, Background { lights: Some(true), ..scene.background.clone() });
        assert_eq!(read(&scene.settings_toml()), Ok(scene));
    }
}
