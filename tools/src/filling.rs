//! Points that fill a space and carry a scalar: what volumes are shown with.

use crate::noise::random;
use crate::ply::Points;
use crate::vector::Vector;
use crate::{figure, implicit};

/// A point of the box, the same for the same number.
fn random_point(low: Vector, high: Vector, number: u32) -> Vector {
    [0, 1, 2].map(|axis| {
        let part = random(f64::from(number), 1000.0 + axis as f64);
        low[axis] + part * (high[axis] - low[axis])
    })
}

/// Smooth, from -1 to 1, with whirls of several sizes.
fn whirls([x, y, z]: Vector) -> f64 {
    let wave = |k: f64, p: f64| {
        ((k * x + p).sin() + (k * y + 2.0 * p + (k * z).cos()).sin() + (k * z - p).cos()) / 3.0
    };
    0.6 * wave(3.1, 0.3) + 0.3 * wave(6.7, 1.9) + 0.1 * wave(13.0, 4.0)
}

#[expect(clippy::cast_possible_truncation, reason = "rounding to float is meant")]
fn rounded(values: impl Iterator<Item = f64>) -> Vec<f32> {
    values.map(|value| value as f32).collect()
}

/// Random points in the ball; the density falls to nothing at its rim, in whirls.
pub fn smoke(count: u32) -> Points {
    let square = |p: &Vector| p.iter().map(|x| x * x).sum::<f64>();
    let positions: Vec<Vector> = (0..)
        .map(|number| random_point([-1.0; 3], [1.0; 3], number))
        .filter(|p| square(p) < 1.0)
        .take(count as usize)
        .collect();
    let density = |p: &Vector| {
        let rim = 1.0 - square(p);
        (rim * (0.35 + 1.1 * whirls([2.2 * p[0], 1.7 * p[1], 2.2 * p[2]]))).clamp(0.0, 1.0)
    };
    let densities = rounded(positions.iter().map(density));
    Points { positions, attributes: vec![("density", densities)], ..Points::default() }
}

/// The hare's surface, three of five points, and points inside, away from it.
pub fn filled_hare(count: u32) -> Points {
    let on_skin = count * 3 / 5;
    let [low, high] = figure::HARE_BOX;
    let mut positions = implicit::even_points(figure::hare, low, high, on_skin);
    let inside = (0..)
        .map(|number| random_point(low, high, number))
        .filter(|&p| figure::hare(p) < -0.012)
        .take((count - on_skin) as usize);
    positions.extend(inside);
    let densities =
        rounded(positions.iter().map(|&[x, y, z]| 0.5 + 0.5 * whirls([2.4 * x, 2.0 * y, 2.4 * z])));
    let skin = (0..count).map(|i| f64::from(u8::from(i < on_skin)));
    Points {
        positions,
        attributes: vec![("density", densities), ("skin", rounded(skin))],
        ..Points::default()
    }
}
