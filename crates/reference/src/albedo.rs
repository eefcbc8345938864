//! Twin of `glsl/shared/albedo.glsl`: the share of light that the surface of an object scatters back.

use crate::around::points_around;
use crate::blend::weight_at;
use crate::grid_build::CellLists;
use crate::image::Images;
use crate::levels::Levels;
use crate::polynomial::Polynomial;
use crate::real::{Real, V3};
use kernels::layout::{NONE, ObjectInfo};
use std::ops::Range;

const MOST_ASKED: usize = 2048;

/// What albedos depend on.
#[derive(Debug, Clone, Copy)]
pub struct Albedos<'a, R> {
    /// Where the grids lie.
    pub levels: &'a Levels<R>,
    /// The points of each cell.
    pub lists: &'a CellLists,
    /// By slot.
    pub polynomials: &'a [Polynomial<R>],
    /// One an object.
    pub objects: &'a [ObjectInfo],
    /// Three floats a point of each object that has colours, two where it has a texture.
    pub colors: &'a [f32],
    /// Textures and environment.
    pub images: Images<'a>,
}

impl<R: Real> Albedos<'_, R> {
    fn value_of(&self, object: &ObjectInfo, slot: u32) -> V3<R> {
        let stride = if object.texture == NONE { 3 } else { 2 };
        let at = (object.first_color + stride * (slot - object.first_slot)) as usize;
        let mut value = [0.0; 3];
        value[..stride as usize].copy_from_slice(&self.colors[at..at + stride as usize]);
        V3::of_f32(value)
    }

    /// Whether a point of the object has no value: its red is negative.
    fn has_none(&self, object: &ObjectInfo, slot: u32) -> bool {
        let at = (object.first_color + 3 * (slot - object.first_slot)) as usize;
        object.texture == NONE && self.colors[at] < 0.0
    }

    /// The mean over the points of the object around x that have a value; where none has a weight, or the
    /// point that was hit has no value, or is a sphere or disc, what that has.
    fn blended_value(&self, object: &ObjectInfo, slot: u32, x: V3<R>) -> V3<R> {
        let slots = slots_of(object);
        let own = self.value_of(object, slot);
        if self.has_none(object, slot) {
            let V3([red, green, blue]) = own;
            return V3([R::of(0.0) - red, green, blue]);
        }
        if !slots.contains(&slot) {
            return own;
        }
        let own = (own.times(R::of(1e-6)), R::of(1e-6));
        let around =
            points_around(self.levels, self.lists, self.polynomials, x, slots.clone(), MOST_ASKED);
        let (sum, weights) = around
            .iter()
            .filter(|near| slots.contains(near) && !self.has_none(object, **near))
            .map(|&near| (near, &self.polynomials[near as usize]))
            .fold(own, |(sum, weights), (near, p)| {
                let (weight, _) = weight_at(p, x);
                (sum + self.value_of(object, near).times(weight), weights + weight)
            });
        sum.over(weights)
    }

    /// The albedo at x of the object at `index`, whose point at `slot` was hit.
    #[must_use]
    pub fn albedo_at(&self, index: u32, slot: u32, x: V3<R>) -> V3<R> {
        let object = &self.objects[index as usize];
        let value = (object.first_color != NONE).then(|| self.blended_value(object, slot, x));
        if object.texture == NONE {
            return value.unwrap_or_else(|| V3::of_f32(object.albedo));
        }
        let along =
            |[x, y, z, w]: [f32; 4], at: V3<R>| V3::of_f32([x, y, z]).dot(at) + R::of_f32(w);
        let [u, v, _] = value.map_or_else(
            || [along(object.texture_u, x), along(object.texture_v, x), R::of(0.0)],
            |value| value.0,
        );
        let image = &self.images.infos[object.texture as usize];
        self.images.image_at(image, u, v, false)
    }
}

/// The slots of an object's points that carry its surface: its spheres and discs come after these.
#[must_use]
pub fn slots_of(object: &ObjectInfo) -> Range<u32> {
    object.first_slot..object.first_slot + object.slot_count
}
