//! Where grids lie.

use super::*;

fn plan(balls: &[([f32; 3], f32)], resolution: u32) -> GridInfo {
    let grids = plan_levels(balls, resolution);
    assert!(!grids.are_several());
    grids.levels[0].grid
}

fn plan_levels(balls: &[([f32; 3], f32)], resolution: u32) -> Grids {
    let points: Vec<Point> =
        balls.iter().map(|&(position, _)| Point { position, index: 0 }).collect();
    let outcomes: Vec<FitOutcome> = balls
        .iter()
        .map(|&(_, trust)| FitOutcome { trust, kind: 3, feature_size: trust })
        .collect();
    plan_grids(&points, &outcomes, resolution, false)
}

#[test]
fn no_surface_one_empty_cell() {
    assert_eq!(plan(&[], 0), EMPTY);
    assert_eq!(plan(&[([0.0; 3], 0.0)], 0), EMPTY);
}

#[test]
fn the_grid_holds_every_ball() {
    let balls = [([0.0, 0.0, 0.0], 1.0), ([10.0, 2.0, -3.0], 0.5), ([4.0, 4.0, 4.0], 0.25)];
    for resolution in [0, 1, 7, 100] {
        let grid = plan(&balls, resolution);
        for (center, trust) in balls {
            let inside = |axis: usize| {
                let end = grid.origin[axis] + grid.edge * grid.resolution[axis] as f32;
                grid.origin[axis] < center[axis] - trust && end > center[axis] + trust
            };
            assert!((0..3).all(inside), "{grid:?}");
        }
    }
    assert_eq!(plan(&balls, 7).resolution.iter().max(), Some(&7));
}

/// A far outlier with a huge ball must not fill memory with cells or pairs.
#[test]
fn outliers_make_the_grid_coarser_and_no_larger() {
    let mut balls: Vec<([f32; 3], f32)> = (0..10_000)
        .map(|i| ([(i % 100) as f32 * 0.01, (i / 100) as f32 * 0.01, 0.0], 0.02))
        .collect();
    balls.push(([1e6, 1e6, 1e6], 1e6));
    let grid = plan(&balls, 100_000);
    assert!(f64::from(grid.cell_count()) <= CELLS_PER_POINT * 10_001.0, "{grid:?}");
}

/// Of very many balls a part says how fine the grid may be, and all of them have the last word: also where the part has
/// one of the few that meet most of the pairs.
#[test]
fn very_many_balls_have_the_finest_grid_within_their_bounds() {
    let side = 1100;
    let mut balls = square([0.0; 3], 1.0, side);
    for large in [0, PART, 37 * PART + 1] {
        balls[large].1 = 0.2;
    }
    assert!(balls.len() >= MANY);
    let share = Share { of_all: 1.0, budget: BYTES_BESIDE_TREE };
    let grid = plan_grid(&balls, 1.0 / f64::from(side), 0, share);
    let [low, high] = bounds_of(&balls);
    let extent = [0, 1, 2].map(|axis| high[axis] - low[axis]);
    let bytes = |edge: f64| {
        let pairs = pair_count(&balls, low, edge);
        (8.0 * cell_count(extent, edge) + 4.0 * LISTED_PAIRS * pairs) / balls.len() as f64
    };
    let edge = f64::from(grid.edge);
    assert!(bytes(edge) <= BYTES_BESIDE_TREE, "{}", bytes(edge));
    assert!(bytes(edge / 1.1) > BYTES_BESIDE_TREE, "{}", bytes(edge / 1.1));
}

/// `count` squared balls on a square of this width, as large as they lie apart.
fn square(corner: [f32; 3], width: f32, count: u32) -> Vec<([f32; 3], f32)> {
    let step = width / count as f32;
    let at = |i: u32| [corner[0] + step * (i % count) as f32, corner[1], corner[2]];
    (0..count * count)
        .map(|i| (at(i), (i / count) as f32 * step))
        .map(|([x, y, z], along)| ([x, y + along, z], step))
        .collect()
}

#[test]
fn each_size_and_place_has_its_grid() {
    let land = square([-500.0, -500.0, 0.0], 1000.0, 100);
    let (here, there) = (square([0.0; 3], 1.0, 60), square([300.0, 200.0, 1.0], 1.0, 60));
    let grids = plan_levels(&[land, here, there].concat(), 0);
    let grid = |at: usize| grids.levels[at].grid;
    assert_eq!(grids.levels.len(), 3);
    for at in [0, 1] {
        assert!((grid(at).edge * 60.0 / 2.5 - 1.0).abs() < 1e-3, "{:?}", grid(at));
    }
    assert!((grid(2).edge / 25.0 - 1.0).abs() < 1e-3, "{:?}", grid(2));
    // Slots of all grids, in the given order, are those of all points.
    let order: Vec<u32> = (0..17_200).rev().collect();
    let counts = [0, 1, 2].map(|level| grids.order_of(level, &order).len());
    assert_eq!(counts, [3600, 3600, 10_000]);
    assert_eq!(grids.order_of(2, &order)[0], 9999);
    let [first, second, third] = &grids.levels[..] else { unreachable!("three") };
    let [one, other] = [first, second].map(|level| level.first_slot);
    assert_eq!([one.min(other), one.max(other), third.end_slot], [10_000, 13_600, 10_000]);
    assert!(second.first_cell >= first.grid.cell_count() && second.first_cell % FIRST_CELL == 0);
    assert!(third.first_offset > second.first_offset + second.grid.cell_count());
}

/// Radii from 1 to 1000, as from a scanner that sees far.
#[test]
fn sizes_without_a_gap_are_parted_too() {
    let balls: Vec<([f32; 3], f32)> = (0..20_000)
        .map(|i| {
            let radius = 1000f32.powf(i as f32 / 20_000.0);
            let angle = i as f32 * 2.4;
            ([radius * 50.0 * angle.cos(), radius * 50.0 * angle.sin(), 0.0], radius)
        })
        .collect();
    let grids = plan_levels(&balls, 0);
    assert!((3..=8).contains(&grids.levels.len()), "{:?}", grids.levels);
    assert!(grids.levels.windows(2).all(|pair| pair[0].grid.edge < pair[1].grid.edge));
}

/// A ground below a scene: it has a grid of its own, and the others have the one that they have without it.
#[test]
fn a_giant_changes_no_grid_but_its_own() {
    let balls = |with: bool| {
        let mut balls: Vec<([f32; 3], f32)> = (0..20_000u32)
            .map(|i| {
                let [u, v] = [i % 200, i / 200].map(|at| f64::from(at) / 200.0);
                ([u as f32, (0.1 * (7.0 * u).sin()) as f32, v as f32], 0.01)
            })
            .collect();
        balls.extend(with.then_some(([0.5, -0.2, 0.25], 9.0)));
        plan_levels(&balls, 0)
    };
    let (without, with) = (balls(false), balls(true));
    assert_eq!((without.levels.len(), with.levels.len()), (1, 2));
    // But for the share of cells and pairs, which is of all.
    let [fine, giant] = [with.levels[0].grid, with.levels[1].grid];
    assert!((fine.edge / without.levels[0].grid.edge - 1.0).abs() < 0.01, "{fine:?}");
    assert!(giant.edge > 100.0 * fine.edge, "{giant:?}");
}
