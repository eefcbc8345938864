//! Volumes (\[T\] §6): Eq. 3 against its definition, Beer and Lambert's law, and the twin's bits.
#![allow(clippy::expect_used, reason = "a test fails by panicking")]

#[path = "volume/modes.rs"]
mod modes;

use film::Film;
use harness::{
    Bench, assert_same_bits, assert_same_film, fibonacci_sphere, grid_points, plan_of, random,
    render_twin, set_of, shared_data, with_attribute,
};
use kernels::layout;
use plan::{Plan, RayLoop, SceneImages};
use points::PointSet;
use reference::real::V3;
use reference::volume;
use scene::{Scene, Up};
use std::path::Path;
use std::sync::Arc;

const CAMERA: &str = "
[camera]
eye = [0.3, 0.4, 4.0]
target = [0.0, 0.0, 0.0]
vertical_fov = 36.0
";

/// A smooth field over the cube of side 2.
fn field([x, y, z]: [f64; 3]) -> f64 {
    0.5 + 0.5 * (2.0 * x).sin() * (1.5 * y + 0.4).cos() * (1.0 - 0.3 * z)
}

/// Random points in the cube that carry the field.
fn cloud(count: usize) -> PointSet {
    let mut seed = 11;
    let positions: Vec<[f64; 3]> =
        (0..count).map(|_| [0; 3].map(|_| 2.0 * random(&mut seed) - 1.0)).collect();
    with_attribute(set_of(positions), "s", field)
}

const TRANSFER: &str = "transfer = [
  { value = 0.0, color = [0.0, 0.1, 1.0], extinction = 0.0 },
  { value = 0.6, color = [1.0, 0.3, 0.0], extinction = 2.0 },
  { value = 1.0, color = [1.0, 0.9, 0.2], extinction = 6.0 },
]";

/// The same transfer function in f64.
fn transfer(s: f64) -> ([f64; 3], f64) {
    let stops =
        [(0.0, [0.0, 0.1, 1.0], 0.0), (0.6, [1.0, 0.3, 0.0], 2.0), (1.0, [1.0, 0.9, 0.2], 6.0)];
    let s = s.clamp(0.0, 1.0);
    let i = usize::from(s > 0.6);
    let part = (s - stops[i].0) / (stops[i + 1].0 - stops[i].0);
    let mix = |a: f64, b: f64| a + part * (b - a);
    ([0, 1, 2].map(|c| mix(stops[i].1[c], stops[i + 1].1[c])), mix(stops[i].2, stops[i + 1].2))
}

fn volume_scene(size: &str, radius: f64, step: f64) -> String {
    format!(
        "[image]\nsize = {size}\n{CAMERA}
[[objects]]
points = \"cloud.ply\"
[objects.volume]
scalar = \"s\"
radius = {radius}
smoothing = {}
step = {step}
{TRANSFER}
",
        radius * radius / 4.0
    )
}

/// Eq. 3 by its definition, over all points.
fn direct(set: &PointSet, values: &[f64], x: [f64; 3], radius: f64) -> Option<f64> {
    let rho = radius * radius / 4.0;
    let (mut numerator, mut denominator) = (0.0, 0.0);
    for (p, value) in set.positions.iter().zip(values) {
        let square: f64 = (0..3).map(|axis| (p[axis] - x[axis]).powi(2)).sum();
        if square <= radius * radius {
            let weight = (-square / (2.0 * rho)).exp();
            numerator += weight * value;
            denominator += weight;
        }
    }
    (denominator > 0.0).then(|| numerator / denominator)
}

const EYE: [f64; 3] = [0.3, 0.4, 4.0];

/// The unit direction of a pixel of 24 by 18, by the camera's definition.
fn direction(i: u32, j: u32) -> [f64; 3] {
    let half = (18f64).to_radians().tan();
    let norm = |v: [f64; 3]| {
        let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
        v.map(|x| x / length)
    };
    let forward = norm(EYE.map(|x| -x));
    let right = norm([-forward[2], 0.0, forward[0]]);
    let up = [
        right[1] * forward[2] - right[2] * forward[1],
        right[2] * forward[0] - right[0] * forward[2],
        right[0] * forward[1] - right[1] * forward[0],
    ];
    let x = (f64::from(i) + 0.5 - 12.0) * half / 9.0;
    let y = (9.0 - f64::from(j) - 0.5) * half / 9.0;
    norm([0, 1, 2].map(|a| forward[a] + x * right[a] + y * up[a]))
}

/// Where a ray from the eye is in the points' bounding box grown by the radius.
fn way(set: &PointSet, radius: f64, d: [f64; 3]) -> [f64; 2] {
    let low = [0, 1, 2].map(|a| set.positions.iter().map(|p| p[a]).fold(9.0, f64::min) - radius);
    let high = [0, 1, 2].map(|a| set.positions.iter().map(|p| p[a]).fold(-9.0, f64::max) + radius);
    let (mut enter, mut leave) = (0.0f64, f64::INFINITY);
    for a in 0..3 {
        let (s, t) = ((low[a] - EYE[a]) / d[a], (high[a] - EYE[a]) / d[a]);
        enter = enter.max(s.min(t));
        leave = leave.min(s.max(t));
    }
    [enter, leave]
}

/// Acceptance: 20 000 random points, step 0.005 in a cloud two units wide, 95 of 100 pixels within 4e-3.
#[test]
fn a_random_cloud_agrees_with_a_direct_evaluation_of_equation_3() {
    let (radius, step) = (0.12, 0.005);
    let set = cloud(20_000);
    let values: Vec<f64> = set.attribute("s").expect("values").iter().collect();
    let film = {
        let plan = plan_of(&volume_scene("[24, 18]", radius, step), std::slice::from_ref(&set));
        Bench::open().render(&plan).film
    };
    let eye = EYE;
    let mut errors = Vec::new();
    for j in (0..18).step_by(3) {
        for i in (0..24).step_by(3) {
            let d = direction(i, j);
            let [enter, leave] = way(&set, radius, d);
            let (mut color, mut through) = ([0.0; 3], 1.0);
            let mut t = enter + 0.5 * step;
            while t < leave {
                if let Some(s) = direct(&set, &values, [0, 1, 2].map(|a| eye[a] + t * d[a]), radius)
                {
                    let (c, sigma) = transfer(s);
                    let alpha = 1.0 - (-sigma * step).exp();
                    color = [0, 1, 2].map(|k| color[k] + through * alpha * c[k]);
                    through *= 1.0 - alpha;
                }
                t += step;
            }
            let seen = film.color[(j * 24 + i) as usize];
            let error = (0..3).map(|k| (f64::from(seen[k]) - color[k]).abs()).fold(0.0, f64::max);
            errors.push(error.max((f64::from(seen[3]) - (1.0 - through)).abs()));
        }
    }
    errors.sort_by(f64::total_cmp);
    let (median, p95) = (errors[errors.len() / 2], errors[errors.len() * 95 / 100]);
    println!("Eq. 3: median {median:.1e}, 95th percentile {p95:.1e}, limit 4e-3");
    assert!(p95 < 4e-3, "95th percentile {p95}");
    assert!(film.color.iter().any(|c| c[3] > 0.9), "nothing was seen");
}

/// The ray ends where the transmittance is under 1e-30, which is 0: the brightest emission that a scene may state,
/// behind that, changes no bit.
#[test]
fn nothing_behind_an_opaque_volume_changes_a_bit() {
    let object = |z: f64, stops: &str| {
        format!(
            "[[objects]]\npoints = \"c.ply\"\ntransform.translate = [0.0, 0.0, {z}]\n[objects.volume]\n\
             scalar = \"s\"\nradius = 0.4\nstep = 0.02\ntransfer = [{{ value = 0.0, {stops} }}]\n"
        )
    };
    let wall = object(0.0, "color = [1e-6, 0.0, 0.0], extinction = 60.0");
    let sun = object(-3.0, "color = [1e15, 1e15, 1e15], extinction = 1.0");
    let view = "[image]\nsize = [16, 16]\n[camera]\neye = [0.0, 0.0, 4.0]\ntarget = [0.0, 0.0, 0.0]\n\
                vertical_fov = 20.0\n";
    let set = with_attribute(set_of(cloud(2_000).positions), "s", |_| 1.0);
    let bench = Bench::open();
    let both =
        bench.render(&plan_of(&(view.to_owned() + &wall + &sun), &[set.clone(), set.clone()]));
    // As far away, so that both scenes are centred alike, and thin.
    let dark = sun.replace("extinction = 1.0", "extinction = 0.0");
    let alone = bench.render(&plan_of(&(view.to_owned() + &wall + &dark), &[set.clone(), set]));
    assert_same_film("behind", &both.film, &alone.film);
    assert!(both.film.color.iter().all(|color| color[0] > 0.0 && color[3] == 1.0), "a wall");
}

/// Midpoints are of second order where extinction is smooth along the ray: here the field fades at the faces of the
/// cube to values that are not seen, and the weights are e^-8 at the radius. Where a cloud ends at once, as it does
/// by Eq. 3 a radius beyond its last points, one step counts or not: first order.
#[test]
fn the_picture_converges_with_the_square_of_the_step() {
    let bench = Bench::open();
    let fading = |p: [f64; 3]| field(p) * p.iter().map(|x| 1.0 - x * x).product::<f64>();
    let set = with_attribute(set_of(cloud(16_000).positions), "s", fading);
    let film = |step: f64| {
        let text =
            volume_scene("[32, 24]", 0.3, step).replace("smoothing = 0.0225", "smoothing = 0.0056");
        assert!(text.contains("smoothing = 0.0056"));
        let text = text.replace("value = 0.0", "value = 0.2");
        bench.render(&plan_of(&text, std::slice::from_ref(&set))).film
    };
    let finest = film(0.0025);
    let errors = [0.08, 0.04, 0.02].map(|step| {
        let coarse = film(step);
        let squares: f64 = (coarse.color.iter().zip(&finest.color))
            .map(|(a, b)| (0..3).map(|c| f64::from(a[c] - b[c]).powi(2)).sum::<f64>())
            .sum();
        (squares / (3.0 * finest.color.len() as f64)).sqrt()
    });
    println!("steps 0.08, 0.04, 0.02: {errors:.6?}");
    assert!(errors[0] / errors[1] > 3.0 && errors[1] / errors[2] > 3.0, "{errors:?}");
}

/// A ball of glass (1.33) full of points that all have the value 1.
fn fog_ball() -> PointSet {
    let mut seed = 5;
    let mut positions = fibonacci_sphere(10_000);
    while positions.len() < 20_000 {
        let p = [0; 3].map(|_| 2.0 * random(&mut seed) - 1.0);
        if p.iter().map(|x| x * x).sum::<f64>() < 0.97 {
            positions.push(p);
        }
    }
    let is_skin = |p: [f64; 3]| f64::from(p.iter().map(|x| x * x).sum::<f64>() > 0.99);
    with_attribute(with_attribute(set_of(positions), "s", |_| 1.0), "skin", is_skin)
}

fn fog_ball_scene(background: f64, color: [f64; 3], absorption: [f64; 3]) -> String {
    format!(
        "[image]\nsize = [96, 72]\n{CAMERA}
[background]
color = [{background}, {background}, {background}]
[[objects]]
points = \"fog.ply\"
material = {{ kind = \"glass\", ior = 1.33, absorption = {absorption:?} }}
[objects.volume]
scalar = \"s\"
radius = 0.2
step = 0.01
boundary = \"skin\"
transfer = [{{ value = 1.0, color = {color:?}, extinction = 0.8 }}]
"
    )
}

/// The refracted chord 2 cos θt of a pixel that shows the ball within 0.93 of its radius.
fn refracted_chord(film: &Film, pixel: usize) -> Option<f64> {
    let p = film.position[pixel].map(f64::from);
    let d: Vec<f64> = (0..3).map(|a| p[a] - EYE[a]).collect();
    let length = d.iter().map(|x| x * x).sum::<f64>().sqrt();
    let cosine = -(0..3).map(|a| p[a] * d[a] / length).sum::<f64>();
    let sine = (1.0 - cosine * cosine).sqrt();
    let seen = film.object[pixel] >= 0.0 && sine < 0.93;
    seen.then(|| 2.0 * (1.0 - (sine / 1.33).powi(2)).sqrt())
}

/// A glass ball (1.33) full of constant fog: Beer and Lambert along the refracted chord, within 1.5e-2.
#[test]
fn fog_in_a_glass_ball_obeys_beer_and_lambert_along_the_refracted_chord() {
    let plan = plan_of(&fog_ball_scene(1.0, [0.0; 3], [0.0; 3]), &[fog_ball()]);
    let on_device = Bench::open().render(&plan);
    assert_same_bits("fog", &on_device, &render_twin(&plan));
    let film = &on_device.film;
    let mut errors = Vec::new();
    for (at, color) in film.color.iter().enumerate() {
        assert!(film.object[at] >= 0.0 || color[0] == 1.0, "the background beside the ball");
        if let Some(chord) = refracted_chord(film, at) {
            errors.push((f64::from(color[1]) - (-0.8 * chord).exp()).abs());
        }
    }
    let worst = errors.iter().copied().fold(0.0, f64::max);
    println!("fog in glass: worst of {} pixels {worst:.1e}, limit 1.5e-2", errors.len());
    assert!(errors.len() > 1_000 && worst < 1.5e-2, "{worst}");
}

/// Glowing fog in glass that absorbs: L = c σ/(σ + a) (1 − e^(−(σ + a)ℓ)) along the chord ℓ, channel by channel.
#[test]
fn glass_dims_what_the_fog_inside_of_it_emits() {
    let (glow, absorption) = ([1.0, 0.6, 0.3], [1.5, 0.5, 0.0]);
    let plan = plan_of(&fog_ball_scene(0.0, glow, absorption), &[fog_ball()]);
    let on_device = Bench::open().render(&plan);
    assert_same_bits("glowing fog", &on_device, &render_twin(&plan));
    let film = &on_device.film;
    let mut worst = 0.0f64;
    for (at, color) in film.color.iter().enumerate() {
        let Some(chord) = refracted_chord(film, at) else { continue };
        for channel in 0..3 {
            let both = 0.8 + absorption[channel];
            let expected = glow[channel] * 0.8 / both * (1.0 - (-both * chord).exp());
            worst = worst.max((f64::from(color[channel]) - expected).abs());
        }
    }
    println!("glowing fog: worst {worst:.1e}");
    // Midpoints of steps of 0.01: (σ a) 0.01²/24 of each term, and the glass as above.
    assert!(worst > 0.0 && worst < 1e-4, "{worst}");
}

/// Two volumes that overlap, a surface between them that throws a shadow and gets one from them, glass in
/// front: the twin gives the device's bits, for any K; and what is skipped changes no byte.
#[test]
fn overlapping_volumes_with_surfaces_are_the_same_to_the_bit() {
    let text = format!(
        "[image]\nsize = [96, 72]\n{CAMERA}
[background]
color = [0.2, 0.3, 0.4]
[[lights]]
kind = \"directional\"
direction = [-0.3, -1.0, -0.2]
irradiance = [3.0, 3.0, 3.0]
[[objects]]
points = \"a.ply\"
[objects.volume]
scalar = \"s\"
{TRANSFER}
[[objects]]
points = \"b.ply\"
transform = {{ scale = 0.7, translate = [0.5, 0.2, 0.6] }}
[objects.volume]
scalar = \"s\"
kernel = \"sum\"
radius = 0.15
transfer = [{{ value = 0.0, color = [0.0, 1.0, 0.0], extinction = 0.0 }},
            {{ value = 4.0, color = [0.5, 1.0, 0.0], extinction = 3.0 }}]
[[objects]]
points = \"floor.ply\"
transform = {{ scale = 4.0, translate = [-2.0, -1.2, -2.0] }}
[[objects]]
points = \"glass.ply\"
transform = {{ scale = 0.4, translate = [-0.4, 0.3, 1.5] }}
material = {{ kind = \"glass\", ior = [1.4, 1.5, 1.6] }}
"
    );
    let sets =
        [cloud(3_000), cloud(2_000), set_of(grid_points(40)), set_of(fibonacci_sphere(2_000))];
    let mut plan = plan_of(&text, &sets);
    let bench = Bench::open();
    let whole = bench.render(&plan);
    assert_same_bits("volumes", &whole, &render_twin(&plan));
    assert!(whole.film.color.as_flattened().iter().all(|value| value.is_finite()));
    let cut = bench.render_within(&plan, Some(200)); // passes that end within a block of places
    assert_same_bits("budget", &whole, &cut);
    let skipped = plan.volumes.cells.iter().filter(|cell| cell.counts == 0).count();
    for cell in &mut plan.volumes.cells {
        cell.counts = 1;
    }
    (plan.cells_per_pass, plan.ray_loop) = (3, RayLoop::Images);
    assert!(skipped > 0);
    assert_same_film("skipping and K", &whole.film, &bench.render(&plan).film);
}

/// `all` and `auto` find the same skin of a solid ball as an attribute does, up to single points.
#[test]
fn the_skin_of_a_solid_is_found() {
    let mut seed = 9;
    let mut positions = fibonacci_sphere(2_000);
    while positions.len() < 12_000 {
        let p = [0; 3].map(|_| 2.0 * random(&mut seed) - 1.0);
        if p.iter().map(|x| x * x).sum::<f64>() < 0.9 {
            positions.push(p);
        }
    }
    let set = with_attribute(set_of(positions), "s", |_| 1.0);
    let text = "[image]\nsize = [32, 24]
[[objects]]
points = \"ball.ply\"
material = { kind = \"glass\", ior = 1.0 }
[objects.volume]
scalar = \"s\"
boundary = \"auto\"
transfer = [{ value = 1.0, color = [1.0, 1.0, 1.0], extinction = 1.0 }]
";
    let plan = plan_of(text, &[set]);
    let on_skin = plan
        .cloud
        .points
        .iter()
        .filter(|p| p.position.iter().map(|x| x * x).sum::<f32>() > 0.99)
        .count();
    assert!(on_skin > 1_980, "{on_skin} of 2000 points of the skin");
    assert!(plan.cloud.points.len() < 2_200, "{} points", plan.cloud.points.len());
}

/// Particles on two lattices, eight to one in density, as a shock tube has them: h = 1.2 (m/ρ)^(1/3).
fn shock_tube() -> PointSet {
    let mut positions = Vec::new();
    for (low, high, side) in [(-0.5, 0.0, 0.05), (0.0, 0.5, 0.1)] {
        let count = |length: f64| (length / side).round() as u32;
        for k in 0..count(0.4) {
            for j in 0..count(0.4) {
                for i in 0..count(high - low) {
                    let at = |n: u32| (f64::from(n) + 0.5) * side;
                    positions.push([low + at(i), at(j) - 0.2, at(k) - 0.2]);
                }
            }
        }
    }
    let dense = |p: [f64; 3]| p[0] < 0.0;
    let set = with_attribute(set_of(positions), "h", move |p| if dense(p) { 0.06 } else { 0.12 });
    let set = with_attribute(set, "density", move |p| if dense(p) { 1.0 } else { 0.125 });
    with_attribute(set, "u", |p| 1.2 + 0.3 * p[0])
}

/// Σ (m/ρ) A W by its definition, with each particle's own h, whichever way mass and density are given; and the
/// density comes out as what the particles have.
#[test]
fn particles_agree_with_a_direct_evaluation_of_their_sum() {
    let set = shock_tube();
    let of = |name: &str| set.attribute(name).expect("values").iter().collect::<Vec<f64>>();
    let (h, rho, u) = (of("h"), of("density"), of("u"));
    let m = 0.05f64.powi(3);
    let given = "mass = 1.25e-4\ndensity = \"density\"";
    let cases: [(&str, &str, &[f64], f64); 4] = [
        ("u", given, &u, 1.0),
        ("u", "", &u, 1.0),
        ("u", given, &u, 2.5),
        ("density", "mass = 1.25e-4", &rho, 1.0),
    ];
    let bench = Bench::open();
    for (scalar, keys, values, scale) in cases {
        let text = format!(
            "[image]\nsize = [48, 36]\n[[objects]]\npoints = \"tube.ply\"\ntransform.scale = {scale}
[objects.volume]\nscalar = \"{scalar}\"\nkernel = \"sph\"\nsmoothing_length = \"h\"\n{keys}
color_map = \"viridis\"\nextinction = [0.0, 4.0]\n"
        );
        let plan = plan_of(&text, std::slice::from_ref(&set));
        let info = &plan.volumes.infos[0];
        let mut seed = 3;
        let mut worst = 0.0f64;
        for _ in 0..500 {
            let x = [0.9, 0.3, 0.3].map(|side| side * (random(&mut seed) - 0.5));
            let mut sum = 0.0;
            for (i, p) in set.positions.iter().enumerate() {
                let q = (0..3).map(|a| (p[a] - x[a]).powi(2)).sum::<f64>().sqrt() / h[i];
                let w = match q {
                    q if q < 1.0 => 1.0 - 1.5 * q * q + 0.75 * q * q * q,
                    q if q < 2.0 => 0.25 * (2.0 - q).powi(3),
                    _ => 0.0,
                };
                sum += m / rho[i] * values[i] * w / (std::f64::consts::PI * h[i].powi(3));
            }
            let at = V3([0, 1, 2].map(|a| (scale * x[a] - plan.cloud.origin[a]) as f32));
            let found = volume::scalar_at(info, &plan.volumes, at).expect("in reach");
            worst = worst.max((f64::from(found) / sum - 1.0).abs());
        }
        println!("{scalar}, {keys:?}, scale {scale}: worst {worst:.1e}");
        // Some hundred terms of f32, each rounded a few times at d near 2h.
        assert!(worst < 2e-5, "{worst}");
        let on_device = bench.render(&plan);
        assert_same_bits(scalar, &on_device, &render_twin(&plan));
        assert!(on_device.film.color.iter().any(|c| c[3] > 0.1), "nothing was seen");
    }
}

/// A scan thinned to a third of its voxels, put back onto the lattice: as far from the truth as Eq. 3 is in f64.
#[test]
fn ironprot_is_interpolated_back_onto_its_lattice() {
    let [Some(points), Some(lattice)] = ["ironprot_100k.ply", "ironprot_68x68x68_u8.raw"]
        .map(|file| shared_data(&format!("volumes/{file}")))
    else {
        return;
    };
    let set = points::read(&points, &mut |_, _| {}).expect("a readable file");
    let lattice = std::fs::read(lattice).expect("a readable file");
    let text = "[[objects]]\npoints = \"ironprot.ply\"\n[objects.volume]\nscalar = \"density\"
color_map = \"gray\"\nextinction = [0.0, 1.0]\nradius = 2.0\nsmoothing = 0.3\n";
    let plan = plan_of(text, std::slice::from_ref(&set));
    let mut info = plan.volumes.infos[0];
    let mut volumes = plan.volumes.clone();
    // Where nothing is seen, too.
    volumes.cells.iter_mut().for_each(|cell| cell.counts = 1);
    info.stop_count = 1;
    let values: Vec<f64> = set.attribute("density").expect("values").iter().collect();
    let (mut ours, mut exact, mut apart, mut count) = (0.0, 0.0, 0.0f64, 0.0);
    for index in (0..lattice.len()).step_by(311) {
        let x = [index % 68, index / 68 % 68, index / (68 * 68)].map(|i| i as f64);
        let at = V3([0, 1, 2].map(|a| (x[a] - plan.cloud.origin[a]) as f32));
        let (mut numerator, mut denominator) = (0.0, 0.0);
        for (p, value) in set.positions.iter().zip(&values) {
            let square: f64 = (0..3).map(|axis| (p[axis] - x[axis]).powi(2)).sum();
            if square <= 4.0 {
                numerator += (-square / 0.6).exp() * value;
                denominator += (-square / 0.6).exp();
            }
        }
        let Some(found) = volume::scalar_at(&info, &volumes, at).map(f64::from) else {
            assert!(denominator == 0.0, "{x:?} is in reach");
            continue;
        };
        let truth = f64::from(lattice[index]);
        ours += (found - truth).powi(2);
        exact += (numerator / denominator - truth).powi(2);
        apart = apart.max((found - numerator / denominator).abs());
        count += 1.0;
    }
    let [ours, exact] = [ours, exact].map(|sum| f64::sqrt(sum / count));
    println!(
        "ironprot: rms error {ours:.6} of 255, in f64 {exact:.6}; apart by {apart:.1e} at most"
    );
    // Values to 255 by quotients of sums of f32.
    assert!(count > 900.0 && (ours - exact).abs() < 1e-4 && apart < 1e-3);
}
