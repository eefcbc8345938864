//! `boundary_clip`: surfaces of open sets end near their last points, closed ones are not touched.
#![allow(clippy::expect_used, clippy::print_stdout, reason = "tests panic and print")]

use film::Film;
use harness::{
    Bench, Rendered, assert_same_bits, assert_same_film, fibonacci_sphere, grid_points, pinholes,
    plan_of, random, render_twin, set_of, shared_data,
};

/// Looks straight down at the middle of the unit square, 256 pixels to its side (to 0.1 %).
const DOWN: &str = "
[camera]
eye = [0.5, 10.0, 0.5]
target = [0.5, 0.0, 0.5]
up = [0.0, 0.0, -1.0]
vertical_fov = 7.1526692
[image]
size = [320, 320]
";
const SIDE: f64 = 256.0;

const AROUND: &str = "
[camera]
eye = [1.2, 1.6, 2.2]
target = [0.0, 0.0, 0.0]
vertical_fov = 45.0
[image]
size = [120, 90]
";

fn render(bench: &Bench, view: &str, surface: &str, positions: &[[f64; 3]]) -> Rendered {
    let text = format!("{view}\n[[objects]]\npoints = \"p.ply\"\nsurface = {{ {surface} }}");
    let plan = plan_of(&text, &[set_of(positions.to_vec())]);
    let rendered = bench.render(&plan);
    assert_same_bits(surface, &rendered, &render_twin(&plan));
    rendered
}

fn hit(film: &Film, x: usize, y: usize) -> bool {
    film.object[y * film.window.width as usize + x] >= 0.0
}

/// How the surface of a square sheet ends.
#[derive(Debug)]
struct Ends {
    /// Over that of the square.
    area: f64,
    /// Beyond the sides, away from the corners, in spacings.
    mean: f64,
    most: f64,
    least: f64,
    /// Mean step of the outline from pixel to pixel, in pixels.
    roughness: f64,
    /// Area missed more than two spacings inside, in squares of the spacing.
    holes: f64,
}

/// The pixel at a place along a side and a depth from it, of a square picture of this size.
type Turn = fn(usize, usize, usize) -> (usize, usize);

fn ends_of_square(film: &Film, count: usize) -> Ends {
    let spacing = SIDE / (count as f64).sqrt();
    let size = film.window.width as usize;
    let first = (size - SIDE as usize) / 2;
    let middle = first + size / 10..size - first - size / 10;
    let mut beyond = Vec::new();
    let mut steps = Vec::new();
    let turned: [Turn; 4] = [
        |across, depth, _| (across, depth),
        |across, depth, size| (across, size - 1 - depth),
        |across, depth, _| (depth, across),
        |across, depth, size| (size - 1 - depth, across),
    ];
    for turn in turned {
        let outline: Vec<f64> = middle
            .clone()
            .map(|across| {
                let reached = |depth: &usize| {
                    let (x, y) = turn(across, *depth, size);
                    hit(film, x, y)
                };
                first as f64 - (0..size).find(reached).unwrap_or(size) as f64
            })
            .collect();
        steps.extend(outline.windows(2).map(|pair| (pair[1] - pair[0]).abs()));
        beyond.extend(outline.into_iter().map(|pixels| pixels / spacing));
    }
    let deep = first + (2.0 * spacing).ceil() as usize;
    let inside = (deep..size - deep).flat_map(|y| (deep..size - deep).map(move |x| (x, y)));
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    Ends {
        area: film.object.iter().filter(|&&object| object >= 0.0).count() as f64 / (SIDE * SIDE),
        mean: mean(&beyond),
        most: beyond.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        least: beyond.iter().copied().fold(f64::INFINITY, f64::min),
        roughness: mean(&steps),
        holes: inside.filter(|&(x, y)| !hit(film, x, y)).count() as f64 / (spacing * spacing),
    }
}

/// Points on the lattice that has some on each side of the square.
fn even_square(side: u32) -> Vec<[f64; 3]> {
    let scale = f64::from(side) / f64::from(side - 1);
    grid_points(side).into_iter().map(|p| p.map(|x| x * scale)).collect()
}

/// Before and after, for one square sheet.
fn square(name: &str, surface: &str, sheet: &[[f64; 3]]) -> [Ends; 2] {
    let bench = Bench::open();
    [false, true].map(|clip| {
        let settings = format!("boundary_clip = {clip}{surface}");
        let film = render(&bench, DOWN, &settings, sheet).film;
        let ends = ends_of_square(&film, sheet.len());
        println!("{name}, clip {clip}: {ends:.3?}");
        ends
    })
}

/// The definition, on a lattice: half a spacing beyond the last points, to a quarter of one.
#[test]
fn an_even_square_ends_half_a_spacing_beyond_its_points() {
    let sheet = even_square(40);
    for k in [8, 12, 16, 24, 32] {
        let [open, clipped] = square(&format!("k {k}"), &format!(", neighbors = {k}"), &sheet);
        assert!(
            open.mean > 1.9 * clipped.mean && open.area > clipped.area,
            "{k}: {open:?} {clipped:?}"
        );
        assert!(clipped.least > 0.1 && clipped.most < 0.9, "{k}: {clipped:?}");
        assert!(clipped.roughness < 0.5 && clipped.holes == 0.0, "{k}: {clipped:?}");
    }
}

#[test]
fn a_square_of_random_points_ends_near_its_last_points() {
    let mut seed = 5;
    let sheet: Vec<[f64; 3]> =
        (0..1_600).map(|_| [random(&mut seed), 0.0, random(&mut seed)]).collect();
    let [open, clipped] = square("random", "", &sheet);
    assert!(open.mean > 1.0 && clipped.mean.abs() < 0.5, "{open:?} {clipped:?}");
    assert!(clipped.most < 1.5, "{clipped:?}");
    assert!(clipped.holes <= 1.0, "{clipped:?}");
    assert!(clipped.roughness < 1.1 * open.roughness, "{open:?} {clipped:?}");
}

/// Every point of the lattice moved by up to a third of the spacing.
fn noisy_square(side: u32) -> Vec<[f64; 3]> {
    let mut seed = 3;
    let mut moved = |x: f64| x + (random(&mut seed) - 0.5) * 0.66 / f64::from(side - 1);
    even_square(side).into_iter().map(|[x, _, z]| [moved(x), 0.0, moved(z)]).collect()
}

#[test]
fn a_noisy_rim_is_no_rougher_than_it_was() {
    let [open, clipped] = square("noisy", "", &noisy_square(40));
    assert!(clipped.mean < 0.4 * open.mean && clipped.most < 1.2, "{open:?} {clipped:?}");
    assert!(clipped.least > -0.3 && clipped.holes == 0.0, "{clipped:?}");
    assert!(clipped.roughness <= open.roughness, "{open:?} {clipped:?}");
}

/// The other ways to set a surface up agree with the twin, and end where the default does.
#[test]
fn rims_do_not_depend_on_the_other_settings() {
    let sheet = noisy_square(30);
    for surface in [
        ", refine = \"project\"",
        ", polynomial = \"incomplete\"",
        ", close_gaps = false",
        ", trust = 1.0",
        ", feature_size = \"smoothed\"",
        ", feature_size = 0.1",
        ", weight_width = 2.0",
        ", normals = \"blended\"",
    ] {
        let [_, clipped] = square(surface, surface, &sheet);
        assert!(clipped.mean < 0.9 && clipped.mean > 0.2, "{surface}: {clipped:?}");
        assert!(clipped.holes == 0.0, "{surface}: {clipped:?}");
    }
}

#[test]
fn rims_are_the_same_for_discs_and_any_number_of_cells_a_pass() {
    let bench = Bench::open();
    let mut seed = 11;
    let sheet: Vec<[f64; 3]> =
        noisy_square(30).into_iter().map(|[x, _, z]| [x, 0.1 * random(&mut seed), z]).collect();
    for refine in ["none", "project"] {
        let films = [
            "primary = \"discs\"",
            "cells_per_pass = 1",
            "cells_per_pass = 5",
            "primary = \"grid\"",
        ]
        .map(|settings| {
            let text = format!(
                "{AROUND}\n[render]\n{settings}\n[[objects]]\npoints = \"p.ply\"\n\
                     surface = {{ refine = \"{refine}\" }}"
            );
            bench.render(&plan_of(&text, &[set_of(sheet.clone())])).film
        });
        for film in &films[1..] {
            assert_same_film(refine, &films[0], film);
        }
    }
}

/// Half of an even sphere: its rim is a circle of radius 1, which the surface leaves by half a spacing.
#[test]
fn a_hemisphere_ends_below_its_rim_and_keeps_its_shape() {
    let bench = Bench::open();
    let half: Vec<[f64; 3]> = fibonacci_sphere(6_000)
        .into_iter()
        .filter(|p| p[2] >= 0.0)
        .map(|[x, y, z]| [x, z, y])
        .collect();
    let spacing = (4.0 * std::f64::consts::PI / 6_000.0).sqrt();
    let from_the_side = "[camera]\neye = [6.0, 0.0, 0.0]\ntarget = [0.0, 0.0, 0.0]\n\
                         vertical_fov = 20.0\n[image]\nsize = [240, 240]";
    let [open, clipped] = [false, true].map(|clip| {
        let settings = format!("boundary_clip = {clip}");
        let film = render(&bench, from_the_side, &settings, &half).film;
        let hits = film.object.iter().zip(&film.position).filter(|(object, _)| **object >= 0.0);
        let (mut lowest, mut off) = (0.0f64, 0.0f64);
        for (_, p) in hits {
            lowest = lowest.min(f64::from(p[1]));
            let radius = p.iter().map(|x| f64::from(*x).powi(2)).sum::<f64>().sqrt();
            off = off.max((radius - 1.0).abs());
        }
        println!(
            "clip {clip}: {:.2} spacings below the rim, {off:.1e} off the sphere",
            -lowest / spacing
        );
        assert_eq!(pinholes(&film), 0);
        (-lowest / spacing, off)
    });
    assert!(open.0 > 1.3 && clipped.0 < 0.9, "{open:?} {clipped:?}");
    assert!(clipped.1 <= open.1);
}

#[test]
fn a_disc_stays_round() {
    let bench = Bench::open();
    let golden = std::f64::consts::PI * (3.0 - 5f64.sqrt());
    let disc: Vec<[f64; 3]> = (0..3_000u32)
        .map(|i| {
            let radius = 0.5 * ((f64::from(i) + 0.5) / 3_000.0).sqrt();
            let (sin, cos) = (golden * f64::from(i)).sin_cos();
            [0.5 + radius * cos, 0.0, 0.5 + radius * sin]
        })
        .collect();
    let spacing = (std::f64::consts::PI * 0.25 / 3_000.0).sqrt();
    let radii = [false, true].map(|clip| {
        let film = render(&bench, DOWN, &format!("boundary_clip = {clip}"), &disc).film;
        let radius = |film: &Film| {
            let inside = film.object.iter().filter(|&&object| object >= 0.0).count() as f64;
            (inside / std::f64::consts::PI).sqrt() / SIDE
        };
        (radius(&film) - 0.5) / spacing
    });
    println!("{radii:.2?} spacings beyond the disc");
    assert!(radii[0] > 1.0 && radii[1] > 0.0 && radii[1] < 0.75, "{radii:.2?}");
}

/// Points all around a torus, turned from ring to ring.
fn torus() -> Vec<[f64; 3]> {
    let at = |i: u32, j: u32| {
        let v = std::f64::consts::TAU * (f64::from(j) + 0.5 * f64::from(i % 2)) / 40.0;
        let (su, cu) = (std::f64::consts::TAU * f64::from(i) / 100.0).sin_cos();
        let ring = 0.8 + 0.3 * v.cos();
        [ring * cu, 0.3 * v.sin(), ring * su]
    };
    (0..4_000).map(|n| at(n / 40, n % 40)).collect()
}

/// Points off a torus by noise in all directions.
fn noisy_torus() -> Vec<[f64; 3]> {
    let mut seed = 9;
    (0..6_000)
        .map(|_| {
            let (u, v) = (random(&mut seed), random(&mut seed));
            let ((su, cu), (sv, cv)) =
                ((std::f64::consts::TAU * u).sin_cos(), (std::f64::consts::TAU * v).sin_cos());
            let ring = 0.8 + 0.3 * cv;
            [ring * cu, 0.3 * sv, ring * su].map(|x| x + 0.02 * (random(&mut seed) - 0.5))
        })
        .collect()
}

#[test]
fn closed_sets_have_the_same_bytes_but_for_rare_gaps_of_uneven_ones() {
    let bench = Bench::open();
    let mut seed = 21;
    let random_sphere: Vec<[f64; 3]> =
        std::iter::repeat_with(|| [0; 3].map(|_| 2.0 * random(&mut seed) - 1.0))
            .filter_map(|p| {
                let r = p.iter().map(|x| x * x).sum::<f64>().sqrt();
                (r < 1.0 && r > 0.1).then(|| p.map(|x| x / r))
            })
            .take(10_000)
            .collect();
    for (name, set) in [
        ("sphere", fibonacci_sphere(10_000)),
        ("torus", torus()),
        ("noisy torus", noisy_torus()),
        ("random sphere", random_sphere),
    ] {
        let [without, with] = [false, true]
            .map(|clip| format!("neighbors = 16, boundary_clip = {clip}"))
            .map(|surface| render(&bench, AROUND, &surface, &set));
        let differing = with
            .polynomials
            .iter()
            .zip(&without.polynomials)
            .filter(|(a, b)| a.center_trust != b.center_trust)
            .count();
        println!("{name}: {differing} of {} balls clipped", set.len());
        let most = if name == "sphere" || name == "torus" { 0 } else { set.len() * 3 / 1_000 };
        assert!(differing <= most, "{name}: {differing}");
        assert!(pinholes(&with.film) <= pinholes(&without.film), "{name}");
        if differing == 0 {
            assert_same_bits(name, &with, &without);
        }
    }
}

/// Few points, and none that could have a rim.
#[test]
fn tiny_sets_are_the_same_to_the_bit() {
    let bench = Bench::open();
    let mut seed = 2;
    for count in [1, 2, 3, 4, 7, 12, 20] {
        let set: Vec<[f64; 3]> = (0..count)
            .map(|_| [random(&mut seed), 0.1 * random(&mut seed), random(&mut seed)])
            .collect();
        for surface in ["boundary_clip = true", "boundary_clip = true, refine = \"project\""] {
            render(&bench, DOWN, surface, &set);
        }
    }
}

/// The models of the paper are closed but for the underside of the Bunny, and thin at the ears and hooves of the
/// Horse.
#[test]
fn the_papers_models_hardly_change() {
    let bench = Bench::open();
    for (model, most) in [("bunny", 400), ("horse", 700), ("armadillo", 20)] {
        let Some(path) = shared_data(&format!("surfaces/{model}.ply")) else { continue };
        let set = points::read(&path, &mut |_, _| {}).expect("a readable file");
        let [without, with] = [false, true].map(|clip| {
            let text = format!(
                "[image]\nsize = [640, 480]\n[[objects]]\npoints = \"p.ply\"\n\
                 surface = {{ boundary_clip = {clip} }}"
            );
            bench.render(&plan_of(&text, std::slice::from_ref(&set)))
        });
        let balls = with
            .polynomials
            .iter()
            .zip(&without.polynomials)
            .filter(|(a, b)| a.center_trust != b.center_trust)
            .count();
        let pixels =
            with.film.position.iter().zip(&without.film.position).filter(|(a, b)| a != b).count();
        let holes = [&without, &with].map(|rendered| pinholes(&rendered.film));
        println!("{model}: {balls} balls clipped, {pixels} pixels changed, pinholes {holes:?}");
        assert!(balls <= most, "{model}: {balls} balls clipped");
        assert!(holes[1] <= holes[0], "{model}: {holes:?} pinholes");
    }
}
