//! Closed forms, and the projection against its own definition.

use super::plane::PlaneEnergy;
use super::*;
use std::f64::consts::TAU;

const GOLDEN: f64 = 0.618_033_988_749_894_9;

#[derive(Debug, Clone, Copy, PartialEq)]
enum Shape {
    Sphere,
    /// About z, radius 1, |z| ≤ 2.
    Cylinder,
    /// About z, radii 1 and 0.4.
    Torus,
}

impl Shape {
    fn area(self) -> f64 {
        match self {
            Self::Sphere => 2.0 * TAU,
            Self::Cylinder => 4.0 * TAU,
            Self::Torus => 0.4 * TAU * TAU,
        }
    }

    /// The point and the normal at parameters in the unit square, which map to equal areas.
    fn at(self, s: f64, t: f64) -> (V3<f64>, V3<f64>) {
        let (sin, cos) = (TAU * t).sin_cos();
        match self {
            Self::Sphere => {
                let z = 2.0 * s - 1.0;
                let p = V3([(1.0 - z * z).sqrt() * cos, (1.0 - z * z).sqrt() * sin, z]);
                (p, p)
            }
            Self::Cylinder => (V3([cos, sin, 4.0 * s - 2.0]), V3([cos, sin, 0.0])),
            Self::Torus => {
                let mut around = TAU * s;
                for _ in 0..20 {
                    let excess = around + 0.4 * around.sin() - TAU * s;
                    around -= excess / (1.0 + 0.4 * around.cos());
                }
                let normal = V3([around.cos() * cos, around.cos() * sin, around.sin()]);
                (V3([cos, sin, 0.0]) + normal.times(0.4), normal)
            }
        }
    }

    /// Signed distance of a point, and the normal of the surface next to it.
    fn distance(self, p: V3<f64>) -> (f64, V3<f64>) {
        let radial = V3([p.x(), p.y(), 0.0]);
        let (from, radius) = match self {
            Self::Sphere => (p, 1.0),
            Self::Cylinder => (radial, 1.0),
            Self::Torus => (p - radial.normalize(), 0.4),
        };
        (from.dot(from).sqrt() - radius, from.normalize())
    }

    /// h of 16 neighbours: π h² holds 17 points.
    fn feature_size(self, count: u32) -> f64 {
        2.33 * (self.area() / f64::from(count)).sqrt()
    }
}

/// Numbers in 0..1, by Steele's SplitMix64.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
    fn symmetric(&mut self) -> f64 {
        2.0 * self.next() - 1.0
    }
}

fn length(v: V3<f64>) -> f64 {
    v.dot(v).sqrt()
}

fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    length(V3(a) - V3(b))
}

/// Points of a shape, random or even (a lattice of the golden ratio), displaced along the normal by
/// up to `noise` × h.
fn cloud(shape: Shape, count: u32, random: bool, noise: f64) -> Vec<[f64; 3]> {
    let mut numbers = Random(7);
    let h = shape.feature_size(count);
    (0..count)
        .map(|i| {
            let even = [(f64::from(i) + 0.5) / f64::from(count), (f64::from(i) * GOLDEN).fract()];
            let [s, t] = if random { [numbers.next(), numbers.next()] } else { even };
            let (p, n) = shape.at(s, t);
            (p + n.times(noise * h * numbers.symmetric())).0
        })
        .collect()
}

/// Points within 0.3 h of a shape, away from the cylinder's borders.
fn queries(shape: Shape, count: usize, h: f64) -> Vec<[f64; 3]> {
    let mut random = Random(3);
    (0..count)
        .map(|_| {
            let (p, n) = shape.at(0.4 + 0.2 * random.next(), random.next());
            (p + n.times(0.3 * h * random.symmetric())).0
        })
        .collect()
}

/// Sums over all that f64 can tell from nothing: e^(-6.1²) < ε/2. Cut nearer, the sum itself depends
/// on r.
fn surface(points: &[[f64; 3]], h: f64, polynomial: PolynomialKind) -> PointSurface<'_> {
    PointSurface::new(points, FeatureSize::Constant(h), polynomial).with_reach(6.1)
}

/// Root mean squares of distance and angle over 200 projections.
fn errors(shape: Shape, count: u32, random: bool, polynomial: PolynomialKind) -> [f64; 2] {
    let points = cloud(shape, count, random, 0.0);
    let h = shape.feature_size(count);
    let surface = surface(&points, h, polynomial).with_reach(3.0);
    let squares = queries(shape, 200, h).iter().fold([0.0; 2], |[d2, a2], &r| {
        let found = surface.project(r).expect("a surface");
        let (distance, normal) = shape.distance(V3(found.point));
        let angle = length(normal.cross(V3(found.normal)));
        [d2 + distance * distance / 200.0, a2 + angle * angle / 200.0]
    });
    squares.map(f64::sqrt)
}

/// Orders in the spacing, which halves twice.
fn orders(shape: Shape, random: bool, polynomial: PolynomialKind) -> [f64; 2] {
    let coarse = errors(shape, 4000, random, polynomial);
    let fine = errors(shape, 64_000, random, polynomial);
    [0, 1].map(|i| 0.5 * (coarse[i] / fine[i]).log2())
}

/// Of distance and normal. One set of random points and 200 projections tell an order to a third.
fn assert_orders(shape: Shape, random: bool, polynomial: PolynomialKind, expected: [f64; 2]) {
    let found = orders(shape, random, polynomial);
    for (order, expected) in found.iter().zip(expected) {
        assert!((order - expected).abs() < 0.35, "{shape:?} {polynomial:?}: {found:?}");
    }
}

/// From any side and at any slant; h and position far from 1.
#[test]
fn points_of_a_plane_are_projected_onto_it_along_its_normal() {
    let normal = V3([2.0, -1.0, 2.0]).over(3.0);
    let u = V3([1.0, 2.0, 0.0]).over(5f64.sqrt());
    let v = normal.cross(u);
    for (scale, origin) in [(1.0, V3([0.0; 3])), (1e-6, V3([1e-5, 0.0, 2e-5])), (1e4, V3([3e5; 3]))]
    {
        let mut random = Random(1);
        let points: Vec<[f64; 3]> = (0..2000)
            .map(|_| {
                let [x, y] = [random.symmetric(), random.symmetric()].map(|c| 5.0 * scale * c);
                (origin + u.times(x) + v.times(y)).0
            })
            .collect();
        let largest = points.as_flattened().iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        for polynomial in PolynomialKind::SIMPLER {
            let surface = surface(&points, 0.5 * scale, polynomial);
            for height in [-0.49, -0.3, -1e-3, 0.0, 1e-9, 0.2, 0.49] {
                let [x, y] = [random.symmetric(), random.symmetric()].map(|c| 2.0 * scale * c);
                let foot = origin + u.times(x) + v.times(y);
                let r = foot + normal.times(height * 0.5 * scale);
                let found = surface.project(r.0).expect("a plane");
                let off = V3(found.point) - foot;
                let case = format!("{polynomial:?} at {height} h, scale {scale}: {off:?}");
                // Rounding of the coordinates, magnified by the fit of a random set.
                assert!(off.dot(normal).abs() <= 1e-12 * scale + 1e-15 * largest, "{case}");
                // n has settled to 1e-10 radians, half a feature size away.
                assert!(length(off) <= 1e-10 * scale, "{case}");
                assert!(length(normal.cross(V3(found.normal))) <= 1e-10, "{case}");
            }
        }
    }
}

/// Odd terms vanish where surface and points look the same from both sides: the normal is n, and
/// the first term to disturb g(0, 0) is the fourth.
#[test]
fn even_points_of_a_sphere_and_a_cylinder_give_fourth_order_and_exact_normals() {
    for shape in [Shape::Sphere, Shape::Cylinder] {
        let coarse = errors(shape, 4000, false, PolynomialKind::Full);
        let fine = errors(shape, 64_000, false, PolynomialKind::Full);
        let order = 0.5 * (coarse[0] / fine[0]).log2();
        assert!((order - 4.0).abs() < 0.1, "{shape:?}: {order}");
        // What the cut at 3 h leaves: θ = 1e-4 at an edge that is not even.
        assert!(fine[1] < 1e-7, "{shape:?}: {fine:?}");
    }
}

#[test]
fn a_torus_of_even_points_is_fourth_order_in_distance_and_second_in_the_normal() {
    assert_orders(Shape::Torus, false, PolynomialKind::Incomplete, [4.1, 2.0]);
    assert_orders(Shape::Torus, false, PolynomialKind::Full, [4.1, 2.0]);
}

/// The method's orders: third and second with all terms, second and first without the linear ones.
/// Between 4000 and 64 000 points the next order, of the torus itself, still adds to the distance.
#[test]
fn a_torus_of_random_points_shows_what_the_linear_terms_are_for() {
    assert_orders(Shape::Torus, true, PolynomialKind::Incomplete, [2.2, 1.0]);
    assert_orders(Shape::Torus, true, PolynomialKind::Full, [3.7, 2.0]);
}

/// Degree m leaves m + 1 in distance and m in the normal; an even order more where the terms of the
/// next degree are odd.
#[test]
fn higher_degrees_have_higher_orders() {
    assert_orders(Shape::Torus, true, PolynomialKind::Cubic, [4.1, 3.0]);
    assert_orders(Shape::Torus, true, PolynomialKind::Quartic, [6.1, 4.4]);
}

#[test]
fn slopes_of_equation_1_agree_with_finite_differences() {
    let (shape, count) = (Shape::Torus, 4000);
    let h = shape.feature_size(count);
    let points = cloud(shape, count, true, 0.1);
    let surface = surface(&points, h, PolynomialKind::Full);
    let mut random = Random(11);
    for r in queries(shape, 30, h) {
        let around = surface.neighborhood(r).expect("points");
        let energy = PlaneEnergy { offsets: &around.offsets };
        let n = V3([0; 3].map(|_| random.symmetric())).normalize();
        let t = 0.5 * random.symmetric();
        let found = energy.at(t, n);
        // Central differences of step 1e-5 err by 1e-10 of the third derivative and by 1e-11 of the
        // value, both relative to energies of order ten.
        let step = 1e-5;
        let over_t = (energy.at(t + step, n).value - energy.at(t - step, n).value) / (2.0 * step);
        assert!((over_t - found.along_t).abs() < 1e-7, "{over_t} {}", found.along_t);
        let u = any_perpendicular(n);
        for d in [u, n.cross(u)] {
            let at = |phi: f64| energy.at(t, n.times(phi.cos()) + d.times(phi.sin())).value;
            let over_n = (at(step) - at(-step)) / (2.0 * step);
            assert!((over_n - found.along_n.dot(d)).abs() < 1e-7, "{over_n} {:?}", found.along_n);
        }
    }
}

/// Moved and turned a little or a lot, the plane has more energy. Levin's condition holds q while n
/// turns, so there only t and the turns about q are free.
#[test]
fn the_plane_of_a_noisy_torus_minimises_equation_1() {
    let (shape, count) = (Shape::Torus, 8000);
    let h = shape.feature_size(count);
    let points = cloud(shape, count, true, 0.2);
    let surface = surface(&points, h, PolynomialKind::Full);
    let mut random = Random(5);
    for r in queries(shape, 40, h) {
        let offsets = surface.neighborhood(r).expect("points").offsets;
        let found = reference_plane(&offsets, PlaneSearch::FixedDistance).expect("a plane");
        let energy = PlaneEnergy { offsets: &offsets };
        let least = energy.at(found.t, found.n);
        let levin = reference_plane(&offsets, PlaneSearch::FixedOrigin).expect("a plane");
        let q = levin.n.times(levin.t);
        let about_q: Vec<V3<f64>> = offsets.iter().map(|&y| y - q).collect();
        let about_q = PlaneEnergy { offsets: &about_q };
        let least_levin = about_q.at(0.0, levin.n);
        // Settled to 1e-10, times second derivatives of order ten.
        assert!(least.along_t.abs() + length(least.along_n) < 1e-8);
        assert!(least_levin.along_t.abs() + length(least_levin.along_n) < 1e-8);
        for size in [1e-4, 1e-3, 1e-2, 0.1] {
            for _ in 0..10 {
                let dt = size * random.symmetric();
                let turn = V3([0; 3].map(|_| size * random.symmetric()));
                let moved = energy.at(found.t + dt, (found.n + turn).normalize()).value;
                assert!(moved > least.value, "{moved} < {} at {size}", least.value);
                let turned = about_q.at(0.0, (levin.n + turn).normalize()).value;
                let shifted = about_q.at(dt, levin.n).value;
                assert!(turned.min(shifted) > least_levin.value, "at {size}");
            }
        }
    }
}

/// Levin's condition does not know r but through the line that r is on.
#[test]
fn projecting_twice_is_projecting_once_with_levins_condition() {
    let (shape, count) = (Shape::Torus, 8000);
    let h = shape.feature_size(count);
    for noise in [0.0, 0.1, 0.3] {
        let points = cloud(shape, count, true, noise);
        for polynomial in PolynomialKind::SIMPLER {
            let surface = surface(&points, h, polynomial).with_search(PlaneSearch::FixedOrigin);
            for r in queries(shape, 20, h) {
                let once = surface.project(r).expect("a surface");
                let twice = surface.project(once.point).expect("a surface");
                let moved = apart(twice.point, once.point);
                assert!(moved < 1e-8 * h, "{polynomial:?}, noise {noise}: {:e} h", moved / h);
                assert!(apart(twice.plane_origin, once.plane_origin) < 1e-8 * h);
            }
        }
    }
}

/// Where the plane is symmetric about n it does not matter what n turns about. Elsewhere the paper's
/// projection moves its own points a little, and less each time.
#[test]
fn the_papers_projection_converges_to_fixed_points() {
    for (shape, random, noise, once) in [
        (Shape::Sphere, false, 0.0, 1e-11),
        (Shape::Cylinder, false, 0.0, 1e-11),
        (Shape::Torus, false, 0.0, 1e-5),
        (Shape::Torus, true, 0.2, 1e-3),
    ] {
        let h = shape.feature_size(8000);
        let points = cloud(shape, 8000, random, noise);
        let surface = surface(&points, h, PolynomialKind::Full);
        for r in queries(shape, 40, h) {
            let mut x = surface.project(r).expect("a surface").point;
            for allowed in [once, 1e-3 * once, 1e-8] {
                let next = surface.project(x).expect("a surface").point;
                let moved = apart(next, x) / h;
                assert!(moved < f64::max(allowed, 1e-12), "{shape:?}, noise {noise}: {moved:e} h");
                x = next;
            }
        }
    }
}

/// So either may be called the surface.
#[test]
fn the_surfaces_of_both_searches_differ_less_than_their_error() {
    let shape = Shape::Torus;
    let h = shape.feature_size(8000);
    for noise in [0.0, 0.1] {
        let points = cloud(shape, 8000, true, noise);
        let paper = surface(&points, h, PolynomialKind::Full);
        let levin = paper.clone().with_search(PlaneSearch::FixedOrigin);
        let (mut error, mut difference) = (0.0, 0.0);
        for r in queries(shape, 100, h) {
            let [a, b] = [&paper, &levin].map(|s| s.project(r).expect("a surface").point);
            error += shape.distance(V3(a)).0.powi(2);
            difference += apart(a, b).powi(2);
        }
        assert!(difference < 0.01 * error, "a tenth, squared: {difference:e} {error:e}");
    }
}

/// The renderer's iteration starts anew from each point, so it ends where P(x) = x for its own P. A
/// sum cut at 3 h shifts both by less than the error of the surface.
#[test]
fn iterating_the_plane_of_covariance_ends_beside_the_complete_projection() {
    let shape = Shape::Torus;
    let h = shape.feature_size(8000);
    for (noise, ratio) in [(0.0, 0.1), (0.1, 0.3)] {
        let points = cloud(shape, 8000, true, noise);
        let complete = surface(&points, h, PolynomialKind::Full);
        let simple = complete.clone().with_reach(3.0);
        let (mut error, mut difference) = (0.0, 0.0);
        for r in queries(shape, 100, h) {
            let mut x = r;
            for _ in 0..8 {
                x = simple.project_at(x).expect("a surface").point;
            }
            let moved = apart(simple.project_at(x).expect("a surface").point, x);
            assert!(moved < 1e-6 * h, "{:e} h", moved / h);
            let exact = complete.project(x).expect("a surface");
            assert_eq!(exact.polynomial, PolynomialKind::Full);
            error += shape.distance(V3(exact.point)).0.powi(2);
            difference += apart(exact.point, x).powi(2);
        }
        let found = (difference / error).sqrt();
        assert!(found < ratio, "noise {noise}: {found} of the error");
    }
}

#[test]
fn a_sum_over_all_points_equals_one_over_those_that_f64_can_see() {
    let h = Shape::Torus.feature_size(2000);
    let points = cloud(Shape::Torus, 2000, true, 0.1);
    let near = surface(&points, h, PolynomialKind::Full);
    let all = near.clone().with_reach(f64::INFINITY);
    for r in queries(Shape::Torus, 10, h) {
        let [near, all] = [&near, &all].map(|s| s.project(r).expect("a surface"));
        assert!(apart(near.point, all.point) < 1e-10 * h, "settled to 1e-10 h");
    }
}

#[test]
fn feature_sizes_of_points_are_taken_from_the_nearest_lower_index_first() {
    let points = cloud(Shape::Sphere, 4000, true, 0.0);
    let h = Shape::Sphere.feature_size(4000);
    let mut sizes = vec![2.0 * h; points.len()];
    let r = V3(points[17]).times(1.001).0;
    sizes[17] = h;
    let mut twins = points.clone();
    twins.push(points[17]);
    sizes.push(3.0 * h);
    let polynomial = PolynomialKind::Full;
    let mixed = PointSurface::new(&twins, FeatureSize::PerPoint(sizes), polynomial);
    let constant = PointSurface::new(&twins, FeatureSize::Constant(h), polynomial);
    assert_eq!(mixed.project(r), constant.project(r));
    assert!(mixed.project(r).is_some());
    assert_ne!(mixed.project(points[3]), constant.project(points[3]));
}

#[test]
fn what_spans_no_surface_projects_nothing() {
    let line: Vec<[f64; 3]> = (0..50).map(|i| [0.1 * f64::from(i), 0.0, 0.0]).collect();
    let steep: Vec<[f64; 3]> = line.iter().map(|p| [p[0], 0.7 * p[0], -0.3 * p[0]]).collect();
    let sets: [&[[f64; 3]]; 6] =
        [&[], &line[..1], &line[..2], &line, &steep, &[[1.0, 0.0, 0.0]; 30]];
    for points in sets {
        for reach in [3.0, f64::INFINITY] {
            for h in [0.2, 1.0, 1e3] {
                let surface =
                    PointSurface::new(points, FeatureSize::Constant(h), PolynomialKind::Full)
                        .with_reach(reach);
                for r in [[1.0, 0.0, 0.0], [1.0, 0.05, 0.02], [0.0; 3], [1e6, 0.0, 1.0]] {
                    assert_eq!(surface.project(r), None);
                    assert_eq!(surface.project_at(r), None);
                }
            }
        }
    }
}

/// Equation 1 looks for t within h/2; further out its minimum is an end of that bracket, no plane.
#[test]
fn points_far_from_the_surface_and_sizes_that_are_none_project_nothing() {
    let points = cloud(Shape::Sphere, 4000, false, 0.0);
    let h = Shape::Sphere.feature_size(4000);
    for reach in [3.0, f64::INFINITY] {
        let surface = surface(&points, h, PolynomialKind::Full).with_reach(reach);
        for r in [1.0 + 0.6 * h, 1.0 - 0.6 * h, 1.0 + 2.9 * h, 2.0, 1e3, 1e300, 0.0] {
            assert_eq!(surface.project([0.0, r, 0.0]), None, "{r}");
        }
        // The plane of a sphere's cap lies below the top, here by 0.06 h.
        assert!(surface.project([0.0, 1.0 + 0.4 * h, 0.0]).is_some());
        assert!(surface.project([0.0, 1.0 - 0.4 * h, 0.0]).is_some());
        for r in [2.0 + 9.0 * h, 1e3, f64::NAN, f64::INFINITY] {
            assert_eq!(surface.project_at([0.0, r, 0.0]), None, "{r}");
        }
    }
    for h in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let surface = PointSurface::new(&points, FeatureSize::Constant(h), PolynomialKind::Full);
        assert_eq!(surface.project(points[0]), None);
    }
}

/// Clumps of few random points, with twins among them, seen from anywhere: an end, and numbers.
#[test]
fn whatever_the_points_the_projection_ends_in_numbers_or_none() {
    let mut random = Random(2);
    let mut surfaces = 0;
    for case in 0..2000 {
        let count = 1 + case % 12;
        let mut points: Vec<[f64; 3]> =
            (0..count).map(|_| [0; 3].map(|_| (4.0 * random.symmetric()).round() * 0.25)).collect();
        points.push(points[0]);
        let surface = PointSurface::new(&points, FeatureSize::Constant(0.5), {
            PolynomialKind::SIMPLER[case % 5]
        });
        let r = [0; 3].map(|_| 0.5 * random.symmetric());
        for search in [PlaneSearch::FixedDistance, PlaneSearch::FixedOrigin] {
            let surface = surface.clone().with_search(search);
            for found in [surface.project(r), surface.project_at(r)].into_iter().flatten() {
                surfaces += 1;
                let numbers = [found.point, found.normal, found.plane_origin, found.plane_normal];
                assert!(numbers.as_flattened().iter().all(|x| x.is_finite()), "{found:?}");
                assert!((length(V3(found.normal)) - 1.0).abs() < 1e-12);
            }
        }
    }
    assert!(surfaces > 1000, "{surfaces}");
}
