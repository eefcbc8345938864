//! What kernels of a plan have to do, as bits that they are specialized by: of the whole scene here, of materials in
//! [`crate::materials`], of volumes in [`crate::Volumes`].

use crate::materials::{self, has_inside, rays_at_most, sends_rays_on};
use crate::{Plan, ShapeKind, environment};
use kernels::layout::{
    NONE, ObjectInfo, SCENE_ALPHA, SCENE_BLENDS, SCENE_CHANCE, SCENE_CLEAR, SCENE_DEPTHS,
    SCENE_DIAGNOSTICS, SCENE_ENVIRONMENT, SCENE_LIGHTS, SCENE_MANY_LIGHTS, SCENE_NESTED,
    SCENE_REFINES, SCENE_SAMPLES, SCENE_SHAPES, SCENE_SPHERES, SCENE_TEXTURES, SCENE_TURNED,
    SCENE_VALUES, SCENE_VOLUMES,
};

impl Plan {
    /// Whether any surface sends rays on.
    #[must_use]
    pub fn scatters(&self) -> bool {
        self.objects.iter().any(sends_rays_on)
    }

    /// Rays of a wave that a pixel may have at most: where glass disperses, one a channel.
    #[must_use]
    pub fn rays_per_pixel(&self) -> u32 {
        rays_at_most(&self.objects)
    }

    /// `SCENE_*`: what kernels of this plan have to do.
    #[must_use]
    pub fn scene_bits(&self) -> u32 {
        let any = |has: fn(&ObjectInfo) -> bool| self.objects.iter().any(has);
        let spheres = || self.shapes.iter().filter(|shapes| shapes.kind == ShapeKind::Sphere);
        [
            (SCENE_ENVIRONMENT, self.wave.background.environment != NONE),
            (SCENE_BLENDS, any(|object| object.blends != 0)),
            (SCENE_LIGHTS, !self.lights.is_empty()),
            (SCENE_ALPHA, self.channel_alpha),
            (SCENE_DIAGNOSTICS, !self.diagnostics.is_empty()),
            (SCENE_VALUES, any(|object| object.first_color != NONE)),
            (SCENE_TEXTURES, any(|object| object.texture != NONE)),
            (SCENE_SAMPLES, self.samples > 1),
            (SCENE_REFINES, self.refines()),
            // A ray may be inside several spheres of one object.
            (
                SCENE_NESTED,
                spheres().any(|shapes| has_inside(&self.objects[shapes.object as usize])),
            ),
            (SCENE_SHAPES, !self.shapes.is_empty()),
            (SCENE_SPHERES, spheres().next().is_some()),
            (SCENE_CHANCE, self.wave.fresnel != 0),
            (SCENE_VOLUMES, !self.volumes.infos.is_empty()),
            (SCENE_MANY_LIGHTS, self.lights.len() > 1),
            (SCENE_TURNED, self.turns_environment()),
            (SCENE_CLEAR, self.may_be_clear() || self.may_pass_own_surface()),
            (SCENE_DEPTHS, self.wants_volume_depth()),
        ]
        .into_iter()
        .fold(
            self.volumes.scene_bits() | materials::scene_bits(&self.objects),
            |bits, (bit, is_set)| if is_set { bits | bit } else { bits },
        )
    }

    /// Whether directions are turned before they are looked up in the environment.
    fn turns_environment(&self) -> bool {
        let at = self.wave.background.environment;
        at != NONE && environment::turns(&self.images[at as usize + 1..][..3])
    }
}
