//! Scanners that look along rays: the depth camera and the laser scanner.

use crate::exact::sin_cos;
use crate::noise::{Mixed, mixed, smoothed};
use crate::random::Random;
use crate::room::Room;
use crate::scan::{Kind, Sample};
use crate::vector::{V3, add, cross, dot, frame, length, unit};
use std::f64::consts::TAU;

/// Surfaces that a ray meets flatter than this (about 6°) give no point.
const FLATTEST: f64 = 0.1;
/// What jumps by so much of the distance between neighbouring rays is an edge, where both mix.
const JUMP: f64 = 0.04;

/// How noisy and how dense a scan is at a place, as one eye sees it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Beam {
    pub sigma: f64,
    pub spacing: f64,
}

/// What looks along rays from one place.
pub(crate) trait Eye {
    fn place(&self) -> V3;
    /// Whether a direction of unit length is within the view.
    fn sees(&self, d: V3) -> bool;
    /// At a distance along a direction, where the surface is met at this cosine.
    fn beam(&self, distance: f64, cosine: f64, d: V3) -> Beam;
}

/// Kinect v1 (Khoshelham and Elberink, Accuracy and Resolution of Kinect Depth Data, 2012): disparity with noise of half
/// a step, of which half the variance is white and half smoothed over 5 × 5 pixels, rounded to 1/8 pixel.
pub(crate) struct DepthCamera {
    eye: V3,
    axes: [V3; 3],
    size: [usize; 2],
    /// In pixels.
    focal: f64,
}

impl DepthCamera {
    /// Between the projector and the camera.
    const BASELINE: f64 = 0.075;
    /// Of disparity, in pixels.
    const STEP: f64 = 0.125;

    /// A resolution of 1 is 640 × 480 pixels. Noise and steps grow with the pixels: steps are a share of them.
    pub fn new(room: &Room, resolution: f64) -> Self {
        let [eye, look] = room.depth_camera;
        let size = [640.0, 480.0].map(|side: f64| (side * resolution).round().max(1.0) as usize);
        Self { eye, axes: frame(add(look, eye, -1.0)), size, focal: 580.0 * resolution }
    }

    /// Points, row by row.
    pub fn scan(&self, room: &Room, random: &mut Random) -> Vec<Sample> {
        let [width, height] = self.size;
        let [right, up, forward] = self.axes;
        let through = |pixel: usize| {
            let x = ((pixel % width) as f64 + 0.5 - 0.5 * width as f64) / self.focal;
            let y = (0.5 * height as f64 - (pixel / width) as f64 - 0.5) / self.focal;
            add(add(forward, right, x), up, y)
        };
        let count = width * height;
        let hits: Vec<_> = (0..count).map(|at| room.trace(self.eye, unit(through(at)))).collect();
        let depth = |at: usize| hits[at].map(|hit| hit.t / length(through(at)));
        let depths: Vec<Option<f64>> = (0..count).map(depth).collect();
        let depths = mixed(&depths, width, JUMP, random);
        let white: Vec<f64> = (0..count).map(|_| random.normal()).collect();
        let soft = smoothed(&(0..count).map(|_| random.normal()).collect::<Vec<_>>(), width);
        let mut samples = Vec::new();
        for at in 0..count {
            let (Some(hit), Some(Mixed { value, is_mixed })) = (hits[at], depths[at]) else {
                continue;
            };
            let way = through(at);
            let d = unit(way);
            if dot(d, hit.normal).abs() <= FLATTEST {
                continue;
            }
            let noise = 0.5 * Self::STEP * (white[at] + soft[at]) / 2.0f64.sqrt();
            let disparity = self.focal * Self::BASELINE / value + noise;
            let steps = (disparity / Self::STEP).round().max(1.0);
            samples.push(Sample {
                position: add(self.eye, way, self.focal * Self::BASELINE / (steps * Self::STEP)),
                clean: add(self.eye, d, hit.t),
                normal: hit.normal,
                kind: if is_mixed { Kind::Mixed } else { Kind::Surface },
            });
        }
        samples
    }
}

impl Eye for DepthCamera {
    fn place(&self) -> V3 {
        self.eye
    }

    fn sees(&self, d: V3) -> bool {
        let [right, up, forward] = self.axes.map(|axis| dot(d, axis));
        let within =
            |across: f64, side: usize| across.abs() * self.focal < 0.5 * side as f64 * forward;
        forward > 0.0 && within(right, self.size[0]) && within(up, self.size[1])
    }

    /// Noise goes with the square of the depth; pixels are smaller off the axis.
    fn beam(&self, distance: f64, cosine: f64, d: V3) -> Beam {
        let off = dot(d, self.axes[2]);
        let depth = distance * off;
        let step = Self::STEP / (self.focal * Self::BASELINE) * depth * depth;
        Beam {
            sigma: SIGMA_OF_STEP * step / off,
            spacing: distance / self.focal * (off * off.sqrt()) / cosine.max(0.05).sqrt(),
        }
    }
}

/// Deviation of the noise over the step: the cited formula's, 1.43e-3 z² at steps of 2.87e-3 z².
const SIGMA_OF_STEP: f64 = 1.43e-3 * 580.0 * DepthCamera::BASELINE / DepthCamera::STEP;

/// Rays over latitude and longitude, with noise along them.
pub(crate) struct Laser {
    eye: V3,
    /// Radians between rays.
    step: f64,
    /// Of the distance.
    noise: f64,
}

impl Laser {
    /// Of rays that hit, how many give a point anywhere before.
    const STRAYS: f64 = 1e-3;
    /// Degrees up and down.
    const HIGHEST: f64 = 75.0;

    /// A resolution of 1 is a ray every 0.4°. Noise grows with the distance between rays.
    pub fn new(eye: V3, permille: f64, resolution: f64) -> Self {
        let step = (0.4 / resolution).to_radians();
        Self { eye, step, noise: 1e-3 * permille / resolution }
    }

    pub fn scan(&self, room: &Room, random: &mut Random) -> Vec<Sample> {
        let highest = Self::HIGHEST.to_radians();
        let [rows, columns] = [2.0 * highest, TAU].map(|angle| (angle / self.step).ceil() as usize);
        let turns: Vec<_> = (0..columns).map(|at| sin_cos(at as f64 * self.step)).collect();
        let lifts: Vec<_> = (0..rows).map(|at| sin_cos(at as f64 * self.step - highest)).collect();
        let through = |at: usize| {
            let ((up, level), (sin, cos)) = (lifts[at / columns], turns[at % columns]);
            [level * cos, level * sin, up]
        };
        let count = rows * columns;
        let hits: Vec<_> = (0..count).map(|at| room.trace(self.eye, through(at))).collect();
        let distances: Vec<Option<f64>> = hits.iter().map(|hit| hit.map(|hit| hit.t)).collect();
        let distances = mixed(&distances, columns, JUMP, random);
        let mut samples = Vec::new();
        for at in 0..count {
            let (Some(hit), Some(Mixed { value, is_mixed })) = (hits[at], distances[at]) else {
                continue;
            };
            let d = through(at);
            if dot(d, hit.normal).abs() <= FLATTEST {
                continue;
            }
            let noisy = value * (1.0 + self.noise * random.normal());
            let is_stray = random.unit() < Self::STRAYS;
            let anywhere = hit.t * random.unit();
            samples.push(Sample {
                position: add(self.eye, d, if is_stray { anywhere } else { noisy }),
                clean: add(self.eye, d, hit.t),
                normal: hit.normal,
                kind: match (is_stray, is_mixed) {
                    (true, _) => Kind::Stray,
                    (_, true) => Kind::Mixed,
                    _ => Kind::Surface,
                },
            });
        }
        samples
    }
}

impl Eye for Laser {
    fn place(&self) -> V3 {
        self.eye
    }

    fn sees(&self, d: V3) -> bool {
        d[2].abs() < sin_cos(Self::HIGHEST.to_radians()).0
    }

    fn beam(&self, distance: f64, cosine: f64, d: V3) -> Beam {
        // Rays of a row are closer towards the poles.
        let level = length(cross(d, [0.0, 0.0, 1.0]));
        Beam {
            sigma: self.noise * distance,
            spacing: distance * self.step * (level / cosine.max(0.05)).sqrt(),
        }
    }
}
