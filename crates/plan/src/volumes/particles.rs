//! Particles with smoothing lengths of their own.

use super::attribute;
use crate::PlanError;
use points::PointSet;
use scene::{Object, PerParticle};

/// What a particle reaches by, in scene units, and what its kernel is multiplied by.
pub(super) struct Particle {
    /// Without an end where no smoothing length is its own.
    pub(super) length: f64,
    pub(super) scalar: f64,
}

/// How particles of smoothed particle hydrodynamics are given.
pub(super) struct Sph<'a> {
    pub(super) smoothing_length: &'a PerParticle,
    pub(super) mass: Option<&'a PerParticle>,
    pub(super) density: Option<&'a str>,
}

impl Sph<'_> {
    /// h over the side of a particle's volume, where no mass says more (Price 2012, with η = 1.2).
    const SPACING: f64 = 1.2;

    /// A (m/ρ) / (π h³) of each point, with m/ρ and h in one unit of length.
    pub(super) fn particles(
        &self,
        object: &Object,
        set: &PointSet,
        scalars: &[f64],
    ) -> Result<Vec<Particle>, PlanError> {
        let scale = object.transform.scale;
        let of = |what: &PerParticle, unit: f64| -> Result<Vec<f64>, PlanError> {
            Ok(match what {
                PerParticle::Number(number) => vec![*number; scalars.len()],
                PerParticle::Attribute(name) => {
                    attribute(object, set, name)?.into_iter().map(|value| value * unit).collect()
                }
            })
        };
        let lengths = of(self.smoothing_length, scale)?;
        let masses = self.mass.map(|mass| of(mass, 1.0)).transpose()?;
        let densities = self.density.map(|name| attribute(object, set, name)).transpose()?;
        let scalar = |i: usize| {
            let h = lengths[i];
            // The volume over h³, times the scalar.
            let carried = match (&masses, &densities) {
                (None, _) => scalars[i] / Self::SPACING.powi(3),
                (Some(m), Some(rho)) => m[i] / rho[i] * scalars[i] * (scale / h).powi(3),
                (Some(m), None) => m[i] * (scale / h).powi(3),
            };
            Particle { length: h, scalar: carried / std::f64::consts::PI }
        };
        Ok((0..scalars.len()).map(scalar).collect())
    }
}
