//! Sets that are made here. Those of files are in `crates/points/tests/dimension.rs`.

use super::*;

/// A generator of pseudo-random numbers in [0, 1): tests need the same points every time.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    /// About normal: twelve uniform numbers.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.next()).sum::<f64>() - 6.0
    }

    fn unit(&mut self) -> [f64; 3] {
        let v = [self.normal(), self.normal(), self.normal()];
        let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
        v.map(|x| x / length)
    }

    fn shuffled(&mut self, mut points: Vec<[f64; 3]>) -> Vec<[f64; 3]> {
        for i in (1..points.len()).rev() {
            points.swap(i, (self.next() * (i + 1) as f64) as usize);
        }
        points
    }
}

fn of(points: Vec<[f64; 3]>) -> Dimension {
    let file_index = (0..points.len() as u32).collect();
    Dimension::of(&PointSet { positions: points, file_index, ..PointSet::default() })
}

/// Nodes, the first index fastest, at places made of three numbers from 0 to 1.
fn nodes([i, j, k]: [usize; 3], at: impl Fn([f64; 3]) -> [f64; 3]) -> Vec<[f64; 3]> {
    let part = |n: usize, of: usize| n as f64 / (of - 1) as f64;
    let mut points = Vec::new();
    for z in 0..k {
        for y in 0..j {
            points.extend((0..i).map(|x| at([part(x, i), part(y, j), part(z, k)])));
        }
    }
    points
}

/// 0 to 1, crowded at 0 as cells at a wall are: the last step is `ratio` times the first.
fn wall(x: f64, ratio: f64) -> f64 {
    (ratio.powf(x) - 1.0) / (ratio - 1.0)
}

/// A cylinder around a hole, whose rows crowd at the inner wall and close on themselves.
fn annulus([r, t, z]: [f64; 3]) -> [f64; 3] {
    let (radius, turn) = (0.2 + wall(r, 300.0), t * std::f64::consts::TAU);
    [radius * turn.cos(), radius * turn.sin(), 4.0 * z]
}

/// The nearest are a line or a sheet in all of these.
#[test]
fn nodes_of_grids_are_volumes_in_their_order() {
    let is_grid = |sides: [usize; 3], points: Vec<[f64; 3]>| {
        let expected = Dimension::Volume(Sign::Nodes(sides.map(|side| side as u64)));
        assert_eq!(of(points), expected);
    };
    let at_walls = |[x, y, z]: [f64; 3]| [x, y, wall(z, 1e3)];
    is_grid([40, 30, 36], nodes([40, 30, 36], at_walls));
    is_grid([30, 20, 24], nodes([30, 20, 24], |[x, y, z]| [x, y, 60.0 * z]));
    is_grid([30, 60, 20], nodes([30, 60, 20], annulus));
    // Over a hill, and turned.
    let hill = |[x, y, z]: [f64; 3]| {
        let height = wall(z, 100.0) + 0.2 * (5.0 * x).sin() * (4.0 * y).cos();
        [0.6 * x - 0.8 * height, y, 0.8 * x + 0.6 * height]
    };
    is_grid([40, 40, 25], nodes([40, 40, 25], hill));
    // From its other end, the same grid.
    is_grid([40, 40, 25], nodes([40, 40, 25], hill).into_iter().rev().collect());
}

/// A file that leaves some nodes out counts them all the same.
#[test]
fn nodes_that_were_dropped_leave_a_grid() {
    let all = nodes([30, 60, 20], annulus);
    let kept = |i: &usize| i % 7 != 3;
    let set = PointSet {
        positions: (0..all.len()).filter(kept).map(|i| all[i]).collect(),
        file_index: (0..all.len()).filter(kept).map(|i| i as u32).collect(),
        non_finite: (0..all.len()).filter(|i| !kept(i)).count() as u64,
        ..PointSet::default()
    };
    assert_eq!(Dimension::of(&set), Dimension::Volume(Sign::Nodes([30, 60, 20])));
}

#[test]
fn lattices_are_volumes_in_any_order_and_with_holes() {
    let mut random = Random(1);
    let stretched = nodes([40, 30, 24], |[x, y, z]| [x, y, 40.0 * z]);
    let expected = Dimension::Volume(Sign::Lattice([40, 30, 24]));
    assert_eq!(of(random.shuffled(stretched.clone())), expected);
    let is_inside =
        |p: &[f64; 3]| (9.0 * p[0]).sin() + (8.0 * p[1]).sin() + (p[2] / 6.0).sin() > 0.0;
    assert_eq!(of(stretched.into_iter().filter(is_inside).collect()), expected);
}

#[test]
fn particles_are_volumes() {
    let mut random = Random(2);
    let mut shell = |count: usize, radius: &dyn Fn(f64) -> f64| -> Vec<[f64; 3]> {
        let point = |_| {
            let r = radius(random.next());
            random.unit().map(|x| r * x)
        };
        (0..count).map(point).collect()
    };
    let ball = shell(20_000, &|m| m.cbrt());
    assert!(of(ball.clone()).is_volume(), "a ball");
    assert!(of(shell(1500, &|m| m.cbrt())).is_volume(), "a small ball");
    // Plummer's cluster: half of the mass within 1.3, a tenth of it beyond 3.6.
    let plummer = |m: f64| 1.0 / ((0.99 * m).powf(-2.0 / 3.0) - 1.0).sqrt();
    assert!(of(shell(20_000, &plummer)).is_volume(), "a cluster");
    // Strays change nothing, wherever they lie.
    let mut with_strays = ball;
    with_strays.extend((0..50).map(|i| [1e6 * f64::from(i), 3.0, -1e9]));
    assert!(of(with_strays).is_volume(), "a ball and strays");
}

/// Particles keep apart; noise, at random, does not.
#[test]
fn layers_of_particles_are_volumes_and_noisy_sheets_are_none() {
    let mut random = Random(3);
    let mut jittered = |layers: usize| {
        let lattice =
            nodes([60, 60, layers], |[x, y, z]| [59.0 * x, 59.0 * y, (layers - 1) as f64 * z]);
        let moved: Vec<[f64; 3]> =
            lattice.into_iter().map(|p| p.map(|x| x + 0.1 * random.normal())).collect();
        random.shuffled(moved)
    };
    for layers in [5, 6, 10] {
        assert!(of(jittered(layers)).is_volume(), "{layers} layers");
    }
    assert_eq!(of(jittered(2)), Dimension::Surface);
    // In spacings of the sheet.
    for sigma in [0.0, 0.5, 1.0, 2.0, 3.0, 5.0] {
        let sheet =
            (0..60_000).map(|_| [random.next(), random.next(), sigma / 245.0 * random.normal()]);
        assert_eq!(of(sheet.collect()), Dimension::Surface, "noise of {sigma} spacings");
    }
}

#[test]
fn surfaces_of_all_kinds_are_surfaces() {
    let mut random = Random(4);
    let sphere: Vec<[f64; 3]> = (0..20_000).map(|_| random.unit()).collect();
    assert_eq!(of(sphere), Dimension::Surface, "a sphere");
    // A map of rows and columns, whose number of points has many divisors.
    let map = nodes([128, 256, 1], |[x, y, _]| {
        let [u, v] = [x, y].map(|x| x * std::f64::consts::TAU);
        [(1.0 + 0.3 * v.cos()) * u.cos(), (1.0 + 0.3 * v.cos()) * u.sin(), 0.3 * v.sin()]
    });
    assert_eq!(of(map), Dimension::Surface, "a torus in rows and columns");
    for gap in [0.01, 0.003, 0.001] {
        let plate = (0..40_000).map(|i| [random.next(), random.next(), gap * f64::from(i % 2)]);
        assert_eq!(of(plate.collect()), Dimension::Surface, "a plate {gap} thick");
    }
    for (floors, gap) in [(3, 0.1), (5, 0.02), (10, 0.1), (10, 0.03), (20, 0.05)] {
        let points = (0..60_000).map(|_| {
            let floor = (random.next() * f64::from(floors)).floor();
            [random.next(), random.next(), gap * floor + 5e-4 * random.normal()]
        });
        assert_eq!(of(points.collect()), Dimension::Surface, "{floors} floors, {gap} apart");
    }
    // Floors whose points are lattices, one above the other.
    let floors = nodes([100, 100, 5], |[x, y, z]| [x, y, 0.4 * z]);
    assert_eq!(of(floors), Dimension::Surface, "five floors of tiles");
    // The same sheet again and again, as a scanner that stands still sees it, and one that moves.
    let frames: Vec<[f64; 3]> = (0..20)
        .flat_map(|frame| {
            nodes([60, 40, 1], move |[x, y, _]| {
                let x = x + 0.05 * f64::from(frame);
                [x, y, 0.3 * (3.0 * x).cos() * (2.0 * y).cos()]
            })
        })
        .collect();
    assert_eq!(of(frames), Dimension::Surface, "frames of a scanner that moves");
}

/// Crowns as shells of leaves over ground, seen from above.
#[test]
fn trees_seen_from_above_are_no_volume() {
    let mut random = Random(5);
    let trees: Vec<[f64; 3]> = (0..700)
        .map(|_| [100.0 * random.next(), 100.0 * random.next(), 12.0 + 13.0 * random.next()])
        .collect();
    let mut points = Vec::new();
    for _ in 0..100_000 {
        let [x, y] = [100.0 * random.next(), 100.0 * random.next()];
        let crown = trees.iter().map(|t| ((t[0] - x).hypot(t[1] - y), t[2]));
        let (away, height) = crown.fold((f64::MAX, 0.0), |a, b| if b.0 < a.0 { b } else { a });
        let depth = -4.0 * (1.0 - random.next()).ln();
        let top = if away < 2.5 { height * (1.0 - 0.1 * away * away) - depth } else { 0.0 };
        points.push([x, y, top.max(0.05 * random.normal())]);
    }
    assert_eq!(of(points), Dimension::Surface);
}

/// A square of the Menger sponge's third step has 27 faces along each side.
#[test]
fn a_sponge_of_faces_is_a_surface() {
    let mut random = Random(6);
    let is_there = |cell: [i32; 3]| {
        cell.iter().all(|c| (0..27).contains(c))
            && [1, 3, 9].iter().all(|step| cell.iter().filter(|&&c| c / step % 3 == 1).count() < 2)
    };
    let mut points = Vec::new();
    while points.len() < 100_000 {
        let cell = [0; 3].map(|_| (27.0 * random.next()) as i32);
        let axis = (3.0 * random.next()) as usize;
        let mut beside = cell;
        beside[axis] += 1;
        if is_there(cell) != is_there(beside) {
            let mut p = cell.map(|c| f64::from(c) + random.next());
            p[axis] = f64::from(beside[axis]);
            points.push(p);
        }
    }
    assert_eq!(of(points), Dimension::Surface);
}

#[test]
fn few_points_or_copies_of_one_show_nothing() {
    assert_eq!(of(Vec::new()), Dimension::Surface);
    assert_eq!(of(vec![[1.0, 2.0, 3.0]; 2000]), Dimension::Surface);
    assert_eq!(of(nodes([7, 7, 7], |p| p)), Dimension::Surface);
}
