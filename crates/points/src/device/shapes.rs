//! The passes `shape_spheres` and `shape_discs`.

use super::line;
use super::work::Work;
use crate::{ShapeKind, Shapes};
use gpu::{Buffer, Device, GpuError};
use kernels::layout::{
    FitOutcome, NORMALS, OUTCOMES, POINTS, POLYNOMIALS, Point, Polynomial, RADII, ShapeParams,
};
use kernels::spirv::{self, Module};
use std::sync::Arc;

/// Shapes of one dispatch.
const BATCH: u32 = 1 << 17;
/// The buffers by slot are bound from multiples of so many, which begin where a part of a buffer may.
const BOUND_FROM: u32 = 64;

/// What the passes work on, by slot.
pub(crate) struct ShapeBuffers<'a> {
    pub points: &'a Buffer,
    pub polynomials: &'a Buffer,
    pub outcomes: &'a Buffer,
}

/// Writes the polynomials and outcomes of all shapes. Where discs have no normals, planes were fitted before.
pub(crate) fn write_shapes(
    device: &Arc<Device>,
    rec: &mut Work,
    io: &ShapeBuffers<'_>,
    all: &[Shapes],
) -> Result<(), GpuError> {
    for kind in [ShapeKind::Sphere, ShapeKind::Disc] {
        for shapes in all.iter().filter(|shapes| shapes.kind == kind && shapes.count > 0) {
            write_batches(device, rec, io, shapes)?;
        }
    }
    Ok(())
}

/// The modules that these shapes take, to be [made ahead](gpu::Kernel::make_ahead).
#[must_use]
pub fn modules_of_shapes(all: &[Shapes]) -> Vec<&'static Module> {
    let kinds = [ShapeKind::Sphere, ShapeKind::Disc];
    let any = |kind: &ShapeKind| all.iter().any(|shapes| shapes.kind == *kind && shapes.count > 0);
    kinds.into_iter().filter(any).map(module_of).collect()
}

fn module_of(kind: ShapeKind) -> &'static Module {
    match kind {
        ShapeKind::Sphere => spirv::shape_spheres(),
        ShapeKind::Disc => spirv::shape_discs(),
    }
}

fn write_batches(
    device: &Arc<Device>,
    rec: &mut Work,
    io: &ShapeBuffers<'_>,
    shapes: &Shapes,
) -> Result<(), GpuError> {
    for first in (0..shapes.count).step_by(BATCH as usize) {
        let count = BATCH.min(shapes.count - first);
        let first_slot = shapes.first_slot + first;
        let bound_from = first_slot - first_slot % BOUND_FROM;
        let part = |stride: usize| {
            let [from, end] = [bound_from, first_slot + count];
            let [from, end] = [from, end].map(|slot| u64::from(slot) * stride as u64);
            [from, end - from]
        };
        let own = first as usize..(first + count) as usize;
        let radii = Buffer::from_slice(device, "radii", &shapes.radii[own.clone()])?;
        let normals = match &shapes.normals {
            Some(normals) => Some(Buffer::from_slice(device, "disc normals", &normals[own])?),
            None => None,
        };
        let (points, polynomials) = (part(size_of::<Point>()), part(size_of::<Polynomial>()));
        let outcomes = part(size_of::<FitOutcome>());
        let params = ShapeParams {
            first_slot,
            count,
            object: shapes.object,
            bound_from,
            has_normals: u32::from(normals.is_some()),
        };
        let mut pass = rec
            .pass(module_of(shapes.kind))
            .buffer_part(POINTS, io.points, points[0], points[1])
            .buffer(RADII, &radii)
            .buffer_part(POLYNOMIALS, io.polynomials, polynomials[0], polynomials[1])
            .buffer_part(OUTCOMES, io.outcomes, outcomes[0], outcomes[1]);
        if shapes.kind == ShapeKind::Disc {
            // Without normals, nothing is read of these.
            pass = pass.buffer(NORMALS, normals.as_ref().unwrap_or(&radii));
        }
        pass.push(&params).dispatch(line(count));
        rec.submit()?;
    }
    Ok(())
}
