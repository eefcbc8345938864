//! A scene that has everything: device and twin to the bit, whatever the loop, the cells a pass, tiles and crops.

use super::*;
use harness::{
    assert_same_bits, assert_same_film, random, render_twin, wavy_sheet, with_attribute,
};
use plan::{RayLoop, Window};

const SIZE: &str = "[image]\nsize = [72, 54]\nsamples = 3\n";

const SCENE: &str = "
[camera]
eye = [0.5, 1.4, 4.5]
target = [0.0, 0.2, 0.0]
vertical_fov = 40.0
[[lights]]
kind = \"directional\"
direction = [-0.4, -1.0, -0.3]
irradiance = [3.0, 2.9, 2.7]
[[lights]]
kind = \"point\"
position = [0.8, 1.9, 1.0]
intensity = [4.0, 5.0, 6.0]
radius = 0.4
[[objects]]
points = \"sheet.ply\"
[[objects]]
points = \"glass.ply\"
transform = { translate = [-0.6, 0.6, 0.4], scale = 0.8 }
material = { kind = \"glass\", ior = [1.4, 1.5, 1.65], absorption = [0.1, 0.3, 0.9] }
[[objects]]
points = \"bubble.ply\"
transform = { translate = [-0.6, 0.6, 0.4], scale = 0.4 }
material = { kind = \"glass\", ior = 1.0, priority = 1 }
[[objects]]
points = \"solid.ply\"
transform = { translate = [-0.6, 0.6, 0.4], scale = 0.2 }
material = { texture = \"checks.png\" }
[[objects]]
points = \"mirror.ply\"
transform = { translate = [1.0, 0.5, -0.6], scale = 0.7 }
material = { kind = \"mirror\", reflectance = [0.9, 0.8, 0.7] }
[[objects]]
points = \"fog.ply\"
[objects.volume]
scalar = \"s\"
radius = 0.35
step = 0.1
shading = \"scatter\"
anisotropy = 0.5
transfer = [{ value = 0.0, color = [0.9, 0.8, 0.7], extinction = 0.1 }, { value = 1.0, color = [0.5, 0.8, 0.9], extinction = 2.0, emission = [0.1, 0.0, 0.05] }]
";

fn sets() -> Vec<PointSet> {
    let sheet = wavy_sheet(3_000).into_iter();
    let mut sheet: PointSet =
        set_of(sheet.map(|[x, y, z]| [5.0 * (x - 0.5), y - 0.4, 5.0 * (z - 0.5)]).collect());
    let mut seed = 5;
    sheet.colors = Some((0..3_000).map(|_| [0; 3].map(|_| random(&mut seed) as f32)).collect());
    let mut sets = vec![sheet];
    sets.extend([4_000, 2_000, 1_000, 2_000].map(|count| set_of(fibonacci_sphere(count))));
    let fog = (0..600).map(|_| {
        let at = [0; 3].map(|_| random(&mut seed));
        [1.2 * at[0], 0.9 * at[1], 1.2 * at[2]]
    });
    sets.push(with_attribute(set_of(fog.collect()), "s", |p| p[0].min(1.0)));
    sets
}

fn noise(width: u32, height: u32) -> Arc<Image> {
    let mut seed = 11;
    let texels = (0..width * height).map(|_| [0; 3].map(|_| random(&mut seed) as f32)).collect();
    Arc::new(Image { width, height, texels: film::Texels::Linear(texels) })
}

fn everything(image: &str, render: &str, background: &str) -> Plan {
    let text = format!(
        "{image}[render]\nfresnel = \"sample\"\nclamp = 2.0\n{render}\n[background]\n{background}\n{SCENE}"
    );
    let environment = background.starts_with("env").then(|| noise(64, 32));
    let mut textures = vec![None; 6];
    textures[3] = Some(noise(9, 17));
    plan_with(&text, &sets(), &SceneImages { environment, textures })
}

const IMAGE: &str = "environment = \"sky.exr\"\nrotate = [10.0, 200.0, -30.0]";
const SKY: &str = "sky = { elevation = 30.0, sun_angle = 4.0 }";

#[test]
fn everything_is_the_same_to_the_bit_with_either_loop() {
    let bench = Bench::open();
    for (integrator, background) in [("path", IMAGE), ("path", SKY), ("sky", IMAGE), ("sky", SKY)] {
        let mut plan = everything(SIZE, &format!("integrator = \"{integrator}\""), background);
        let twin = render_twin(&plan);
        let lit = twin.film.color.iter().filter(|color| color[0] > 0.0).count();
        assert!(lit > 3_000, "{integrator}, {background}: {lit} pixels are lit");
        for (form, cells) in [(RayLoop::Queue, 0), (RayLoop::Images, 0), (RayLoop::Queue, 3)] {
            (plan.ray_loop, plan.cells_per_pass) = (form, cells);
            let name = format!("{integrator}, {background}, {form:?}, {cells}");
            assert_same_bits(&name, &bench.render(&plan), &twin);
        }
    }
}

/// Crops, whose pixels are other invocations, and pictures of several tiles; a picture is not of its threads, since
/// the twin's bits are the device's.
#[test]
fn crops_and_tiles_show_the_pixels_of_the_whole() {
    let bench = Bench::open();
    for integrator in ["path", "sky"] {
        let mut plan = everything(SIZE, &format!("integrator = \"{integrator}\""), IMAGE);
        let whole = bench.render(&plan).film;
        plan.window = Window { origin: [23, 11], size: [31, 37] };
        let crop = bench.render(&plan).film;
        assert_same_film(integrator, &crop, &render_twin(&plan).film);
        for (i, color) in crop.color.iter().enumerate() {
            let at = (11 + i / 31) * 72 + 23 + i % 31;
            assert_eq!(
                (color, crop.depth[i]),
                (&whole.color[at], whole.depth[at]),
                "{integrator}, {i}"
            );
        }
    }
    let mut plan = everything("[image]\nsize = [1040, 40]\n", "integrator = \"path\"", SKY);
    let whole = bench.render(&plan).film;
    plan.window = Window { origin: [1000, 3], size: [40, 30] };
    let crop = render_twin(&plan).film;
    for (i, color) in crop.color.iter().enumerate() {
        let at = (3 + i / 40) * 1040 + 1000 + i % 40;
        assert_eq!(color, &whole.color[at], "tiles, {i}");
    }
}
