//! Real scans: the same bits on device and CPU, and no holes in the paper's models.
#![allow(clippy::expect_used, clippy::print_stdout, reason = "tests panic and print")]

use harness::{Bench, assert_same_bits, pinholes, plan_of, render_twin, shared_data};
use points::PointSet;

fn read(file: &str) -> Option<PointSet> {
    let path = shared_data(file)?;
    Some(points::read(&path, &mut |_, _| {}).expect("a readable file"))
}

const LIGHT: &str = "
[[lights]]
kind = \"directional\"
direction = [-0.6, -0.8, -0.9]
irradiance = [3.0, 3.0, 3.0]
";

#[test]
fn bunny_is_the_same_to_the_bit() {
    let Some(bunny) = read("surfaces/bunny.ply") else { return };
    for polynomial in ["full", "incomplete"] {
        let text = format!(
            "{LIGHT}\n[image]\nsize = [320, 240]\n[[objects]]\npoints = \"bunny.ply\"\n\
             surface = {{ polynomial = \"{polynomial}\" }}"
        );
        let plan = plan_of(&text, std::slice::from_ref(&bunny));
        let on_device = Bench::open().render(&plan);
        assert_same_bits(polynomial, &on_device, &render_twin(&plan));
        let hits = on_device.film.object.iter().filter(|&&object| object == 0.0).count();
        assert!(hits > 15_000, "{hits} pixels show the Bunny");
    }
}

/// Scans with duplicates, noise, colours and sparse surroundings.
#[test]
fn scans_and_terrains_are_the_same_to_the_bit() {
    for file in ["scans/pond.ply", "terrain/rainier_256.ply"] {
        let Some(set) = read(file) else { continue };
        let plan = plan_of(&format!("{LIGHT}\n[image]\nsize = [160, 120]"), &[set]);
        let on_device = Bench::open().render(&plan);
        assert_same_bits(file, &on_device, &render_twin(&plan));
        assert!(on_device.film.color.as_flattened().iter().all(|c| c.is_finite()), "{file}");
    }
}

/// A pinhole is a miss with all four neighbours hit. Trust regions can leave a few at creases;
/// closing them is later work. Found in this view: none; in others, up to four in the Armadillo.
#[test]
fn the_papers_models_have_at_most_a_handful_of_pinholes() {
    for model in ["bunny", "horse", "armadillo"] {
        let Some(set) = read(&format!("surfaces/{model}.ply")) else { continue };
        let film = Bench::open().render(&plan_of("[image]\nsize = [640, 480]", &[set])).film;
        let found = pinholes(&film);
        println!("{model}: {found} pinholes");
        assert!(found <= 6, "{model}: {found} pinholes");
    }
}
