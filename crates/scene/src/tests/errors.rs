//! What errors say, and where.

use super::{FULL, SMALL, error, error_where, error_with, line_of, read, read_with};

#[test]
fn unknown_keys_name_the_place_and_the_nearest_key() {
    let found = error_where("neighbors = 20", "neighbours = 20");
    let expected = format!(
        "scenes/s.toml:{}:1: objects[0].surface.neighbours: unknown key; did you mean 'neighbors'?",
        line_of("neighbors = 20")
    );
    assert_eq!(found, expected);
    for (set, name) in [
        ("camera.fov=30", "vertical_fov"),
        ("camera.Eye=[0,0,0]", "eye"),
        ("background.colour=[0,0,0]", "color"),
        ("light=1", "lights"),
        ("render.bounces=1", "max_bounces"),
    ] {
        let error = error_with(FULL, &[set]);
        assert!(error.ends_with(&format!("unknown key; did you mean '{name}'?")), "{error}");
    }
}

#[test]
fn unknown_keys_far_from_any_list_the_known_and_name_another_tables() {
    let error_far = error_with(FULL, &["background.zzzzzz=1"]);
    assert!(
        error_far.ends_with(
            "unknown key; [background] has color, environment, rotate, sky, gradient, lights"
        ),
        "{error_far}"
    );
    let error = error_with(FULL, &["render.size=[1, 1]"]);
    assert!(error.contains("it belongs to [image], while [render] has max_bounces"), "{error}");
    assert!(error_with(FULL, &["objects.0.scale=2"]).contains("it belongs to [objects.transform]"));
}

#[test]
fn error_says_where_what_expected_and_what_to_do() {
    let error = error_where("trust = 0.75", "  trust =   1.7 # b/h");
    let expected = format!(
        "scenes/s.toml:{}:13: objects[0].surface.trust: found 1.7, expected a number from 0.5 to 1; \
         lower it or leave it out (default 0.6)",
        line_of("trust = 0.75")
    );
    assert_eq!(error, expected);
}

#[test]
fn radii_belong_to_spheres_and_discs_and_are_lengths_or_attributes() {
    let found = |surface: &str| error(&format!("{SMALL}surface = {{ {surface} }}"));
    for (surface, expected) in [
        (
            "radius = 0.1",
            "surface.radius: belongs to kind \"spheres\" or \"discs\", but kind is \"points\"",
        ),
        ("kind = \"spheres\", radius = -0.1", "surface.radius: found -0.1"),
        ("kind = \"spheres\", radius = 0", "surface.radius: found 0"),
        ("kind = \"spheres\", radius = nan", "write a finite number"),
        ("kind = \"discs\", radius = \"attribute:\"", "surface.radius: found"),
        ("kind = \"discs\", radius = \"size\"", "surface.radius: found"),
        ("kind = \"balls\"", "surface.kind: found the string \"balls\""),
    ] {
        let found = found(surface);
        assert!(found.contains(expected), "{surface}: {found}");
    }
}

#[test]
fn values_of_the_wrong_type_length_or_range_are_errors() {
    for (from, to, path, expected) in [
        ("trust = 0.75", "trust = \"a\"", "objects[0].surface.trust", "a number from 0.5 to 1"),
        ("trust = 0.75", "trust = nan", "objects[0].surface.trust", "write a finite number"),
        ("trust = 0.75", "trust = -inf", "objects[0].surface.trust", "write a finite number"),
        ("trust = 0.75", "trust = 1e999", "objects[0].surface.trust", "write a finite number"),
        ("trust = 0.75", "trust = 0.49", "objects[0].surface.trust", "raise it"),
        ("trust = 0.75", "trust = 1979-05-27", "objects[0].surface.trust", "found the date"),
        ("neighbors = 20", "neighbors = 2", "objects[0].surface.neighbors", "3 to 256 points"),
        ("neighbors = 20", "neighbors = 257", "objects[0].surface.neighbors", "lower it"),
        ("neighbors = 20", "neighbors = 16.0", "objects[0].surface.neighbors", "an integer"),
        ("seed = 4294967295", "seed = 4294967296", "render.seed", "0 to 4294967295"),
        ("seed = 4294967295", "seed = -1", "render.seed", "raise it"),
        ("grid_resolution = 96", "grid_resolution = 1025", "render.grid_resolution", "0 to 1024"),
        ("size = [320, 200]", "size = [320, 0]", "image.size[1]", "from 1 to 16384 pixels"),
        ("size = [320, 200]", "size = [16385, 1]", "image.size[0]", "lower it"),
        ("size = [320, 200]", "size = [320.0, 200]", "image.size[0]", "an integer"),
        ("size = [320, 200]", "size = [320]", "image.size", "found a list of 1"),
        ("size = [320, 200]", "size = \"320x200\"", "image.size", "two integers"),
        ("samples = 16", "samples = 0", "image.samples", "1 to 65536 rays a pixel"),
        ("transparent = true", "transparent = 1", "image.transparent", "true or false"),
        ("vertical_fov = 50", "vertical_fov = 180", "camera.vertical_fov", "179 degrees"),
        ("vertical_fov = 50", "vertical_fov = 0", "camera.vertical_fov", "0.001"),
        ("eye = [0.0, 0.4, 3]", "eye = [0.0, nan, 3]", "camera.eye[1]", "finite"),
        ("eye = [0.0, 0.4, 3]", "eye = [0.0, 3]", "camera.eye", "three numbers"),
        ("eye = [0.0, 0.4, 3]", "eye = [0, 0, 1e300]", "camera.eye[2]", "to 1e15 scene units"),
        ("up = [0.0, 0.0, 2.0]", "up = [0, 0, 0]", "camera.up", "not all zero"),
        ("color = [0.1, 0.2, 1e-7]", "color = [0, -1, 0]", "background.color[1]", "raise it"),
        ("irradiance = [3.0, 2.0, 1.0]", "irradiance = [0, 0, -1]", "lights[0].irradiance[2]", ""),
        ("intensity = [5.0, 6.0, 7.0]", "intensity = [-5, 0, 0]", "lights[1].intensity[0]", ""),
        ("direction = [-0.4, -1.0, -0.3]", "direction = [0, 0.0, -0.0]", "lights[0].direction", ""),
        ("direction = [-0.4, -1.0, -0.3]", "direction = [0, 0, 1e-200]", "lights[0].direction", ""),
        ("scale = 2.5", "scale = 0", "objects[0].transform.scale", "from 1e-12"),
        ("scale = 2.5", "scale = -1", "objects[0].transform.scale", "raise it"),
        ("feature_size = 0.25", "feature_size = 0", "objects[0].surface.feature_size", "or"),
        ("feature_size = 0.25", "feature_size = []", "objects[0].surface.feature_size", "or"),
        (
            "albedo = [0.2, 0.4, 0.6]",
            "albedo = [0.2, 0.4, 1.6]",
            "objects[0].material.albedo[2]",
            "",
        ),
        ("albedo = [0.2, 0.4, 0.6]", "albedo = \"\"", "objects[0].material.albedo", "\"points\""),
        ("points = \"points/knot.ply\"", "points = 3", "objects[0].points", "a point file"),
        ("points = \"points/knot.ply\"", "points = \" \"", "objects[0].points", "a point file"),
    ] {
        let error = error_where(from, to);
        assert!(error.starts_with("scenes/s.toml:"), "{error}");
        assert!(error.contains(&format!(": {path}: found ")), "{to}: {error}");
        assert!(error.contains(expected), "{to}: {error}");
        assert!(!error.contains('\n'), "{error}");
    }
}

#[test]
fn integers_beyond_64_bits_are_out_of_range_not_wrapped() {
    for digits in ["18446744073709551616", "-99999999999999999999999999999999999999999999999999"] {
        let error = error_where("max_bounces = 3", &format!("max_bounces = {digits}"));
        assert!(error.contains("render.max_bounces: found "), "{error}");
    }
}

#[test]
fn unknown_choices_suggest_the_nearest() {
    let error = error_where("kind = \"diffuse\"", "kind = \"glas\"");
    assert!(error.ends_with("did you mean \"glass\"?"), "{error}");
    let error = error_where("loop = \"images\"", "loop = \"xyz\"");
    assert!(error.contains("expected \"images\", \"queue\" or \"auto\"; write e.g. "), "{error}");
}

#[test]
fn tables_and_lists_are_told_apart() {
    let error_list = error(&format!("[[camera]]\n{SMALL}"));
    assert!(error_list.contains("camera: found a list of 1, expected a table; write [camera]"));
    let error_table = error("[objects]\npoints = \"a.ply\"\n");
    assert!(error_table.contains("objects: found a table, expected a list"), "{error_table}");
    assert!(error_table.ends_with("write [[objects]]"), "{error_table}");
}

#[test]
fn a_scene_needs_an_object_and_an_object_its_points() {
    for text in ["", "\u{feff}", "# nothing\n", "[image]\nsize = [1, 1]\n"] {
        let error = error(text);
        assert!(error.starts_with("scenes/s.toml:1:1: objects: missing"), "{error}");
        assert!(error.contains("[[objects]]"), "{error}");
    }
    assert!(error("objects = []").contains("1:11: objects: found a list of 0"));
    let error = error("[[objects]]\nname = \"a\"\n");
    assert!(error.starts_with("scenes/s.toml:1:1: objects[0].points: missing"), "{error}");
}

#[test]
fn light_keys_belong_to_their_kind() {
    let error_point = error_where("direction = [-0.4, -1.0, -0.3]", "position = [1, 1, 1]");
    assert!(error_point.contains("lights[0].direction: missing"), "{error_point}");
    assert!(error_point.contains("lights[0].position: belongs to kind \"point\""), "{error_point}");
    let error_kind = error_where("kind = \"point\"\n", "");
    assert!(error_kind.contains("lights[1].kind: missing"), "{error_kind}");
}

#[test]
fn all_problems_are_reported_in_the_order_of_the_file() {
    let text = FULL.replace("trust = 0.75", "trust = 7").replace("seed = ", "sead = ");
    let error = read_with(&text, &["image.samples=0"]).unwrap_err();
    let keys = ["render.sead", "objects[0].surface.trust", "--set image.samples=0: image.samples"];
    assert_eq!(error.lines().len(), keys.len(), "{error}");
    for (line, key) in error.lines().iter().zip(keys) {
        assert!(line.contains(key), "{error}");
    }
    let many = format!("{SMALL}{}", (0..50).map(|i| format!("a{i} = 1\n")).collect::<String>());
    assert!(error_with(&many, &[]).ends_with("scenes/s.toml: and 30 more"));
}

#[test]
fn syntax_errors_have_line_and_column() {
    let error_syntax = error("[image]\n∂ = \"a\"\n");
    assert!(error_syntax.starts_with("scenes/s.toml:2:1: not valid TOML: "), "{error_syntax}");
    let error_open = error("[image]\nsize = [1, 2\n");
    assert!(error_open.starts_with("scenes/s.toml:"), "{error_open}");
    let error_twice = error("[image]\nsamples = 1\n  samples = 1\n");
    assert!(error_twice.starts_with("scenes/s.toml:3:3: "), "{error_twice}");
}

#[test]
fn columns_count_characters() {
    let error = error("objects = [{ name = \"∂∂\", point = \"a\" }]");
    assert!(error.contains("s.toml:1:27: objects[0].point: unknown key"), "{error}");
}

#[test]
fn deep_nesting_is_an_error_not_a_stack_overflow() {
    let deep = 200_000;
    for text in [
        format!("a = {}", "[".repeat(deep)),
        format!("a = {}1{}", "[".repeat(deep), "]".repeat(deep)),
        format!("a = {}", "{a=".repeat(deep)),
        format!("{}a = 1", "a.".repeat(deep)),
        format!("[{}a]", "a.".repeat(deep)),
    ] {
        assert!(read(&text).is_err());
        assert!(read_with(SMALL, &[&text]).is_err());
    }
}
