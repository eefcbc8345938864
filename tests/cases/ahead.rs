//! Pipelines that are made ahead are those that a build and a picture ask for.
#![allow(clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use harness::{Bench, fibonacci_sphere, moved, plan_of, set_of};
use points::device::kernels_of_fits;
use points::{PointSet, Unwatched};
use render::Renderer;
use std::collections::HashSet;

const LIT: &str = "[[lights]]\nkind = \"directional\"\ndirection = [-0.4, -1.0, -0.3]\n\
    irradiance = [3.0, 2.9, 2.7]\n";

/// Renders with what is likely made ahead; how many pipelines that did not foresee, and the kernels that ran.
fn unforeseen(bench: &Bench, text: &str, sets: &[PointSet]) -> (usize, HashSet<&'static str>) {
    let plan = plan_of(text, sets);
    bench.with_device(|device| {
        let neighbors = plan.fits[0].neighbors;
        let fits = kernels_of_fits(device, neighbors).expect("kernels");
        let others = Renderer::likely_kernels(device, &plan).expect("kernels");
        let likely: HashSet<_> = fits.iter().chain(&others).map(gpu::Kernel::name).collect();
        for kernel in fits.iter().chain(&others) {
            kernel.make_ahead().expect("a pipeline");
        }
        let made = device.pipeline_count();
        let mut renderer = Renderer::new(device, &plan, &Unwatched).expect("builds");
        let (_, stats) = renderer.frame(&plan, &Unwatched).expect("renders");
        let of_build = renderer.surfaces().kernels.iter();
        let ran: HashSet<_> = of_build.chain(&stats.kernels).map(|kernel| kernel.0).collect();
        // What nothing runs would be made for nothing.
        let idle: Vec<_> = likely.difference(&ran).collect();
        assert!(idle.is_empty(), "{text}: {idle:?} made, and not run");
        (device.pipeline_count() - made, ran)
    })
}

/// Diffuse points by discs and by the tree, glass, several samples: nothing is left to wait for.
#[test]
fn what_surfaces_take_is_foreseen() {
    let bench = Bench::open();
    let ball = |at| set_of(moved(&fibonacci_sphere(3000), at));
    let sets = [ball([0.0; 3]), ball([0.8, 0.0, -3.0])];
    let objects = |material: &str| {
        format!(
            "{LIT}[[objects]]\npoints = \"a.ply\"\n{material}\n[[objects]]\npoints = \"b.ply\"\n"
        )
    };
    let glass = objects("material = { kind = \"glass\", ior = [1.4, 1.5, 1.6] }");
    for (text, ran) in [
        (format!("[image]\nsize = [256, 192]\n{}", objects("")), "disc_emit"),
        (format!("[image]\nsize = [64, 64]\n{}", objects("")), "tree_nodes"),
        (format!("[image]\nsize = [256, 192]\n{glass}"), "scatter"),
        (format!("[image]\nsize = [64, 64]\nsamples = 4\n{glass}"), "camera_rays"),
    ] {
        let (count, kernels) = unforeseen(&bench, &text, &sets);
        assert!(kernels.contains(ran), "{text}: {kernels:?}");
        assert_eq!(count, 0, "{text}: pipelines made in the course of the work");
    }
}
