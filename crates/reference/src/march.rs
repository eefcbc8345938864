//! Twin of `march`: rays through volumes, sample after sample (\[T\] §6).

use crate::camera_rays::Ray;
use crate::media::{Media, transmittance};
use crate::real::{NO_HIT, Real, V3};
use crate::steps::{Between, End, Way};
use crate::volume::{Lighting, Shown, mean_of};
use kernels::layout::{
    ObjectInfo, VOLUME_AVERAGE, VOLUME_EMITS, VOLUME_INTEGRAL, VOLUME_MAXIMUM, VolumeInfo,
};
use plan::Volumes;
use std::ops::ControlFlow;

/// Optical depth through which nothing is seen, a transmittance of 1e-30.
const DEEPEST: f64 = 69.077_552_8;
/// The optical depth from there on.
const OPAQUE: f64 = NO_HIT;

/// What volumes do to a ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct March<R> {
    /// Where one scatters it, if one does.
    pub scattered: Option<Scattered<R>>,
    /// Emitted towards its start.
    pub color: V3<R>,
    /// Optical depth.
    pub depth: R,
    /// What channels of volumes show (`March::along` in `glsl/stages/volume.glsl`).
    pub along: R,
}

/// A place where a volume scatters a ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scattered<R> {
    /// Along the ray.
    pub t: R,
    /// The share of light that goes on.
    pub color: V3<R>,
    /// The slot that stands for the volume.
    pub slot: u32,
}

/// What of light counts along a ray.
#[derive(Debug, Clone, Copy)]
pub enum Along<'a, R> {
    /// What volumes emit.
    Emitted,
    /// That, and what reaches the points of volumes that are lit.
    OfLamps(Lighting<'a, R>),
    /// That, and where the optical depth of volumes that are lit is this, they scatter the ray.
    Scattered(R),
}

impl<'a, R: Real> Along<'a, R> {
    pub(crate) fn lamps(self) -> Option<Lighting<'a, R>> {
        match self {
            Self::OfLamps(lighting) => Some(lighting),
            _ => None,
        }
    }
}

/// Scattering volumes of a step.
struct Scatter<R> {
    color: V3<R>,
    extinction: R,
    /// The most of one of them, and the slot that stands for it.
    most: R,
    slot: u32,
}

/// Kahan's summation.
#[derive(Debug, Clone, Copy)]
struct Sum<R> {
    sum: R,
    /// What rounding added to it.
    lost: R,
}

impl<R: Real> Sum<R> {
    fn zero() -> Self {
        Self { sum: R::of(0.0), lost: R::of(0.0) }
    }

    fn add(&mut self, term: R) {
        let more = term - self.lost;
        let total = self.sum + more;
        let left = (total - self.sum) - more;
        self.lost = if total.abs() < R::of(NO_HIT) { left } else { R::of(0.0) };
        self.sum = total;
    }
}

/// Whether one scalar stands for the whole way of a ray.
pub(crate) fn is_whole(volume: &VolumeInfo) -> bool {
    [VOLUME_MAXIMUM, VOLUME_AVERAGE, VOLUME_INTEGRAL].contains(&volume.mode)
}

/// What a ray shows of the scalar that stands for its whole way, from that or its integral and the length in reach: a
/// layer of one radius, all of it, or once.
fn shown<R: Real>(volume: &VolumeInfo, volumes: &Volumes, [scalar, way]: [R; 2]) -> March<R> {
    let zero = R::of(0.0);
    if way <= zero {
        return March { scattered: None, color: V3::splat(zero), depth: zero, along: zero };
    }
    let mean = volume.mode == VOLUME_AVERAGE;
    let scalar = if mean { scalar / way } else { scalar };
    let thickness = match volume.mode {
        VOLUME_AVERAGE => way,
        VOLUME_INTEGRAL => R::of(1.0),
        _ => R::of_f32(volume.square_radius).sqrt(),
    };
    let seen = mean_of(volume, volumes, scalar, scalar);
    let depth = seen.extinction * thickness;
    let color = (seen.scattering + seen.emission).times(thickness * depth.mean_transmittance());
    let depth = if depth > R::of(DEEPEST) { R::of(OPAQUE) } else { depth };
    March { scattered: None, color, depth, along: scalar }
}

impl<R: Real> Scatter<R> {
    fn add(&mut self, volume: &VolumeInfo, of: &Between<R>, seen: &Shown<R>) {
        let own = of.share * seen.extinction;
        if own > self.most {
            (self.most, self.slot) = (own, volume.refracts);
        }
        self.color = self.color + seen.scattering.times(of.share);
        self.extinction = self.extinction + own;
    }
}

/// Follows a ray that ends at `end` through all volumes. `media` are those it is inside.
pub fn march<R: Real>(
    ray: &Ray<R>,
    end: R,
    media: &Media,
    volumes: &Volumes,
    objects: &[ObjectInfo],
    light: Along<'_, R>,
) -> March<R> {
    let lighting = light.lamps();
    let zero = R::of(0.0);
    let way = Way::of(ray, end, media, volumes);
    let medium = media.medium(objects);
    let (mut color, mut depth) = ([Sum::zero(); 3], Sum::<R>::zero());
    let mut whole = [Sum::zero(); 2]; // the greatest scalar or the integral of all, and the length in reach
    let mut met = false;
    let mut scatter_depth = Sum::<R>::zero();
    let mut scattered = None;
    way.walk(lighting, |place, there, here| {
        let (mut step_color, mut step_extinction) = (V3::splat(zero), zero);
        let mut scatter = Scatter { color: V3::splat(zero), extinction: zero, most: zero, slot: 0 };
        for (volume, (&there, &here)) in way.taking_part.iter().zip(there.iter().zip(here)) {
            let between = Between::of(volume, there, here);
            if is_whole(volume) {
                let counted = between.as_ref().map_or(zero, |of| of.share * place.length);
                if volume.mode != VOLUME_MAXIMUM {
                    whole[0]
                        .add(between.map_or(zero, |of| counted * (R::of(0.5) * (of.from + of.to))));
                } else if let End::At(scalar, _) = here
                    && (!met || scalar > whole[0].sum)
                {
                    whole[0].sum = scalar;
                }
                met |= matches!(here, End::At(..));
                whole[1].add(counted);
            } else if let Some(of) = between {
                let mut seen = mean_of(volume, volumes, of.from, of.to);
                if lighting.is_some() {
                    seen.scattering = seen.scattering * of.light;
                }
                if matches!(light, Along::Scattered(_)) && volume.shading != VOLUME_EMITS {
                    scatter.add(volume, &of, &seen);
                    (seen.scattering, seen.extinction) = (V3::splat(zero), zero);
                }
                step_color = step_color + (seen.scattering + seen.emission).times(of.share);
                step_extinction = step_extinction + of.share * seen.extinction;
            }
        }
        let mut length = place.length;
        if let Along::Scattered(chosen) = light {
            let depth = scatter.extinction * length;
            let short_of = chosen - scatter_depth.sum;
            if depth > zero && depth >= short_of {
                length = length * (short_of.max(zero) / depth);
                let color =
                    scatter.color.over(scatter.extinction).zip(V3::splat(R::of(1.0)), R::min);
                scattered = Some(Scattered { t: place.begin + length, color, slot: scatter.slot });
            } else if depth > zero {
                scatter_depth.add(depth);
            }
        }
        let step_depth = step_extinction * length;
        if step_depth > zero || step_color.0.iter().any(|&channel| channel > zero) {
            let lengths = if medium.is_some() {
                let absorption =
                    V3::of_f32(objects[medium.unwrap_or_default() as usize].absorption);
                let depths = V3::splat(step_depth) + absorption.times(length);
                V3(depths.0.map(|depth| length * depth.mean_transmittance()))
                    * transmittance(medium, place.begin, objects)
            } else {
                V3::splat(length * step_depth.mean_transmittance())
            };
            let sent = (lengths * step_color).times((-depth.sum).exp_negative());
            for (sum, sent) in color.iter_mut().zip(sent.0) {
                sum.add(sent);
            }
        }
        if step_depth > zero {
            depth.add(step_depth);
        }
        if depth.sum > R::of(DEEPEST) {
            depth.sum = R::of(OPAQUE);
            return ControlFlow::Break(());
        }
        if scattered.is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    match volumes.infos.first() {
        Some(only) if is_whole(only) => shown(only, volumes, whole.map(|of| of.sum)),
        _ => {
            let color = V3(color.map(|of| of.sum));
            March { scattered, color, depth: depth.sum, along: R::of(-1.0) }
        }
    }
}

/// Where along the ray half of the light is lost that the volumes take on its way, which `depth` says: the first place
/// with the transmittance (1 + T)/2. `None` where they take none.
pub fn half_lost<R: Real>(
    ray: &Ray<R>,
    end: R,
    media: &Media,
    volumes: &Volumes,
    lighting: Option<Lighting<'_, R>>,
    depth: R,
) -> Option<R> {
    let wanted = (R::of(0.5) * depth.absorptance()).depth_of_absorptance();
    if wanted <= R::of(0.0) {
        return None;
    }
    let way = Way::of(ray, end, media, volumes);
    let mut depth = Sum::<R>::zero();
    let mut lost = None;
    way.walk(lighting, |place, there, here| {
        let mut extinction = R::of(0.0);
        for (volume, (&there, &here)) in way.taking_part.iter().zip(there.iter().zip(here)) {
            if let Some(of) = Between::of(volume, there, here) {
                let seen = mean_of(volume, volumes, of.from, of.to);
                extinction = extinction + of.share * seen.extinction;
            }
        }
        let step_depth = extinction * place.length;
        let missing = wanted - depth.sum;
        if step_depth > R::of(0.0) && step_depth >= missing {
            let part = missing.max(R::of(0.0)) / step_depth;
            lost = Some(place.begin + place.length * part);
            return ControlFlow::Break(());
        }
        if step_depth > R::of(0.0) {
            depth.add(step_depth);
        }
        ControlFlow::Continue(())
    });
    lost
}
