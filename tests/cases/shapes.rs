//! Points drawn as spheres and discs, against closed forms, and the same to the bit whatever way rays take.
#![allow(clippy::expect_used, reason = "a test fails by panicking")]
#![allow(clippy::print_stdout, reason = "measured figures, for whoever asks with --nocapture")]

use film::{Film, Image};
use harness::analytic::{
    Body, Matter, Shape, V3, View, add, cross, dot, environment_at, environment_of, follow, length,
    unit,
};
use harness::{
    Bench, Rendered, assert_same_bits, assert_same_film, fibonacci_sphere, moved, plan_of,
    plan_with, random, render_twin, set_of, with_attribute,
};
use kernels::layout::{FIT_DISC, FIT_SPHERE};
use plan::{Diagnostic, Plan, Primary, RayLoop, SceneImages, Secondary, ShapeKind, Shapes};
use points::{PointSet, Unwatched};
use reference::Reference;
use std::f64::consts::{FRAC_1_PI, PI};
use std::sync::Arc;

const SIZE: [usize; 2] = [160, 120];
const VIEW: View = View { eye: [0.9, 1.1, 3.0], target: [0.1, 0.2, -0.3], fov: 40.0, size: SIZE };
const LIGHT: &str = "
[[lights]]
kind = \"directional\"
direction = [-0.4, -1.0, -0.3]
irradiance = [3.0, 3.0, 3.0]
[background]
color = [0.1, 0.2, 0.3]
";

fn object(surface: &str, material: &str) -> String {
    format!(
        "[[objects]]\npoints = \"s.ply\"\nsurface = {{ {surface} }}\nmaterial = {{ {material} }}\n"
    )
}

/// On the device, after the twin gave the same.
fn checked(name: &str, plan: &Plan) -> Rendered {
    let on_device = Bench::open().render(plan);
    assert_same_bits(name, &on_device, &render_twin(plan));
    on_device
}

/// The greatest errors of depth and, in degrees, of normals beside a sphere, where the ray meets it inside `inner` of
/// its radius; the outline is where it is.
fn errors(film: &Film, middle: V3, radius: f64, inner: f64) -> (f64, f64) {
    let sphere = Shape::Sphere(middle, radius);
    let forward = unit(add(VIEW.target, VIEW.eye, -1.0));
    let (mut depth, mut angle) = (0.0f64, 0.0f64);
    for pixel in 0..SIZE[0] * SIZE[1] {
        let d = VIEW.through(pixel);
        let crossing = sphere.crossing(VIEW.eye, d);
        let passes = VIEW.distance(pixel, middle) / radius;
        if (passes - 1.0).abs() > 1e-5 {
            assert_eq!(film.object[pixel] >= 0.0, crossing.is_some(), "pixel {pixel}: {passes}");
        }
        let Some(t) = crossing.filter(|_| passes < inner) else { continue };
        let normal = unit(add(add(VIEW.eye, d, t), middle, -1.0));
        let found = film.normal[pixel].map(f64::from);
        let across = cross(normal, found);
        depth = depth.max((f64::from(film.depth[pixel]) - t * dot(d, forward)).abs());
        angle = angle.max(length(across).atan2(dot(normal, found)).to_degrees());
    }
    (depth, angle)
}

#[test]
fn a_sphere_is_where_its_radius_says_and_its_normal_is_exact() {
    let (middle, radius) = ([0.1, 0.2, -0.3], 0.8);
    let text = format!("{}{LIGHT}{}", VIEW.text(), object("kind = \"spheres\", radius = 0.8", ""));
    let mut plan = plan_of(&text, &[set_of(vec![middle])]);
    plan.diagnostics = vec![Diagnostic::Fit, Diagnostic::Trust];
    let film = checked("a sphere", &plan).film;
    let (depth, angle) = errors(&film, middle, radius, 0.99);
    println!("f32: depth {depth:.1e}, normal {angle:.1e} degrees");
    // Some steps of f32 at distance 3; near the outline, at 0.99 of the radius, seven times that.
    assert!(depth < 3e-6 && angle < 3e-4, "depth {depth}, normal {angle}");
    let truth = Reference::<f64>::new(&plan, &Unwatched).expect("nobody interrupts");
    let film64 = truth.frame(&plan, &Unwatched).expect("nobody interrupts").finish();
    let (depth, angle) = errors(&film64, middle, radius, 0.99);
    // Directions and positions are written in f32, and the radius is one.
    assert!(depth < 1e-6 && angle < 4e-5, "in f64: depth {depth}, normal {angle}");
    for (pixel, &object) in film.object.iter().enumerate().filter(|(_, object)| **object >= 0.0) {
        assert_eq!(object, 0.0);
        assert_eq!(film.extra[0].1[pixel], FIT_SPHERE as f32);
        assert!((film.extra[1].1[pixel] - 1.0).abs() < 2e-5, "on the trust ball");
    }
}

/// An attribute in the file's units goes with the object's scale; a number does not.
#[test]
fn radii_are_numbers_in_the_scene_or_attributes_in_the_file() {
    let set = with_attribute(set_of(vec![[0.0; 3]]), "size", |_| 0.4);
    for (radius, expected) in [
        ("0.5", 0.5f32),
        ("\"attribute:size\"", 0.8),
        ("\"attribute:size\", radius_scale = 0.25", 0.2),
    ] {
        let surface = format!("kind = \"spheres\", radius = {radius}");
        let text = format!("{}transform = {{ scale = 2.0 }}", object(&surface, ""));
        assert_eq!(plan_of(&text, std::slice::from_ref(&set)).shapes[0].radii, [expected]);
    }
    // Of points at 0, 1, 2 and 4, distances to the nearest other are 1, 1, 1 and 2.
    let line = [0.0, 1.0, 2.0, 4.0].map(|x| [x, 0.0, 0.0]).to_vec();
    let text = format!("{}transform = {{ scale = 2.0 }}", object("kind = \"spheres\"", ""));
    assert_eq!(plan_of(&text, &[set_of(line.clone())]).shapes[0].radii, [1.0; 4]);
    // To the three others: 7/3, 5/3, 5/3 and 3 in the mean.
    let text = text.replace("\"spheres\"", "\"discs\", radius = \"local\"");
    let mut radii = plan_of(&text, &[set_of(line)]).shapes[0].radii.clone();
    radii.sort_by(f32::total_cmp);
    for (radius, expected) in radii.iter().zip([5.0 / 3.0, 5.0 / 3.0, 7.0 / 3.0, 3.0]) {
        assert!((radius - expected).abs() < 1e-6, "{radii:?}");
    }
}

fn sky() -> Arc<Image> {
    let wave = |d: V3, phase: f64| {
        0.5 + 0.25 * (3.0 * d[0] + phase).sin() + 0.2 * (2.0 * d[1] - 2.0 * d[2]).cos()
    };
    Arc::new(environment_of(256, |d| [wave(d, 0.0), wave(d, 1.0), wave(d, 2.0)]))
}

/// The share of pixels that are off by more than 2e-3 from the same bodies in closed form, of those whose rays do not
/// pass within 3 % of an outline, where directions turn fast; and the twin gives the same bits.
fn off_from(bodies: &[Body], material: &str) -> f64 {
    let environment = sky();
    let spheres = bodies.iter().filter_map(|body| match body.shape {
        Shape::Sphere(middle, radius) => Some((middle, radius)),
        Shape::Below(_) => None,
    });
    let spheres: Vec<(V3, f64)> = spheres.collect();
    let set = with_attribute(set_of(spheres.iter().map(|s| s.0).collect()), "r", |p| {
        spheres.iter().find(|s| s.0 == p).map_or(0.0, |s| s.1)
    });
    let text = format!(
        "{}[render]\nmax_bounces = 32\n[background]\nenvironment = \"sky.exr\"\n{}",
        VIEW.text(),
        object("kind = \"spheres\", radius = \"attribute:r\"", material)
    );
    let images = SceneImages { environment: Some(Arc::clone(&environment)), textures: Vec::new() };
    let film = checked(material, &plan_with(&text, &[set], &images)).film;
    let (mut asked, mut off) = (0, 0);
    for pixel in 0..SIZE[0] * SIZE[1] {
        let grazes = |&(middle, radius): &(V3, f64)| {
            (VIEW.distance(pixel, middle) / radius - 1.0).abs() < 0.03
        };
        if spheres.iter().any(grazes) {
            continue;
        }
        let way = follow(bodies, VIEW.eye, VIEW.through(pixel));
        let seen = environment_at(&environment, way.direction);
        let error =
            |i: usize| (f64::from(film.color[pixel][i]) - seen[i] * way.throughput[i]).abs();
        asked += 1;
        off += usize::from(error(0).max(error(1)).max(error(2)) > 2e-3);
    }
    assert!(asked > SIZE[0] * SIZE[1] / 2);
    f64::from(off as u32) / f64::from(asked as u32)
}

fn body(middle: V3, radius: f64, matter: Matter) -> Body {
    Body { shape: Shape::Sphere(middle, radius), matter }
}

#[test]
fn spheres_of_glass_and_mirror_show_what_bodies_in_closed_form_do() {
    let middle = [0.1, 0.2, -0.3];
    let glass = |index| Matter::Glass(index, 0.3);
    for index in [1.5, 1.02, 0.7] {
        let material = format!("kind = \"glass\", ior = {index}, absorption = [0.3, 0.3, 0.3]");
        let off = off_from(&[body(middle, 0.8, glass(index))], &material);
        assert_eq!(off, 0.0, "index {index}");
    }
    let mirror = Matter::Mirror([0.9; 3]);
    let two = [body([-0.4, 0.2, -0.3], 0.5, mirror), body([0.7, 0.3, -0.2], 0.55, mirror)];
    // Between two mirrors errors grow with each reflection.
    let off = off_from(&two, "kind = \"mirror\", reflectance = [0.9, 0.9, 0.9]");
    assert!(off < 2e-3, "mirrors: {off}");
}

/// Where two spheres of one object overlap, light goes straight on: they are one body. Beside the ring where they
/// meet, rays may take either.
#[test]
fn overlapping_spheres_of_glass_are_one_body() {
    let glass = Matter::Glass(1.4, 0.5);
    let two = [body([-0.2, 0.2, -0.3], 0.6, glass), body([0.4, 0.3, -0.1], 0.5, glass)];
    let material = "kind = \"glass\", ior = 1.4, absorption = [0.5, 0.5, 0.5]";
    let off = off_from(&two, material);
    println!("two: {off:.1e} of the pixels are off");
    assert!(off < 1e-3, "{off}");
    let three = [two[0], two[1], body([0.1, 0.1, 0.1], 0.55, glass)];
    let off = off_from(&three, material);
    println!("three: {off:.1e} of the pixels are off");
    assert!(off < 2e-3, "{off}");
}

/// An eye inside two spheres of glass sees what it would in closed form.
#[test]
fn an_eye_inside_spheres_of_glass_is_inside_as_many() {
    let set = set_of(vec![VIEW.eye, add(VIEW.eye, [0.1, 0.0, 0.0], 1.0), [0.1, 0.2, -0.3]]);
    let text = format!(
        "{}{LIGHT}{}",
        VIEW.text(),
        object("kind = \"spheres\", radius = 0.5", "kind = \"glass\"")
    );
    let plan = plan_of(&text, &[set]);
    assert_eq!(plan.camera_media, [0, 0]);
    checked("inside", &plan);
}

/// A disc of the file's normal under a sphere: what is lit, and what is in the sphere's shadow.
#[test]
fn a_sphere_casts_its_shadow_on_a_disc() {
    let text = format!(
        "{}{LIGHT}{}{}",
        VIEW.text(),
        object("kind = \"discs\", radius = 2.0", "albedo = [0.5, 0.5, 0.5]"),
        object("kind = \"spheres\", radius = 0.4", "albedo = [0.5, 0.5, 0.5]")
    );
    let (level, middle) = ([0.1, -0.5, -0.3], [0.1, 0.2, -0.3]);
    let floor = PointSet { normals: Some(vec![[0.0, 3.0, 0.0]]), ..set_of(vec![level]) };
    let film = checked("shadow", &plan_of(&text, &[floor, set_of(vec![middle])])).film;
    let towards = unit([0.4, 1.0, 0.3]);
    let (mut lit, mut dark) = (0, 0);
    for pixel in 0..SIZE[0] * SIZE[1] {
        let d = VIEW.through(pixel);
        let ball = Shape::Sphere(middle, 0.4);
        let Some(t) = Shape::Below(level[1]).crossing(VIEW.eye, d) else { continue };
        let x = add(VIEW.eye, d, t);
        let rim = length(add(x, level, -1.0)) - 2.0;
        // How far the light passes from the sphere's middle, less its radius.
        let shadow = length(cross(add(x, middle, -1.0), towards)) - 0.4;
        if ball.crossing(VIEW.eye, d).is_some() || rim.abs() < 1e-4 || shadow.abs() < 1e-4 {
            continue;
        }
        assert_eq!(film.object[pixel] == 0.0, rim < 0.0, "pixel {pixel}: {rim}");
        if rim < 0.0 {
            let expected = if shadow < 0.0 { 0.0 } else { 0.5 * 3.0 * towards[1] * FRAC_1_PI };
            let found = f64::from(film.color[pixel][0]);
            assert!((found - expected).abs() < 1e-6, "pixel {pixel}: {found} and {expected}");
            (lit, dark) = if shadow < 0.0 { (lit, dark + 1) } else { (lit + 1, dark) };
        }
    }
    assert!(lit > 1000 && dark > 200, "{lit} lit, {dark} dark");
}

/// Seen by parallels, a disc covers π r² times the cosine of its turn.
#[test]
fn a_disc_covers_its_area_times_the_cosine_of_its_turn() {
    let size = 256;
    let text = format!(
        "[camera]\neye = [0, 0, 5]\ntarget = [0, 0, 0]\nprojection = \"orthographic\"\nheight = 2.0\n\
         [image]\nsize = [{size}, {size}]\n{}",
        object("kind = \"discs\", radius = 0.9", "")
    );
    for degrees in [0.0f64, 30.0, 60.0, 85.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let normals = Some(vec![[0.0, sin as f32, cos as f32]]);
        let plan = plan_of(&text, &[PointSet { normals, ..set_of(vec![[0.0; 3]]) }]);
        let film = checked("disc", &plan).film;
        let pixels = film.object.iter().filter(|object| **object >= 0.0).count();
        let area = f64::from(pixels as u32) * (2.0 / f64::from(size)).powi(2);
        let expected = PI * 0.81 * cos;
        // Along an outline of 400 pixels, half of the centres by chance: some tens.
        assert!((area / expected - 1.0).abs() < 5e-3, "{degrees}: {area} and {expected}");
    }
}

/// Without normals, discs of points on a sphere lie across its radii; alone, and two together, across z.
#[test]
fn discs_without_normals_lie_in_the_plane_of_their_neighbours() {
    let text =
        format!("{}{LIGHT}{}", VIEW.text(), object("kind = \"discs\", radius_scale = 2.0", ""));
    let mut plan = plan_of(&text, &[set_of(fibonacci_sphere(2_000))]);
    plan.diagnostics = vec![Diagnostic::Fit];
    let rendered = checked("discs", &plan);
    for p in &rendered.polynomials {
        let [x, y, z, _] = p.center_trust.map(f64::from);
        let normal = [0, 1, 2].map(|axis| f64::from(p.gradient_offset[axis]));
        let cosine = dot(unit([x, y, z]), normal).abs();
        // Two degrees: neighbourhoods are a tenth of the radius, and not even.
        assert!(cosine > 0.9994, "{cosine} at {x}, {y}, {z}");
    }
    let hits = rendered.film.extra[0].1.iter().filter(|kind| **kind == FIT_DISC as f32).count();
    assert!(hits > 3_000, "{hits}");
    for points in [1u32, 2] {
        let set = set_of((0..points).map(|i| [f64::from(i), 0.0, 0.0]).collect());
        let text = format!("{}{}", VIEW.text(), object("kind = \"discs\", radius = 0.3", ""));
        for p in checked("few", &plan_of(&text, &[set])).polynomials {
            assert_eq!(p.gradient_offset, [0.0, 0.0, 1.0, 0.0], "{points} points");
        }
    }
}

fn cloud(count: usize, seed: u64) -> Vec<V3> {
    let mut seed = seed;
    (0..count).map(|_| [0; 3].map(|_| 2.0 * random(&mut seed) - 1.0)).collect()
}

/// Spheres with colours, discs, and a surface of which some points are spheres and some discs; all of it in one scene.
fn everything(settings: &str, refine: &str) -> Plan {
    let text = format!(
        "{}{LIGHT}{settings}{}{}{}",
        VIEW.text(),
        object("kind = \"spheres\", radius = \"attribute:r\"", ""),
        object("kind = \"discs\", radius = 0.05", "kind = \"mirror\""),
        object(&format!("refine = \"{refine}\""), "kind = \"glass\""),
    );
    let positions = cloud(3_000, 5);
    let colors = positions.iter().map(|p| p.map(|x| 0.5 + 0.5 * x as f32)).collect();
    let spheres = with_attribute(set_of(positions), "r", |p| 0.02 + 0.02 * p[0] * p[0]);
    let spheres = PointSet { colors: Some(colors), ..spheres };
    let sets = [spheres, set_of(cloud(1_000, 6)), set_of(fibonacci_sphere(3_000))];
    let mut plan = plan_of(&text, &sets);
    // Every fifth point of the glass is a sphere, the last of these a disc each.
    let slots = plan.cloud.objects[2];
    let last: Vec<bool> = (0..slots.count).map(|at| at % 5 == 2).collect();
    plan.cloud.put_last(2, &last);
    let moved = last.iter().filter(|last| **last).count() as u32;
    let surface = slots.count - moved;
    plan.fits[2].point_count = surface;
    plan.objects[2].slot_count = surface;
    let shapes = |kind, first: u32, count: u32| Shapes {
        object: 2,
        first_slot: slots.first_slot + first,
        count,
        kind,
        radii: vec![0.02; count as usize],
        normals: None,
    };
    plan.shapes.push(shapes(ShapeKind::Sphere, surface, moved - 100));
    plan.shapes.push(shapes(ShapeKind::Disc, slots.count - 100, 100));
    plan
}

#[test]
fn whatever_way_rays_take_they_meet_the_same_shapes() {
    let mut plan = everything("", "none");
    plan.diagnostics = vec![Diagnostic::Point, Diagnostic::Fit];
    let first = checked("everything", &plan).film;
    for kind in [FIT_DISC, FIT_SPHERE, kernels::layout::FIT_FULL] {
        let seen = first.extra[1].1.iter().filter(|found| **found == kind as f32).count();
        assert!(seen > 30, "kind {kind} at {seen} pixels");
    }
    let ways = [
        (Primary::Grid, Secondary::Grid, RayLoop::Queue),
        (Primary::Tree, Secondary::Tree, RayLoop::Queue),
        (Primary::Discs, Secondary::Tree, RayLoop::Queue),
        (Primary::Discs, Secondary::Grid, RayLoop::Queue),
        (Primary::Auto, Secondary::Auto, RayLoop::Images),
    ];
    for (primary, secondary, ray_loop) in ways {
        (plan.primary, plan.secondary, plan.ray_loop) = (primary, secondary, ray_loop);
        let name = format!("{primary:?}, {secondary:?}, {ray_loop:?}");
        assert_same_film(&name, &first, &Bench::open().render(&plan).film);
    }
    plan.grid_resolution = 7;
    assert_same_film("another grid", &first, &Bench::open().render(&plan).film);
}

/// Hits with spheres and discs stand, and none of them is in the neighbourhood of a hit that is refined.
#[test]
fn refined_hits_go_past_shapes() {
    let plan = everything("", "project");
    checked("project", &plan);
}

/// A sphere shows the colour of its own point, and nothing of its neighbours'.
#[test]
fn every_sphere_has_the_colour_of_its_own_point() {
    let text =
        format!("{}{LIGHT}{}", VIEW.text(), object("kind = \"spheres\", radius_scale = 1.6", ""));
    let positions = cloud(400, 9);
    let colors: Vec<[f32; 3]> =
        (0..400).map(|i| [if i % 2 == 0 { 0.75 } else { 0.25 }, i as f32 / 512.0, 0.5]).collect();
    let set = PointSet { colors: Some(colors.clone()), ..set_of(positions) };
    let mut plan = plan_of(&text, &[set]);
    plan.diagnostics = vec![Diagnostic::Point];
    let film = checked("colours", &plan).film;
    let mut lit = 0;
    for (color, point) in film.color.iter().zip(&film.extra[0].1).filter(|(_, at)| **at >= 0.0) {
        let own = colors[*point as usize];
        if color[2] > 1e-3 {
            lit += 1;
            for channel in [0, 1] {
                // All channels are lit alike.
                let ratio = color[channel] / color[2];
                assert!((ratio - own[channel] / own[2]).abs() < 1e-5, "{color:?} and {own:?}");
            }
        }
    }
    assert!(lit > 2_000, "{lit}");
}

/// More than one dispatch writes, of an object that begins and ends within one of its parts.
#[test]
fn many_spheres_are_the_same_to_the_bit() {
    let spheres = "kind = \"spheres\", radius = 0.004";
    let text = format!("{}{LIGHT}{}{}", VIEW.text(), object(spheres, ""), object(spheres, ""));
    let set = set_of(cloud(140_001, 4));
    let rendered = checked("many", &plan_of(&text, &[set_of(cloud(77, 8)), set]));
    assert_eq!(rendered.polynomials.len(), 140_078);
    assert!(rendered.polynomials.iter().all(|p| p.gradient_offset[3] == 0.002));
}

/// Steps of 2^-10 are the same at 4.1e6: so is the picture, to the bit.
#[test]
fn survey_coordinates_change_no_pixel() {
    let steps = |p: V3| p.map(|x| (1024.0 * x).round() / 1024.0);
    let positions: Vec<V3> = cloud(500, 3).into_iter().map(steps).collect();
    let by = [500_000.0, 4_100_000.0, 1_200.0];
    let film = |by: V3| {
        let view = View { eye: add(VIEW.eye, by, 1.0), target: add(VIEW.target, by, 1.0), ..VIEW };
        let view = View { eye: steps(view.eye), target: steps(view.target), ..view };
        let surface = "kind = \"spheres\", radius = 0.06";
        let text = format!("{}{LIGHT}{}", view.text(), object(surface, ""));
        checked("survey", &plan_of(&text, &[set_of(moved(&positions, by))])).film
    };
    let (near, far) = (film([0.0; 3]), film(by));
    assert!(near.object.iter().filter(|object| **object >= 0.0).count() > 3_000);
    assert_eq!(near.color, far.color);
    assert_eq!((near.depth, near.normal), (far.depth, far.normal));
}

/// From nothing to a thousand times the scene, and what is no radius: all finite, counted, and the same to the bit.
#[test]
fn radii_of_any_size_are_drawn_or_counted() {
    let sizes = [0.0, 1e-30, 1e-9, 1e-3, 0.1, 1e3, -1.0, f64::NAN, f64::INFINITY, 1e13];
    let at = |i: usize| [0.3 * (i as f64) - 1.4, 0.1 * (i % 3) as f64, -0.2];
    let positions: Vec<V3> = (0..sizes.len()).map(at).collect();
    let set = with_attribute(set_of(positions.clone()), "r", |p| {
        positions.iter().position(|q| *q == p).map_or(0.0, |i| sizes[i])
    });
    for kind in ["spheres", "discs"] {
        let surface = format!("kind = \"{kind}\", radius = \"attribute:r\"");
        let text = format!("{}{LIGHT}{}", VIEW.text(), object(&surface, ""));
        let plan = plan_of(&text, std::slice::from_ref(&set));
        let missing = plan.missing[0].to_string();
        assert!(missing.contains("4 of 10 points have no radius ('r'"), "{missing}");
        let rendered = checked(kind, &plan);
        let drawn = rendered.polynomials.iter().filter(|p| p.center_trust[3] > 0.0).count();
        assert_eq!(drawn, 4, "{kind}: from 1e-9 to 1e3");
        assert!(rendered.film.color.as_flattened().iter().all(|v| v.is_finite()));
        assert!(rendered.film.normal.as_flattened().iter().all(|v| v.is_finite()));
    }
}

/// One sphere without a camera in the scene fills the picture, and no more.
#[test]
fn spheres_are_framed_with_their_radii() {
    let text =
        format!("[image]\nsize = [64, 64]\n{}", object("kind = \"spheres\", radius = 3.0", ""));
    let film = Bench::open().render(&plan_of(&text, &[set_of(vec![[7.0, 8.0, 9.0]])])).film;
    let hit = |at: usize| film.object[at] >= 0.0;
    let share = (0..64 * 64).filter(|&at| hit(at)).count() as f64 / (64.0 * 64.0);
    assert!(share > 0.4 && share < 0.8, "{share}");
    assert!((0..64).all(|i| !hit(i) && !hit(63 * 64 + i) && !hit(64 * i) && !hit(64 * i + 63)));
}
