//! 3D Gaussians (Kerbl et al., 3D Gaussian Splatting for Real-Time Radiance Field Rendering, 2023) in
//! the vertices of a PLY file: their numbers as others expect them.
//!
//! The constant term of the spherical harmonics becomes a colour; the terms that depend on the
//! view, and normals, which are zeros, are left out. Opacity and scales are stored by their logit and
//! logarithm, and become what they stand for.

use crate::field::{Field, Type};

/// The constant spherical harmonic, 1 / (2 √π).
const HARMONIC: f64 = 0.282_094_791_773_878_14;
const COLOR: [(&str, &str); 3] = [("f_dc_0", "red"), ("f_dc_1", "green"), ("f_dc_2", "blue")];
const OPACITY: &str = "opacity";

/// How vertices become rows.
pub(super) struct Gaussians {
    pub(super) fields: Vec<Field>,
    columns: Vec<(usize, Meaning)>,
}

#[derive(Clone, Copy)]
enum Meaning {
    Itself,
    Harmonic,
    Logit,
    Logarithm,
}

impl Gaussians {
    /// `None` if vertices with these fields are no Gaussians.
    pub(super) fn of(vertex: &[Field]) -> Option<Self> {
        let has = |name: &str| vertex.iter().any(|field| field.name == name);
        if !COLOR.iter().all(|(name, _)| has(name)) || !has(OPACITY) {
            return None;
        }
        let (mut fields, mut columns) = (Vec::new(), Vec::new());
        for (place, field) in vertex.iter().enumerate() {
            let name = field.name.as_str();
            if name.starts_with("f_rest_") || ["nx", "ny", "nz"].contains(&name) {
                continue;
            }
            let color = COLOR.iter().find(|(stored, _)| *stored == name);
            let (name, meaning) = match color {
                Some((_, color)) => (*color, Meaning::Harmonic),
                None if name == OPACITY => (name, Meaning::Logit),
                None if name.starts_with("scale_") => (name, Meaning::Logarithm),
                None => (name, Meaning::Itself),
            };
            let kind = if color.is_some() { Type::F32 } else { field.kind };
            fields.push(Field::new(name, kind));
            columns.push((place, meaning));
        }
        Some(Self { fields, columns })
    }

    /// The row of a vertex.
    pub(super) fn fill(&self, vertex: &[f64], row: &mut Vec<f64>) {
        row.clear();
        row.extend(self.columns.iter().map(|&(place, meaning)| {
            let value = vertex[place];
            match meaning {
                Meaning::Itself => value,
                Meaning::Harmonic => (0.5 + HARMONIC * value).clamp(0.0, 1.0),
                Meaning::Logit => 1.0 / (1.0 + (-value).exp()),
                Meaning::Logarithm => value.exp(),
            }
        }));
    }
}
