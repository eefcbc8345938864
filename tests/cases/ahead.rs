//! Pipelines that are made ahead are those that a build and a picture ask for.
#![allow(clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use gpu::Kernel;
use harness::{Bench, fibonacci_sphere, moved, plan_of, set_of, with_attribute};
use points::device::modules_of_fits;
use points::{PointSet, Unwatched};
use render::Renderer;
use std::collections::HashSet;
use std::sync::{Arc, Mutex, PoisonError};

/// Held by the one test that has a device.
static TURN: Mutex<()> = Mutex::new(());

const LIT: &str = "[[lights]]\nkind = \"directional\"\ndirection = [-0.4, -1.0, -0.3]\n\
    irradiance = [3.0, 2.9, 2.7]\n";

/// Renders with what is likely made ahead, on a device of its own; how many pipelines that did not foresee, and the
/// kernels that ran.
fn unforeseen(text: &str, sets: &[PointSet]) -> (usize, HashSet<&'static str>) {
    let plan = Arc::new(plan_of(text, sets));
    let planes = plan.shapes.iter().filter_map(plan::Shapes::plane_fit);
    let mut fitted = plan.fits.iter().copied().chain(planes).filter(|fit| fit.point_count > 0);
    let neighbors = fitted.next().map_or(0, |fit| fit.neighbors);
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    Bench::open().with_device(|device| {
        // Others are kept from test to test (harness), with what those made.
        let is_new = device.pipeline_count() == 0;
        assert!(is_new || !device.info().name.contains("llvmpipe"), "a device of its own");
        let fits = match neighbors {
            0 => Vec::new(),
            _ => modules_of_fits(device, neighbors),
        };
        let kernel = |module| Kernel::new(device, module, None).expect("a kernel");
        let fits: Vec<Kernel> = fits.into_iter().map(kernel).collect();
        let others = Renderer::likely_kernels(device, &plan).expect("kernels");
        let likely: HashSet<_> = fits.iter().chain(&others).map(Kernel::name).collect();
        for kernel in fits.iter().chain(&others) {
            kernel.make_ahead().expect("a pipeline");
        }
        let made = device.pipeline_count();
        let mut renderer = Renderer::new(device, &plan, &Unwatched).expect("builds");
        let (_, stats) = renderer.frame(&Unwatched).expect("renders");
        let of_build = renderer.surfaces().kernels.iter();
        let ran: HashSet<_> = of_build.chain(&stats.kernels).map(|kernel| kernel.0).collect();
        // What nothing runs would be made for nothing.
        let idle: Vec<_> = likely.difference(&ran).collect();
        assert!(idle.is_empty(), "{text}: {idle:?} made, and not run");
        (device.pipeline_count() - made, ran)
    })
}

/// Diffuse points by discs and by the tree, without lists, glass, several samples, spheres and discs: nothing is left
/// to wait for.
#[test]
fn what_surfaces_take_is_foreseen() {
    let ball = |at| set_of(moved(&fibonacci_sphere(3000), at));
    let sets = [ball([0.0; 3]), ball([0.8, 0.0, -3.0])];
    let objects = |of_each: &str| {
        format!(
            "{LIT}[[objects]]\npoints = \"a.ply\"\n{of_each}\n[[objects]]\npoints = \"b.ply\"\n{of_each}\n"
        )
    };
    let glass = objects("material = { kind = \"glass\", ior = [1.4, 1.5, 1.6] }");
    let bare = objects("surface = { normals = \"polynomial\", neighbors = 24 }");
    for (text, ran) in [
        (format!("[image]\nsize = [256, 192]\n{}", objects("")), "disc_emit"),
        (format!("[image]\nsize = [64, 64]\n{}", objects("")), "grid_emit"),
        (format!("[image]\nsize = [200, 160]\n{bare}"), "tree_nodes"),
        (format!("[image]\nsize = [256, 192]\n{glass}"), "scatter"),
        (format!("[image]\nsize = [64, 64]\nsamples = 4\n{glass}"), "camera_rays"),
        (
            format!("[image]\nsize = [256, 192]\n{}", objects("surface.kind = \"spheres\"")),
            "shape_spheres",
        ),
        (
            format!("[image]\nsize = [256, 192]\n{}", objects("surface.kind = \"discs\"")),
            "shape_discs",
        ),
    ] {
        let (count, kernels) = unforeseen(&text, &sets);
        assert!(kernels.contains(ran), "{text}: {kernels:?}");
        assert_eq!(count, 0, "{text}: pipelines made in the course of the work");
    }
}

/// Volumes, isosurfaces and refined hits, of which three small ones are left: `cell_offsets`, `list_points`, `resume`.
#[test]
fn what_volumes_and_refinement_take_is_foreseen() {
    let ball = with_attribute(set_of(fibonacci_sphere(3000)), "s", |_| 1.0);
    let size = "[image]\nsize = [256, 192]\n";
    let volume = |more: &str| {
        format!(
            "{size}{LIT}[[objects]]\npoints = \"a.ply\"\nvolume = {{ scalar = \"s\", {more} }}\n"
        )
    };
    let stops = "transfer = [{ value = 0.0, color = [1, 1, 1], extinction = 1.0 }]";
    let refined = format!(
        "{size}{LIT}[[objects]]\npoints = \"a.ply\"\nsurface = {{ polynomial = \"incomplete\", refine = \"project\" }}\n"
    );
    // Light goes on through it to the disc of the matt ball, which is seen beside it.
    let glass = volume(
        "radius = 0.3, step = 0.1, kernel = \"sum\", mode = \"isosurface\", iso = 0.5",
    ) + "material = { kind = \"glass\" }\n[[objects]]\npoints = \"b.ply\"\ntransform.translate = [0.5, 0.0, -2.5]\n";
    let (count, kernels) = unforeseen(&glass, &[ball.clone(), ball.clone()]);
    assert!(kernels.contains("shadow_meet"), "{kernels:?}");
    assert_eq!(count, 0, "{glass}: pipelines made in the course of the work: {kernels:?}");
    for (text, ran, left) in [
        (volume(&format!("radius = 0.3, step = 0.1, {stops}")), "march", 0),
        (
            volume("radius = 0.3, step = 0.1, kernel = \"sum\", mode = \"isosurface\", iso = 0.5"),
            "isosurface",
            0,
        ),
        (
            volume(&format!("radius = 0.3, step = 0.1, shading = \"scatter\", {stops}")),
            "point_lights",
            0,
        ),
        (refined, "refine", 3),
    ] {
        let (count, kernels) = unforeseen(&text, std::slice::from_ref(&ball));
        assert!(kernels.contains(ran), "{text}: {kernels:?}");
        assert_eq!(count, left, "{text}: pipelines made in the course of the work: {kernels:?}");
    }
}
