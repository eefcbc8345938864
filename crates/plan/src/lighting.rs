//! How a scene is lit: what lights it beside its lamps, and what kernels have to do for it, as bits that they are specialized
//! by.

use crate::Plan;
use crate::environment::EnvironmentTable;
use kernels::layout::{
    ImageInfo, LIGHT_ENVIRONMENT, LIGHT_POINT, LIGHT_SKY, LIGHT_SUN, LIGHTING_ANISOTROPY,
    LIGHTING_CLAMP, LIGHTING_LAMPS, LIGHTING_PATH, LIGHTING_SCATTERS, LIGHTING_SKY, LIGHTING_SUN,
    LIGHTING_TABLE, Light,
};
use scene::{Integrator, Scene};

/// How much brighter than the mean an environment may be anywhere without being sampled by its brightness: surfaces find the
/// light of such a background as fast by how they scatter it, with one ray a hit instead of two.
const EVEN: f64 = 4.0;

/// What the background is as a light.
pub(crate) struct SkyLight {
    /// Whether it lights what rays hit.
    pub lights: bool,
    /// Where it is bright, if some of it is much brighter than the rest; else empty.
    pub table: Vec<f32>,
}

impl SkyLight {
    /// That of a scene whose environment, if it has one, has this table, and `None` where it is black.
    pub fn of(scene: &Scene, environment: Option<Option<EnvironmentTable>>) -> Self {
        let is_bright = match &environment {
            Some(table) => table.is_some(),
            None => scene.background.color.iter().any(|&x| x > 0.0),
        };
        let lights = scene.background_lights() && is_bright;
        let table = environment.flatten().filter(|table| lights && table.peak_over_mean > EVEN);
        Self { lights, table: table.map_or_else(Vec::new, |table| table.values) }
    }

    /// As lights that rays are sent to. Where light goes from surface to surface, the rays that go on find the background
    /// by how surfaces scatter.
    pub fn lights(&self, integrator: Integrator) -> Vec<Light> {
        let light = |kind| Light { vector: [0.0; 3], kind, strength: [1.0; 3], extent: 0.0 };
        let by_lobe = self.lights && integrator != Integrator::Path;
        let kinds = [(by_lobe, LIGHT_SKY), (!self.table.is_empty(), LIGHT_ENVIRONMENT)];
        kinds.iter().filter(|(asked, _)| *asked).map(|&(_, kind)| light(kind)).collect()
    }
}

/// A directional light as the sun in the background: rays see it there, if it has an extent.
pub(crate) fn sun_light(light: Light) -> Light {
    Light { kind: if light.extent > 0.0 { LIGHT_SUN } else { light.kind }, ..light }
}

/// What rays see of the sun, as it lies among the images: the direction towards it, with the square of the sine of its
/// radius; and its radiance.
pub(crate) fn sun_rows(sun: &Light) -> [ImageInfo; 2] {
    let of = |[x, y, z]: [f32; 3], last: f32| {
        let [first, width, height, format] = [x, y, z, last].map(f32::to_bits);
        ImageInfo { first, width, height, format }
    };
    let square = f64::from(sun.extent).powi(2);
    let area = std::f64::consts::PI * square;
    let radiance = |irradiance: f32| if area > 0.0 { f64::from(irradiance) / area } else { 0.0 };
    [of(sun.vector, square as f32), of(sun.strength.map(|e| radiance(e) as f32), 0.0)]
}

impl Plan {
    /// The lights that have a place or a direction: all but the background, which comes after them.
    #[must_use]
    pub fn lamps(&self) -> &[Light] {
        let is_background = |light: &Light| [LIGHT_SKY, LIGHT_ENVIRONMENT].contains(&light.kind);
        let count = self.lights.iter().take_while(|&light| !is_background(light)).count();
        &self.lights[..count]
    }

    /// Whether light goes from surface to surface.
    #[must_use]
    pub fn follows_paths(&self) -> bool {
        self.integrator == Integrator::Path
    }

    /// Whether the background lights what rays hit.
    #[must_use]
    pub fn sky_lights(&self) -> bool {
        self.sky_lights
    }

    /// Whether a sun stands in the background.
    #[must_use]
    pub fn shows_sun(&self) -> bool {
        self.shows_sun
    }

    /// Whether rays that surfaces send on may meet lamps.
    #[must_use]
    pub fn meets_lamps(&self) -> bool {
        let may_be_met = |light: &Light| light.extent > 0.0 && light.kind <= LIGHT_POINT;
        self.follows_paths() && self.lights.iter().any(may_be_met)
    }

    /// `LIGHTING_*`: what kernels of this plan have to do.
    #[must_use]
    pub fn lighting_bits(&self) -> u32 {
        [
            (LIGHTING_TABLE, !self.environment_table.is_empty()),
            (LIGHTING_PATH, self.follows_paths()),
            (LIGHTING_SKY, self.sky_lights),
            (LIGHTING_LAMPS, self.meets_lamps()),
            (LIGHTING_SUN, self.shows_sun),
            (LIGHTING_CLAMP, self.follows_paths() && self.clamp.is_some()),
            (LIGHTING_SCATTERS, self.volumes.any_cloud()),
            (LIGHTING_ANISOTROPY, self.volumes.any_anisotropy()),
        ]
        .into_iter()
        .fold(0, |bits, (bit, is_set)| if is_set { bits | bit } else { bits })
    }

    /// What kernels of this plan are specialized by.
    #[must_use]
    pub fn constants(&self) -> [u32; 2] {
        [self.scene_bits(), self.lighting_bits()]
    }
}
