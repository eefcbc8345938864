//! Volumes whose points do not have what is shown of them, or lie on a skin only.

use super::Asked;
use crate::field;
use kernels::layout::{
    CELL_NOTHING, VOLUME_EMISSION, VOLUME_ISOSURFACE, VOLUME_SHEPARD, VolumeInfo,
};
use points::Dimension;
use rayon::prelude::*;
use scene::Transfer;
use std::collections::HashSet;
use std::ops::Range;

/// Sums are the greatest near points; over the greatest at a point, what may be between.
const BETWEEN: f64 = 1.5;
/// Points at which sums are taken.
const MOST_SUMS: usize = 1 << 17;
/// Fewer points, and fewer cells of a reach with points, say nothing of a skin.
const FEWEST_POINTS: usize = 512;
const FEWEST_CELLS: usize = 200;
/// Part of the cells with points around which all six neighbours have some: of skins less.
const INNER: f64 = 0.03;

/// A number for a message.
fn plain(x: f64) -> String {
    format!("{:?}", x as f32)
}

/// Warnings of isosurfaces and transfer functions that lie beside the data.
pub(super) fn without_values(of: &Asked<'_>) -> Vec<String> {
    let volumes = &of.plan.volumes;
    let mut found = Vec::new();
    for (info, range) in volumes.point_ranges() {
        let index = info.object as usize;
        let name = of.name(index);
        let Some(volume) = &of.scene.objects[index].volume else { continue };
        let scalar = &volume.scalar;
        let values = || volumes.points[range.clone()].iter().map(|point| f64::from(point.scalar));
        let low = values().fold(f64::INFINITY, f64::min);
        let high = values().fold(f64::NEG_INFINITY, f64::max);
        let is_mean = info.kernel == VOLUME_SHEPARD;
        if info.mode == VOLUME_ISOSURFACE {
            let iso = f64::from(info.iso);
            let reached =
                if is_mean { high } else { BETWEEN * greatest_sum(of, info, range.clone()) };
            if iso >= reached || (is_mean && iso <= low) {
                let known = match is_mean {
                    true => format!("'{scalar}' goes from {} to {}", plain(low), plain(high)),
                    false => {
                        format!("the sum of '{scalar}' goes to about {}", plain(reached / BETWEEN))
                    }
                };
                let number = match is_mean {
                    true => 0.5 * (low + high),
                    false => 0.5 * reached / BETWEEN,
                };
                found.push(format!(
                    "object '{name}' is not seen: no place has its isosurface's scalar, {}, since {known}; set \
                     objects.{index}.volume.iso to e.g. {}",
                    plain(iso),
                    plain(number)
                ));
            }
            continue;
        }
        // The coarsest grid by size knows of all points.
        let cells =
            info.first_cell as usize..info.first_cell as usize + info.grid.cell_count() as usize;
        let is_empty = volumes.cells[cells].iter().all(|cell| cell.counts == CELL_NOTHING);
        if info.mode == VOLUME_EMISSION && is_empty {
            let known = match is_mean {
                true => format!("which go from {} to {}", plain(low), plain(high)),
                false => "as its kernel sums them up".to_owned(),
            };
            let advice = match &volume.transfer {
                Some(Transfer::Map { range: Some(_), extinction, .. })
                    if *extinction != [0.0; 2] =>
                {
                    format!("leave objects.{index}.volume.value_range out")
                }
                Some(Transfer::Map { .. }) => {
                    format!("raise objects.{index}.volume.extinction, e.g. to [0.0, 5.0]")
                }
                _ => format!(
                    "give one of them an extinction over 0 in objects.{index}.volume.transfer"
                ),
            };
            found.push(format!(
                "object '{name}' is not seen: its transfer function is transparent for all values of '{scalar}', {known}; \
                 {advice}"
            ));
        }
    }
    found
}

/// The greatest sum of a kernel at one of the points, or at many.
fn greatest_sum(of: &Asked<'_>, info: &VolumeInfo, range: Range<usize>) -> f64 {
    let volumes = &of.plan.volumes;
    let sum_at = |place: [f32; 3]| {
        let mut sum = 0.0;
        field::for_each_near(volumes, info, place.map(f64::from), |other, weight, _, _| {
            sum += weight * f64::from(volumes.points[other].scalar);
        });
        sum
    };
    let step = range.len().div_ceil(MOST_SUMS).max(1);
    let places: Vec<[f32; 3]> =
        volumes.points[range].iter().step_by(step).map(|point| point.position).collect();
    places.into_par_iter().map(sum_at).reduce(|| 0.0, f64::max)
}

/// Warnings of volumes whose points lie on a surface.
pub(super) fn of_skins(of: &Asked<'_>) -> Vec<String> {
    let mut found = Vec::new();
    for (info, range) in of.plan.volumes.point_ranges() {
        let index = info.object as usize;
        if info.mode == VOLUME_ISOSURFACE || !is_skin(of, info, range) {
            continue;
        }
        let name = of.name(index);
        let reach = plain(f64::from(info.square_radius).sqrt());
        found.push(format!(
            "object '{name}': the points of its volume lie on a surface, so that only a skin about it, {reach} thick to \
             each side, shows anything; leave objects.{index}.volume out to see the surface, or take points that fill \
             the inside"
        ));
    }
    found
}

/// Whether points lie on a surface, by how they lie among each other and by the cells that they fill.
fn is_skin(of: &Asked<'_>, info: &VolumeInfo, range: Range<usize>) -> bool {
    if range.len() < FEWEST_POINTS {
        return false;
    }
    let points = &of.plan.volumes.points[range];
    let edge = info.square_radius.sqrt();
    let cell = |position: [f32; 3]| {
        [0, 1, 2].map(|axis| ((position[axis] - info.grid.origin[axis]) / edge).floor() as i32)
    };
    let cells: HashSet<[i32; 3]> = points.iter().map(|point| cell(point.position)).collect();
    let is_inner = |at: &&[i32; 3]| {
        (0..3).all(|axis| {
            [-1, 1].iter().all(|step| {
                let mut next = **at;
                next[axis] += step;
                cells.contains(&next)
            })
        })
    };
    let inner = cells.iter().filter(is_inner).count();
    cells.len() >= FEWEST_CELLS
        && (inner as f64) < INNER * cells.len() as f64
        && !Dimension::of(&of.sets[info.object as usize]).is_volume()
}
