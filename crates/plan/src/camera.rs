//! The view: where rays start, which way they go, and the matrices that say so in an EXR.

use crate::frame::Sight;
use glam::DVec3;
use kernels::layout::{CameraParams, NONE, ORTHOGRAPHIC, PERSPECTIVE};
use scene::{Camera, Projection};

/// A camera in the forms that kernels and files take.
#[derive(Debug, Clone, Copy)]
pub struct View {
    /// Parameters of `camera_rays`, in centred scene space; the tile is zero.
    pub params: CameraParams,
    /// Row vectors, v · M: from (world − origin) to a camera that looks along −z, +y up.
    pub world_to_camera: [[f32; 4]; 4],
    /// Row vectors, v · M: from (world − origin); after division by w, x to the right and y down,
    /// (0, 0) and (1, 1) at the corners of the picture; z = 1 − 1/depth, or the depth where rays are
    /// parallel, and w = 1.
    pub world_to_ndc: [[f32; 4]; 4],
}

impl View {
    /// `origin` is what is subtracted from world coordinates.
    #[must_use]
    pub fn new(camera: &Camera, image_size: [u32; 2], origin: [f64; 3]) -> Self {
        let sight = Sight::new(camera, image_size);
        let [eye, target] = [camera.eye, camera.target].map(DVec3::from);
        let local_eye = eye - DVec3::from(origin);
        let [width, height] = image_size.map(f64::from);
        let params = CameraParams {
            eye: local_eye.as_vec3().into(),
            scale: (sight.half_extent / (0.5 * height)) as f32,
            right: sight.right.as_vec3().into(),
            half_width: (0.5 * width) as f32,
            up: sight.up.as_vec3().into(),
            half_height: (0.5 * height) as f32,
            forward: sight.forward.as_vec3().into(),
            sample_index: NONE,
            tile_origin: [0, 0],
            tile_size: [0, 0],
            projection: match camera.projection {
                Projection::Perspective { .. } => PERSPECTIVE,
                Projection::Orthographic { .. } => ORTHOGRAPHIC,
            },
            lens_radius: (0.5 * camera.aperture) as f32,
            focus: camera.focus.unwrap_or((target - eye).length()) as f32,
            seed: 0,
        };
        let [world_to_camera, world_to_ndc] = sight.matrices(origin);
        Self { params, world_to_camera, world_to_ndc }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn apply(v: [f32; 3], m: [[f32; 4]; 4]) -> [f32; 4] {
        [0, 1, 2, 3].map(|j| v[0] * m[0][j] + v[1] * m[1][j] + v[2] * m[2][j] + m[3][j])
    }

    const WIDE: Projection = Projection::Perspective { vertical_fov: 90.0 };

    fn view(projection: Projection) -> View {
        let camera = Camera {
            eye: [10.0, 2.0, 5.0],
            target: [10.0, 2.0, 0.0],
            up: [0.0, 3.0, 0.0],
            projection,
            aperture: 0.0,
            focus: None,
        };
        View::new(&camera, [200, 100], [10.0, 0.0, 0.0])
    }

    #[test]
    fn camera_looks_along_minus_z_with_y_up() {
        // One to the right of, two above and four before the eye; the origin is subtracted.
        let [x, y, z, w] = apply([1.0, 4.0, 1.0], view(WIDE).world_to_camera);
        assert_eq!([x, y, z, w], [1.0, 2.0, -4.0, 1.0]);
    }

    #[test]
    fn ndc_has_its_corners_at_the_corners_of_the_picture() {
        let ndc = |p: [f32; 3]| {
            let [x, y, z, w] = apply(p, view(WIDE).world_to_ndc);
            [x / w, y / w, z / w]
        };
        let close = |a: [f32; 3], b: [f32; 3]| (0..3).all(|i| (a[i] - b[i]).abs() < 1e-6);
        // At depth 2 the picture reaches from -4 to 4 and from 4 above to 0.
        assert!(close(ndc([-4.0, 4.0, 3.0]), [0.0, 0.0, 0.5]), "{:?}", ndc([-4.0, 4.0, 3.0]));
        assert!(close(ndc([4.0, 0.0, 3.0]), [1.0, 1.0, 0.5]), "{:?}", ndc([4.0, 0.0, 3.0]));
        assert!(close(ndc([0.0, 2.0, 1.0]), [0.5, 0.5, 0.75]), "{:?}", ndc([0.0, 2.0, 1.0]));
    }

    #[test]
    fn parallel_rays_show_the_same_at_any_depth() {
        let view = view(Projection::Orthographic { height: 4.0 });
        // From 4 above the centre to 0, and, twice as wide as high, from -4 to 4.
        assert_eq!(apply([-4.0, 4.0, 3.0], view.world_to_ndc), [0.0, 0.0, 2.0, 1.0]);
        assert_eq!(apply([4.0, 0.0, -7.0], view.world_to_ndc), [1.0, 1.0, 12.0, 1.0]);
        assert_eq!((view.params.scale, view.params.projection), (0.04, ORTHOGRAPHIC));
        assert_eq!((view.params.focus, view.params.lens_radius), (5.0, 0.0));
    }
}
