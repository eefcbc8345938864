//! Environments with a bright patch, turned ones, and a sky with its sun: the light on a plane is their integral.

use super::*;
use harness::analytic::{environment_at, environment_of, looked_up, turned_back};
use kernels::layout::LIGHT_SUN;
use reference::environment::background_at;
use reference::image::Images;

/// A plane that fills the picture.
const VIEW: View = View { eye: [0.5, 4.0, 0.8], target: [0.0; 3], fov: 20.0, size: [32, 24] };

fn scene(integrator: &str, up: V3, background: &str) -> String {
    let View { eye, target, fov, size } = VIEW;
    format!(
        "[camera]\neye = {eye:?}\ntarget = {target:?}\nvertical_fov = {fov}\nup = {up:?}\n\
         [image]\nsize = {size:?}\nsamples = 128\n\
         [render]\nintegrator = \"{integrator}\"\n[background]\n{background}\n\
         [[objects]]\npoints = \"plane.ply\"\nmaterial = {{ albedo = [0.7, 0.7, 0.7] }}\n"
    )
}

/// The light on a level plane that faces +y, of a radiance: ∫ L cos dω = π ∫∫ L du dv, with u = sin² of the angle to +y.
fn irradiance(radiance: impl Fn(V3) -> V3) -> V3 {
    let steps = 1000;
    let mut sums = [0.0; 3];
    for i in 0..steps {
        let square = (f64::from(i) + 0.5) / f64::from(steps);
        let (level, up) = (square.sqrt(), (1.0 - square).sqrt());
        for j in 0..steps {
            let (sin, cos) = (2.0 * PI * (f64::from(j) + 0.5) / f64::from(steps)).sin_cos();
            let seen = radiance([level * cos, up, level * sin]);
            sums = add(sums, seen, PI / f64::from(steps * steps));
        }
    }
    sums
}

/// A dim sky with a rectangle of texels 60 times as bright.
fn patched() -> Arc<Image> {
    let mut image = environment_of(32, |_| [0.5, 0.4, 0.6]);
    let film::Texels::Linear(texels) = &mut image.texels else { panic!("linear") };
    for row in 5..9 {
        for column in 20..25 {
            texels[row * 64 + column] = [30.0, 28.0, 20.0];
        }
    }
    Arc::new(image)
}

/// Directions are drawn by the table and by the lobe, and weighted by both. The integral's own error is 1e-5.
#[test]
fn a_bright_patch_lights_by_its_integral() {
    let image = patched();
    let set = [set_of(lattice(2.0, 0.05, 0.0))];
    for (up, rotate) in [
        ([0.0, 1.0, 0.0], [0.0; 3]),
        ([0.0, 1.0, 0.0], [20.0, -35.0, 60.0]),
        ([0.0, 0.0, 1.0], [0.0, 0.0, 40.0]),
    ] {
        let light = irradiance(|d| environment_at(&image, looked_up(up, turned_back(rotate, d))));
        for integrator in ["sky", "path"] {
            let background = format!("environment = \"sky.exr\"\nrotate = {rotate:?}");
            let plan = plan(&scene(integrator, up, &background), &set, Some(&image));
            let expected = light.map(|e| 0.7 * FRAC_1_PI * e);
            check(&format!("patch, {up:?}, {rotate:?}, {integrator}"), &plan, 3e-5, |_| {
                Some(expected)
            });
        }
    }
}

/// The sky's image as it is seen, and the sun, which is as bright as it is at its height.
#[test]
fn a_sky_lights_by_its_image_and_its_sun() {
    let set = [set_of(lattice(2.0, 0.05, 0.0))];
    for (integrator, angle) in [("sky", 0.53), ("path", 8.0)] {
        let sky = format!("sky = {{ elevation = 35.0, azimuth = 70.0, sun_angle = {angle} }}");
        let plan = plan(&scene(integrator, [0.0, 1.0, 0.0], &sky), &set, None);
        let images = Images { infos: &plan.images, texels: &plan.texels };
        let background = plan.wave_of(&plan.window, 0).background;
        let dome = irradiance(|d| background_at(images, &background, reference::real::V3(d)).0);
        let sun = plan.lights.iter().find(|light| light.kind == LIGHT_SUN).expect("a sun");
        let height = 35f64.to_radians().sin();
        assert!((f64::from(sun.vector[1]) - height).abs() < 1e-6, "{:?}", sun.vector);
        let expected =
            [0, 1, 2].map(|i| 0.7 * FRAC_1_PI * (dome[i] + f64::from(sun.strength[i]) * height));
        check(&format!("sky, {integrator}"), &plan, 3e-5, |_| Some(expected));
    }
}
