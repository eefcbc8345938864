//! Where an object's points land in the world.

/// Scale, then rotation about the fixed x, y, z axes in that order (right-handed), then
/// translation: p' = Rz·Ry·Rx·(s·p) + t.
///
/// With the default values [`Transform::apply`] returns its argument, bit for bit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transform {
    /// Uniform scale, 1e-12 to 1e12.
    pub scale: f64,
    /// Angles about x, y, z in degrees, each -1e6 to 1e6.
    pub rotate: [f64; 3],
    /// Translation in scene units, each -1e15 to 1e15.
    pub translate: [f64; 3],
}

impl Transform {
    /// Leaves every point where it is.
    pub const IDENTITY: Self = Self { scale: 1.0, rotate: [0.0; 3], translate: [0.0; 3] };

    /// The rotation R = Rz·Ry·Rx as rows. Multiples of 90 degrees give exact zeros and ones.
    pub fn rotation(&self) -> [[f64; 3]; 3] {
        let [(sx, cx), (sy, cy), (sz, cz)] = self.rotate.map(sin_cos_degrees);
        [
            [cz * cy, cz * sy * sx - sz * cx, cz * sy * cx + sz * sx],
            [sz * cy, sz * sy * sx + cz * cx, sz * sy * cx - cz * sx],
            [-sy, cy * sx, cy * cx],
        ]
    }

    /// The world position of a point of the object.
    pub fn apply(&self, p: [f64; 3]) -> [f64; 3] {
        if *self == Self::IDENTITY {
            return p;
        }
        let r = self.rotate(p.map(|x| self.scale * x));
        let t = self.translate;
        [r[0] + t[0], r[1] + t[1], r[2] + t[2]]
    }

    /// The world direction of a direction of the object: rotation alone, so lengths stay.
    pub fn rotate(&self, v: [f64; 3]) -> [f64; 3] {
        if self.rotate == [0.0; 3] {
            return v;
        }
        self.rotation().map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
    }
}

/// Sine and cosine of an angle in degrees, exact at multiples of 90.
fn sin_cos_degrees(degrees: f64) -> (f64, f64) {
    let turn = degrees.rem_euclid(360.0);
    if turn == 0.0 || turn == 360.0 {
        (0.0, 1.0)
    } else if turn == 90.0 {
        (1.0, 0.0)
    } else if turn == 180.0 {
        (0.0, -1.0)
    } else if turn == 270.0 {
        (-1.0, 0.0)
    } else {
        turn.to_radians().sin_cos()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const P: [f64; 3] = [1.5, -0.0, 3e-9];

    fn turned(rotate: [f64; 3], v: [f64; 3]) -> [f64; 3] {
        Transform { rotate, ..Transform::IDENTITY }.rotate(v)
    }

    #[test]
    fn identity_keeps_every_bit() {
        let bits = |p: [f64; 3]| p.map(f64::to_bits);
        assert_eq!(bits(Transform::IDENTITY.apply(P)), bits(P), "-0.0 stays -0.0");
        assert_eq!(bits(Transform::IDENTITY.rotate(P)), bits(P));
    }

    #[test]
    fn quarter_turns_are_right_handed_and_exact() {
        assert_eq!(turned([90.0, 0.0, 0.0], [0.0, 1.0, 0.0]), [0.0, 0.0, 1.0], "x: y to z");
        assert_eq!(turned([0.0, 90.0, 0.0], [0.0, 0.0, 1.0]), [1.0, 0.0, 0.0], "y: z to x");
        assert_eq!(turned([0.0, 0.0, 90.0], [1.0, 0.0, 0.0]), [0.0, 1.0, 0.0], "z: x to y");
        assert_eq!(turned([0.0, 0.0, -450.0], [1.0, 0.0, 0.0]), [0.0, -1.0, 0.0]);
    }

    /// x first: y goes to z under Rx, then z to x under Ry. The other order would leave y at z.
    #[test]
    fn x_turns_before_y_before_z() {
        assert_eq!(turned([90.0, 90.0, 0.0], [0.0, 1.0, 0.0]), [1.0, 0.0, 0.0]);
        assert_eq!(turned([90.0, 90.0, 90.0], [0.0, 1.0, 0.0]), [0.0, 1.0, 0.0]);
        assert_eq!(turned([0.0, 90.0, 90.0], [0.0, 0.0, 1.0]), [0.0, 1.0, 0.0]);
    }

    #[test]
    fn any_rotation_is_the_product_of_the_three_and_keeps_lengths() {
        let angles = [33.0, -71.5, 208.25];
        let v = [0.3, -1.2, 2.5];
        let [x, y, z] = angles;
        let steps = turned([0.0, 0.0, z], turned([0.0, y, 0.0], turned([x, 0.0, 0.0], v)));
        let at_once = turned(angles, v);
        let length = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        for i in 0..3 {
            // A dozen roundings of values under 3.
            assert!((steps[i] - at_once[i]).abs() < 1e-14, "{steps:?} {at_once:?}");
        }
        assert!((length(at_once) - length(v)).abs() < 1e-14);
    }

    #[test]
    fn scale_comes_before_rotation_and_translation_last() {
        let t = Transform { scale: 2.0, rotate: [0.0, 0.0, 90.0], translate: [10.0, 0.0, -1.0] };
        assert_eq!(t.apply([1.0, 0.0, 3.0]), [10.0, 2.0, 5.0]);
    }
}
