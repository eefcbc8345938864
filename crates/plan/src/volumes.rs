//! Volumes: which points carry a surface, and the grid in which a sample finds the points in its reach
//! (\[T\] §6; docs/method.md, section 7).

mod build;
mod cells;
mod particles;
mod reach;
mod sizes;
mod thinned;

pub(crate) use cells::cell_of;

use crate::PlanError;
use crate::bulk::Bulk;
use crate::chord;
use crate::chosen::Findings;
use crate::colors::attribute_values;
use crate::field;
use crate::missing::{Lacking, Missing};
use crate::neighborhoods::{length, open_points};
use crate::steep;
use crate::transfer::{own_range, stops_of};
use bytemuck::Zeroable;
use kernels::layout::{
    MATERIAL_CLOUD, NONE, ObjectInfo, Polynomial, SCENE_GLOWS, SCENE_MANY_VOLUMES, SCENE_PARTICLES,
    SCENE_SIZES, SCENE_STEEP, SCENE_WEIGHTS, SCENE_WHOLES, STRIDE_STEPS, VOLUME_AVERAGE,
    VOLUME_EMISSION, VOLUME_EMITS, VOLUME_INTEGRAL, VOLUME_ISOSURFACE, VOLUME_LIGHTS,
    VOLUME_MAXIMUM, VOLUME_SHEPARD, VOLUME_SPH, VolumeCell, VolumeInfo, VolumePoint, VolumeStop,
};
use particles::{Particle, Sph};
use points::{Cloud, Dimension, PointSet, Watch, bounds_of};
use reach::{Reach, Spacings};
use scene::{
    Boundary, Integrator, Object, Scene, Transfer, Volume, VolumeKernel, VolumeMode, VolumeRadius,
};
use std::sync::Arc;

/// Samples that a ray may take.
const MOST_SAMPLES: f64 = 16_000_000.0;
/// Powers of two that a weight may be away from 1 in a block.
const MOST_POWERS: f64 = 100.0;
/// Cells along the longest axis, where there are not twice as many points as cells: more cost more memory than they save
/// samples.
const MOST_CELLS: f64 = 160.0;

/// All volumes of a scene, as plain data.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Volumes {
    /// In the order of their objects.
    pub infos: Vec<VolumeInfo>,
    /// Of volumes whose points reach unevenly, the grids by size, coarsest first: grid, cells, the greatest reach of their
    /// own points, and level.
    pub sizes: Vec<VolumeInfo>,
    /// Cells of each grid, with one after the last.
    pub cells: Vec<VolumeCell>,
    /// Points of each grid by cell, in the order of the file within one.
    pub points: Vec<VolumePoint>,
    /// 1/h of each particle, 1/r of each point with a reach r of its own, 0 of others; one number where no volume has such.
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
    let mut volumes = Volumes::default();
    let mut steps = Vec::new();
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
        let there = || particles.iter().enumerate().filter(|(_, of)| counts(of)).map(|(i, _)| i);
        let reach = match &volume.kernel {
            VolumeKernel::Sph { .. } => {
                let lengths = particles.iter().map(|p| p.length).filter(|h| h.is_finite());
                Reach::Even(2.0 * lengths.fold(0.0, f64::max))
            }
            _ if lacking == 0 => reach_of(volume, &bulk.world[index], set, watch)?,
            _ => {
                let world: Vec<[f64; 3]> = there().map(|i| positions[i]).collect();
                reach_of(volume, &world, set, watch)?
            }
        };
        watch.stage("sorting the points of a volume", positions.len() as u64);
        // Points that all lie in one place have no spacing, and any reach shows them alike.
        let seen = |radius: f64| if radius > 0.0 { radius } else { 1.0 };
        let local = |i: usize| [0, 1, 2].map(|axis| (positions[i][axis] - origin[axis]) as f32);
        let inverse = |at: usize, i: usize| match &reach {
            Reach::Even(_) => 1.0 / particles[i].length,
            Reach::Own(reaches) => 1.0 / seen(reaches[at]),
        };
        let points: Vec<(VolumePoint, f32)> = (there().enumerate())
            .map(|(at, i)| {
                let point = VolumePoint { position: local(i), scalar: particles[i].scalar as f32 };
                (point, inverse(at, i) as f32)
            })
            .collect();
        let radius = match &reach {
            Reach::Even(radius) => seen(*radius),
            Reach::Own(_) => 1.0,
        };
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
        let is_own = matches!(reach, Reach::Own(_));
        if is_own && volume.radius == VolumeRadius::Auto {
            found.word(index, "volume.radius", "adaptive");
        }
        for (key, length, is_given) in [
            ("volume.radius", radius, is_sph || is_own || volume.radius != VolumeRadius::Auto),
            ("volume.smoothing", lengths.smoothing, is_sph || is_own || volume.smoothing.is_some()),
            ("volume.step", lengths.step, !lengths.of_sizes.is_empty() || volume.step.is_some()),
        ] {
            if !is_given {
                found.number(index, key, length);
            }
        }
        steps.push(lengths);
    }
    volumes.set_levels(&steps);
    if volumes.infos.iter().all(|info| info.kernel != VOLUME_SPH && info.size_count == 0) {
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
    for at in 0..volumes.infos.len() {
        volumes.infos[at].block = volumes.block_of(&volumes.infos[at]);
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

/// How far the points of a volume reach.
fn reach_of(
    volume: &Volume,
    positions: &[[f64; 3]],
    set: &PointSet,
    watch: &dyn Watch,
) -> Result<Reach, PlanError> {
    if let VolumeRadius::Length(radius) = volume.radius {
        return Ok(Reach::Even(radius));
    }
    let spacings = Spacings::of(positions, watch)?;
    let is_auto = volume.radius == VolumeRadius::Auto;
    if is_auto && volume.smoothing.is_some() {
        return Ok(Reach::Even(spacings.mean()));
    }
    let (mut own, is_uneven) = spacings.own(positions.len(), || Dimension::of(set).is_volume());
    if is_auto && !is_uneven {
        return Ok(Reach::Even(spacings.mean()));
    }
    // Steps of a quarter of the reach, as many as floats count, through a box that is grown by the greatest reach and a
    // stretch of its steps.
    let most = own.iter().copied().fold(0.0, f64::max);
    let [low, high] = bounds_of([positions]).unwrap_or_default();
    let grown = 2.0 * most * (1.0 + 0.25 * f64::from(STRIDE_STEPS));
    let longest = length([0, 1, 2].map(|axis| high[axis] - low[axis] + grown));
    let least = 1.01 * 4.0 * longest / MOST_SAMPLES;
    own.iter_mut().for_each(|reach| *reach = reach.max(least));
    Ok(Reach::Own(own))
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
    /// ρ, scene units squared; the mean one of points with reaches of their own.
    smoothing: f64,
    step: f64,
    /// Of steps among the points of each of its grids by size.
    of_sizes: Vec<f32>,
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

    /// How many ends of steps a ray keeps of each volume, and one number as large of the stretch that they are in.
    #[must_use]
    pub fn ends_kept(&self) -> u64 {
        1 + u64::from(self.any_steep()) + u64::from(!self.sizes.is_empty())
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
            (SCENE_SIZES, !self.sizes.is_empty()),
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
        self.infos.iter().map(|info| (info, self.range_of(info)))
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
            + size_of_val(self.sizes.as_slice())
            + size_of_val(self.cells.as_slice())
            + size_of_val(self.points.as_slice())
            + size_of_val(self.inverse_lengths.as_slice())
            + size_of_val(self.stops.as_slice())) as u64
    }
}
