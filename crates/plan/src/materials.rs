//! What kernels take of a material, and what the rest of the plan asks of one. Only here are kinds told apart.

use bytemuck::Zeroable;
use kernels::layout::{
    MATERIAL_DIFFUSE, MATERIAL_GLASS, MATERIAL_INSIDE, MATERIAL_LIT, MATERIAL_MATTE,
    MATERIAL_MIRROR, MATERIAL_SENDS, ObjectInfo, SCENE_ABSORBS, SCENE_DISPERSES, SCENE_GLOSSY,
    SCENE_LIT, SCENE_NESTED, SCENE_SCATTERS,
};
use scene::{Albedo, Integrator, Material, MaterialKind};

/// Albedo of objects whose points have no colours and whose material names none.
pub(crate) const DEFAULT_ALBEDO: [f32; 3] = [0.8; 3];

/// What kernels take of a material; nothing else of the object.
pub(crate) fn info_of(material: &Material, integrator: Integrator) -> ObjectInfo {
    let f32s = |v: [f64; 3]| v.map(|x| x as f32);
    let opaque = |material: u32, albedo: [f32; 3]| ObjectInfo {
        material,
        albedo,
        ior: [1.0; 3],
        ..ObjectInfo::zeroed()
    };
    match material.kind {
        MaterialKind::Diffuse => {
            let albedo = match material.albedo {
                Albedo::Color(color) => f32s(color),
                _ => DEFAULT_ALBEDO,
            };
            let goes_on = integrator == Integrator::Path;
            opaque(if goes_on { MATERIAL_MATTE } else { MATERIAL_DIFFUSE }, albedo)
        }
        MaterialKind::Mirror { reflectance } => opaque(MATERIAL_MIRROR, f32s(reflectance)),
        MaterialKind::Glass { ior, priority, absorption } => ObjectInfo {
            ior: f32s(ior),
            priority,
            absorption: f32s(absorption),
            ..opaque(MATERIAL_GLASS, [1.0; 3])
        },
    }
}

/// Whether lights of the scene light the surface.
#[must_use]
pub fn is_lit(object: &ObjectInfo) -> bool {
    object.material & MATERIAL_LIT != 0
}

/// Whether rays go on from the surface.
#[must_use]
pub fn sends_rays_on(object: &ObjectInfo) -> bool {
    object.material & MATERIAL_SENDS != 0
}

/// Whether the surface encloses a medium, which rays are inside or outside of.
#[must_use]
pub fn has_inside(object: &ObjectInfo) -> bool {
    object.material & MATERIAL_INSIDE != 0
}

/// Whether rays that go on from the surface, or through its inside, lose light.
pub(crate) fn dims(object: &ObjectInfo) -> bool {
    object.albedo != [1.0; 3] || absorbs(object)
}

/// Whether a lit surface scatters light by Lambert's law. Kernels need no bit to send rays on from one.
fn is_plain(object: &ObjectInfo) -> bool {
    [MATERIAL_DIFFUSE, MATERIAL_MATTE].contains(&object.material)
}

fn absorbs(object: &ObjectInfo) -> bool {
    has_inside(object) && object.absorption != [0.0; 3]
}

/// Whether its inside bends one channel more than another.
fn disperses(object: &ObjectInfo) -> bool {
    object.ior.iter().any(|&ior| ior != object.ior[0])
}

/// Whether its inside bends or absorbs one channel more than another.
pub(crate) fn tells_channels_apart(object: &ObjectInfo) -> bool {
    let [r, g, b] = object.absorption;
    has_inside(object) && (disperses(object) || r != g || g != b)
}

/// Rays that one may become at a surface: where glass disperses, one a channel.
pub(crate) fn rays_at_most(objects: &[ObjectInfo]) -> u32 {
    if objects.iter().any(disperses) { 3 } else { 1 }
}

/// `SCENE_*` that the materials of these objects ask for.
pub(crate) fn scene_bits(objects: &[ObjectInfo]) -> u32 {
    let any = |has: fn(&ObjectInfo) -> bool| objects.iter().any(has);
    let bits = [
        (SCENE_LIT, any(is_lit)),
        (SCENE_SCATTERS, any(sends_rays_on)),
        (SCENE_GLOSSY, any(|object| is_lit(object) && !is_plain(object))),
        (SCENE_NESTED, objects.iter().filter(|object| has_inside(object)).count() > 1),
        (SCENE_DISPERSES, any(disperses)),
        (SCENE_ABSORBS, any(absorbs)),
    ];
    bits.into_iter().filter(|(_, asked)| *asked).fold(0, |all, (bit, _)| all | bit)
}
