//! Uniform light from everywhere, and the inside of a sphere.

use super::*;

const VIEW: View = View { eye: [0.9, 0.7, 2.4], target: [0.0; 3], fov: 44.0, size: [32, 32] };

fn white() -> Arc<Image> {
    Arc::new(harness::analytic::environment_of(16, |_| [1.0; 3]))
}

/// A convex body shows ρL whatever the integrator; a white one in a white furnace is white however often light may go on,
/// since all that leaves it meets the furnace. Ways that the points' polynomials cut, near to tangential, are the floor.
#[test]
fn a_convex_body_shows_its_albedo() {
    let radiance = [1.0, 0.5, 2.0];
    let sets = [set_of(fibonacci_sphere(4_000))];
    for (albedo, samples) in [(0.6, 32), (1.0, 32)] {
        for render in [
            "integrator = \"sky\"",
            "integrator = \"path\"\nmax_bounces = 0",
            "integrator = \"path\"\nmax_bounces = 1",
            "integrator = \"path\"\nmax_bounces = 8",
        ] {
            let text = format!(
                "{}samples = {samples}\nfilter_width = 0.2\n[render]\n{render}\n[background]\ncolor = {radiance:?}\n\
                 [[objects]]\npoints = \"ball.ply\"\nmaterial = {{ albedo = {:?} }}\n",
                VIEW.text(),
                [albedo; 3]
            );
            let expected = radiance.map(|l| albedo * l);
            check(
                &format!("ball of {albedo}, {render:?}"),
                &plan(&text, &sets, None),
                2e-5,
                |pixel| ball(pixel, &VIEW).then_some(expected),
            );
        }
    }
}

/// An image of one colour is that colour, though directions are drawn by its table too.
#[test]
fn an_image_of_one_colour_lights_as_the_colour_does() {
    let image = white();
    for integrator in ["sky", "path"] {
        let text = format!(
            "{}samples = 128\nfilter_width = 0.2\n[render]\nintegrator = \"{integrator}\"\n\
             [background]\nenvironment = \"sky.exr\"\n\
             [[objects]]\npoints = \"ball.ply\"\nmaterial = {{ albedo = [0.8, 0.8, 0.8] }}\n",
            VIEW.text(),
        );
        let plan = plan(&text, &[set_of(fibonacci_sphere(4_000))], Some(&image));
        check(&format!("image, {integrator}"), &plan, 2e-5, |pixel| {
            ball(pixel, &VIEW).then_some([0.8; 3])
        });
    }
}

/// Glass over a white plane, with a mirror beside it: all is white, by the colour and by an image's table, and whatever is
/// seen through what.
#[test]
fn glass_and_mirrors_in_a_white_furnace_are_white() {
    let image = white();
    let view = View { eye: [0.0, 1.6, 4.0], target: [0.3, 0.6, 0.0], fov: 40.0, size: [32, 24] };
    for background in ["color = [1.0, 1.0, 1.0]", "environment = \"sky.exr\""] {
        let text = format!(
            "{}samples = 96\n[render]\nintegrator = \"path\"\nfresnel = \"sample\"\nmax_bounces = 1024\n\
             [background]\n{background}\n\
             [[objects]]\npoints = \"plane.ply\"\nmaterial = {{ albedo = [1.0, 1.0, 1.0] }}\n\
             [[objects]]\npoints = \"glass.ply\"\nmaterial = {{ kind = \"glass\", ior = [1.45, 1.5, 1.6] }}\n\
             [[objects]]\npoints = \"mirror.ply\"\nmaterial = {{ kind = \"mirror\" }}\n",
            view.text()
        );
        let ball = fibonacci_sphere(4_000);
        let sets = [
            set_of(lattice(3.0, 0.06, 0.0)),
            set_of(moved(&ball, [-0.5, 1.05, 0.0])),
            set_of(moved(&ball, [1.6, 1.05, 0.0])),
        ];
        let image = background.starts_with("env").then_some(&image);
        check(background, &plan(&text, &sets, image), 1e-4, |_| Some([1.0; 3]));
    }
}

/// A lamp in the middle of a matt sphere lights every place with I/R², and each order of scattered light is ρ times the one
/// before: after m bounces ρ/π I/R² (1 − ρ^(m+1)) / (1 − ρ). The
/// floor is for what points lose, rays between patches at a grazing angle: at 4 bounces 5.6e-4 of the mean over three albedos with
/// 2 000 points, 1.3e-4 with 8 000, and (0.1 ± 0.2)e-4 with 32 000, of 1.5·10⁶ samples or more.
#[test]
fn light_inside_a_sphere_is_a_geometric_series() {
    let view = View { eye: [0.3, 0.1, 0.2], target: [-1.0, 0.2, -0.4], fov: 70.0, size: [32, 32] };
    let albedo = [0.2, 0.5, 0.8];
    for bounces in [0, 4, 200] {
        let text = format!(
            "{}samples = 96\n[render]\nintegrator = \"path\"\nmax_bounces = {bounces}\n\
             [[lights]]\nkind = \"point\"\nposition = [0.0, 0.0, 0.0]\nintensity = [2.0, 2.0, 2.0]\n\
             [[objects]]\npoints = \"sphere.ply\"\nmaterial = {{ albedo = {albedo:?} }}\n",
            view.text()
        );
        let expected = albedo
            .map(|rho: f64| rho * FRAC_1_PI * 2.0 * (1.0 - rho.powi(bounces + 1)) / (1.0 - rho));
        let plan = plan(&text, &[set_of(fibonacci_sphere(8_000))], None);
        check(&format!("inside, {bounces} bounces"), &plan, 3e-4, |_| Some(expected));
    }
}
