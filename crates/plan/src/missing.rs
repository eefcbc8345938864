//! Points that lack what is shown of them: how they are marked for kernels, and how they are counted.

use std::fmt;

/// What a point is drawn in whose shown attribute is not a number, linear, whatever the map.
pub(crate) const NO_VALUE: [f32; 3] = [0.5, 0.0, 0.5];

/// A colour as kernels take it of points that have no value: its red is negative, which says that it
/// takes no part where colours are interpolated (`glsl/shared/albedo.glsl`).
pub(crate) fn marked([red, green, blue]: [f32; 3]) -> [f32; 3] {
    [-red, green, blue]
}

/// How many of the colours are marked.
pub(crate) fn count_marked(colors: &[[f32; 3]]) -> u64 {
    colors.iter().filter(|color| color[0] < 0.0).count() as u64
}

/// Points of an object that lack a value that is shown.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Missing {
    /// Name of the object.
    pub object: String,
    /// What they lack.
    pub what: Lacking,
    /// How many lack it.
    pub points: u64,
    /// Points of the object.
    pub of: u64,
}

/// What points lack.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Lacking {
    /// A colour of their own.
    Color,
    /// The attribute that is shown as a colour.
    Attribute(String),
    /// The attribute that is the radius of spheres or discs.
    Radius(String),
    /// The scalar of a volume, or what else its kernel takes of a point.
    Scalar(String),
}

impl fmt::Display for Missing {
    /// One sentence, without its end.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { object, what, points, of } = self;
        write!(f, "object '{object}': {points} of {of} points have ")?;
        match what {
            Lacking::Color => {
                write!(f, "no colour (NaN) and are drawn in that of objects without, 0.8")
            }
            Lacking::Attribute(name) => {
                write!(f, "no '{name}' (NaN) and are drawn in purple, (0.5, 0, 0.5) in linear RGB")
            }
            Lacking::Radius(name) => {
                write!(
                    f,
                    "no radius ('{name}' is negative, over 1e12 scene units, or NaN) and are not drawn"
                )
            }
            Lacking::Scalar(name) => {
                write!(f, "no finite '{name}' or reach and take no part in the volume")
            }
        }
    }
}
