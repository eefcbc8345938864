//! Lights in the form that kernels take.

use glam::DVec3;
use kernels::layout::{self, LIGHT_DIRECTIONAL, LIGHT_POINT};
use scene::{Camera, Light, Projection};

/// `origin` is what is subtracted from world coordinates.
pub(crate) fn local_light(light: &Light, camera: &Camera, origin: [f64; 3]) -> layout::Light {
    let directional = |direction: DVec3, irradiance: [f64; 3], angle: f64| layout::Light {
        vector: (-direction.normalize()).as_vec3().into(),
        kind: LIGHT_DIRECTIONAL,
        strength: irradiance.map(|x| x as f32),
        extent: (0.5 * angle).to_radians().sin() as f32,
    };
    let point = |position: [f64; 3], intensity: [f64; 3], radius: f64| layout::Light {
        vector: [0, 1, 2].map(|axis| (position[axis] - origin[axis]) as f32),
        kind: LIGHT_POINT,
        strength: intensity.map(|x| x as f32),
        extent: radius as f32,
    };
    match *light {
        Light::Directional { direction, irradiance, angle } => {
            directional(direction.into(), irradiance, angle)
        }
        Light::Point { position, intensity, radius } => point(position, intensity, radius),
        Light::Headlight { at_target } => {
            let ahead = DVec3::from(camera.target) - DVec3::from(camera.eye);
            match camera.projection {
                Projection::Perspective { .. } => {
                    let square = ahead.length_squared();
                    // As large as the intensity of a light may be.
                    point(camera.eye, at_target.map(|x| (x * square).min(1e15)), 0.0)
                }
                Projection::Orthographic { .. } => directional(ahead, at_target, 0.0),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn headlight_of(projection: Projection) -> layout::Light {
        let [eye, target] = [[11.0, 2.0, 3.0], [11.0, 2.0, -1.0]];
        let up = [0.0, 1.0, 0.0];
        let camera = Camera { eye, target, up, projection, aperture: 0.0, focus: None };
        local_light(&Light::Headlight { at_target: [0.5, 1.0, 2.0] }, &camera, [10.0, 0.0, 0.0])
    }

    /// I = E r², with r = 4.
    #[test]
    fn a_headlight_is_a_point_light_in_the_eye() {
        let light = headlight_of(Projection::Perspective { vertical_fov: 40.0 });
        assert_eq!((light.kind, light.vector), (LIGHT_POINT, [1.0, 2.0, 3.0]));
        assert_eq!((light.strength, light.extent), ([8.0, 16.0, 32.0], 0.0));
    }

    #[test]
    fn a_headlight_of_parallel_rays_is_parallel_to_them() {
        let light = headlight_of(Projection::Orthographic { height: 1.0 });
        assert_eq!((light.kind, light.vector), (LIGHT_DIRECTIONAL, [0.0, 0.0, 1.0]));
        assert_eq!(light.strength, [0.5, 1.0, 2.0]);
    }
}
