//! A clear sky with its sun over a ground: the model of Hošek and Wilkie ("An Analytic Model for Full Spectral Sky-Dome
//! Radiance", 2012, and "Adding a Solar-Radiance Function to the Hošek-Wilkie Skylight Model", 2013), in docs/method.md,
//! section 6.
//!
//! Directions are in an environment's own frame, with +y upwards. Radiances are in W sr⁻¹ m⁻² nm⁻¹, irradiances in
//! W m⁻² nm⁻¹: means over wavelengths weighted by the eye's sensitivity, in linear Rec. 709.

mod color;
mod data;
mod dome;
mod sun;

use crate::PlanError;
use crate::environment::turn;
use glam::DVec3;
use rayon::prelude::*;
use scene::{Sky, SunPlace};
use std::f64::consts::{FRAC_1_PI, FRAC_PI_2, PI, TAU};
use std::sync::Arc;

/// Columns and rows of the image of a sky. Above its middle row is the sky, below it the ground.
const SIZE: [u32; 2] = [1024, 512];
/// How far below the horizon the sky has given way to the ground, in degrees.
const HAZE: f64 = 0.5;
/// How far below the horizon, in degrees, a sun may be that is meant to be on it.
const ON_HORIZON: f64 = 1e-6;

/// The image of a sky without the sun's disc, in the environment's own frame. Where the camera's `up` is given, that
/// frame is [`turn`]'s.
///
/// # Errors
/// A sun below the horizon.
pub(crate) fn image(sky: &Sky, up: [f64; 3]) -> Result<Arc<film::Image>, PlanError> {
    let sun = towards_sun(sky, up);
    let degrees = -sun.y.asin().to_degrees();
    if degrees > ON_HORIZON {
        return Err(PlanError::SunBelowHorizon { degrees, up });
    }
    let [width, height] = SIZE;
    let rows = height as usize / 2;
    let dome = dome::Dome::new(sky, sun);
    let upper: Vec<Vec<[f64; 3]>> =
        (0..rows).into_par_iter().map(|row| row_of(&dome, row)).collect();
    let lit = add(sky_irradiance(&upper), sun::irradiance(sky.turbidity, sun.y).map(|e| e * sun.y));
    let ground = [0, 1, 2].map(|i| sky.ground[i] * lit[i] * FRAC_1_PI);
    let blended = |row: usize| -> Vec<[f64; 3]> {
        let share = smooth(1.0 + altitude_of(row).to_degrees() / HAZE);
        if share == 0.0 {
            return vec![ground; width as usize];
        }
        let between =
            |color: [f64; 3]| [0, 1, 2].map(|i| ground[i] + share * (color[i] - ground[i]));
        row_of(&dome, row).into_iter().map(between).collect()
    };
    let lower = (rows..2 * rows).flat_map(blended);
    let texels = upper.into_iter().flatten().chain(lower).map(|color| color.map(|x| x as f32));
    Ok(Arc::new(film::Image { width, height, texels: film::Texels::Linear(texels.collect()) }))
}

/// The sun of a sky as a light of the world; none where it is below the horizon.
pub(crate) fn sun(sky: &Sky, up: [f64; 3]) -> Option<scene::Light> {
    let sun = towards_sun(sky, up);
    let irradiance = sun::irradiance(sky.turbidity, sun.y);
    let is_up = -sun.y.asin().to_degrees() <= ON_HORIZON;
    let rows = turn(up, [0.0; 3]);
    // The turn's inverse is its transpose.
    let back = |axis: usize| -> f64 { (0..3).map(|row| rows[row][axis] * sun[row]).sum() };
    let direction = [0, 1, 2].map(|axis| -back(axis) + 0.0);
    let angle = sky.sun_angle;
    is_up.then_some(scene::Light::Directional { direction, irradiance, angle })
}

/// The unit vector towards the sun in the environment's own frame.
fn towards_sun(sky: &Sky, up: [f64; 3]) -> DVec3 {
    match sky.sun {
        SunPlace::Towards(direction) => {
            let largest = direction.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            let world = DVec3::from(direction.map(|x| x / largest)).normalize();
            DVec3::from(turn(up, [0.0; 3]).map(|row| DVec3::from(row).dot(world)))
        }
        SunPlace::Angles { elevation, azimuth } => {
            let (above, level) = elevation.to_radians().sin_cos();
            let (right, ahead) = azimuth.to_radians().sin_cos();
            DVec3::new(level * right, above, -level * ahead)
        }
    }
}

/// How high the middle of a row of texels is over the horizon, in radians.
fn altitude_of(row: usize) -> f64 {
    FRAC_PI_2 - PI * (row as f64 + 0.5) / f64::from(SIZE[1])
}

/// The sky in the middles of a row's texels; below the horizon, as it is there.
fn row_of(dome: &dome::Dome, row: usize) -> Vec<[f64; 3]> {
    let (above, level) = altitude_of(row).sin_cos();
    let texel = |column: u32| {
        let azimuth = TAU * ((f64::from(column) + 0.5) / f64::from(SIZE[0]) - 0.5);
        dome.radiance(DVec3::new(level * azimuth.sin(), above, -level * azimuth.cos()))
    };
    (0..SIZE[0]).map(texel).collect()
}

/// The irradiance of a level surface by the rows above the horizon: texel by texel the radiance times the exact integral of
/// the cosine.
fn sky_irradiance(upper: &[Vec<[f64; 3]>]) -> [f64; 3] {
    let border = |row: usize| (PI * row as f64 / f64::from(SIZE[1])).sin().powi(2);
    let of_row = |(row, colors): (usize, &Vec<[f64; 3]>)| {
        let weight = 0.5 * TAU / f64::from(SIZE[0]) * (border(row + 1) - border(row));
        colors.iter().copied().fold([0.0; 3], add).map(|sum| sum * weight)
    };
    upper.iter().enumerate().map(of_row).fold([0.0; 3], add)
}

fn add(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| a[i] + b[i])
}

/// From 0 at 0 and below to 1 at 1 and above, without a kink.
pub(crate) fn smooth(t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests;
