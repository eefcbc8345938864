//! Values of the command line over those of the file.

use super::{FULL, SMALL, error_with, read_with};
use crate::*;

#[test]
fn overrides_reach_every_kind_of_place() {
    let scene = read_with(
        SMALL,
        &[
            "objects.0.surface.trust=0.7",
            "objects.0.surface.polynomial=incomplete",
            "objects.0.surface.feature_size = 3",
            "objects.0.material.albedo=[0, 0.5, 1]",
            "objects.0.name=a b",
            "image.size.1=100",
            "camera={ eye = [0, 0, 3], target = [0, 0, 0] }",
            "camera.up.0=0.5",
            "lights=[{ kind = 'point', position = [0, 0, 0], intensity = [1, 1, 1] }]",
            "lights.0.intensity.2=9",
        ],
    );
    let scene = scene.unwrap();
    assert_eq!(scene.objects[0].surface.trust, 0.7);
    assert_eq!(scene.objects[0].surface.polynomial, Polynomial::Incomplete);
    assert_eq!(scene.objects[0].surface.feature_size, FeatureSize::Constant(3.0));
    assert_eq!(scene.objects[0].material.albedo, Albedo::Color([0.0, 0.5, 1.0]));
    assert_eq!(scene.objects[0].name, "a b");
    assert_eq!(scene.image.size, [640, 100], "the other element is the default");
    assert_eq!(scene.camera.whole().unwrap().up, [0.5, 1.0, 0.0]);
    let light = Light::Point { position: [0.0; 3], intensity: [1.0, 1.0, 9.0], radius: 0.0 };
    assert_eq!(scene.lights, [light]);
}

#[test]
fn later_overrides_win() {
    let scene = read_with(FULL, &["render.seed=1", "render.seed=2"]).unwrap();
    assert_eq!(scene.render.seed, 2);
}

#[test]
fn errors_in_overrides_name_the_override() {
    let error = error_with(FULL, &["objects.0.surface.trust=1.7"]);
    let expected = "scenes/s.toml: --set objects.0.surface.trust=1.7: objects[0].surface.trust: \
                    found 1.7, expected a number from 0.5 to 1; \
                    lower it or leave it out (default 0.6)";
    assert_eq!(error, expected);
    for (set, expected) in [
        ("objects.8.name=a", "objects: found index '8', but the list has 8"),
        ("objects.-1.name=a", "use 0 to 7"),
        ("objects.name=a", "found index 'name'"),
        ("render.seed.x=1", "render.seed: found 4294967295, which has no 'x'"),
        ("image.size.2=1", "image.size: found index '2'"),
        ("image.size", "found no '=', expected PATH=VALUE"),
        ("=3", "empty part"),
        ("a..b=3", "empty part"),
        (".a=3", "empty part"),
        ("image.sixe=[1, 1]", "image.sixe: unknown key; did you mean 'size'?"),
        ("objects.0.points=", "objects[0].points: found the string \"\""),
        ("image.size=[1, 2", "image.size: found the string \"[1, 2\""),
    ] {
        let error = error_with(FULL, &[set]);
        assert!(error.starts_with(&format!("scenes/s.toml: --set {set}: ")), "{error}");
        assert!(error.contains(expected), "{set}: {error}");
    }
    assert!(error_with(SMALL, &["lights.0.kind=point"]).contains("lights: found index '0'"));
}
