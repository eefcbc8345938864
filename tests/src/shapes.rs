//! Point sets whose surfaces are known in closed form.

use points::{Attribute, PointSet, Values};

/// A set of positions, without colours.
#[must_use]
pub fn set_of(positions: Vec<[f64; 3]>) -> PointSet {
    let file_index = (0..positions.len() as u32).collect();
    PointSet { positions, file_index, ..PointSet::default() }
}

/// The set with another attribute, a function of the position.
#[must_use]
pub fn with_attribute(mut set: PointSet, name: &str, value: impl Fn([f64; 3]) -> f64) -> PointSet {
    let values = Values::F64(set.positions.iter().map(|&p| value(p)).collect());
    set.attributes.push(Attribute { name: name.to_owned(), values });
    set
}

/// Even points on the unit sphere: the spherical Fibonacci lattice.
#[must_use]
pub fn fibonacci_sphere(count: u32) -> Vec<[f64; 3]> {
    let golden = std::f64::consts::PI * (3.0 - 5f64.sqrt());
    (0..count)
        .map(|i| {
            let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(count);
            let (sin, cos) = (golden * f64::from(i)).sin_cos();
            let radius = (1.0 - z * z).sqrt();
            [radius * cos, radius * sin, z]
        })
        .collect()
}

/// A flat square grid: every distance is a tie.
#[must_use]
pub fn grid_points(side: u32) -> Vec<[f64; 3]> {
    let at = |i: u32| f64::from(i) / f64::from(side);
    (0..side * side).map(|i| [at(i % side), 0.0, at(i / side)]).collect()
}

/// Random points on a wavy sheet over the unit square.
#[must_use]
pub fn wavy_sheet(count: u32) -> Vec<[f64; 3]> {
    let mut seed = 7;
    (0..count)
        .map(|_| {
            let (x, z) = (random(&mut seed), random(&mut seed));
            [x, 0.1 * (7.0 * x).sin() * (5.0 * z).cos(), z]
        })
        .collect()
}

/// Every position moved by the same vector.
#[must_use]
pub fn moved(positions: &[[f64; 3]], by: [f64; 3]) -> Vec<[f64; 3]> {
    positions.iter().map(|p| [p[0] + by[0], p[1] + by[1], p[2] + by[2]]).collect()
}

/// Pseudo-random in [0, 1), the same on every run.
pub fn random(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 11) as f64 / (1u64 << 53) as f64
}
