//! Points out, as binary little-endian PLY.

/// Points, and a colour each where the set is coloured.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PlyPoints {
    /// Where they are.
    pub positions: Vec<[f64; 3]>,
    /// Red, green and blue; none, or one a position.
    pub colors: Vec<[u8; 3]>,
    /// Names and values of further numbers, one value a position.
    pub attributes: Vec<(&'static str, Vec<f32>)>,
    /// Write coordinates in 64 bits, not 32.
    pub double: bool,
}

/// The bytes of the file.
///
/// # Panics
/// Where there are colours or values, but not one a position.
#[must_use]
pub fn encode_ply(comment: &str, points: &PlyPoints) -> Vec<u8> {
    let coloured = !points.colors.is_empty();
    assert!(!coloured || points.colors.len() == points.positions.len(), "one colour a point");
    let colors = if coloured {
        "property uchar red\nproperty uchar green\nproperty uchar blue\n"
    } else {
        ""
    };
    let attributes: String =
        points.attributes.iter().map(|(name, _)| format!("property float {name}\n")).collect();
    let number = if points.double { "double" } else { "float" };
    let header = format!(
        "ply\nformat binary_little_endian 1.0\ncomment {comment}\nelement vertex {}\n\
         property {number} x\nproperty {number} y\nproperty {number} z\n{colors}{attributes}end_header\n",
        points.positions.len(),
    );
    let mut bytes = header.into_bytes();
    bytes.reserve(15 * points.positions.len());
    for (i, position) in points.positions.iter().enumerate() {
        for &coordinate in position {
            match points.double {
                true => bytes.extend(coordinate.to_le_bytes()),
                false => bytes.extend((coordinate as f32).to_le_bytes()),
            }
        }
        bytes.extend(points.colors.get(i).into_iter().flatten());
        for (_, values) in &points.attributes {
            bytes.extend(values[i].to_le_bytes());
        }
    }
    bytes
}
