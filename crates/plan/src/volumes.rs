//! Volumes: which points carry a surface, and the grid in which a sample finds the points in its reach
//! (\[T\] §6; docs/method.md, section 7).

mod build;
mod particles;

pub(crate) use build::cell_of;

use crate::PlanError;
use crate::bulk::Bulk;
use crate::chord;
use crate::chosen::Findings;
use crate::colors::attribute_values;
use crate::field;
use crate::missing::{Lacking, Missing};
use crate::neighborhoods::{length, open_points, spacing};
use crate::steep;
use crate::transfer::{own_range, stops_of};
use bytemuck::Zeroable;
use kernels::layout::{
    BLOCK_PLACES, MATERIAL_CLOUD, NONE, ObjectInfo, Polynomial, SCENE_GLOWS, SCENE_MANY_VOLUMES,
    SCENE_PARTICLES, SCENE_STEEP, SCENE_WEIGHTS, SCENE_WHOLES, VOLUME_AVERAGE, VOLUME_EMISSION,
    VOLUME_EMITS, VOLUME_INTEGRAL, VOLUME_ISOSURFACE, VOLUME_LIGHTS, VOLUME_MAXIMUM,
    VOLUME_SHEPARD, VOLUME_SPH, VolumeCell, VolumeInfo, VolumePoint, VolumeStop,
};
use particles::{Particle, Sph};
use points::{Cloud, PointSet, Watch, bounds_of};
use scene::{Boundary, Integrator, Object, Scene, Transfer, VolumeKernel, VolumeMode};
use std::sync::Arc;

/// Samples that a ray may take.
const MOST_SAMPLES: f64 = 16_000_000.0;
/// Powers of two that a weight may be away from 1 in a block.
const MOST_POWERS: f64 = 100.0;
/// Cells along the longest axis: more cost more memory than they save samples.
const MOST_CELLS: f64 = 160.0;

/// All volumes of a scene, as plain data.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Volumes {
    /// In the order of their objects.
    pub infos: Vec<VolumeInfo>,
    /// Cells of each volume, with one behind the last.
    pub cells: Vec<VolumeCell>,
    /// Points of each volume by cell, in the order of the file within one.
    pub points: Vec<VolumePoint>,
    /// 1/h of each point, 0 where it has none; one number where no volume has particles.
    pub inverse_lengths: Vec<f32>,
    /// Of all transfer functions.
    pub stops: Vec<VolumeStop>,
    /// Length of the steps along a ray: the shortest that a volume asks for.
    pub step: f32,
    /// Where light goes from surface to surface: the first of the objects, after those of the scene, that stand for
    /// volumes which scatter rays.
    pub first_cloud: Option<u32>,
}

/// The points of an object that carry its surface.
pub(crate) fn surface_points(
    object: &Object,
    set: &Arc<PointSet>,
    watch: &dyn Watch,
) -> Result<Arc<PointSet>, PlanError> {
    let Some(volume) = &object.volume else { return Ok(Arc::clone(set)) };
    Ok(match &volume.boundary {
        Boundary::All => Arc::clone(set),
        Boundary::None => Arc::new(set.filtered(|_| false)),
        Boundary::Auto => {
            let open = open_points(&set.positions, watch)?;
            Arc::new(set.filtered(|i| open[i]))
        }
        Boundary::Attribute(name) => {
            let values = attribute(object, set, name)?;
            Arc::new(set.filtered(|i| values[i] != 0.0 && !values[i].is_nan()))
        }
    })
}

/// The values of an attribute that a volume asks for.
fn attribute(object: &Object, set: &PointSet, name: &str) -> Result<Vec<f64>, PlanError> {
    attribute_values(set, name).map_err(|known| PlanError::NoVolumeAttribute {
        name: object.name.clone(),
        attribute: name.to_owned(),
        file: object.points.display().to_string(),
        known,
    })
}

/// Lists the points of every volume.
pub(crate) fn plan_volumes(
    scene: &Scene,
    bulk: &Bulk,
    cloud: &Cloud,
    (watch, found): (&dyn Watch, &mut Findings),
) -> Result<Volumes, PlanError> {
    let origin = cloud.origin;
    let mut volumes = Volumes { step: f32::MAX, ..Volumes::default() };
    for (index, object) in scene.objects.iter().enumerate() {
        let Some(volume) = &object.volume else { continue };
        let (set, positions) = &bulk.particles[index];
        let scalars = attribute(object, set, &volume.scalar)?;
        let particles = match &volume.kernel {
            VolumeKernel::Sph { smoothing_length, mass, density } => {
                let of = Sph { smoothing_length, mass: mass.as_ref(), density: density.as_deref() };
                of.particles(object, set, &scalars)?
            }
            _ => scalars.iter().map(|&scalar| Particle { length: f64::INFINITY, scalar }).collect(),
        };
        let counts = |of: &Particle| {
            let inverse_length = (1.0 / of.length) as f32;
            (of.scalar as f32).is_finite() && of.length > 0.0 && inverse_length.is_finite()
        };
        let lacking = particles.iter().filter(|of| !counts(of)).count();
        if lacking == particles.len() && lacking > 0 {
            return Err(PlanError::NoScalars {
                name: object.name.clone(),
                attribute: volume.scalar.clone(),
                file: object.points.display().to_string(),
            });
        }
        if lacking > 0 {
            found.missing.push(Missing {
                object: object.name.clone(),
                what: Lacking::Scalar(volume.scalar.clone()),
                points: lacking as u64,
                of: particles.len() as u64,
            });
        }
        let radius = match (&volume.kernel, volume.radius) {
            (VolumeKernel::Sph { .. }, _) => {
                2.0 * particles
                    .iter()
                    .map(|p| p.length)
                    .filter(|h| h.is_finite())
                    .fold(0.0, f64::max)
            }
            (_, Some(radius)) => radius,
            (_, None) if lacking == 0 => spacing(&bulk.world[index], watch)?,
            (_, None) => {
                let both = positions.iter().zip(&particles);
                let there = both.filter(|(_, of)| counts(of)).map(|(&p, _)| p);
                spacing(&there.collect::<Vec<_>>(), watch)?
            }
        };
        watch.stage("sorting the points of a volume", positions.len() as u64);
        // Points that all lie in one place have no spacing, and any reach shows them alike.
        let radius = if radius > 0.0 { radius } else { 1.0 };
        let points: Vec<(VolumePoint, f32)> = positions
            .iter()
            .zip(&particles)
            .filter(|(_, of)| counts(of))
            .map(|(p, of)| {
                let position = [0, 1, 2].map(|axis| (p[axis] - origin[axis]) as f32);
                let inverse_length = (1.0 / of.length) as f32;
                (VolumePoint { position, scalar: of.scalar as f32 }, inverse_length)
            })
            .collect();
        let own = own_range(&scalars, volume.scale);
        if own.is_none()
            && volume.mode != VolumeMode::Integral
            && matches!(volume.transfer, Some(Transfer::Map { range: None, .. }))
        {
            return Err(PlanError::NothingPositive {
                name: object.name.clone(),
                attribute: volume.scalar.clone(),
                file: object.points.display().to_string(),
            });
        }
        let own = own.unwrap_or([0.0, 1.0]);
        let stops = stops_of(volume.transfer.as_ref(), volume.scale, || own);
        let lengths = volumes.add(index as u32, object, volume, radius as f32, (points, stops));
        if let Some(Transfer::Map { range: None, .. }) = &volume.transfer {
            let range = match volume.mode {
                VolumeMode::Integral => volumes.bound_integral(volume),
                _ => own,
            };
            found.range(index, "volume.value_range", range);
        }
        volumes.scale_extinctions(volume.extinction, |volumes, info| {
            let bounds = bounds_of([&bulk.world[index][..]])?;
            let local = |corner: [f64; 3]| [0, 1, 2].map(|axis| corner[axis] - origin[axis]);
            let factor = chord::factor(volumes, info, bounds.map(local))?;
            found.number(index, "volume.extinction", factor);
            Some(factor)
        });
        let is_sph = matches!(volume.kernel, VolumeKernel::Sph { .. });
        for (key, length, is_given) in [
            ("volume.radius", radius, is_sph || volume.radius.is_some()),
            ("volume.smoothing", lengths.smoothing, is_sph || volume.smoothing.is_some()),
            ("volume.step", lengths.step, volume.step.is_some()),
        ] {
            if !is_given {
                found.number(index, key, length);
            }
        }
    }
    if volumes.infos.iter().all(|info| info.kernel != VOLUME_SPH) {
        volumes.inverse_lengths = vec![0.0];
    }
    for (info, object) in
        volumes.infos.iter().map(|info| (info, &scene.objects[info.object as usize]))
    {
        found.long_steps.extend(field::long_step(&volumes, info, object));
    }
    // Floats count no farther, so a ray of more samples would end too soon.
    let corner = |of: fn(&VolumeInfo) -> [f32; 3], pick: fn(f32, f32) -> f32| {
        let corners = volumes.infos.iter().map(of);
        corners.reduce(|a, b| [0, 1, 2].map(|axis| pick(a[axis], b[axis]))).unwrap_or_default()
    };
    let (low, high) =
        (corner(|info| info.grid.origin, f32::min), corner(|info| info.high, f32::max));
    let across = [0, 1, 2].map(|axis| f64::from(high[axis]) - f64::from(low[axis]));
    let samples = length(across) / f64::from(volumes.step);
    if !volumes.infos.is_empty() && samples > MOST_SAMPLES {
        return Err(PlanError::TooManySamples { step: volumes.step, samples });
    }
    let name = |info: &VolumeInfo| scene.objects[info.object as usize].name.clone();
    let count = volumes.infos.len();
    let alone = |info: &&VolumeInfo| is_whole(info);
    if let Some(info) = volumes.infos.iter().find(alone).filter(|_| count > 1) {
        return Err(PlanError::SeveralVolumes { name: name(info), count });
    }
    if scene.render.integrator == Integrator::Path {
        volumes.first_cloud = Some(scene.objects.len() as u32);
    }
    let lit = volumes.infos.iter().find(|info| info.shading != VOLUME_EMITS);
    let lit = lit.filter(|_| volumes.any_lit());
    let has_sun = scene.background_lights() && scene.background.sky.is_some();
    let lights = scene.lights.len() + usize::from(has_sun);
    if let Some(info) = lit.filter(|_| lights > VOLUME_LIGHTS as usize) {
        return Err(PlanError::TooManyVolumeLights { name: name(info), lights });
    }
    let refracts = |info: &&VolumeInfo| info.refracts != 0 && info.kernel == VOLUME_SHEPARD;
    if let Some(info) = volumes.infos.iter().find(refracts) {
        return Err(PlanError::OpenIsosurface { name: name(info) });
    }
    for info in &mut volumes.infos {
        info.block = block_of(info, volumes.step);
    }
    steep::mark(&mut volumes);
    for (slot, info) in (cloud.points.len() as u32..)
        .zip(volumes.infos.iter_mut().filter(|info| info.mode == VOLUME_ISOSURFACE))
    {
        info.slot = slot;
    }
    if volumes.first_cloud.is_some() {
        let first = cloud.points.len() as u32 + volumes.isosurfaces().count() as u32;
        let scattering = volumes.infos.iter_mut().filter(|info| scatters(info));
        for (slot, info) in (first..).zip(scattering) {
            info.refracts = slot;
        }
    }
    Ok(volumes)
}

/// Places of a block: as many as leave all weights, from the first place on, in the range of floats with a few decades to
/// spare, and square distances with their digits.
fn block_of(info: &VolumeInfo, step: f32) -> u32 {
    let reach = f64::from(info.square_radius).sqrt();
    let fits = |places: &u32| {
        let way = f64::from(places - 1) * f64::from(step);
        let powers =
            f64::from(info.inverse_width) * (reach + way).powi(2) * std::f64::consts::LOG2_E;
        way <= 4.0 * reach && (powers <= MOST_POWERS || info.kernel == VOLUME_SPH)
    };
    [BLOCK_PLACES, BLOCK_PLACES / 2, BLOCK_PLACES / 4].into_iter().find(fits).unwrap_or(1)
}

/// Whether one scalar stands for the whole way of a ray.
fn is_whole(info: &VolumeInfo) -> bool {
    [VOLUME_MAXIMUM, VOLUME_AVERAGE, VOLUME_INTEGRAL].contains(&info.mode)
}

/// Whether its colours are the share of light that is scattered.
fn scatters(info: &VolumeInfo) -> bool {
    info.mode == VOLUME_EMISSION && info.shading != VOLUME_EMITS
}

fn has_emission(stop: &VolumeStop) -> bool {
    stop.emission != [0.0; 3]
}

/// Lengths of a volume as they are, given or chosen.
struct Lengths {
    /// ρ, scene units squared.
    smoothing: f64,
    step: f64,
}

impl Volumes {
    /// Whether anything is seen along the way of a ray.
    #[must_use]
    pub fn any_marched(&self) -> bool {
        self.infos.iter().any(|info| info.mode != VOLUME_ISOSURFACE)
    }

    /// Whether the only volume shows one scalar for the whole way of a ray.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        self.infos.first().is_some_and(is_whole)
    }

    /// Whether there are isosurfaces.
    #[must_use]
    pub fn any_isosurface(&self) -> bool {
        self.infos.iter().any(|info| info.mode == VOLUME_ISOSURFACE)
    }

    /// Whether the light of the scene counts in any, as it reaches the points; where light goes from surface to surface,
    /// it does as it reaches rays.
    #[must_use]
    pub fn any_lit(&self) -> bool {
        self.first_cloud.is_none() && self.infos.iter().any(scatters)
    }

    /// Those that scatter rays.
    fn clouds(&self) -> impl Iterator<Item = &VolumeInfo> {
        self.infos.iter().filter(|info| self.first_cloud.is_some() && scatters(info))
    }

    /// Whether any scatters rays.
    #[must_use]
    pub fn any_cloud(&self) -> bool {
        self.clouds().next().is_some()
    }

    /// Whether any scatters light to some sides more than to others.
    pub(crate) fn any_anisotropy(&self) -> bool {
        self.infos.iter().any(|info| scatters(info) && info.iso != 0.0)
    }

    /// The objects that stand for those.
    pub(crate) fn cloud_objects(&self) -> impl Iterator<Item = ObjectInfo> {
        let of = |info: &VolumeInfo| ObjectInfo {
            weight_scale: info.iso,
            first_color: NONE,
            texture: NONE,
            ior: [1.0; 3],
            material: MATERIAL_CLOUD,
            ..ObjectInfo::zeroed()
        };
        self.clouds().map(of)
    }

    fn isosurfaces(&self) -> impl Iterator<Item = &VolumeInfo> {
        self.infos.iter().filter(|info| info.mode == VOLUME_ISOSURFACE)
    }

    /// Whether the transfer function of any is steep, and rays may divide steps.
    #[must_use]
    pub fn any_steep(&self) -> bool {
        self.infos.iter().any(|info| steep::is_steep(self, info))
    }

    /// How many ends of steps a ray keeps of each volume.
    #[must_use]
    pub fn ends_kept(&self) -> u64 {
        if self.any_steep() { 2 } else { 1 }
    }

    /// `SCENE_*`: what kernels of these volumes have to do.
    pub(crate) fn scene_bits(&self) -> u32 {
        let glows = |info: &VolumeInfo| info.mode != VOLUME_ISOSURFACE && info.slot != 0;
        [
            (SCENE_WEIGHTS, self.infos.iter().any(|info| info.kernel != VOLUME_SPH)),
            (SCENE_PARTICLES, self.infos.iter().any(|info| info.kernel == VOLUME_SPH)),
            (SCENE_MANY_VOLUMES, self.infos.len() > 1),
            (SCENE_WHOLES, self.is_whole()),
            (SCENE_GLOWS, self.infos.iter().any(glows)),
            (SCENE_STEEP, self.any_steep()),
        ]
        .into_iter()
        .fold(0, |bits, (bit, is_set)| if is_set { bits | bit } else { bits })
    }

    /// The colour that a volume's transfer function gives a scalar.
    pub(crate) fn color_of(&self, info: &VolumeInfo, scalar: f32) -> [f32; 3] {
        self.light_of(info, scalar)[0]
    }

    /// The colour and the emission that a volume's transfer function gives a scalar.
    pub(crate) fn light_of(&self, info: &VolumeInfo, scalar: f32) -> [[f32; 3]; 2] {
        let first = info.first_stop as usize;
        let stops = &self.stops[first..first + info.stop_count as usize];
        let above = stops[1..].partition_point(|stop| stop.value <= scalar);
        let (from, to) = (&stops[above], &stops[(above + 1).min(stops.len() - 1)]);
        let span = to.value - from.value;
        let part = if span > 0.0 { ((scalar - from.value) / span).clamp(0.0, 1.0) } else { 0.0 };
        let mixed =
            |from: [f32; 3], to: [f32; 3]| [0, 1, 2].map(|i| from[i] + part * (to[i] - from[i]));
        [mixed(from.color, to.color), mixed(from.emission, to.emission)]
    }

    /// Which points are whose: of each volume its object and the range of its points.
    pub fn point_ranges(&self) -> impl Iterator<Item = (&VolumeInfo, std::ops::Range<usize>)> {
        self.infos.iter().map(|info| {
            let first = self.cells[info.first_cell as usize].first as usize;
            let last = info.first_cell as usize + info.grid.cell_count() as usize;
            (info, first..self.cells[last].first as usize)
        })
    }

    /// Polynomials without a surface, at the slots of the isosurfaces, and after them of the volumes that scatter rays: they
    /// say whose those are.
    #[must_use]
    pub fn stand_ins(&self) -> Vec<Polynomial> {
        let stand_in = |object: u32| Polynomial {
            center_trust: [0.0; 4],
            gradient_offset: [0.0, 0.0, 1.0, 0.0],
            curvature: [0.0; 4],
            cross_terms: [0.0; 2],
            object,
            index: u32::MAX,
        };
        let clouds = (self.first_cloud.unwrap_or_default()..).zip(self.clouds());
        let objects = self.isosurfaces().map(|info| info.object).chain(clouds.map(|(at, _)| at));
        objects.map(stand_in).collect()
    }

    /// Bytes of all of it.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        (size_of_val(self.infos.as_slice())
            + size_of_val(self.cells.as_slice())
            + size_of_val(self.points.as_slice())
            + size_of_val(self.inverse_lengths.as_slice())
            + size_of_val(self.stops.as_slice())) as u64
    }
}
