//! Rays through the tree of boxes around points: the pictures of the grid.
#![allow(clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use harness::{
    Bench, Rendered, assert_same_film, fibonacci_sphere, moved, plan_of, random, set_of, wavy_sheet,
};
use kernels::layout::{Polynomial, TreeInfo};
use plan::Plan;
use points::{PointSet, Unwatched};
use reference::real::V3;
use render::Renderer;

const VIEW: &str = "
[camera]
eye = [0.5, 0.9, 3.2]
target = [0.0, 0.0, 0.0]
vertical_fov = 40.0
[image]
size = [96, 72]
[background]
color = [0.3, 0.4, 0.5]
[[lights]]
kind = \"directional\"
direction = [-0.4, -1.0, -0.3]
irradiance = [3.0, 2.9, 2.7]
[[lights]]
kind = \"point\"
position = [1.0, 2.0, 1.0]
intensity = [4.0, 4.0, 5.0]
";

const GRID: &str = "primary = \"grid\"\nsecondary = \"grid\"";
const TREE: &str = "primary = \"tree\"\nsecondary = \"tree\"";

/// The same scene by both.
fn by_both(bench: &Bench, view: &str, objects: &str, sets: &[PointSet]) -> [Rendered; 2] {
    [GRID, TREE].map(|render| {
        bench.render(&plan_of(&format!("{view}\n[render]\n{render}\n{objects}"), sets))
    })
}

fn scaled(points: Vec<[f64; 3]>, by: f64) -> Vec<[f64; 3]> {
    points.into_iter().map(|p| p.map(|x| by * x)).collect()
}

/// Glass that parts colours, a mirror, normals that are blended and that are not, refined hits, fog past its own surface.
#[test]
fn the_tree_gives_the_bytes_of_the_grid() {
    let bench = Bench::open();
    let ball = |at| set_of(moved(&scaled(fibonacci_sphere(3000), 0.5), at));
    let sets = [ball([0.0; 3]), ball([-0.9, 0.0, -0.5]), set_of(scaled(wavy_sheet(4000), 2.0))];
    let plain = "surface = { normals = \"polynomial\" }";
    let objects = |third: &str| {
        format!(
            "[[objects]]\npoints = \"a.ply\"\nmaterial = {{ kind = \"glass\", ior = [1.4, 1.5, 1.6] }}\n{plain}\n\
             [[objects]]\npoints = \"b.ply\"\nmaterial = {{ kind = \"mirror\" }}\n{plain}\n\
             [[objects]]\npoints = \"c.ply\"\n{third}"
        )
    };
    for third in [plain, "", "surface = { polynomial = \"incomplete\", refine = \"project\" }"] {
        let [grid, tree] = by_both(&bench, VIEW, &objects(third), &sets);
        assert_same_film(third, &grid.film, &tree.film);
        assert!(2 * tree.tests < grid.tests, "{} of {} tests", tree.tests, grid.tests);
        assert_eq!(tree.cells.is_empty(), third == plain, "lists where something looks into them");
    }
    for settings in ["secondary = \"tree\"", "primary = \"tree\"", "primary = \"discs\"", ""] {
        let text = format!("{VIEW}\n[render]\n{settings}\n{}", objects(plain));
        let [grid, _] = by_both(&bench, VIEW, &objects(plain), &sets);
        assert_same_film(settings, &grid.film, &bench.render(&plan_of(&text, &sets)).film);
    }
}

/// A ray that may do little in a pass goes on in the next where it stopped.
#[test]
fn any_budget_gives_the_same_bytes() {
    let bench = Bench::open();
    let text = format!(
        "{VIEW}\n[render]\n{TREE}\n[[objects]]\npoints = \"a.ply\"\nmaterial = {{ kind = \"glass\" }}\n\
         [[objects]]\npoints = \"b.ply\""
    );
    let sets = [set_of(fibonacci_sphere(10_000)), set_of(scaled(wavy_sheet(9_000), 3.0))];
    let plan = plan_of(&text, &sets);
    let whole = bench.render(&plan);
    let cut = bench.render_within(&plan, Some(1));
    assert!(cut.passes > whole.passes + 4, "passes: {} and {}", whole.passes, cut.passes);
    assert_same_film("budget", &whole.film, &cut.film);
    assert_eq!(whole.tests, cut.tests);
}

/// Trees of one level and of more, full ones and ones with a single point in the last leaf.
#[test]
fn any_number_of_points_has_its_tree() {
    let bench = Bench::open();
    let object = "[[objects]]\npoints = \"a.ply\"\nsurface = { feature_size = 0.8 }";
    for count in [4, 8, 9, 55, 56, 57, 64, 65, 448, 449, 3584, 3585] {
        let sets = [set_of(fibonacci_sphere(count))];
        let [grid, tree] = by_both(&bench, VIEW, object, &sets);
        assert_same_film(&format!("{count} points"), &grid.film, &tree.film);
    }
    let same = set_of(vec![[0.1, 0.2, 0.3]; 100]);
    let [grid, tree] = by_both(&bench, VIEW, object, &[same]);
    assert_same_film("one place", &grid.film, &tree.film);
}

/// Boxes are as large as rounding asks for: seen from far away, and far from the middle of the scene. (From farther
/// still, the grid itself does not know where a ray enters a ball.)
#[test]
fn no_hit_is_lost_to_rounding() {
    let bench = Bench::open();
    let object = "[[objects]]\npoints = \"a.ply\"\nmaterial = { kind = \"mirror\" }";
    for (distance, angle) in [(1e3, 0.15), (1e4, 0.015)] {
        let view = format!(
            "[camera]\neye = [{}, {}, {}]\ntarget = [0.0, 0.0, 0.0]\nvertical_fov = {angle}\n\
             [image]\nsize = [96, 72]\n[background]\ncolor = [0.3, 0.4, 0.5]",
            0.3 * distance,
            0.2 * distance,
            distance
        );
        let [grid, tree] = by_both(&bench, &view, object, &[set_of(fibonacci_sphere(4000))]);
        assert_same_film(&view, &grid.film, &tree.film);
    }
    // A small ball between two large ones far apart.
    let small = moved(&scaled(fibonacci_sphere(4000), 0.01), [3000.0, 0.0, 0.0]);
    let all = [
        set_of(small),
        set_of(scaled(fibonacci_sphere(4000), 1000.0)),
        set_of(moved(&scaled(fibonacci_sphere(2000), 500.0), [9000.0, 0.0, 0.0])),
    ];
    let view = "[camera]\neye = [3000.01, 0.02, 0.04]\ntarget = [3000.0, 0.0, 0.0]\nvertical_fov = 40.0\n\
                [image]\nsize = [96, 72]\n[background]\ncolor = [0.3, 0.4, 0.5]";
    let objects =
        format!("{object}\n[[objects]]\npoints = \"b.ply\"\n[[objects]]\npoints = \"c.ply\"");
    let [grid, tree] = by_both(&bench, view, &objects, &all);
    assert!(tree.film.object.iter().filter(|&&object| object == 0.0).count() > 500);
    assert_same_film("far from the middle", &grid.film, &tree.film);
}

/// The box of a child as the kernel decodes it, in f64.
fn child_box(node: &[u32; 16], child: usize) -> Option<[[f64; 3]; 2]> {
    let there = node[3] >> 8 >> child & 1 != 0;
    let step = f64::from(f32::from_bits((node[3] & 255) << 23));
    let words = 4 + 6 * (child / 4);
    let side = |first: usize| {
        [0, 1, 2].map(|axis| {
            let byte = node[words + first + axis] >> (8 * (child % 4)) & 255;
            f64::from(f32::from_bits(node[axis])) + step * f64::from(byte)
        })
    };
    there.then(|| [side(0), side(3)])
}

/// Polynomials and the tree's nodes of a plan.
fn built(bench: &Bench, plan: &Plan) -> (Vec<Polynomial>, Vec<[u32; 16]>, TreeInfo) {
    bench.with_device(|device| {
        let renderer =
            Renderer::new(device, &std::sync::Arc::new(plan.clone()), &Unwatched).expect("builds");
        let surfaces = renderer.surfaces();
        let tree = surfaces.tree.as_ref().expect("a tree");
        let mut nodes = vec![[0u32; 16]; tree.node_count() as usize];
        tree.nodes.read(0, &mut nodes).expect("nodes");
        let mut polynomials =
            vec![<Polynomial as bytemuck::Zeroable>::zeroed(); plan.cloud.points.len()];
        surfaces.polynomials.read(0, &mut polynomials).expect("polynomials");
        (polynomials, nodes, tree.info)
    })
}

/// Places on a polynomial inside of its trust ball, found along its normal from places across it.
fn places_on(p: &Polynomial, seed: &mut u64) -> Vec<V3<f64>> {
    let p = reference::polynomial::Polynomial::<f64>::from(p);
    let n = p.gradient.normalize();
    let mut places = vec![];
    for _ in 0..12 {
        let mut u = || 2.0 * random(seed) - 1.0;
        let across = V3([u(), u(), u()]).times(p.trust * 1.2);
        let from = p.center + (across - n.times(across.dot(n))) - n.times(2.0 * p.trust);
        let t = p.intersect(from, n, 0.0);
        if t < 1e30 {
            places.push(from + n.times(t));
        }
    }
    places
}

#[test]
fn boxes_hold_their_surfaces_and_those_inside_of_them() {
    let bench = Bench::open();
    let mut seed = 7;
    let mut noisy = fibonacci_sphere(5000);
    for p in &mut noisy {
        *p = p.map(|x| x * (1.0 + 0.02 * random(&mut seed)));
    }
    for (name, set) in [("noisy ball", set_of(noisy)), ("sheet", set_of(wavy_sheet(3000)))] {
        let text = format!("{VIEW}\n[render]\n{TREE}\n[[objects]]\npoints = \"a.ply\"");
        let (polynomials, nodes, info) = built(&bench, &plan_of(&text, &[set]));
        let at = |node: usize| match node >= info.first_leaf as usize {
            true => &nodes[node - info.gap as usize],
            false => &nodes[node],
        };
        let mut checked = 0;
        for (slot, p) in polynomials.iter().enumerate() {
            for place in places_on(p, &mut seed) {
                let (mut node, mut child) = (info.first_leaf as usize + slot / 8, slot % 8);
                loop {
                    let [low, high] = child_box(at(node), child).expect("a child that is there");
                    let inside = (0..3).all(|i| low[i] <= place.0[i] && place.0[i] <= high[i]);
                    assert!(inside, "{name}: slot {slot}, node {node}, child {child}: {place:?}");
                    if node == 0 {
                        break;
                    }
                    (node, child) = (node / 8, node % 8);
                }
                checked += 1;
            }
        }
        assert!(checked > 10_000, "{name}: {checked} places");
    }
}
