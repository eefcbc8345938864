//! Colours of objects.

use super::{SMALL, error_with, read_with};
use crate::*;

#[test]
fn attributes_have_a_map_and_their_own_range_if_none_is_given() {
    let scene = read_with(SMALL, &["objects.0.material.albedo=attribute:z"]).unwrap();
    let height = Albedo::Attribute {
        name: "z".into(),
        color_map: ColorMap::Viridis,
        range: None,
        scale: Scale::Linear,
    };
    assert_eq!(scene.objects[0].material.albedo, height);
    for (map, name) in ColorMap::ALL.into_iter().zip(ColorMap::NAMES) {
        assert_eq!(map.name(), name);
        assert_eq!(format!("{map:?}").to_lowercase(), name);
    }
}

#[test]
fn colors_that_exclude_each_other_are_errors() {
    let cases: [(&[&str], &str); 16] = [
        (
            &["objects.0.material.albedo=[1, 1, 1]", "objects.0.material.texture=a.png"],
            "objects[0].material.texture: found both albedo and texture",
        ),
        (
            &["background.color=[1, 1, 1]", "background.environment=a.exr"],
            "background.environment: found both color and environment",
        ),
        (
            &["background.sky={}", "background.environment=a.exr"],
            "background.sky: found both environment and sky, expected one of them; remove one",
        ),
        (
            &["background.sky={}", "background.color=[0, 0, 0]"],
            "background.sky: found both color and sky",
        ),
        (
            &["background.gradient=[[0, 0, 0], [1, 1, 1]]", "background.sky={}"],
            "background.gradient: found both sky and gradient",
        ),
        (
            &["background.sky={}", "background.rotate=[0, 90, 0]"],
            "background.rotate: found angles, expected none without environment, which they turn; turn the sky by \
             sky.azimuth",
        ),
        (
            &["background.sky={ sun = [0, 1, 0], azimuth = 3 }"],
            "background.sky.azimuth: found both sun and azimuth",
        ),
        (&["background.sky.sun=[0, 1e-200, 0]"], "background.sky.sun: found a length of 1e-200"),
        (
            &["background.gradient=[[0, 0, 0], [1, -1, 1]]"],
            "background.gradient[1][1]: found -1, expected a number from 0 to 1e15",
        ),
        (&["objects.0.material.texture_axis=x"], "there is none; add texture, or remove it"),
        (
            &["objects.0.material.color_map=turbo"],
            "there is none; write albedo = \"attribute:NAME\"",
        ),
        (
            &["objects.0.material.albedo=points", "objects.0.material.value_range=[0, 1]"],
            "objects[0].material.value_range: belongs to the albedo of an attribute",
        ),
        (&["objects.0.material.value_range=[1]"], "expected two numbers"),
        (&["objects.0.material.albedo=attribute:"], "found the string \"attribute:\", expected"),
        (&["objects.0.material.albedo=attribut:z"], "\"attribute:\" and the name of an attribute"),
        (
            &["objects.0.material.albedo=attribute:z", "objects.0.material.color_map=virdis"],
            "did you mean \"viridis\"?",
        ),
    ];
    for (overrides, expected) in cases {
        let error = error_with(SMALL, overrides);
        assert!(error.contains(expected) && error.lines().count() == 1, "{overrides:?}: {error}");
    }
}
