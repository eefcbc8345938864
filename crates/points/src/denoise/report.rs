//! What `info` says of a set's noise, by a thousand of its points.

use super::fit::Fit;
use super::judge::{Noise, Sample, median};
use super::near::square;
use super::scales::{NEAREST, Worker};
use super::{APART_BEFORE, SPACING, Smoothing, scatter};
use crate::cloud::{Cloud, ObjectPoints};
use crate::set::PointSet;
use crate::strays::{Strays, rough_origin};
use rayon::prelude::*;
use serde_json::{Value, json};
use std::fmt;

/// The noise of a set of points, and what smoothing does about it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NoiseReport {
    /// Of which kind.
    pub noise: Noise,
    /// The median expected error of normals from 16 neighbours, in degrees.
    pub error: f64,
    /// The median standard deviation along normals, in units of the positions; of quantised points, that of the steps.
    pub sigma: f64,
    /// The median spacing: that of so many points on a plane.
    pub spacing: f64,
    /// The share of points that lie on no surface, 0 to 1, strays not counted. By a sample: two figures are right.
    pub scatter: f64,
    /// Points that lie far from all others.
    pub strays: u64,
    /// All points.
    pub points: u64,
}

impl NoiseReport {
    /// Measures the points of a set; `None` where there are too few, or too far apart. Fewer than 2³² points.
    #[must_use]
    pub fn of(set: &PointSet) -> Option<Self> {
        let origin = rough_origin(&[&set.positions])?;
        let strays = Strays::find(&set.positions, origin).places;
        let mut keep = vec![true; set.len()];
        strays.iter().for_each(|&place| keep[place as usize] = false);
        let left: Vec<[f64; 3]> =
            set.positions.iter().zip(&keep).filter(|(_, keep)| **keep).map(|(p, _)| *p).collect();
        let index: Vec<u32> = (0..left.len() as u32).collect();
        let cloud = Cloud::distinct(&[ObjectPoints::new(&left, &index)]).ok()?;
        let points: Vec<[f32; 3]> = cloud.points.iter().map(|point| point.position).collect();
        let sample = Sample::of(&points)?;
        let noise = sample.noise();
        let in_steps = matches!(noise, Noise::Quantised { .. });
        let looked = look(&sample, in_steps);
        Some(Self {
            noise,
            error: f64::from(sample.error().to_degrees()),
            sigma: f64::from(median(looked.iter().map(|looked| looked.fit.s).collect())),
            spacing: f64::from(median(
                looked.iter().map(|looked| SPACING * looked.square.sqrt()).collect(),
            )),
            scatter: scattered(&looked, in_steps),
            strays: strays.len() as u64,
            points: set.len() as u64,
        })
    }

    /// As `info --json` has it.
    #[must_use]
    pub fn to_json(&self) -> Value {
        let (kind, edge) = match self.noise {
            Noise::Clean => ("none", None),
            Noise::Random => ("random", None),
            Noise::Quantised { edge } => ("quantised", Some(edge)),
        };
        json!({
            "kind": kind,
            "edge": edge,
            "normal_error": self.error,
            "sigma": self.sigma,
            "spacing": self.spacing,
            "sigma_in_spacings": self.sigma / self.spacing.max(f64::MIN_POSITIVE),
            "scatter": self.scatter,
            "strays": self.strays as f64 / self.points.max(1) as f64,
            "auto": self.auto(),
        })
    }

    /// What `neighbors = "auto"` does.
    #[must_use]
    pub fn auto(&self) -> String {
        match self.noise {
            Noise::Clean => "leaves the points as they are".to_owned(),
            Noise::Random => "smooths it".to_owned(),
            Noise::Quantised { edge } => {
                format!("takes means over {edge:.3e}, and smooths their noise")
            }
        }
    }
}

impl fmt::Display for NoiseReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let spacings = self.sigma / self.spacing.max(f64::MIN_POSITIVE);
        match self.noise {
            Noise::Clean => {
                write!(f, "none that matters (normals are within {:.2} degrees)", self.error)?
            }
            Noise::Random => write!(f, "{:.3e} ({spacings:.2} spacings)", self.sigma)?,
            Noise::Quantised { .. } => {
                write!(f, "depths in steps, {:.3e} ({spacings:.2} spacings)", self.sigma)?;
            }
        }
        let share = |count: f64| 100.0 * count;
        write!(
            f,
            ", about {:.1} % on no surface, {:.3} % strays; neighbors = \"auto\" {}",
            share(self.scatter),
            share(self.strays as f64 / self.points.max(1) as f64),
            self.auto()
        )
    }
}

/// So many of the sample's points are asked for what is usual around one.
const ASKED: usize = 64;

/// Neighbours that reach over several steps of depths.
const WIDE: usize = 256;

/// What a point of the sample shows.
struct Looked {
    position: [f32; 3],
    fit: Fit,
    square: f32,
    is_apart: bool,
}

fn look(sample: &Sample<'_>, in_steps: bool) -> Vec<Looked> {
    let smoothing = Smoothing { accuracy: 2.5 / 180.0 * std::f32::consts::PI, agreed: false };
    let near = &sample.near;
    let places = sample.places.par_iter().with_min_len(16);
    places
        .map_init(Worker::default, |worker, &at| {
            let at = at as usize;
            let own = worker.reach(near, at, NEAREST)?;
            let around = worker.others(at, own);
            let reaches = around.iter().filter_map(|&other| worker.reach(near, other, NEAREST));
            let is_apart = own > APART_BEFORE * median(reaches.collect());
            let fit = match in_steps {
                // Over several of them.
                true => worker.fit_alone(near, at, WIDE)?,
                false => worker.fit_of(near, at, &smoothing),
            };
            Some(Looked { position: near.points[at], fit, square: own * own, is_apart })
        })
        .flatten()
        .collect()
}

/// The share that is scatter, by the rules of all points with the sample standing for what is around.
fn scattered(looked: &[Looked], in_steps: bool) -> f64 {
    let is_scatter = |own: &&Looked| {
        let mut around: Vec<(f32, f32, f32)> = looked
            .iter()
            .map(|other| (square(own.position, other.position), other.fit.s, other.square))
            .collect();
        let asked = ASKED.min(around.len());
        around.select_nth_unstable_by(asked - 1, |a, b| a.0.total_cmp(&b.0));
        let s = median(around[..asked].iter().map(|other| other.1).collect());
        let reach = median(around[..asked].iter().map(|other| other.2).collect());
        // Steps are no noise: what their means are shows only in these.
        own.is_apart || (!in_steps && scatter::by_fit(&own.fit, own.square, [s, reach]))
    };
    let count = looked.par_iter().with_min_len(16).filter(is_scatter).count();
    count as f64 / looked.len().max(1) as f64
}
