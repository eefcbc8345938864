//! How the environment is turned: its top is the camera's `up` where that is an axis, and the scene may turn it
//! about the world's axes (docs/method.md, section 6).

mod made;
mod table;

pub(crate) use made::{made_image, sun_of};
pub use table::EnvironmentTable;

use kernels::layout::ImageInfo;
use scene::Transform;

/// A matrix by rows.
type Rows = [[f64; 3]; 3];

const NONE: Rows = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// What makes of a direction in the world the one that is looked up in the environment.
pub(crate) fn turn(up: [f64; 3], rotate: [f64; 3]) -> Rows {
    let upright = upright(up);
    let rotation = Transform { rotate, ..Transform::IDENTITY }.rotation();
    // A turned environment shows in a direction what it would show, unturned, in the direction turned back.
    let entry = |i: usize, j: usize| (0..3).map(|k| upright[i][k] * rotation[j][k]).sum::<f64>();
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| entry(i, j) + 0.0))
}

/// The quarter turns that bring an axis to +y: about x, and for ±x about z.
fn upright(up: [f64; 3]) -> Rows {
    match up.map(|along| along.partial_cmp(&0.0).map_or(0, |order| order as i8)) {
        [0, -1, 0] => [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]],
        [0, 0, 1] => [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]],
        [0, 0, -1] => [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]],
        [1, 0, 0] => [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
        [-1, 0, 0] => [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
        _ => NONE,
    }
}

/// Whether it turns anything, as kernels see it.
pub(crate) fn turns(rows: &[ImageInfo]) -> bool {
    rows != rows_of(&NONE)
}

/// The rows as they lie among the images.
pub(crate) fn rows_of(turn: &Rows) -> [ImageInfo; 3] {
    turn.map(|row| {
        let [first, width, height] = row.map(|entry| (entry as f32).to_bits());
        ImageInfo { first, width, height, format: 0 }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn looked_up(up: [f64; 3], rotate: [f64; 3], d: [f64; 3]) -> [f64; 3] {
        turn(up, rotate).map(|row| row[0] * d[0] + row[1] * d[1] + row[2] * d[2])
    }

    /// The six of docs/scene.md, whatever the length of `up`.
    #[test]
    fn each_axis_is_a_top() {
        let d = [2.0, 3.0, 5.0];
        for (up, expected) in [
            ([0.0, 1.0, 0.0], [2.0, 3.0, 5.0]),
            ([0.0, -7.0, 0.0], [2.0, -3.0, -5.0]),
            ([0.0, 0.0, 0.5], [2.0, 5.0, -3.0]),
            ([0.0, 0.0, -1.0], [2.0, -5.0, 3.0]),
            ([1.0, -0.0, 0.0], [-3.0, 2.0, 5.0]),
            ([-1.0, 0.0, 0.0], [3.0, -2.0, 5.0]),
            ([0.0, 1e-9, 1.0], [2.0, 3.0, 5.0]),
        ] {
            assert_eq!(looked_up(up, [0.0; 3], d), expected, "{up:?}");
            let top = up.map(|along| along / up.iter().map(|x| x * x).sum::<f64>().sqrt());
            if up != [0.0, 1e-9, 1.0] {
                assert_eq!(looked_up(up, [0.0; 3], top), [0.0, 1.0, 0.0], "the top of {up:?}");
            }
        }
    }

    /// Turned by 90 degrees about y, what was seen along +z is seen along +x; then about the world's z where that is up.
    #[test]
    fn turns_are_about_the_axes_of_the_world() {
        let (x, z) = ([1.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
        assert_eq!(looked_up([0.0, 1.0, 0.0], [0.0, 90.0, 0.0], x), z);
        let y = [0.0, 1.0, 0.0];
        assert_eq!(looked_up(z, [0.0, 0.0, 90.0], y), x, "what was along +x is along +y");
        assert_eq!(looked_up(z, [0.0, 0.0, 37.0], z), y, "the top stays");
    }

    #[test]
    fn no_turn_is_none() {
        let is_one = |up, rotate| turns(&rows_of(&turn(up, rotate)));
        assert!(!is_one([0.0, 2.0, 0.0], [0.0; 3]));
        assert!(!is_one([0.0, 2.0, 0.0], [360.0, -720.0, 0.0]));
        assert!(is_one([0.0, 0.0, 1.0], [0.0; 3]) && is_one([0.0, 1.0, 0.0], [0.0, 1.0, 0.0]));
        assert!(!is_one([0.0, 0.0, 1.0], [-90.0, 0.0, 0.0]), "turned back");
    }
}
