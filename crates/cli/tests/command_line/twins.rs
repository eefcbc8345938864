//! What a device renders, `--device reference` renders too: every feature, to the bit, and the same counts. On the
//! device that a user gets; on one whose arithmetic may differ, what is asserted is that both do it. That all
//! scenes of `scenes/` are the same is in the end-to-end tests.

use crate::{Folder, Ran, pointillist, run_in, said};
use serde_json::Value;
use std::fmt::Write;

const SCENE: &str = "
[camera]
eye = [0.6, 0.8, 5.0]
target = [0.5, 0.0, 0.0]
[image]
size = [40, 30]
[background]
color = [0.2, 0.3, 0.4]
[[lights]]
kind = \"directional\"
direction = [-1.0, -1.0, -1.0]
irradiance = [3.0, 3.0, 3.0]
[[lights]]
kind = \"point\"
position = [1.0, 3.0, 2.0]
intensity = [5.0, 5.0, 5.0]
[[objects]]
points = \"ball.ply\"
[[objects]]
points = \"ball.ply\"
transform = { scale = 0.8, rotate = [10.0, 20.0, 30.0], translate = [1.6, 0.1, 0.3] }
";

/// A volume, as a value of `--set`.
const VOLUME: &str = "objects.1.volume={ scalar = 'heat', radius = 0.5, step = 0.05, color_map = 'turbo', \
                      extinction = [0.5, 3.0] }";

/// Options, one a line; all but those that begin with a dash are `--set`.
const FEATURES: [&str; 17] = [
    "",
    "--samples 3\nimage.filter=box\ncamera.aperture=0.2\nlights.0.angle=5\nlights.1.radius=0.3\nrender.seed=7",
    "--crop 5,3,20,17\n--channels point,tests,cells,iterations,trust,fit",
    "--channels point,iterations\n--cells-per-pass 1\nrender.loop=images",
    "image.transparent=true\nobjects.0.material={ kind = 'glass', absorption = [0.1, 0.5, 1.0] }",
    "render.fresnel=sample\nobjects.0.material={ kind = 'glass', ior = [1.4, 1.5, 1.6], priority = 1 }\n--samples 2",
    "objects.0.material={ kind = 'glass', abbe = 30.0 }\nobjects.1.material={ kind = 'mirror' }\nrender.max_bounces=3",
    "background={ environment = 'sky.png' }\nobjects.1.material={ kind = 'mirror', reflectance = [0.9, 0.8, 0.7] }",
    "background={ sky = { elevation = 10, ground = [0.3, 0.2, 0.1] } }\ncamera.up=[1, 0, 0]\nobjects.1.material.kind=mirror",
    "background={ gradient = [[0.1, 0.1, 0.2], [0.5, 0.6, 0.9]] }\nobjects.0.material.kind=glass",
    "objects.0.material={ texture = 'sky.png', texture_axis = 'z' }\nobjects.1.material.albedo=attribute:heat",
    "objects.0.surface={ refine = 'project', neighbors = 12, polynomial = 'incomplete' }",
    "objects.0.surface={ close_gaps = false, normals = 'polynomial', feature_size = 0.4, drop_isolated = 3.0 }",
    "camera={ eye = [0, 1, 5], target = [0, 0, 0], projection = 'orthographic', height = 4 }\nrender.primary=grid",
    "VOLUME\nrender.grid_resolution=9",
    "VOLUME\nobjects.1.volume.mode=isosurface\nobjects.1.volume.iso=0.6\nobjects.1.material.kind=mirror",
    "VOLUME\nobjects.1.volume.shading=gradient\nobjects.1.volume.boundary=all\n--half",
];

fn points() -> String {
    let count = 260;
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex {count}\nproperty float x\nproperty float y\nproperty float z\n\
         property float heat\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n"
    );
    for i in 0..count {
        let y = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(count);
        let (sin, cos) = (2.399_963 * f64::from(i)).sin_cos();
        let r = (1.0 - y * y).sqrt();
        writeln!(text, "{} {y} {} {} 200 90 {}", r * cos, r * sin, 0.5 + 0.5 * y, i % 256)
            .expect("a string takes all");
    }
    text
}

#[test]
fn every_feature_is_the_same_on_device_and_cpu() {
    let folder = Folder::new();
    folder.write("ball.ply", &points());
    folder.write("s.toml", SCENE);
    let pixels: Vec<[u8; 3]> = (0..32u8).map(|i| [i * 8, 255 - i * 8, i * 3]).collect();
    film::write_png([8, 4], &pixels, &folder.path().join("sky.png")).expect("a written file");
    let (mut exact, mut through_grid) = (true, 0);
    for feature in FEATURES {
        let render = |device: &[&str], name: &str| -> Value {
            let mut command = pointillist();
            let stats = format!("{name}.json");
            command.current_dir(folder.path()).args(["render", "s.toml", "--quiet"]).args(device);
            command.args(["-o", &format!("{name}.exr"), "--stats", &stats]);
            for option in feature.lines() {
                match option.strip_prefix("--") {
                    Some(_) => command.args(option.split(' ')),
                    None => command
                        .args(["--set", option.strip_prefix("VOLUME").map_or(option, |_| VOLUME)]),
                };
            }
            let ran = Ran::of(&mut command);
            assert_eq!((ran.code, &*ran.stderr), (Some(0), ""), "{feature}");
            let text = std::fs::read_to_string(folder.path().join(stats)).expect("statistics");
            serde_json::from_str(&text).expect("JSON")
        };
        let [device, cpu] = [render(&[], "device"), render(&["--device", "reference"], "cpu")];
        let name = device["device"].as_str().expect("a name");
        exact =
            ["llvmpipe", "SwiftShader Device (Subzero)"].iter().any(|exact| name.contains(exact));
        if exact {
            run_in(folder.path(), &["compare", "device.exr", "cpu.exr", "--max-abs", "0"])
                .succeeds();
            for count in ["points", "rays", "hits", "pixels", "fits", "dropped", "size"] {
                assert_eq!(device[count], cpu[count], "{feature}: {count}");
            }
            // The CPU goes through the grid: where cells are shown or limited, so does the device.
            if device["tree"].is_null() {
                assert_eq!(device["tests_per_ray"], cpu["tests_per_ray"], "{feature}");
                through_grid += 1;
            }
        }
        let keys = |row: &Value| -> Vec<String> {
            row.as_object().expect("a row").keys().cloned().collect()
        };
        assert_eq!(keys(&device), keys(&cpu), "{feature}");
    }
    assert!(!exact || through_grid >= 2, "{through_grid} features");
    if !exact {
        said("SKIPPED: equal bits on device and CPU: this device may round otherwise");
    }
}
