//! Scenes that render without an error and show nothing: what is black, one colour, or empty for a reason that is known
//! before a ray is traced, and what to do about it. What is named here is certain; what is only likely is not.
//!
//! [`blank`] judges the finished picture, and catches what only rays find out.

mod blank;
mod sight;
mod volumes;

pub use blank::{Shown, blank};

use crate::Plan;
use crate::crossings::votes;
use crate::materials::{dims, has_inside, is_lit, sends_rays_on};
use crate::shapes::surface_slots;
use kernels::layout::{LIGHT_POINT, NONE, PERSPECTIVE, VOLUME_EMITS, VOLUME_ISOSURFACE};
use points::PointSet;
use scene::Scene;
use std::sync::Arc;

/// Point lights of which it is asked whether a surface is around them.
const MOST_LIGHTS: usize = 8;

/// Why the picture of a plan would show nothing, or nothing of an object: a sentence each, which says what to do. `scene`
/// and `sets` are what the plan was made from.
#[must_use]
pub fn nothing_seen(scene: &Scene, sets: &[Arc<PointSet>], plan: &Plan) -> Vec<String> {
    let of = Asked { scene, sets, plan };
    let whole = [
        of.is_unlit(),
        of.is_enclosed(),
        of.is_one_color(),
        of.has_no_bounces(),
        sight::is_out_of_sight(&of),
    ];
    let mut found: Vec<String> = whole.into_iter().flatten().collect();
    found.extend(volumes::without_values(&of));
    found.extend(volumes::of_skins(&of));
    found.extend(sight::too_small(&of));
    found
}

/// What is asked about.
struct Asked<'a> {
    scene: &'a Scene,
    sets: &'a [Arc<PointSet>],
    plan: &'a Plan,
}

impl Asked<'_> {
    fn name(&self, object: usize) -> &str {
        &self.plan.names[object]
    }

    /// Whether an object has a surface, of whatever kind.
    fn has_surface(&self, object: usize) -> bool {
        let is_own = |info: &kernels::layout::VolumeInfo| info.object as usize == object;
        let isosurface = || {
            self.plan
                .volumes
                .infos
                .iter()
                .any(|info| is_own(info) && info.mode == VOLUME_ISOSURFACE)
        };
        self.plan.cloud.objects[object].count > 0 || isosurface()
    }

    /// The first object that is black without light.
    fn needs_light(&self) -> Option<usize> {
        let scatters = |object: usize| {
            let volumes = self.plan.volumes.infos.iter();
            let mut own = volumes.filter(|info| info.object as usize == object);
            own.any(|info| info.mode != VOLUME_ISOSURFACE && info.shading != VOLUME_EMITS)
        };
        let shows_light = |object: usize| {
            let info = &self.plan.objects[object];
            let colored = info.first_color != NONE || info.texture != NONE;
            is_lit(info) && (colored || info.albedo != [0.0; 3])
        };
        (0..self.plan.names.len())
            .find(|&object| scatters(object) || self.has_surface(object) && shows_light(object))
    }

    fn is_unlit(&self) -> Option<String> {
        let object = self.needs_light()?;
        let glows = self.plan.follows_paths() && self.plan.volumes.any_marched();
        if self.plan.sky_lights() || glows {
            return None;
        }
        if self.plan.lights.iter().any(|light| light.strength.iter().any(|x| *x > 0.0)) {
            return None;
        }
        let (why, advice) = match self.plan.lights.is_empty() {
            true => (
                "there are no lights",
                "add [[lights]] with kind = \"headlight\" and at_target = [1, 1, 1]",
            ),
            false => (
                "the irradiance, intensity or at_target of every light is 0",
                "raise that of one, e.g. to [1, 1, 1]",
            ),
        };
        Some(format!(
            "object '{}' is black: {why}, and the background lights nothing; {advice}",
            self.name(object)
        ))
    }

    /// Whether every light is closed in by a surface that the eye is outside.
    fn is_enclosed(&self) -> Option<String> {
        self.needs_light()?;
        let plan = self.plan;
        if plan.sky_lights() {
            return None;
        }
        let shining = || plan.lights.iter().filter(|light| light.strength.iter().any(|x| *x > 0.0));
        let are_points = shining().all(|light| light.kind == LIGHT_POINT);
        if !(are_points
            && plan.camera.projection == PERSPECTIVE
            && (1..=MOST_LIGHTS).contains(&shining().count()))
        {
            return None;
        }
        let around = |object: usize, place: [f32; 3]| {
            let slots = surface_slots(&plan.cloud, &plan.shapes, object);
            let votes = votes(&plan.cloud.points[slots.range()], place.map(f64::from));
            votes.is_clear().then(|| votes.says_inside())
        };
        let closes = |object: &usize| {
            let info = &plan.objects[*object];
            let is_opaque = is_lit(info) || !sends_rays_on(info);
            is_opaque
                && shining().all(|light| around(*object, light.vector) == Some(true))
                && around(*object, plan.camera.eye) == Some(false)
        };
        let object = (0..plan.names.len()).find(closes)?;
        Some(format!(
            "object '{}' encloses every light, and the camera is outside, where it is dark; move lights.0.position \
             outside, or add a light of kind \"headlight\"",
            self.name(object)
        ))
    }

    /// Whether all that rays meet leads to one background of one colour, and changes nothing of it.
    fn is_one_color(&self) -> Option<String> {
        let (scene, plan) = (self.scene, self.plan);
        if plan.wave.background.environment != NONE || scene.image.transparent {
            return None;
        }
        let is_black = scene.background.color == [0.0; 3];
        let marched = plan.volumes.infos.iter().any(|info| info.mode != VOLUME_ISOSURFACE);
        let shows = |object: &usize| {
            let info = &plan.objects[*object];
            is_lit(info) || (!is_black && dims(info))
        };
        let surfaces: Vec<usize> =
            (0..plan.names.len()).filter(|&object| self.has_surface(object)).collect();
        if marched || surfaces.is_empty() || surfaces.iter().any(shows) {
            return None;
        }
        let name = self.name(surfaces[0]);
        let what = scene.objects[surfaces[0]].material.kind.noun();
        let color = if is_black { "a black background" } else { "a background of one colour" };
        Some(format!(
            "object '{name}' is not seen: it is {what} before {color}, and there is nothing else to see in it; give \
             background.environment an image, or add an object of another material"
        ))
    }

    /// Whether rays end where they would begin to show something.
    fn has_no_bounces(&self) -> Option<String> {
        // Surfaces between media of one index are passed without a bounce.
        let around =
            self.plan.camera_media.iter().map(|&object| self.plan.objects[object as usize].ior);
        let around: Vec<[f32; 3]> = around.chain([[1.0; 3]]).collect();
        let scattering = |&object: &usize| {
            let info = &self.plan.objects[object];
            let may_pass = has_inside(info) && around.contains(&info.ior);
            let shows_rays_alone = sends_rays_on(info) && !is_lit(info);
            shows_rays_alone && !may_pass && self.has_surface(object)
        };
        let object = (0..self.plan.names.len()).find(scattering)?;
        (self.plan.wave.max_bounces == 0).then(|| {
            format!(
                "object '{}' shows only the background: render.max_bounces is 0, so that rays end at mirrors and glass; \
                 raise it, e.g. to 8",
                self.name(object)
            )
        })
    }
}

#[cfg(test)]
mod tests;
