//! Photogrammetry: points anywhere on the surfaces, as dense and as noisy as the pictures were good.

use crate::exact::{exp, ln, sin_cos};
use crate::random::Random;
use crate::room::{Block, Column, Rectangle, Room};
use crate::scan::{Kind, Observed, Sample};
use crate::vector::{V3, add, cross, length};

/// Points of a scan at resolution 1.
const POINTS: f64 = 140_000.0;
/// Places a square metre of which points are chosen, at resolution 1.
const CANDIDATES: f64 = 40_000.0;
/// Of the highest density over the lowest.
const DENSITIES: f64 = 30.0;
/// Deviations of the noise, in spacings.
const NOISE: [f64; 2] = [0.3, 2.0];
/// Radius of the places without points.
const BLIND: f64 = 0.16;
/// Points that lie anywhere in a box around the room.
const OUTLIERS: f64 = 0.02;
const AROUND: [V3; 2] = [[-0.3; 3], [4.0, 4.0, 3.0]];
/// How far inside a body a surface is hidden.
const INSIDE: f64 = 1e-9;

/// Densities and holes.
pub(crate) struct Photo {
    blind: [V3; 6],
    /// Points a square metre where there are fewest.
    lowest: f64,
}

impl Photo {
    pub fn scan(room: &Room, resolution: f64, random: &mut Random) -> (Self, Vec<Sample>) {
        let per_area = CANDIDATES * resolution * resolution;
        let mut places = Places { per_area, random, found: Vec::new() };
        room.rectangles.iter().for_each(|rectangle| places.rectangle(rectangle));
        room.blocks.iter().for_each(|block| places.block(block));
        places.ball(room.ball);
        places.column(&room.column);
        let mut places = places.found;
        places.retain(|&(p, _)| !is_hidden(room, p));
        let mut photo = Self { blind: room.blind, lowest: 1.0 };
        // Relative to the lowest.
        let density = |photo: &Self, p: V3| {
            let at = photo.at(p);
            if at.is_seen { 1.0 / (at.spacing * at.spacing) } else { 0.0 }
        };
        let sum: f64 = places.iter().map(|&(p, _)| density(&photo, p)).sum();
        photo.lowest = POINTS * resolution * resolution * per_area / sum;
        places.retain(|&(p, _)| random.unit() < density(&photo, p) / per_area);
        let mut samples: Vec<Sample> = Vec::with_capacity(places.len());
        for (clean, normal) in places {
            let noise = random.normals();
            let noisy = add(clean, noise, photo.at(clean).sigma);
            let is_stray = random.unit() < OUTLIERS;
            let anywhere = [0, 1, 2].map(|i| random.between(AROUND[0][i], AROUND[1][i]));
            samples.push(Sample {
                position: if is_stray { anywhere } else { noisy },
                clean,
                normal,
                kind: if is_stray { Kind::Stray } else { Kind::Surface },
            });
        }
        for at in (1..samples.len()).rev() {
            samples.swap(at, random.index(at + 1));
        }
        (photo, samples)
    }

    pub fn at(&self, p: V3) -> Observed {
        let [x, y, z] = p;
        let (sin, cos) = (sin_cos(2.1 * x + 1.3 + z).0, sin_cos(1.7 * y + 0.4).1);
        let dense = 0.5 + 0.5 * sin * cos;
        let noisy = 0.5 + 0.5 * sin_cos(1.9 * y - 1.1 * x + 1.6 * z).0;
        let spacing = 1.0 / (self.lowest * exp(dense * ln(DENSITIES))).sqrt();
        let is_blind = self.blind.iter().any(|&q| length(add(p, q, -1.0)) < BLIND);
        Observed {
            sigma: spacing * NOISE[0] * exp(noisy * ln(NOISE[1] / NOISE[0])),
            spacing,
            is_seen: !is_blind,
        }
    }
}

/// Whether a place of some surface lies in another body, or under one.
fn is_hidden(room: &Room, p: V3) -> bool {
    let in_block = |block: &Block| {
        let place = block.inside(p);
        let within = |k: usize| place[k].abs() < block.half[k] - INSIDE;
        within(0) && within(1) && (within(2) || p[2] < INSIDE)
    };
    let Column { base, radius, height } = room.column;
    let from = add(p, base, -1.0);
    let in_column = length([from[0], from[1], 0.0]) < radius - INSIDE && p[2] < height - INSIDE;
    let in_ball = length(add(p, room.ball.0, -1.0)) < room.ball.1 - INSIDE;
    p[2] < -INSIDE || room.blocks.iter().any(in_block) || in_column || in_ball
}

/// Places by chance on surfaces, with their normals, either way.
struct Places<'a> {
    per_area: f64,
    random: &'a mut Random,
    found: Vec<(V3, V3)>,
}

impl Places<'_> {
    fn add(&mut self, area: f64, place: impl Fn(&mut Random) -> (V3, V3)) {
        for _ in 0..(area * self.per_area) as u64 {
            let found = place(self.random);
            self.found.push(found);
        }
    }

    fn rectangle(&mut self, rectangle: &Rectangle) {
        let Rectangle { middle, along, half } = *rectangle;
        let normal = cross(along[0], along[1]);
        self.add(4.0 * half[0] * half[1], |random| {
            let [a, b] = half.map(|half| random.between(-half, half));
            (add(add(middle, along[0], a), along[1], b), normal)
        });
    }

    fn block(&mut self, block: &Block) {
        for k in 0..3 {
            for side in [-1.0, 1.0] {
                let [a, b] = [(k + 1) % 3, (k + 2) % 3];
                self.rectangle(&Rectangle {
                    middle: add(block.middle, block.along[k], side * block.half[k]),
                    along: [block.along[a], block.along[b]],
                    half: [block.half[a], block.half[b]],
                });
            }
        }
    }

    fn ball(&mut self, (middle, radius): (V3, f64)) {
        self.add(4.0 * std::f64::consts::PI * radius * radius, |random| {
            let normal = random.direction();
            (add(middle, normal, radius), normal)
        });
    }

    fn column(&mut self, column: &Column) {
        let Column { base, radius, height } = *column;
        self.add(std::f64::consts::TAU * radius * height, |random| {
            let (sin, cos) = sin_cos(random.between(0.0, std::f64::consts::TAU));
            let normal = [cos, sin, 0.0];
            let up = random.between(0.0, height);
            (add(add(base, normal, radius), [0.0, 0.0, up], 1.0), normal)
        });
        self.add(std::f64::consts::PI * radius * radius, |random| {
            let (sin, cos) = sin_cos(random.between(0.0, std::f64::consts::TAU));
            let r = radius * random.unit().sqrt();
            (add(base, [r * cos, r * sin, height], 1.0), [0.0, 0.0, 1.0])
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Places under the box and the ball, and in the floor, are no surface; nothing else is hidden.
    #[test]
    fn what_lies_in_bodies_or_under_them_is_hidden() {
        let room = Room::new(0);
        for p in [[0.95, 1.65, 0.0], [1.75, 0.8, 0.0], [0.65, 0.6, 0.0], [1.75, 0.8, -0.05]] {
            assert!(is_hidden(&room, p), "{p:?}");
        }
        for p in [[3.0, 3.0, 0.0], [0.95, 1.65, 0.6], [0.0, 2.0, 1.0], [1.75, 1.151, 0.28]] {
            assert!(!is_hidden(&room, p), "{p:?}");
        }
    }
}
