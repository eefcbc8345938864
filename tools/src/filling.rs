//! Points that fill a space and carry a scalar: what volumes are shown with.

use crate::noise::random;
use crate::vector::{Vector, length};
use crate::{figure, implicit};
use points::PlyPoints as Points;
use points::fill::{random_point, whirls};

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

/// Nodes of a grid that is stretched towards its axis: a jet along z that swirls and mixes, with its `density`.
pub fn swirl(count: u32) -> Points {
    let rings = (f64::from(count) / 72.0).sqrt();
    let (along, out, around) = (rings * 3.0, rings * 1.0, 24.0_f64);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some hundreds")]
    let columns = along.ceil() as u32;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some hundreds")]
    let rows = out.ceil() as u32 + 1;
    let place = |i: u32| {
        let (ring, spoke) = (i / 24, f64::from(i % 24));
        let z = f64::from(ring % columns) / f64::from(columns - 1);
        let part = (f64::from(ring / columns) + 0.5) / f64::from(rows);
        // Half a spoke of twist from ring to ring, so that rows do not line up.
        let angle = std::f64::consts::TAU * (spoke + 0.5 * f64::from(ring % 2)) / around;
        let radius = 0.05 + 0.95 * part.powf(1.5) * (1.0 - 0.35 * z);
        [radius * angle.cos(), radius * angle.sin(), 3.0 * z - 1.5]
    };
    let positions: Vec<Vector> = (0..count).map(place).collect();
    let density = |&[x, y, z]: &Vector| {
        let radius = x.hypot(y);
        let turn = y.atan2(x) + 2.6 * z;
        let core = (-(radius * radius) / (0.05 + 0.04 * (z + 1.5))).exp();
        let arms = 0.5 + 0.5 * (2.0 * turn).cos();
        0.2 + 0.55 * core + 0.25 * arms * (-((radius - 0.5) / 0.22).powi(2)).exp()
    };
    let density = rounded(positions.iter().map(density));
    Points { positions, attributes: vec![("density", density)], ..Points::default() }
}

/// Two pillars in a stream along x, the `speed` of a potential flow around them, slower in their wakes.
pub fn stream(count: u32) -> Points {
    let pillars = [[-0.8, 0.0, 0.35], [0.7, 0.45, 0.22]];
    let free =
        |p: &Vector| pillars.iter().all(|&[x, z, radius]| (p[0] - x).hypot(p[2] - z) > radius);
    let positions: Vec<Vector> = (0..)
        .map(|number| random_point([-2.0, -0.6, -1.0], [2.0, 0.6, 1.0], number))
        .filter(free)
        .take(count as usize)
        .collect();
    let speed = |p: &Vector| {
        let (mut u, mut w, mut wake) = (1.0, 0.0, 1.0);
        for [x, z, radius] in pillars {
            let (a, b) = (p[0] - x, p[2] - z);
            let square = a * a + b * b;
            let dipole = radius * radius / (square * square);
            u -= dipole * (a * a - b * b);
            w -= dipole * 2.0 * a * b;
            let behind = (a / radius).clamp(0.0, 6.0);
            let waves = 0.12 * (5.0 * a + 2.0 * p[1]).sin();
            let across = (b - waves * behind.min(1.5)) / (radius * (0.8 + 0.12 * behind));
            wake *= 1.0
                - 0.85 * (1.0 - (-behind).exp()) * (-across * across).exp() * (-behind / 7.0).exp();
        }
        u.hypot(w) * wake
    };
    let speed = rounded(positions.iter().map(speed));
    Points { positions, attributes: vec![("speed", speed)], ..Points::default() }
}

/// A chain of blobs that winds up, as a molecule's density is measured: every third sample of a lattice,
/// `density` from 0 to 255.
pub fn molecule(count: u32) -> Points {
    let beads: Vec<(Vector, f64)> = (0..46)
        .map(|i| {
            let t = f64::from(i) / 45.0;
            let (turn, tilt) = (19.0 * t, 5.0 * t);
            let radius = 0.25 + 0.45 * (3.1 * t).sin();
            let y = 1.5 * t - 0.75 + 0.12 * tilt.sin();
            ([radius * turn.cos(), y, radius * turn.sin()], 0.09 + 0.05 * (7.0 * t).sin().abs())
        })
        .collect();
    let side = (3.0 * f64::from(count)).cbrt().ceil();
    let positions: Vec<Vector> = (0..)
        .map(|number: u32| {
            let at = |place: f64| (random(f64::from(number), place) * side).floor() / (side - 1.0);
            [at(2000.0), at(2001.0), at(2002.0)].map(|x| 2.2 * x - 1.1)
        })
        .take(count as usize)
        .collect();
    let density = |p: &Vector| {
        let near = |&(bead, width): &(Vector, f64)| {
            let off = [0, 1, 2].map(|axis| p[axis] - bead[axis]);
            (-(length(off) / width).powi(2)).exp()
        };
        255.0 * beads.iter().map(near).sum::<f64>().min(1.0)
    };
    let density = rounded(positions.iter().map(density));
    Points { positions, attributes: vec![("density", density)], ..Points::default() }
}

/// Particles of a drop that has fallen into a pool, `density` 1, spaced as a simulation has them.
pub fn splash(count: u32) -> Points {
    // The volume of water is 5.9: a particle has its share.
    let side = (5.9 / f64::from(count)).cbrt();
    let water = |[x, y, z]: Vector| {
        let radius = x.hypot(z);
        let ring = 0.85;
        let waves = 0.10 * (7.0 * radius - 1.2).cos() * (-0.9 * radius).exp();
        let angle = z.atan2(x);
        let fingers = 0.16 * (0.5 + 0.5 * (9.0 * angle).cos()).powi(2);
        let lean = ring + 0.22 * y;
        let wall = 0.10 * (1.0 - 0.55 * y).max(0.35);
        let crown = y < 0.62 + fingers && (radius - lean).abs() < wall;
        let drops = (0..9).any(|i| {
            let turn = std::f64::consts::TAU * f64::from(i) / 9.0;
            let middle = [1.06 * turn.cos(), 0.98 + 0.05 * f64::from(i % 3), 1.06 * turn.sin()];
            length([x - middle[0], y - middle[1], z - middle[2]]) < 0.11
        });
        let column = radius < 0.16 + 0.10 * (1.0 - y).max(0.0) && y < 0.85;
        let top = length([x, y - 1.02, z]) < 0.20;
        let pool = y < -0.05 + waves && x.abs() < 1.6 && z.abs() < 1.6 && y > -0.6;
        pool || (y > -0.2 && (crown || drops || column || top))
    };
    let mut positions = Vec::new();
    let mut number = 0u32;
    let mut side = side;
    // Lattices of smaller and smaller cells, until one has as many as asked for.
    while positions.len() < count as usize {
        positions.clear();
        let cells = |extent: f64| (extent / side).ceil();
        for k in 0..cells(3.2) as u32 {
            for j in 0..cells(2.0) as u32 {
                for i in 0..cells(3.2) as u32 {
                    number = number.wrapping_add(1);
                    let jitter = |axis: f64| 0.15 * (random(f64::from(number), axis) - 0.5);
                    let at = |n: u32, axis: f64| (f64::from(n) + 0.5 + jitter(axis)) * side;
                    let p = [at(i, 1.0) - 1.6, at(j, 2.0) - 0.6, at(k, 3.0) - 1.6];
                    if water(p) {
                        positions.push(p);
                    }
                }
            }
        }
        side *= 0.99;
    }
    // Spread over all of it, what is too many.
    let kept = positions.len();
    let positions: Vec<Vector> =
        (0..count as usize).map(|i| positions[i * kept / count as usize]).collect();
    let density = rounded(positions.iter().map(|_| 1.0));
    Points { positions, attributes: vec![("density", density)], ..Points::default() }
}
