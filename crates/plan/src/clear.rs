//! Surfaces that light passes on its way: all of glass, or those between media of one index (docs/method.md, section 6).

use crate::Plan;
use crate::materials::has_inside;
use kernels::layout::{LIGHT_POINT, Light, ObjectInfo, PASSED_NEAR, VOLUME_ISOSURFACE, VolumeInfo};
use points::{Cloud, Shapes};
use scene::{Integrator, Shadows};

/// Of the diagonal of an object's points: how far its surface may reach beyond their box.
const MARGIN: f64 = 0.05;

/// Whether a channel of both has one index.
fn share_an_index(a: [f32; 3], b: [f32; 3]) -> bool {
    (0..3).any(|channel| a[channel] == b[channel])
}

/// Whether glass may meet a medium of its own index anywhere.
fn may_be_clear(objects: &[ObjectInfo]) -> bool {
    let glass: Vec<[f32; 3]> =
        objects.iter().filter(|object| has_inside(object)).map(|object| object.ior).collect();
    (glass.iter().enumerate()).any(|(i, &ior)| {
        share_an_index(ior, [1.0; 3]) || glass[..i].iter().any(|&other| share_an_index(ior, other))
    })
}

/// Whether there is glass that light passes: any, where it goes straight on; else such as borders on air of its own index,
/// or may on other glass of its own index: where their boxes meet.
pub(crate) fn lets_light_pass(
    shadows: Shadows,
    objects: &[ObjectInfo],
    cloud: &Cloud,
    shapes: &[Shapes],
) -> bool {
    let glass: Vec<usize> = (0..objects.len()).filter(|&at| has_inside(&objects[at])).collect();
    if shadows == Shadows::Tinted {
        return !glass.is_empty();
    }
    if glass.iter().any(|&at| share_an_index(objects[at].ior, [1.0; 3])) {
        return true;
    }
    if !may_be_clear(objects) {
        return false;
    }
    let boxes: Vec<[[f64; 3]; 2]> = glass.iter().map(|&at| box_of(at, cloud, shapes)).collect();
    let meet = |a: &[[f64; 3]; 2], b: &[[f64; 3]; 2]| {
        (0..3).all(|axis| a[0][axis] <= b[1][axis] && b[0][axis] <= a[1][axis])
    };
    (0..glass.len()).any(|i| {
        (0..i).any(|j| {
            let [a, b] = [i, j].map(|at| objects[glass[at]].ior);
            share_an_index(a, b) && meet(&boxes[i], &boxes[j])
        })
    })
}

/// The box that holds an object's surface; without points, which isosurfaces have none of, it may be anywhere.
fn box_of(object: usize, cloud: &Cloud, shapes: &[Shapes]) -> [[f64; 3]; 2] {
    let points = &cloud.points[cloud.objects[object].range()];
    if points.is_empty() {
        return [[f64::NEG_INFINITY; 3], [f64::INFINITY; 3]];
    }
    let own = shapes.iter().filter(|shapes| shapes.object as usize == object);
    let radius = own.flat_map(|shapes| &shapes.radii).fold(0.0f32, |most, &r| most.max(r));
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for point in points {
        for axis in 0..3 {
            low[axis] = low[axis].min(f64::from(point.position[axis]));
            high[axis] = high[axis].max(f64::from(point.position[axis]));
        }
    }
    let diagonal: f64 = (0..3).map(|axis| (high[axis] - low[axis]).powi(2)).sum::<f64>().sqrt();
    let margin = MARGIN * diagonal + f64::from(radius);
    [low.map(|x| x - margin), high.map(|x| x + margin)]
}

/// Whether a light may go straight on through glass. Where light goes from surface to surface, paths find those with an
/// extent, refracted as they are, and glass blocks the straight way to them.
pub(crate) fn shines_through(light: &Light, integrator: Integrator) -> bool {
    let is_hard = light.extent == 0.0 && light.kind <= LIGHT_POINT;
    integrator != Integrator::Path || is_hard
}

impl Plan {
    /// Whether glass may meet a medium of its own index.
    pub(crate) fn may_be_clear(&self) -> bool {
        may_be_clear(&self.objects)
    }

    /// Whether light of this number goes straight on through glass, rather than only between media of one index.
    #[must_use]
    pub fn tints(&self, light: u32) -> bool {
        let light = self.lights.get(light as usize);
        self.shadows == Shadows::Tinted
            && light.is_some_and(|light| shines_through(light, self.integrator))
    }

    /// Whether light of this number goes on through isosurfaces, of which some are of glass.
    #[must_use]
    pub fn passes_isosurfaces(&self, light: u32) -> bool {
        let of_glass = |info: &VolumeInfo| {
            info.mode == VOLUME_ISOSURFACE && has_inside(&self.objects[info.object as usize])
        };
        self.tints(light) && self.volumes.infos.iter().any(of_glass)
    }

    /// Whether light for the points of a volume may pass the surface of the volume's own object as it passes others.
    pub(crate) fn may_pass_own_surface(&self) -> bool {
        self.volumes.any_lit() && (0..self.lights.len() as u32).any(|light| self.tints(light))
    }

    /// What light of this number for the points of an object's volume passes, as kernels take it: the object's own surface,
    /// or, where light can pass it as other surfaces, what of it is near the point that asks.
    #[must_use]
    pub fn passed_of(&self, object: u32, light: u32) -> u32 {
        let own = &self.objects[object as usize];
        let clear = || self.tints(light) || share_an_index(own.ior, [1.0; 3]);
        if self.light_passes && has_inside(own) && clear() { object | PASSED_NEAR } else { object }
    }
}
