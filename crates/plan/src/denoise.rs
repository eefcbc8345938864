//! Noise is smoothed, and what lies on no surface set apart, before a device sees the points.

use crate::PlanError;
use crate::bulk::Bulk;
use crate::shapes::{ShapeKind, Shapes, scatter_kind};
use points::{Cloud, Denoised, Noise, PointSet, Smoothing, Watch, voxel_means};
use scene::{Neighbors, Object, Scene, SurfaceKind};
use std::fmt;
use std::sync::Arc;

/// Radius of a disc or sphere at a point that lies on no surface, over the spacing there, and of a stray over the median
/// spacing.
const SHARE: f32 = 0.5;
const OF_STRAY: f32 = 0.25;

/// What was done to the points of an object with noise.
#[derive(Debug, Clone, PartialEq)]
pub struct Denoising {
    /// Its index in the scene.
    pub object: usize,
    /// What noise they had.
    pub noise: Noise,
    /// The median standard deviation of the noise along normals, scene units.
    pub sigma: f64,
    /// The median spacing of points on surfaces, scene units.
    pub spacing: f64,
    /// Points that were smoothed: of a quantised set, means.
    pub points: u64,
    /// Points of the object before means were taken.
    pub of: u64,
    /// How many of those that were smoothed lie on no surface; strays near the others among them.
    pub scatter: u64,
    /// What these are drawn as.
    pub drawn: Option<ShapeKind>,
    /// Whether strays are among them.
    pub has_strays: bool,
}

impl fmt::Display for Denoising {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let spacings = self.sigma / self.spacing.max(f64::MIN_POSITIVE);
        match self.noise {
            Noise::Quantised { edge } => write!(
                f,
                "depths are in steps, so {} points became {} means over {edge:.2e}; their noise of {:.2e} \
                 ({spacings:.2} spacings) was smoothed",
                self.of, self.points, self.sigma
            )?,
            _ => write!(f, "noise of {:.2e} ({spacings:.2} spacings) was smoothed", self.sigma)?,
        }
        if self.scatter > 0 {
            let share = 100.0 * self.scatter as f64 / self.points.max(1) as f64;
            let drawn = match self.drawn {
                Some(ShapeKind::Disc) => "drawn as small discs",
                Some(ShapeKind::Sphere) => "drawn as small spheres",
                None => "not drawn",
            };
            write!(
                f,
                "; {} points ({share:.2} %) lie on no surface and are {drawn}",
                self.scatter
            )?;
        }
        write!(
            f,
            "; --set objects.{}.surface.neighbors=16 takes the points as they are",
            self.object
        )
    }
}

/// How the noise of an object is smoothed, if its surface asks for that.
fn smoothing(object: &Object) -> Option<Smoothing> {
    let is_surface = object.volume.is_none() && object.surface.kind == SurfaceKind::Points;
    match object.surface.neighbors {
        Neighbors::Auto { accuracy } if is_surface => {
            Some(Smoothing { accuracy: accuracy.to_radians() as f32, agreed: false })
        }
        _ => None,
    }
}

/// What smoothing leaves over.
#[derive(Default)]
pub(crate) struct Smoothed {
    /// What is drawn at points on no surface, object by object.
    pub shapes: Vec<Shapes>,
    pub found: Vec<Denoising>,
}

/// Moves the points of objects with noise onto their surfaces. Where there are other points than before, `sets` and
/// `cloud` get these.
pub(crate) fn denoise(
    scene: &Scene,
    bulk: &Bulk,
    sets: &mut [Arc<PointSet>],
    cloud: &mut Cloud,
    watch: &dyn Watch,
) -> Result<Smoothed, PlanError> {
    let mut noisy: Vec<Noisy> = Vec::new();
    let mut is_changed = false;
    for (index, object) in scene.objects.iter().enumerate() {
        let Some(smoothing) = smoothing(object) else { continue };
        let noise = Noise::of(&positions(cloud, index));
        if noise == Noise::Clean {
            continue;
        }
        let of = sets[index].len() as u64;
        let mut own = Noisy { index, noise, smoothing, of, is_stray: Vec::new() };
        if let Noise::Quantised { edge } = noise {
            let edge_in_file = f64::from(edge) / object.transform.scale;
            sets[index] = Arc::new(voxel_means(&sets[index], edge_in_file, Noise::LEAST));
            own.smoothing.agreed = true;
            is_changed = true;
        } else if let Some((with_strays, is_stray)) = bulk.near_strays(index) {
            sets[index] = Arc::clone(with_strays);
            own.is_stray.clone_from(is_stray);
            is_changed = true;
        }
        noisy.push(own);
    }
    if is_changed {
        watch.stage("sorting points", sets.iter().map(|set| set.len() as u64).sum());
        *cloud = bulk.cloud(scene, sets, watch)?;
    }
    let mut smoothed = Smoothed::default();
    for own in noisy {
        let (shapes, found) =
            own.smooth(&scene.objects[own.index], &sets[own.index], cloud, watch)?;
        smoothed.shapes.extend(shapes);
        smoothed.found.push(found);
    }
    Ok(smoothed)
}

fn positions(cloud: &Cloud, object: usize) -> Vec<[f32; 3]> {
    cloud.points[cloud.objects[object].range()].iter().map(|point| point.position).collect()
}

/// An object whose points have noise.
struct Noisy {
    index: usize,
    noise: Noise,
    smoothing: Smoothing,
    of: u64,
    /// By place in its set; empty where no stray is.
    is_stray: Vec<bool>,
}

impl Noisy {
    /// Where each point was seen from, by its place among the object's slots; empty where no sensor is known.
    fn sensors(&self, object: &Object, set: &PointSet, cloud: &Cloud) -> Vec<Option<[f32; 3]>> {
        if set.sensors.is_empty() {
            return Vec::new();
        }
        let range = cloud.objects[self.index].range();
        let mut sensors = vec![None; range.len()];
        for place in (0..set.len()).filter(|&place| cloud.counts(self.index, place)) {
            let local = |sensor: [f64; 3]| {
                let world = object.transform.apply(sensor);
                [0, 1, 2].map(|axis| (world[axis] - cloud.origin[axis]) as f32)
            };
            let slot = cloud.slot(self.index, place) as usize - range.start;
            sensors[slot] = set.sensor_of(place).map(local);
        }
        sensors
    }

    fn smooth(
        &self,
        object: &Object,
        set: &PointSet,
        cloud: &mut Cloud,
        watch: &dyn Watch,
    ) -> Result<(Option<Shapes>, Denoising), PlanError> {
        let seen_from = self.sensors(object, set, cloud);
        let range = cloud.objects[self.index].range();
        let mut is_left = vec![true; range.len()];
        for place in (0..self.is_stray.len()).filter(|&place| self.is_stray[place]) {
            is_left[cloud.slot(self.index, place) as usize - range.start] = false;
        }
        let own = &mut cloud.points[range.clone()];
        let left: Vec<usize> = (0..own.len()).filter(|&at| is_left[at]).collect();
        let points: Vec<_> = left.iter().map(|&at| own[at]).collect();
        let sensors: Vec<_> = match seen_from.is_empty() {
            true => Vec::new(),
            false => left.iter().map(|&at| seen_from[at]).collect(),
        };
        let denoised = Denoised::of(&points, &sensors, &self.smoothing, watch)
            .ok_or(PlanError::Interrupted)?;
        // Strays look anywhere.
        let mut is_scatter = vec![true; own.len()];
        let mut radii = vec![OF_STRAY * denoised.spacing; own.len()];
        let mut normals = vec![[0.0; 3]; own.len()];
        for (place, &at) in left.iter().enumerate() {
            own[at].position = denoised.positions[place];
            is_scatter[at] = denoised.is_scatter[place];
            radii[at] = SHARE * denoised.spacings[place];
            normals[at] = denoised.normals[place];
        }
        cloud.put_last(self.index, &is_scatter);
        let scatter = is_scatter.iter().filter(|&&is_scatter| is_scatter).count();
        let drawn = scatter_kind(object);
        let of_scatter = |at: &usize| is_scatter[*at];
        let shapes = (scatter > 0).then(|| Shapes {
            object: self.index as u32,
            first_slot: (range.end - scatter) as u32,
            count: scatter as u32,
            kind: drawn.unwrap_or(ShapeKind::Disc),
            radii: (0..range.len())
                .filter(of_scatter)
                .map(|at| if drawn.is_some() { radii[at] } else { 0.0 })
                .collect(),
            normals: Some((0..range.len()).filter(of_scatter).map(|at| normals[at]).collect()),
        });
        let found = Denoising {
            object: self.index,
            noise: self.noise,
            sigma: f64::from(denoised.sigma),
            spacing: f64::from(denoised.spacing),
            points: range.len() as u64,
            of: self.of,
            scatter: scatter as u64,
            drawn,
            has_strays: !self.is_stray.is_empty(),
        };
        Ok((shapes, found))
    }
}
