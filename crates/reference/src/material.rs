//! Twin of `glsl/shared/material.glsl`: what surfaces do with light and with rays. Each kind of material has its
//! functions in a file below `material/`; here they are called by kind.
//!
//! Whether a kind is lit, sends rays on and has an inside are properties, which [`plan::materials`] states.

pub(crate) mod cloud;
mod diffuse;
mod glass;
mod mirror;

use crate::media::{Crossing, Media, Way};
use crate::real::{Real, V3};
use crate::sampler::{sample_2d, shared_sample};
use kernels::layout::{
    FIRST_CHANCE, MATERIAL_CLOUD, MATERIAL_DIFFUSE, MATERIAL_GLASS, MATERIAL_MATTE,
    MATERIAL_MIRROR, MOST_CROSSINGS, NONE, ObjectInfo, SAMPLE_FRESNEL, SAMPLE_SCATTER, WaveParams,
};
use plan::materials::{has_inside, is_lit, sends_rays_on};

/// What becomes of a ray at a surface.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Fate {
    /// Lights of the scene light the surface.
    pub lit: bool,
    /// Rays go on from it.
    pub sends: bool,
    /// How they go through it, where it has an inside.
    pub crossing: Option<Crossing>,
    /// The ray goes through as if there were nothing: no bounce.
    pub passes: bool,
    /// It becomes one ray a channel.
    pub splits: bool,
}

/// The fate of a ray of these channels, which is inside `media`.
pub(crate) fn fate_at(
    object: u32,
    objects: &[ObjectInfo],
    (media, way, channels): (&Media, Way, u32),
) -> Fate {
    let info = &objects[object as usize];
    let crossing = has_inside(info).then(|| media.crossing(object, way, objects));
    let passes = crossing.is_some_and(|crossing| crossing.passes(channels, objects));
    Fate {
        lit: is_lit(info),
        sends: sends_rays_on(info),
        crossing,
        passes,
        splits: !passes && crossing.is_some_and(|crossing| crossing.splits(channels, objects)),
    }
}

/// The chance that a path with this throughput goes on.
pub(crate) fn survival_of<R: Real>(throughput: V3<R>, channels: u32, bounces: u32) -> R {
    if bounces < FIRST_CHANCE {
        return R::of(1.0);
    }
    throughput.largest_of(channels).min(R::of(1.0))
}

impl Fate {
    /// Whether rays may still go on, after so many bounces and crossings.
    pub fn goes_on(&self, [bounces, crossings]: [u32; 2], max_bounces: u32) -> bool {
        if self.passes { crossings < MOST_CROSSINGS } else { bounces < max_bounces }
    }
}

/// Where a ray meets a surface.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place<'a, R> {
    /// The ray's direction.
    pub d: V3<R>,
    /// Of the surface, facing the ray's origin; in a cloud, the colour there.
    pub normal: V3<R>,
    pub info: &'a ObjectInfo,
}

/// The numbers of a pixel's sample that decide what happens at a bounce.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Drawn<R> {
    /// Under it, glass reflects; `None`: it refracts wherever it can.
    pub chance: Option<R>,
    /// In the unit square: where scattered light goes.
    pub place: [R; 2],
}

impl<R: Real> Drawn<R> {
    pub fn at(params: &WaveParams, pixel: [u32; 2], bounce: u32) -> Self {
        let sample = if params.sample_index == NONE { 0 } else { params.sample_index };
        let chance =
            || crate::sampler::sample_1d(pixel, sample, params.seed, SAMPLE_FRESNEL + bounce);
        let (block, index) = shared_sample(pixel, sample, params.sample_bits);
        let place = sample_2d(block, index, params.seed, SAMPLE_SCATTER + bounce);
        Self { chance: (params.fresnel != 0).then(chance), place }
    }
}

/// A ray that goes on from a surface.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sent<R> {
    pub direction: V3<R>,
    /// What it keeps of its throughput.
    pub weight: V3<R>,
    /// It stays on the side that it came from.
    pub reflects: bool,
}

/// The ray of these channels that goes on.
pub(crate) fn sent_on<R: Real>(
    place: &Place<'_, R>,
    fate: &Fate,
    channels: u32,
    drawn: &Drawn<R>,
    objects: &[ObjectInfo],
) -> Sent<R> {
    match (place.info.material, &fate.crossing) {
        (MATERIAL_MIRROR, _) => mirror::sent_on(place),
        (MATERIAL_GLASS, Some(crossing)) => {
            glass::sent_on(place, (crossing, fate.passes), channels, drawn, objects)
        }
        (MATERIAL_MATTE, _) => diffuse::sent_on(place, drawn),
        (MATERIAL_CLOUD, _) => cloud::sent_on(place, drawn),
        (kind, _) => unreachable!("material {kind} sends no rays on"),
    }
}

/// What of light from `towards` a surface scatters to where the ray came from, but for what is the same for all
/// directions.
pub(crate) fn lobe<R: Real>(place: &Place<'_, R>, towards: V3<R>) -> V3<R> {
    match place.info.material {
        MATERIAL_DIFFUSE | MATERIAL_MATTE => diffuse::lobe(place, towards),
        MATERIAL_CLOUD => cloud::lobe(place, towards),
        kind => unreachable!("material {kind} is not lit"),
    }
}

/// What of the light that [`lobe`] left a surface scatters. `albedo` is that of the place.
pub(crate) fn scattered<R: Real>(
    info: &ObjectInfo,
    light: V3<R>,
    albedo: impl FnOnce() -> V3<R>,
) -> V3<R> {
    match info.material {
        MATERIAL_DIFFUSE | MATERIAL_MATTE => diffuse::scattered(light, albedo()),
        MATERIAL_CLOUD => albedo() * light,
        kind => unreachable!("material {kind} is not lit"),
    }
}

/// A direction that light comes from, drawn by how a lit surface scatters, for u in the unit square.
pub(crate) fn lobe_direction<R: Real>(place: &Place<'_, R>, u: [R; 2]) -> V3<R> {
    match place.info.material {
        MATERIAL_DIFFUSE | MATERIAL_MATTE => diffuse::direction(place, u),
        MATERIAL_CLOUD => cloud::direction(place, u),
        kind => unreachable!("material {kind} is not lit"),
    }
}

/// How densely that draws directions around one, per steradian.
pub(crate) fn lobe_density<R: Real>(place: &Place<'_, R>, towards: V3<R>) -> R {
    match place.info.material {
        MATERIAL_DIFFUSE | MATERIAL_MATTE => diffuse::density(place, towards),
        MATERIAL_CLOUD => cloud::density(place, towards),
        kind => unreachable!("material {kind} is not lit"),
    }
}

/// Of each channel, what of light goes straight on through a surface on its way to a place inside `media`: all of it or,
/// where it `tints`, what glass does not reflect. `d` is the direction of the shadow ray, `normal` of unit length.
pub(crate) fn light_passed<R: Real>(
    object: u32,
    objects: &[ObjectInfo],
    (media, way): (&Media, Way),
    [d, normal]: [V3<R>; 2],
    tints: bool,
) -> V3<R> {
    let cosine = d.dot(normal).abs().min(R::of(1.0));
    match objects[object as usize].material {
        MATERIAL_GLASS => {
            glass::light_passed(&media.crossing(object, way, objects), cosine, tints, objects)
        }
        _ => V3::splat(R::of(0.0)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bytemuck::Zeroable;
    use kernels::layout::{
        CHANNELS_ALL, Constant, MATERIAL_INSIDE, MATERIAL_LIT, MATERIAL_SENDS, STAGES,
    };

    const GLSL: &str = include_str!("../../../glsl/shared/material.glsl");

    /// The kernel's side has a `case` in each function that the kind's bits ask for, and in no other; the twin's side
    /// reaches an arm.
    #[test]
    fn every_kind_has_its_case_on_both_sides() {
        let body = |head: &str| {
            let (_, after) = GLSL.split_once(head).unwrap_or_else(|| panic!("no '{head}'"));
            after.split("\n}\n").next().unwrap().to_owned()
        };
        let [sends, lights, scatters, passes, directions, densities] = [
            "\nSent sent_on(",
            "\nvec3 lobe(",
            "\nvec3 scattered(",
            "\nvec3 light_passed(",
            "\nvec3 lobe_direction(",
            "\nfloat lobe_density(",
        ]
        .map(body);
        let bits = ["MATERIAL_LIT", "MATERIAL_SENDS", "MATERIAL_INSIDE"];
        let all = STAGES.iter().flat_map(|stage| stage.constants);
        let is_kind = |name: &str| name.starts_with("MATERIAL_") && !bits.contains(&name);
        for &Constant { name, value: material, .. } in all.filter(|constant| is_kind(constant.name))
        {
            let case = format!("case uint({name}):");
            let [lit, sent] = [MATERIAL_LIT, MATERIAL_SENDS].map(|bit| material & bit != 0);
            assert!(lit || sent, "{name}: rays end in it without a light");
            assert_eq!(sends.contains(&case), sent, "{name}: sent_on");
            assert_eq!(lights.contains(&case), lit, "{name}: lobe");
            assert_eq!(scatters.contains(&case), lit, "{name}: scattered");
            assert_eq!(directions.contains(&case), lit, "{name}: lobe_direction");
            assert_eq!(densities.contains(&case), lit, "{name}: lobe_density");
            let inside = material & MATERIAL_INSIDE != 0;
            assert_eq!(passes.contains(&case), inside, "{name}: light_passed");

            let info = ObjectInfo { material, ior: [1.5; 3], ..ObjectInfo::zeroed() };
            let objects = [info];
            let fate = fate_at(0, &objects, (&Media::default(), Way::Either, CHANNELS_ALL));
            let place = Place { d: V3([0.0, -1.0, 0.0]), normal: V3([0.0, 1.0, 0.0]), info: &info };
            if fate.sends {
                let _: Sent<f64> = sent_on(
                    &place,
                    &fate,
                    CHANNELS_ALL,
                    &Drawn::at(&WaveParams::zeroed(), [0; 2], 0),
                    &objects,
                );
            }
            if fate.lit {
                let light = lobe(&place, lobe_direction(&place, [0.25, 0.5]));
                assert!(lobe_density(&place, V3([0.0, 1.0, 0.0])) > 0.0);
                let _: V3<f64> = scattered(&info, light, || V3::splat(1.0));
            }
        }
    }
}
