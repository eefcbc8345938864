//! Rays that graze coarse skins, and miss their way out.

use super::*;

/// A coarse skin of 500 points, whose way out a grazing ray does not always see: behind it, nothing but the smoke's shadow,
/// and only the glass's, up to lamps near and infinitely far. Chords under half a trust radius are missed, here 0.1.
#[test]
fn rays_that_graze_a_coarse_skin_lose_no_light_beyond_it() {
    let set = with_attribute(smoke(8_000, 0.97), "s", |_| 1.0);
    let coarse = |set: &PointSet| {
        let mut positions: Vec<V3> = set.positions.iter().copied().take(8_000).collect();
        positions.extend(fibonacci_sphere(500));
        let mut coarse = set_of(positions);
        let on_skin = (0..8_500).map(|i| f64::from(i >= 8_000)).collect();
        coarse.attributes.push(Attribute { name: "skin".into(), values: Values::F64(on_skin) });
        with_attribute(coarse, "s", |_| 1.0)
    };
    let smoky = coarse(&set);
    let skin = set_of(fibonacci_sphere(500));
    for light in [Light::Sun, Light::Lamp([0.6, 2.8, 0.3])] {
        for (object, set, sigma) in [
            (
                format!("material = {{ kind = \"glass\", ior = 1.0 }}\n{FOG}boundary = \"skin\"\n"),
                &smoky,
                1.5,
            ),
            (
                "material = { kind = \"glass\", ior = 1.0, absorption = [1.5, 1.5, 1.5] }\n"
                    .to_owned(),
                &skin,
                1.5,
            ),
        ] {
            let text = format!(
                "{}{}{FLOOR}[[objects]]\npoints = \"smoke.ply\"\n{object}",
                VIEW.text(),
                light.text()
            );
            let plan = plan_of(&text, &[floor(), set.clone()]);
            assert_eq!(plan.lamp_media, [Some(vec![])], "the lamp is outside");
            let film = render_twin(&plan).film;
            let mut worst = f64::NEG_INFINITY;
            for pixel in 0..film.color.len() {
                let Some((x, towards, irradiance)) = seen_floor(pixel, 1.06, light) else {
                    continue;
                };
                let lit = 0.8 * FRAC_1_PI * irradiance * towards[1];
                let [inside, nearest] = chord(x, towards, 1.0);
                if nearest < 0.9 {
                    continue;
                }
                // Of a grazing ray, at most the chord may be missed.
                let left = f64::from(film.color[pixel][0]) / lit;
                worst = worst.max((-sigma * (inside + 0.1)).exp() - left);
            }
            assert!(worst < 0.0, "{worst} of the light is lost beyond what a chord takes");
        }
    }
}

/// Before the background no ray that grazes a coarse ball is darker than the longest chord makes it: what the glass of a
/// ray takes whose way out was missed is not infinite.
#[test]
fn rays_that_graze_a_coarse_ball_do_not_end_in_it() {
    let bench = Bench::open();
    for count in [200, 500, 1_500] {
        let text = "[image]\nsize = [320, 240]\n[camera]\neye = [0.4, 0.9, 4.0]\ntarget = [0.0, 0.0, 0.0]\n\
                    vertical_fov = 35.0\n[background]\ncolor = [1.0, 1.0, 1.0]\n[[objects]]\npoints = \"ball.ply\"\n\
                    material = { kind = \"glass\", ior = 1.0, absorption = [0.5, 0.5, 0.5] }\n";
        let plan = plan_of(text, &[set_of(fibonacci_sphere(count))]);
        let film = bench.render(&plan).film;
        let darkest = film.color.iter().map(|color| color[0]).fold(1.0, f32::min);
        // A ball of few points bulges by less than a hundredth.
        assert!(darkest > (-0.5f32 * 2.04).exp(), "{count}: {darkest}");
        assert!(darkest < (-0.5f32 * 1.95).exp(), "{count}: {darkest}");
    }
}
