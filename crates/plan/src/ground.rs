//! The ground below the other objects of a scene (`points = "@ground"`): one disc.

use crate::bulk::World;
use crate::colors::attribute_values;
use glam::DVec3;
use points::neighbors::median_spacing;
use points::{Attribute, PointSet, Values, bounds_of};
use scene::{Object, RadiusOf, ShapeRadius, SurfaceKind};

/// Radius of the disc, over the diagonal of the box around the other objects.
const WIDE: f64 = 8.0;
/// How far below the lowest point it lies, over that diagonal: surfaces pass their points at a small distance.
const BELOW: f64 = 1e-3;

/// An object that stands on the ground: its points in its file's coordinates and in the world.
pub(crate) struct Standing<'a> {
    pub object: &'a Object,
    pub set: &'a PointSet,
    pub world: &'a World,
}

/// The point of a disc below all of these, `up` being a unit vector; with its normal, and its radius as the attribute `radius`.
pub(crate) fn below(all: &[Standing<'_>], up: [f64; 3]) -> PointSet {
    let up = DVec3::from(up);
    let Some([low, high]) = bounds_of(all.iter().map(|one| &one.world[..])) else {
        return PointSet::default();
    };
    let [low, high] = [low, high].map(DVec3::from);
    let diagonal = (high - low).length();
    // One place has no size.
    let size = if diagonal > 0.0 { diagonal } else { 1.0 };
    let lowest = all.iter().map(|one| lowest_of(one, up)).fold(f64::INFINITY, f64::min);
    let middle = 0.5 * low + 0.5 * high;
    let place = middle + (lowest - BELOW * size - middle.dot(up)) * up;
    PointSet {
        positions: vec![place.into()],
        file_index: vec![0],
        normals: Some(vec![up.as_vec3().into()]),
        attributes: vec![Attribute {
            name: "radius".to_owned(),
            values: Values::F64(vec![WIDE * size]),
        }],
        ..PointSet::default()
    }
}

/// How high the lowest place of an object is, spheres included.
fn lowest_of(one: &Standing<'_>, up: DVec3) -> f64 {
    let scale = one.object.transform.scale;
    let radius = match &one.object.surface.kind {
        SurfaceKind::Spheres(radius) => Some(radius),
        SurfaceKind::Points | SurfaceKind::Discs(_) => None,
    };
    let spacing = || 0.5 * scale * median_spacing(&one.set.positions).unwrap_or_default();
    let radii = radius.and_then(|ShapeRadius { of, .. }| match of {
        RadiusOf::Attribute(name) => attribute_values(one.set, name).ok(),
        _ => None,
    });
    let same = radius.map_or(0.0, |ShapeRadius { of, scale }| {
        scale
            * match of {
                RadiusOf::Length(length) => *length,
                RadiusOf::Spacing | RadiusOf::LocalSpacing => spacing(),
                RadiusOf::Attribute(_) => 0.0,
            }
    });
    let factor = scale * radius.map_or(1.0, |radius| radius.scale);
    let reach = |place: usize| {
        let own = radii.as_ref().and_then(|radii| radii.get(place)).copied().unwrap_or_default();
        if own.is_finite() { same + own * factor } else { same }
    };
    let heights = one.world.iter().enumerate();
    heights.map(|(place, p)| DVec3::from(*p).dot(up) - reach(place)).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    fn object(surface: &str) -> Object {
        let text = format!("[[objects]]\npoints = \"a.ply\"\nsurface = {surface}\n");
        let scene = scene::Scene::from_toml(&text, std::path::Path::new("a.toml"), &[]);
        scene.expect("a scene").objects.remove(0)
    }

    /// Its place in the world, normal and radius.
    fn ground(surface: &str, positions: &[[f64; 3]], up: [f64; 3]) -> ([f64; 3], [f32; 3], f64) {
        let set = PointSet { positions: positions.to_vec(), ..PointSet::default() };
        let world: World = Arc::new(positions.to_vec());
        let object = object(surface);
        let found = below(&[Standing { object: &object, set: &set, world: &world }], up);
        let radius = found.attribute("radius").and_then(|values| values.iter().next());
        let normal = found.normals.expect("normals")[0];
        (found.positions[0], normal, radius.expect("a radius"))
    }

    /// Of a box of 2 by 3 by 6, whose diagonal is 7. In f64 all of it is exact to a few units of the last place.
    #[test]
    fn it_lies_under_the_lowest_point_of_each_axis() {
        let places = [[0.0, 0.0, 0.0], [2.0, 3.0, 6.0], [1.0, 1.0, 2.0]];
        for (up, place) in [
            ([0.0, 1.0, 0.0], [1.0, -0.007, 3.0]),
            ([0.0, -1.0, 0.0], [1.0, 3.007, 3.0]),
            ([0.0, 0.0, 1.0], [1.0, 1.5, -0.007]),
        ] {
            let (found, normal, radius) = ground("{}", &places, up);
            assert!((DVec3::from(found) - DVec3::from(place)).length() < 1e-12, "{found:?}");
            assert_eq!(normal.map(f64::from), up);
            assert!((radius - 56.0).abs() < 1e-12);
            let spheres = "{ kind = \"spheres\", radius = 0.5, radius_scale = 2.0 }";
            let (under, ..) = ground(spheres, &places, up);
            let lower = (DVec3::from(found) - DVec3::from(under)).dot(DVec3::from(up));
            assert!((lower - 1.0).abs() < 1e-12, "{lower}");
        }
    }
}
