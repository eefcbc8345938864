//! Volumes: which points carry a surface, and the grid in which a sample finds the points in its reach
//! (\[T\] §6; docs/method.md, section 7).

use crate::PlanError;
use crate::bulk::Bulk;
use crate::chord;
use crate::chosen::Findings;
use crate::colors::attribute_values;
use crate::field;
use crate::missing::{Lacking, Missing};
use crate::neighborhoods::{length, open_points, spacing};
use crate::steep;
use crate::transfer::{own_range, scaled, stops_of};
use kernels::layout::{
    CELL_ABOVE, CELL_BELOW, CELL_LOOK, CELL_NOTHING, GridInfo, Polynomial, SCENE_GLOWS,
    SCENE_MANY_VOLUMES, SCENE_PARTICLES, SCENE_STEEP, SCENE_WEIGHTS, SCENE_WHOLES, VOLUME_AVERAGE,
    VOLUME_EMISSION, VOLUME_EMITS, VOLUME_GRADIENT, VOLUME_INTEGRAL, VOLUME_ISOSURFACE,
    VOLUME_LIGHTS, VOLUME_MAXIMUM, VOLUME_SCATTERS, VOLUME_SHEPARD, VOLUME_SPH, VOLUME_SUM,
    VolumeCell, VolumeInfo, VolumePoint, VolumeStop,
};
use points::{Cloud, PointSet, Watch, bounds_of};
use scene::{
    Boundary, ExtinctionFactor, Object, PerParticle, Scene, Transfer, Volume, VolumeKernel,
    VolumeMode, VolumeShading,
};
use std::sync::Arc;

/// Samples that a ray may take.
const MOST_SAMPLES: f64 = 16_000_000.0;
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
    let lit = volumes.infos.iter().find(|info| info.shading != VOLUME_EMITS);
    let lights = scene.lights.len();
    if let Some(info) = lit.filter(|_| lights > VOLUME_LIGHTS as usize) {
        return Err(PlanError::TooManyVolumeLights { name: name(info), lights });
    }
    let refracts = |info: &&VolumeInfo| info.refracts != 0 && info.kernel == VOLUME_SHEPARD;
    if let Some(info) = volumes.infos.iter().find(refracts) {
        return Err(PlanError::OpenIsosurface { name: name(info) });
    }
    steep::mark(&mut volumes);
    for (slot, info) in (cloud.points.len() as u32..)
        .zip(volumes.infos.iter_mut().filter(|info| info.mode == VOLUME_ISOSURFACE))
    {
        info.slot = slot;
    }
    Ok(volumes)
}

/// Whether one scalar stands for the whole way of a ray.
fn is_whole(info: &VolumeInfo) -> bool {
    [VOLUME_MAXIMUM, VOLUME_AVERAGE, VOLUME_INTEGRAL].contains(&info.mode)
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

/// What a particle reaches by, in scene units, and what its kernel is multiplied by.
struct Particle {
    /// Without an end where no smoothing length is its own.
    length: f64,
    scalar: f64,
}

/// How particles of smoothed particle hydrodynamics are given.
struct Sph<'a> {
    smoothing_length: &'a PerParticle,
    mass: Option<&'a PerParticle>,
    density: Option<&'a str>,
}

impl Sph<'_> {
    /// h over the side of a particle's volume, where no mass says more (Price 2012, with η = 1.2).
    const SPACING: f64 = 1.2;

    /// A (m/ρ) / (π h³) of each point, with m/ρ and h in one unit of length.
    fn particles(
        &self,
        object: &Object,
        set: &PointSet,
        scalars: &[f64],
    ) -> Result<Vec<Particle>, PlanError> {
        let scale = object.transform.scale;
        let of = |what: &PerParticle, unit: f64| -> Result<Vec<f64>, PlanError> {
            Ok(match what {
                PerParticle::Number(number) => vec![*number; scalars.len()],
                PerParticle::Attribute(name) => {
                    attribute(object, set, name)?.into_iter().map(|value| value * unit).collect()
                }
            })
        };
        let lengths = of(self.smoothing_length, scale)?;
        let masses = self.mass.map(|mass| of(mass, 1.0)).transpose()?;
        let densities = self.density.map(|name| attribute(object, set, name)).transpose()?;
        let scalar = |i: usize| {
            let h = lengths[i];
            // The volume over h³, times the scalar.
            let carried = match (&masses, &densities) {
                (None, _) => scalars[i] / Self::SPACING.powi(3),
                (Some(m), Some(rho)) => m[i] / rho[i] * scalars[i] * (scale / h).powi(3),
                (Some(m), None) => m[i] * (scale / h).powi(3),
            };
            Particle { length: h, scalar: carried / std::f64::consts::PI }
        };
        Ok((0..scalars.len()).map(scalar).collect())
    }
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

    /// Whether the light of the scene counts in any.
    #[must_use]
    pub fn any_lit(&self) -> bool {
        self.infos.iter().any(|info| info.shading != VOLUME_EMITS)
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

    /// Polynomials without a surface, at the slots of the isosurfaces: they say whose those are.
    #[must_use]
    pub fn stand_ins(&self) -> Vec<Polynomial> {
        let isosurfaces = self.infos.iter().filter(|info| info.mode == VOLUME_ISOSURFACE);
        let stand_in = |info: &VolumeInfo| Polynomial {
            center_trust: [0.0; 4],
            gradient_offset: [0.0, 0.0, 1.0, 0.0],
            curvature: [0.0; 4],
            cross_terms: [0.0; 2],
            object: info.object,
            index: u32::MAX,
        };
        isosurfaces.map(stand_in).collect()
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

    /// Gives the last volume, which shows integrals, the stops of a transfer function up to what no ray exceeds, and
    /// returns that range.
    fn bound_integral(&mut self, volume: &Volume) -> [f64; 2] {
        let Some(mut info) = self.infos.pop() else { return [0.0; 2] };
        let range = field::bound_of_integrals(self, &info);
        self.stops.truncate(info.first_stop as usize);
        self.stops.extend(stops_of(volume.transfer.as_ref(), volume.scale, || range));
        info.stop_count = self.stops.len() as u32 - info.first_stop;
        self.infos.push(info);
        range
    }

    fn add(
        &mut self,
        index: u32,
        object: &Object,
        volume: &Volume,
        radius: f32,
        (points, stops): (Vec<(VolumePoint, f32)>, Vec<VolumeStop>),
    ) -> Lengths {
        let smoothing = volume.smoothing.map_or(0.25 * radius * radius, |rho| rho as f32);
        let lengths = points.iter().filter(|(_, inverse)| *inverse > 0.0);
        let (sum, count) = lengths.fold((0.0, 0u32), |(sum, count), (_, inverse)| {
            (sum + 1.0 / f64::from(*inverse), count + 1)
        });
        let step = match (volume.step, count) {
            (Some(step), _) => step as f32,
            (None, 0) => 0.25 * radius,
            (None, _) => (0.5 * sum / f64::from(count)) as f32,
        };
        self.step = self.step.min(step);
        let (grid, high) = grid_over(&points, radius);
        let (first_cell, first_stop) = (self.cells.len() as u32, self.stops.len() as u32);
        self.stops.extend(stops);
        let kernel = match volume.kernel {
            VolumeKernel::Shepard => VOLUME_SHEPARD,
            VolumeKernel::Sum => VOLUME_SUM,
            VolumeKernel::Sph { .. } => VOLUME_SPH,
        };
        let info = VolumeInfo {
            grid,
            first_cell,
            first_stop,
            stop_count: self.stops.len() as u32 - first_stop,
            kernel,
            square_radius: radius * radius,
            inverse_width: 1.0 / (2.0 * smoothing),
            object: index,
            bounded: u32::from(volume.boundary != Boundary::None),
            high,
            mode: match volume.mode {
                VolumeMode::Emission => VOLUME_EMISSION,
                VolumeMode::Maximum => VOLUME_MAXIMUM,
                VolumeMode::Average => VOLUME_AVERAGE,
                VolumeMode::Integral => VOLUME_INTEGRAL,
                VolumeMode::Isosurface(_) => VOLUME_ISOSURFACE,
            },
            iso: match volume.mode {
                VolumeMode::Isosurface(iso) => iso as f32,
                _ => 0.0,
            },
            slot: u32::from(self.stops[first_stop as usize..].iter().any(has_emission)),
            refracts: u32::from(
                matches!(volume.mode, VolumeMode::Isosurface(_))
                    && object.material.kind.has_inside(),
            ),
            shading: match volume.shading {
                VolumeShading::None => VOLUME_EMITS,
                VolumeShading::Gradient => VOLUME_GRADIENT,
                VolumeShading::Scatter => VOLUME_SCATTERS,
            },
        };
        self.list(&info, &points, step);
        self.infos.push(info);
        Lengths { smoothing: smoothing.into(), step: step.into() }
    }

    /// Multiplies the extinctions of the last volume; `chosen` says by what where the scene leaves it to the program.
    fn scale_extinctions(
        &mut self,
        factor: ExtinctionFactor,
        chosen: impl FnOnce(&Self, &VolumeInfo) -> Option<f64>,
    ) {
        let Some(info) = self.infos.last() else { return };
        let factor = match factor {
            ExtinctionFactor::Given(factor) => factor,
            ExtinctionFactor::Auto => chosen(self, info).unwrap_or(1.0),
        };
        let first = info.first_stop as usize;
        if factor != 1.0 {
            let scaled = scaled(self.stops.split_off(first), factor);
            self.stops.extend(scaled);
        }
    }

    /// Counts, adds up and scatters the points, in their order, and says which cells may show anything.
    fn list(&mut self, info: &VolumeInfo, points: &[(VolumePoint, f32)], step: f32) {
        let grid = &info.grid;
        let base = self.points.len();
        let cell_of: Vec<usize> = points.iter().map(|(p, _)| cell_of(grid, p.position)).collect();
        let cells = grid.cell_count() as usize;
        let mut first = vec![0u32; cells + 1];
        for &cell in &cell_of {
            first[cell + 1] += 1;
        }
        for cell in 0..cells {
            first[cell + 1] += first[cell];
        }
        let mut next = first.clone();
        self.points.resize(base + points.len(), VolumePoint { position: [0.0; 3], scalar: 0.0 });
        self.inverse_lengths.resize(base + points.len(), 0.0);
        for ((point, inverse_length), &cell) in points.iter().zip(&cell_of) {
            self.points[base + next[cell] as usize] = *point;
            self.inverse_lengths[base + next[cell] as usize] = *inverse_length;
            next[cell] += 1;
        }
        let seen = self.cells_seen(info, points, &cell_of, step);
        self.cells.extend(
            first
                .iter()
                .enumerate()
                .map(|(cell, &at)| VolumeCell { first: base as u32 + at, counts: seen[cell] }),
        );
    }

    /// What may be seen from each cell: something, where there are points in the cells around, and some
    /// value that they can have together has an extinction or an emission; or on which side of an isosurface all of it
    /// is. What counts for a place counts for the steps that end there, too: of a step with an end in a cell from which
    /// nothing is seen, nothing is seen.
    fn cells_seen(
        &self,
        info: &VolumeInfo,
        points: &[(VolumePoint, f32)],
        cell_of: &[usize],
        step: f32,
    ) -> Vec<u32> {
        let [nx, ny, nz] = info.grid.resolution.map(|n| n as usize);
        let none = (f32::INFINITY, f32::NEG_INFINITY, 0u32);
        let mut ranges = vec![none; nx * ny * nz];
        let merge =
            |a: (f32, f32, u32), b: (f32, f32, u32)| (a.0.min(b.0), a.1.max(b.1), a.2 + b.2);
        for ((point, _), &cell) in points.iter().zip(cell_of) {
            ranges[cell] = merge(ranges[cell], (point.scalar, point.scalar, 1));
        }
        // Of a place in the cell, and of the ends of the steps that end there.
        let cells = (info.square_radius.sqrt() + step) * info.grid.inverse_edge;
        let reach = ((cells + 1e-3).min(MOST_CELLS as f32)) as usize + 1;
        // The box around a cell, one axis after the other.
        for (stride, count) in [(1, nx), (nx, ny), (nx * ny, nz)] {
            let before = ranges.clone();
            for (at, range) in ranges.iter_mut().enumerate() {
                let place = at / stride % count;
                let (low, high) = (place.saturating_sub(reach), (place + reach).min(count - 1));
                *range = (low..=high)
                    .map(|other| before[at + other * stride - place * stride])
                    .fold(none, merge);
            }
        }
        let seen = |(low, high, count): (f32, f32, u32)| {
            let (low, high) = match info.kernel {
                // No kernel is over 1.
                VOLUME_SUM | VOLUME_SPH => {
                    ((low * count as f32).min(0.0), (high * count as f32).max(0.0))
                }
                _ => (low, high),
            };
            let margin = rounding(low, high);
            match info.mode {
                _ if count == 0 => CELL_NOTHING,
                VOLUME_ISOSURFACE if high + margin < info.iso => CELL_BELOW,
                VOLUME_ISOSURFACE if low - margin > info.iso => CELL_ABOVE,
                VOLUME_ISOSURFACE => CELL_LOOK,
                VOLUME_EMISSION if !self.shows(info, low, high) => CELL_NOTHING,
                // What cannot be seen counts too, where not each place is seen for itself.
                _ => CELL_LOOK,
            }
        };
        ranges.into_iter().map(seen).chain([CELL_NOTHING]).collect()
    }

    /// Whether the transfer function shows anything from `low` to `high`, and a rounding farther.
    fn shows(&self, info: &VolumeInfo, low: f32, high: f32) -> bool {
        let margin = rounding(low, high);
        let (low, high) = (low - margin, high + margin);
        let first = info.first_stop as usize;
        let stops = &self.stops[first..first + info.stop_count as usize];
        let sends = |stop: &VolumeStop| stop.extinction > 0.0 || has_emission(stop);
        let inside = stops.iter().any(|s| sends(s) && s.value >= low && s.value <= high);
        // Linear between stops: only its ends, and what the outer stops mean beyond them.
        let pieces = stops.windows(2).any(|pair| {
            pair[0].value <= high
                && pair[1].value >= low
                && (sends(&pair[0]) && pair[1].value > low
                    || sends(&pair[1]) && pair[0].value < high)
        });
        let (Some(least), Some(last)) = (stops.first(), stops.last()) else { return false };
        inside
            || pieces
            || (low <= least.value && sends(least))
            || (high >= last.value && sends(last))
    }
}

/// How far beyond the greatest and least of some values rounding may take what is made of them.
fn rounding(low: f32, high: f32) -> f32 {
    1e-5 * low.abs().max(high.abs())
}

/// Cells of an edge of the radius, over the points' bounding box grown by it, and the highest corner of that.
fn grid_over(points: &[(VolumePoint, f32)], radius: f32) -> (GridInfo, [f32; 3]) {
    let along = |axis: usize| points.iter().map(move |(p, _)| p.position[axis]);
    let (mut low, mut high, mut extent) = ([0.0; 3], [0.0; 3], [0.0f64; 3]);
    for axis in 0..3 {
        let least = along(axis).fold(f32::INFINITY, f32::min);
        let most = along(axis).fold(f32::NEG_INFINITY, f32::max);
        if least <= most {
            low[axis] = least - radius;
            high[axis] = most + radius;
            extent[axis] = f64::from(most) - f64::from(least) + 2.0 * f64::from(radius);
        }
    }
    let longest = extent.iter().copied().fold(0.0, f64::max);
    let edge = f64::from(radius).max(longest / MOST_CELLS);
    let grid = GridInfo {
        origin: low,
        edge: edge as f32,
        resolution: extent.map(|length| (length * 1.000_01 / edge).ceil().max(1.0) as u32),
        inverse_edge: 1.0 / edge as f32,
    };
    (grid, high)
}

pub(crate) fn cell_of(grid: &GridInfo, position: [f32; 3]) -> usize {
    let at = [0, 1, 2].map(|axis| {
        let cell = ((position[axis] - grid.origin[axis]) * grid.inverse_edge).floor();
        (cell.max(0.0) as usize).min(grid.resolution[axis] as usize - 1)
    });
    at[0] + grid.resolution[0] as usize * (at[1] + grid.resolution[1] as usize * at[2])
}
