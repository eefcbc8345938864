//! A black sphere in the sky's way, and spheres of light.

use super::*;
use harness::analytic::{Body, Matter, Shape, dot, follow, length};

const VIEW: View =
    View { eye: [0.5, 4.5, 6.5], target: [0.0, 0.0, 0.0], fov: 40.0, size: [40, 30] };
const HALF: f64 = 5.0;
const MIDDLE: V3 = [0.0, 2.0, 0.0];

/// Where a pixel shows the plane y = 0, and no ball of this radius about [`MIDDLE`] before it.
fn on_plane(pixel: usize, radius: f64) -> Option<V3> {
    let x = on_level(&VIEW, pixel, 0.0)?;
    let clear = VIEW.distance(pixel, MIDDLE) > 1.05 * radius;
    (clear && x[0].abs().max(x[2].abs()) < 0.9 * HALF).then_some(x)
}

/// (1/d)² cos θ of the ball's middle from a place on the plane.
fn share(x: V3) -> f64 {
    let away = add(MIDDLE, x, -1.0);
    away[1] / length(away).powi(3)
}

/// E = πL (1 − (R/d)² cos θ): what the ball covers, wherever all of it is above the horizon.
#[test]
fn a_black_ball_takes_its_share_of_the_sky() {
    let (radius, albedo, radiance) = (1.0, 0.7, 1.5);
    let ball = fibonacci_sphere(4_000);
    let sets = [set_of(lattice(HALF, 0.1, 0.0)), set_of(moved(&ball, MIDDLE))];
    for integrator in ["sky", "path"] {
        let text = format!(
            "{}samples = 128\nfilter_width = 0.2\n[render]\nintegrator = \"{integrator}\"\n\
             [background]\ncolor = {:?}\n\
             [[objects]]\npoints = \"plane.ply\"\nmaterial = {{ albedo = {:?} }}\n\
             [[objects]]\npoints = \"ball.ply\"\nmaterial = {{ albedo = [0.0, 0.0, 0.0] }}\n",
            VIEW.text(),
            [radiance; 3],
            [albedo; 3]
        );
        check(&format!("black ball, {integrator}"), &plan(&text, &sets, None), 2e-5, |pixel| {
            let x = on_plane(pixel, radius)?;
            Some([albedo * radiance * (1.0 - radius * radius * share(x)); 3])
        });
    }
}

/// E = I/d² cos θ, as of a lamp without extent.
#[test]
fn a_sphere_of_light_lights_as_its_middle_does() {
    let albedo = 0.7;
    for integrator in ["direct", "sky", "path"] {
        let text = format!(
            "{}samples = 64\nfilter_width = 0.2\n[render]\nintegrator = \"{integrator}\"\n\
             [[lights]]\nkind = \"point\"\nposition = {MIDDLE:?}\nradius = 0.8\nintensity = [4.0, 4.0, 4.0]\n\
             [[objects]]\npoints = \"plane.ply\"\nmaterial = {{ albedo = {:?} }}\n",
            VIEW.text(),
            [albedo; 3]
        );
        let plan = plan(&text, &[set_of(lattice(HALF, 0.1, 0.0))], None);
        // A pixel's rays lie about its middle, over which light is curved: 1e-5 of it.
        check(&format!("lamp, {integrator}"), &plan, 2e-5, |pixel| {
            Some([albedo * FRAC_1_PI * 4.0 * share(on_plane(pixel, 0.0)?); 3])
        });
    }
}

/// A lamp's radiance I/(πr²), where it is seen in a mirror or through a plate of glass; nothing where the camera looks at it,
/// and with other integrators.
#[test]
fn mirrors_and_glass_show_a_sphere_of_light() {
    let (radius, intensity) = (0.8, 4.0);
    let lamp = |o: V3, d: V3| {
        let from = add(o, MIDDLE, -1.0);
        let along = -dot(from, d);
        (along > 0.0).then(|| length(add(from, d, along)))
    };
    for (material, levels) in [
        ("kind = \"mirror\", reflectance = [0.9, 0.9, 0.9]", &[0.0][..]),
        ("kind = \"glass\"", &[0.5, 0.2]),
    ] {
        for integrator in ["direct", "sky", "path"] {
            let text = format!(
                "{}[render]\nintegrator = \"{integrator}\"\n\
                 [[lights]]\nkind = \"point\"\nposition = {MIDDLE:?}\nradius = {radius}\nintensity = {:?}\n\
                 [[objects]]\npoints = \"sheets.ply\"\nmaterial = {{ {material} }}\n",
                if levels.len() == 1 { VIEW } else { BELOW }.text(),
                [intensity; 3]
            );
            let view = if levels.len() == 1 { VIEW } else { BELOW };
            let sheets = levels.iter().flat_map(|&y| lattice(HALF, 0.1, y)).collect();
            let plan = plan(&text, &[set_of(sheets)], None);
            let bodies = match levels {
                [level] => {
                    vec![Body { shape: Shape::Below(*level), matter: Matter::Mirror([0.9; 3]) }]
                }
                [top, bottom, ..] => vec![
                    Body { shape: Shape::Below(*top), matter: Matter::Glass(1.5, 0.0) },
                    Body { shape: Shape::Below(*bottom), matter: Matter::Glass(1.0, 0.0) },
                ],
                [] => Vec::new(),
            };
            for (by, film) in pictures(&plan) {
                let (mut lit, mut wrong) = (0, 0);
                for (pixel, color) in film.color.iter().enumerate() {
                    let d = view.through(pixel);
                    let way = follow(&bodies, view.eye, d);
                    let inside =
                        way.hits.iter().all(|(_, x)| x[0].abs().max(x[2].abs()) < 0.9 * HALF);
                    let (Some(&(_, last)), true) = (way.hits.last(), inside) else { continue };
                    let passes =
                        lamp(last, way.direction).map_or(f64::INFINITY, |off| off / radius);
                    if (passes - 1.0).abs() < 1e-3 {
                        continue;
                    }
                    let meets = passes < 1.0 && integrator == "path";
                    lit += usize::from(meets);
                    let shine = intensity * FRAC_1_PI / (radius * radius) * way.throughput[0];
                    let expected = if meets { shine } else { 0.0 };
                    wrong += usize::from((f64::from(color[0]) - expected).abs() > 1e-5 * shine);
                }
                assert_eq!(wrong, 0, "{material}, {integrator}, {by}");
                assert!(lit > 30 || integrator != "path", "{lit} pixels show the lamp");
            }
        }
    }
}

/// From below a plate of glass at its foot.
const BELOW: View =
    View { eye: [0.5, -2.5, 3.0], target: [0.0, 1.5, 0.0], fov: 40.0, size: [40, 30] };

/// What the camera sees of a lamp itself is what is beyond it, in every integrator.
#[test]
fn the_camera_sees_no_lamp() {
    let text = format!(
        "{}[render]\nintegrator = \"path\"\n[background]\ncolor = [0.1, 0.1, 0.1]\nlights = false\n\
         [[lights]]\nkind = \"point\"\nposition = {MIDDLE:?}\nradius = 0.8\nintensity = [4.0, 4.0, 4.0]\n\
         [[objects]]\npoints = \"plane.ply\"\ntransform = {{ translate = [0.0, -9.0, 0.0] }}\n",
        View { target: MIDDLE, eye: [0.0, 2.0, 6.0], ..VIEW }.text()
    );
    for (by, film) in pictures(&plan(&text, &[set_of(lattice(1.0, 0.1, 0.0))], None)) {
        assert_eq!(film.color[15 * 40 + 20][..3], [0.1; 3], "{by}");
    }
}
