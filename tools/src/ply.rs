//! Points out, as binary little-endian PLY.

use crate::vector::Vector;

/// Points, and a colour each where the set is coloured.
#[derive(Debug, Default)]
pub struct Points {
    /// Where they are.
    pub positions: Vec<Vector>,
    /// Red, green and blue; none, or one a position.
    pub colors: Vec<[u8; 3]>,
    /// Names and values of further numbers, one value a position.
    pub attributes: Vec<(&'static str, Vec<f32>)>,
}

/// The bytes of the file.
pub fn encode(comment: &str, points: &Points) -> Vec<u8> {
    let coloured = !points.colors.is_empty();
    assert!(!coloured || points.colors.len() == points.positions.len(), "one colour a point");
    let colors = if coloured {
        "property uchar red\nproperty uchar green\nproperty uchar blue\n"
    } else {
        ""
    };
    let attributes: String =
        points.attributes.iter().map(|(name, _)| format!("property float {name}\n")).collect();
    let header = format!(
        "ply\nformat binary_little_endian 1.0\ncomment {comment}\nelement vertex {}\n\
         property float x\nproperty float y\nproperty float z\n{colors}{attributes}end_header\n",
        points.positions.len(),
    );
    let mut bytes = header.into_bytes();
    bytes.reserve(15 * points.positions.len());
    for (i, position) in points.positions.iter().enumerate() {
        for &coordinate in position {
            #[expect(clippy::cast_possible_truncation, reason = "rounding to float is meant")]
            bytes.extend((coordinate as f32).to_le_bytes());
        }
        bytes.extend(points.colors.get(i).into_iter().flatten());
        for (_, values) in &points.attributes {
            bytes.extend(values[i].to_le_bytes());
        }
    }
    bytes
}
