//! From the matrices in a picture's header back to a camera: of pictures of any program.

use glam::{DMat3, DVec3};
use scene::{CameraKeys, ViewFrom};

/// How far the middle of a view may lie beside the picture's middle, over the picture's side.
const ASIDE: f64 = 1e-3;
/// Over the reach of the picture's scale: changes of w so small are those of parallel rays.
const LEVEL: f64 = 1e-7;

/// What the header of a picture says of its camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeaderCamera {
    /// The keys that the matrices determine.
    pub keys: CameraKeys,
    /// Width over height of what the picture shows, where they say so.
    pub aspect: Option<f64>,
}

/// The camera of `worldToCamera` and `worldToNDC`, for row vectors, of which one will do; `origin` is what was subtracted
/// from world coordinates before. What they do not determine is left out: the distance of the target, and without
/// `worldToNDC` the angle.
///
/// A camera looks along −z where `worldToCamera` keeps right hands right, and along +z, as OpenEXR's documentation has it,
/// where it does not.
///
/// # Errors
/// Matrices without an inverse, and views whose middle is not the picture's, in words.
pub fn camera_of_matrices(
    world_to_camera: Option<[[f32; 4]; 4]>,
    world_to_ndc: Option<[[f32; 4]; 4]>,
    origin: [f64; 3],
) -> Result<HeaderCamera, String> {
    let placed = world_to_camera.map(Placed::of).transpose()?;
    let mut camera = match world_to_ndc {
        Some(matrix) => Seen::of(matrix, placed.as_ref())?,
        None => {
            let placed = placed.ok_or("found neither worldToCamera nor worldToNDC")?;
            HeaderCamera { keys: placed.keys(), aspect: None }
        }
    };
    for place in [&mut camera.keys.eye, &mut camera.keys.target].into_iter().flatten() {
        *place = [0, 1, 2].map(|axis| place[axis] + origin[axis]);
    }
    let keys = &camera.keys;
    let vectors = [keys.eye, keys.target, keys.up];
    match vectors.into_iter().flatten().flatten().all(|x| x.is_finite() && x.abs() <= 1e15) {
        true => Ok(camera),
        false => Err("found matrices that place the camera nowhere".to_owned()),
    }
}

/// What the columns of a matrix multiply a place by, and what they add.
struct Columns {
    of: [DVec3; 4],
    plus: [f64; 4],
}

impl Columns {
    fn of(matrix: [[f32; 4]; 4]) -> Self {
        let [x, y, z, plus] = matrix.map(|row| row.map(f64::from));
        Self { of: std::array::from_fn(|i| DVec3::new(x[i], y[i], z[i])), plus }
    }

    /// The place where three of the columns are zero.
    fn place(&self, columns: [usize; 3]) -> Option<DVec3> {
        let [a, b, c] = columns.map(|column| self.of[column]);
        let rows = DMat3::from_cols(a, b, c).transpose();
        let size = a.length() * b.length() * c.length();
        let is_solvable = size > 0.0 && rows.determinant().abs() > 1e-9 * size;
        is_solvable.then(|| rows.inverse() * -DVec3::from(columns.map(|column| self.plus[column])))
    }
}

/// Where a camera is, and how it is turned.
struct Placed {
    eye: DVec3,
    forward: DVec3,
    up: DVec3,
}

impl Placed {
    fn of(matrix: [[f32; 4]; 4]) -> Result<Self, String> {
        let columns = Columns::of(matrix);
        let eye = columns.place([0, 1, 2]).ok_or("found a worldToCamera without an inverse")?;
        let [right, up, back, _] = columns.of;
        let is_right_handed = right.cross(up).dot(back) > 0.0;
        let forward = if is_right_handed { -back } else { back };
        Ok(Self { eye, forward: forward.normalize(), up: up.normalize() })
    }

    fn keys(&self) -> CameraKeys {
        CameraKeys {
            eye: Some(self.eye.into()),
            view: Some(ViewFrom::Along(self.forward.into())),
            up: Some(self.up.into()),
            ..CameraKeys::default()
        }
    }
}

/// What `worldToNDC` says.
struct Seen;

impl Seen {
    fn of(matrix: [[f32; 4]; 4], placed: Option<&Placed>) -> Result<HeaderCamera, String> {
        let mut columns = Columns::of(matrix);
        let [x, y, _, w] = columns.of;
        let no_picture = || "found a worldToNDC that spans no picture".to_owned();
        if !(x.length() > 0.0 && y.length() > 0.0) {
            return Err(no_picture());
        }
        if w.length() <= LEVEL * columns.plus[3].abs() * x.length().max(y.length()) {
            return Self::parallel(&columns, placed);
        }
        let eye = columns.place([0, 1, 3]).ok_or_else(no_picture)?;
        // The scale of such a matrix means nothing; w grows forwards, unless the other matrix says otherwise.
        let is_turned = placed.is_some_and(|placed| placed.forward.dot(w) < 0.0);
        let scale = if is_turned { -1.0 } else { 1.0 } / w.length();
        columns.of = columns.of.map(|column| scale * column);
        let [x, y, _, forward] = columns.of;
        let middle = [x.dot(forward), y.dot(forward)];
        let [right, down] = [x - middle[0] * forward, y - middle[1] * forward];
        let window = Window::of(middle)?;
        let scales = [right.length(), down.length()];
        if !(scales[0] > 0.0 && scales[1] > 0.0) {
            return Err(no_picture());
        }
        let keys = CameraKeys {
            eye: Some(eye.into()),
            view: Some(ViewFrom::Along(forward.into())),
            up: Some(placed.map_or_else(|| window.up(down), |placed| placed.up).into()),
            vertical_fov: Some(2.0 * (window.half / scales[1]).atan().to_degrees()),
            ..CameraKeys::default()
        };
        Ok(HeaderCamera { keys, aspect: Some(scales[1] / scales[0]) })
    }

    fn parallel(columns: &Columns, placed: Option<&Placed>) -> Result<HeaderCamera, String> {
        let scale = 1.0 / columns.plus[3];
        let [right, down] = [columns.of[0] * scale, columns.of[1] * scale];
        let plus = [columns.plus[0] * scale, columns.plus[1] * scale];
        let scales = [right.length(), down.length()];
        let nothing = || "found a worldToNDC that spans no picture".to_owned();
        if !(scales.iter().all(|scale| scale.is_finite() && *scale > 0.0)) {
            return Err(nothing());
        }
        let middle_at = |eye: DVec3| [eye.dot(right) + plus[0], eye.dot(down) + plus[1]];
        let (mut keys, window) = match placed {
            Some(placed) => (placed.keys(), Window::of(middle_at(placed.eye))?),
            None => {
                let window = Window { middle: 0.5, half: 0.5 };
                let up = window.up(down);
                let forward = up.cross(right).normalize();
                // The place nearest to the origin that is seen in the middle.
                let target = (0.5 - plus[0]) / (scales[0] * scales[0]) * right
                    + (0.5 - plus[1]) / (scales[1] * scales[1]) * down;
                let keys = CameraKeys {
                    target: Some(target.into()),
                    view: Some(ViewFrom::Along(forward.into())),
                    up: Some(up.into()),
                    ..CameraKeys::default()
                };
                (keys, window)
            }
        };
        keys.is_orthographic = true;
        keys.height = Some(2.0 * window.half / scales[1]);
        Ok(HeaderCamera { keys, aspect: Some(scales[1] / scales[0]) })
    }
}

/// Where a picture's sides lie: from 0 to 1, as OpenEXR has it, or from -1 to 1, as some renderers write it.
struct Window {
    middle: f64,
    half: f64,
}

impl Window {
    fn of(middle: [f64; 2]) -> Result<Self, String> {
        let both = [Self { middle: 0.5, half: 0.5 }, Self { middle: 0.0, half: 1.0 }];
        let fits = |window: &Self| {
            middle.iter().all(|at| (at - window.middle).abs() < 2.0 * ASIDE * window.half)
        };
        both.into_iter().find(fits).ok_or_else(|| {
            format!(
                "found a view whose middle lies at {:.3}, {:.3} of the picture, expected the picture's middle: shifted \
                 lenses are not built",
                middle[0], middle[1]
            )
        })
    }

    /// y goes down from 0 to 1, and up from -1 to 1.
    fn up(&self, y: DVec3) -> DVec3 {
        if self.middle > 0.0 { -y.normalize() } else { y.normalize() }
    }
}

#[cfg(test)]
mod tests;
