//! The view: where rays start, which way they go, and the matrices that say so in an EXR.

use glam::{DMat4, DVec3, DVec4};
use kernels::layout::CameraParams;
use scene::{Camera, Up};

/// Direction from the middle of the points to the eye, for +y up.
const FRAMING_DIRECTION: DVec3 = DVec3::new(0.45, 0.35, 1.0);
/// Distance to the eye over half the diagonal of the bounding box.
const FRAMING_DISTANCE: f64 = 2.2;
const FRAMING_FOV: f64 = 40.0;

/// A camera that sees the whole box.
pub(crate) fn frame(bounds: [[f64; 3]; 2], up: Up) -> Camera {
    let [low, high] = bounds.map(DVec3::from);
    let center = 0.5 * low + 0.5 * high;
    let half_diagonal = match (0.5 * (high - low)).length() {
        0.0 => 1.0, // one point: any distance shows the same nothing
        length => length,
    };
    let (direction, up) = match up {
        Up::Y => (FRAMING_DIRECTION, DVec3::Y),
        Up::Z => {
            (DVec3::new(FRAMING_DIRECTION.x, -FRAMING_DIRECTION.z, FRAMING_DIRECTION.y), DVec3::Z)
        }
    };
    let eye = center + FRAMING_DISTANCE * half_diagonal * direction.normalize();
    Camera { eye: eye.into(), target: center.into(), up: up.into(), vertical_fov: FRAMING_FOV }
}

/// A camera in the forms that kernels and files take.
#[derive(Debug, Clone, Copy)]
pub struct View {
    /// Parameters of `camera_rays`, in centred scene space; the tile is zero.
    pub params: CameraParams,
    /// Row vectors, v · M: from (world − origin) to a camera that looks along −z, +y up.
    pub world_to_camera: [[f32; 4]; 4],
    /// Row vectors, v · M: from (world − origin); after division by w, x to the right and y down,
    /// (0, 0) and (1, 1) at the corners of the picture, z = 1 − 1/depth.
    pub world_to_ndc: [[f32; 4]; 4],
}

impl View {
    /// `origin` is what is subtracted from world coordinates.
    #[must_use]
    pub fn new(camera: &Camera, image_size: [u32; 2], origin: [f64; 3]) -> Self {
        let [eye, target, up] = [camera.eye, camera.target, camera.up].map(DVec3::from);
        let forward = (target - eye).normalize();
        let right = forward.cross(up).normalize();
        let up = right.cross(forward);
        let local_eye = eye - DVec3::from(origin);
        let half_tangent = (0.5 * camera.vertical_fov.to_radians()).tan();
        let [width, height] = image_size.map(f64::from);
        let params = CameraParams {
            eye: local_eye.as_vec3().into(),
            scale: (half_tangent / (0.5 * height)) as f32,
            right: right.as_vec3().into(),
            half_width: (0.5 * width) as f32,
            up: up.as_vec3().into(),
            half_height: (0.5 * height) as f32,
            forward: forward.as_vec3().into(),
            pad: 0,
            tile_origin: [0, 0],
            tile_size: [0, 0],
        };
        // glam's columns, read as rows, are the row vectors' matrix.
        let camera_axes = DMat4::from_cols(
            right.extend(-right.dot(local_eye)),
            up.extend(-up.dot(local_eye)),
            (-forward).extend(forward.dot(local_eye)),
            DVec4::W,
        );
        let x_scale = 0.5 / (half_tangent * width / height);
        let y_scale = 0.5 / half_tangent;
        let projection = DMat4::from_cols(
            DVec4::new(x_scale, 0.0, -0.5, 0.0),
            DVec4::new(0.0, -y_scale, -0.5, 0.0),
            DVec4::new(0.0, 0.0, -1.0, -1.0),
            DVec4::new(0.0, 0.0, -1.0, 0.0),
        );
        Self {
            params,
            world_to_camera: row_vector_matrix(camera_axes),
            world_to_ndc: row_vector_matrix(camera_axes * projection),
        }
    }
}

/// `m`'s columns hold the coefficients of each output coordinate: element [i][j] of the result is
/// what input i adds to output j.
fn row_vector_matrix(m: DMat4) -> [[f32; 4]; 4] {
    let columns = m.to_cols_array_2d();
    [0, 1, 2, 3].map(|input| [0, 1, 2, 3].map(|output| columns[output][input] as f32))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn apply(v: [f32; 3], m: [[f32; 4]; 4]) -> [f32; 4] {
        [0, 1, 2, 3].map(|j| v[0] * m[0][j] + v[1] * m[1][j] + v[2] * m[2][j] + m[3][j])
    }

    fn view() -> View {
        let camera = Camera {
            eye: [10.0, 2.0, 5.0],
            target: [10.0, 2.0, 0.0],
            up: [0.0, 3.0, 0.0],
            vertical_fov: 90.0,
        };
        View::new(&camera, [200, 100], [10.0, 0.0, 0.0])
    }

    #[test]
    fn camera_looks_along_minus_z_with_y_up() {
        // One to the right of, two above and four before the eye; the origin is subtracted.
        let [x, y, z, w] = apply([1.0, 4.0, 1.0], view().world_to_camera);
        assert_eq!([x, y, z, w], [1.0, 2.0, -4.0, 1.0]);
    }

    #[test]
    fn ndc_has_its_corners_at_the_corners_of_the_picture() {
        let ndc = |p: [f32; 3]| {
            let [x, y, z, w] = apply(p, view().world_to_ndc);
            [x / w, y / w, z / w]
        };
        let close = |a: [f32; 3], b: [f32; 3]| (0..3).all(|i| (a[i] - b[i]).abs() < 1e-6);
        // At depth 2 the picture reaches from -4 to 4 and from 4 above to 0.
        assert!(close(ndc([-4.0, 4.0, 3.0]), [0.0, 0.0, 0.5]), "{:?}", ndc([-4.0, 4.0, 3.0]));
        assert!(close(ndc([4.0, 0.0, 3.0]), [1.0, 1.0, 0.5]), "{:?}", ndc([4.0, 0.0, 3.0]));
        assert!(close(ndc([0.0, 2.0, 1.0]), [0.5, 0.5, 0.75]), "{:?}", ndc([0.0, 2.0, 1.0]));
    }

    #[test]
    fn framing_sees_the_box_from_its_front_and_above() {
        for (up, axis) in [(Up::Y, 1), (Up::Z, 2)] {
            let camera = frame([[-1.0; 3], [1.0; 3]], up);
            assert_eq!(camera.up[axis], 1.0);
            assert!(camera.eye[axis] > 0.0 && camera.eye[0] > 0.0);
            let distance = DVec3::from(camera.eye).length();
            assert!((distance - 2.2 * 3f64.sqrt()).abs() < 1e-12);
        }
        assert!(frame([[3.0; 3], [3.0; 3]], Up::Y).eye.iter().all(|x| x.is_finite()));
    }
}
