//! Spheres and discs: which slots are drawn as such, how large, and how discs lie.

use crate::PlanError;
use crate::bulk::World;
use crate::chosen::Findings;
use crate::colors::attribute_values;
use crate::missing::{Lacking, Missing};
use crate::neighborhoods::{at_most, in_batches, length, vectors};
use kernels::layout::Point;
use points::neighbors::median_spacing;
use points::{Cloud, FARTHEST, NeighborSearch, PointSet, SlotRange, Watch, bounds_of};
pub use points::{ShapeKind, Shapes};
use rayon::prelude::*;
use scene::{Object, RadiusOf, Scatter, Scene, ShapeRadius, SurfaceKind};
use std::sync::Arc;

/// Of half the diagonal of a scene's box: spheres and discs that reach farther are framed with their extents, unless
/// they are very many.
const LARGE: f64 = 0.01;
const MOST_LARGE: usize = 1 << 16;
/// Of the radius: places so far out, in 26 directions, have the whole sphere in their hull, and perspective's outline.
const FRAMED: f64 = 1.1;
/// Of `auto`, over the median distance between nearest points; of `local`, over the mean distance of so many others.
const SHARE: f64 = 0.5;
const LOCAL: usize = 4;
/// Normals of a file that are shorter say nothing.
const SHORTEST: f32 = 1e-6;

/// The slots of an object that carry its surface: those before its shapes.
pub(crate) fn surface_slots(cloud: &Cloud, shapes: &[Shapes], object: usize) -> SlotRange {
    let all = cloud.objects[object];
    let own = shapes.iter().filter(|shapes| shapes.object as usize == object);
    SlotRange { count: all.count - own.map(|shapes| shapes.count).sum::<u32>(), ..all }
}

/// What points of an object are drawn as that lie on no surface; `None`: they are not drawn. A disc of glass would have
/// no inside.
#[must_use]
pub fn scatter_kind(object: &Object) -> Option<ShapeKind> {
    match (object.surface.scatter, object.material.kind.has_inside()) {
        (Scatter::Drop, _) => None,
        (Scatter::Discs, false) => Some(ShapeKind::Disc),
        (Scatter::Spheres, _) | (Scatter::Discs, true) => Some(ShapeKind::Sphere),
    }
}

/// The points that a picture is framed by, and their box: those of the objects, and the extents of shapes that are large
/// beside the scene. Grounds are none of these.
pub(crate) fn with_extents(
    (scene, shapes): (&Scene, &[Shapes]),
    cloud: &Cloud,
    world: &[World],
) -> (Vec<World>, [[f64; 3]; 2]) {
    let [low, high] = cloud.bounds;
    let half = [0, 1, 2].map(|axis| 0.5 * (high[axis] - low[axis]));
    let large = LARGE * half.iter().map(|side| side * side).sum::<f64>().sqrt();
    let all = shapes
        .iter()
        .filter(|shapes| !scene.objects[shapes.object as usize].is_ground())
        .flat_map(|shapes| cloud.points[shapes.slots().range()].iter().zip(&shapes.radii));
    let reaching: Vec<_> = all.filter(|(_, radius)| f64::from(**radius) > large).collect();
    let mut framed = world.to_vec();
    if reaching.is_empty() || reaching.len() > MOST_LARGE {
        return (framed, cloud.bounds);
    }
    let sides = (0..27).map(|i| [i / 9, i / 3 % 3, i % 3].map(|side| f64::from(side) - 1.0));
    let directions = sides.filter(|v| length(*v) > 0.0).map(|v| v.map(|x| x / length(v)));
    let directions: Vec<[f64; 3]> = directions.collect();
    let extents_of = |(point, radius): (&Point, &f32)| {
        let (position, reach) = (point.position, FRAMED * f64::from(*radius));
        let from = |axis: usize| f64::from(position[axis]) + cloud.origin[axis];
        let center = [0, 1, 2].map(from);
        let reached = move |v: &[f64; 3]| [0, 1, 2].map(|axis| center[axis] + reach * v[axis]);
        directions.iter().map(reached).collect::<Vec<_>>()
    };
    let extents: Vec<[f64; 3]> = reaching.into_iter().flat_map(extents_of).collect();
    let bounds = bounds_of([&[low, high][..], &extents]).unwrap_or(cloud.bounds);
    framed.push(Arc::new(extents));
    (framed, bounds)
}

/// The objects of which all points are spheres or discs.
pub(crate) fn whole_objects(
    scene: &Scene,
    sets: &[Arc<PointSet>],
    cloud: &Cloud,
    (watch, found): (&dyn Watch, &mut Findings),
) -> Result<Vec<Shapes>, PlanError> {
    let mut all = Vec::new();
    for (index, (object, set)) in scene.objects.iter().zip(sets).enumerate() {
        let (kind, radius) = match &object.surface.kind {
            SurfaceKind::Points => continue,
            SurfaceKind::Spheres(radius) => (ShapeKind::Sphere, radius),
            SurfaceKind::Discs(radius) => (ShapeKind::Disc, radius),
        };
        let slots = cloud.objects[index];
        let SlotRange { first_slot, count } = slots;
        if count == 0 {
            continue;
        }
        let radii = match radius.of {
            RadiusOf::LocalSpacing => {
                let spacings = local_spacings(&cloud.points[slots.range()], watch)?;
                let of = |spacing: f64| (SHARE * spacing * radius.scale).min(FARTHEST) as f32;
                spacings.into_iter().map(of).collect()
            }
            _ => {
                let counts = |place| cloud.counts(index, place);
                cloud.by_slot(index, &radii((index, object), set, radius, counts, found)?)
            }
        };
        let normals = set.normals.as_ref().filter(|_| kind == ShapeKind::Disc);
        all.push(Shapes {
            object: index as u32,
            first_slot,
            count,
            kind,
            radii,
            normals: normals.map(|normals| cloud.by_slot(index, &turned(object, normals))),
        });
    }
    Ok(all)
}

/// The radius of each point in scene units; 0 where it has none, which is counted.
fn radii(
    (index, object): (usize, &Object),
    set: &PointSet,
    radius: &ShapeRadius,
    counts: impl Fn(usize) -> bool,
    found: &mut Findings,
) -> Result<Vec<f32>, PlanError> {
    let scale = object.transform.scale;
    let one = |length: f64| vec![(length * radius.scale).min(FARTHEST) as f32; set.len()];
    let name = match &radius.of {
        RadiusOf::Length(length) => return Ok(one(*length)),
        // One place has no spacing, and is not drawn.
        RadiusOf::Spacing | RadiusOf::LocalSpacing => {
            let spacing = median_spacing(&set.positions);
            let length = spacing.map_or(0.0, |spacing| SHARE * spacing * scale);
            if length > 0.0 {
                found.number(index, "surface.radius", length);
            }
            return Ok(one(length));
        }
        RadiusOf::Attribute(name) => name,
    };
    let values = attribute_values(set, name).map_err(|known| PlanError::NoRadii {
        name: object.name.clone(),
        attribute: name.clone(),
        file: object.points.display().to_string(),
        known,
    })?;
    let is_radius = |length: &f64| (0.0..=FARTHEST).contains(length);
    let lengths: Vec<f64> = values.into_iter().map(|value| value * scale * radius.scale).collect();
    let counted = || lengths.iter().enumerate().filter(|(place, _)| counts(*place));
    let points = counted().filter(|(_, length)| !is_radius(length)).count() as u64;
    if points > 0 {
        let what = Lacking::Radius(name.clone());
        found.missing.push(Missing {
            object: object.name.clone(),
            what,
            points,
            of: counted().count() as u64,
        });
    }
    Ok(lengths
        .into_iter()
        .map(|length| if is_radius(&length) { length as f32 } else { 0.0 })
        .collect())
}

/// The mean distance from each of an object's points to its four nearest others among them, or to as many as there are.
fn local_spacings(points: &[Point], watch: &dyn Watch) -> Result<Vec<f64>, PlanError> {
    watch.stage("measuring distances of points", points.len() as u64);
    let k = at_most(LOCAL, points.len());
    let search = NeighborSearch::new(points, 0);
    let mut spacings = Vec::with_capacity(points.len());
    in_batches(points.len(), watch, |batch| {
        let lists = search.nearest(batch.clone(), k);
        let mean = |(list, slot): (&[u32], usize)| {
            let (sum, others) = vectors(points, slot, list)
                .fold((0.0, 0.0f64), |(sum, others), v| (sum + length(v), others + 1.0));
            sum / others.max(1.0)
        };
        spacings.par_extend(lists.par_chunks(k).zip(batch).map(mean));
    })?;
    Ok(spacings)
}

/// Normals of a file in the world, of unit length; zero where one is no direction.
fn turned(object: &Object, normals: &[[f32; 3]]) -> Vec<[f32; 3]> {
    let turn = |normal: &[f32; 3]| {
        let v = object.transform.rotate(normal.map(f64::from));
        let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let says = length >= f64::from(SHORTEST) && length.is_finite();
        if says { v.map(|x| (x / length) as f32) } else { [0.0; 3] }
    };
    normals.par_iter().map(turn).collect()
}
