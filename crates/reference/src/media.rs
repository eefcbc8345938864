//! Twin of `glsl/shared/media.glsl`: the objects that a ray is inside, and which of them counts
//! (Schmidt and Budge, Simple Nested Dielectrics in Ray Traced Images, 2002).

use crate::real::{Real, V3};
use kernels::layout::{CHANNELS_ALL, MEDIA_WORDS, ObjectInfo};

/// A ray inside more forgets the last that it entered.
const MOST_MEDIA: usize = 2 * MEDIA_WORDS as usize;

/// The glass objects that a ray is inside.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Media(Vec<u32>);

/// Which way a ray goes through a surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Way {
    /// Into the object, unless it is inside.
    Either,
    /// Into it: into one more of its spheres.
    In,
    /// Out of it, or of one of its spheres.
    Out,
}

/// A ray's way through the surface of a glass object.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Crossing {
    /// The medium that it comes from.
    pub before: Option<u32>,
    /// The one that it would go on in.
    pub after: Option<u32>,
}

fn outranks(a: u32, b: u32, objects: &[ObjectInfo]) -> bool {
    let rank = |object: u32| (objects[object as usize].priority, object);
    rank(a) > rank(b)
}

impl Media {
    /// Inside of these.
    #[must_use]
    pub fn of(objects: &[u32]) -> Self {
        Self(objects.to_vec())
    }

    /// Whether the ray is outside everything.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The member of the highest priority, apart from `skipped`.
    fn medium_without(&self, skipped: Option<u32>, objects: &[ObjectInfo]) -> Option<u32> {
        let others = self.0.iter().copied().filter(|&member| Some(member) != skipped);
        others.reduce(|best, member| if outranks(member, best, objects) { member } else { best })
    }

    /// Whether the ray is inside an object.
    #[must_use]
    pub fn contains(&self, object: u32) -> bool {
        self.0.contains(&object)
    }

    /// The medium that the ray is in.
    #[must_use]
    pub fn medium(&self, objects: &[ObjectInfo]) -> Option<u32> {
        self.medium_without(None, objects)
    }

    /// What entering or leaving an object means. Spheres of an object that overlap are one body.
    #[must_use]
    pub fn crossing(&self, object: u32, way: Way, objects: &[ObjectInfo]) -> Crossing {
        let others = self.medium_without(Some(object), objects);
        let rules = others.is_none_or(|other| outranks(object, other, objects));
        let with = if rules { Some(object) } else { others };
        let times = self.0.iter().filter(|&&member| member == object).count();
        match way {
            Way::Either if times > 0 => Crossing { before: with, after: others },
            Way::Either => Crossing { before: others, after: with },
            Way::In => Crossing { before: if times > 0 { with } else { others }, after: with },
            Way::Out => Crossing { before: with, after: if times > 1 { with } else { others } },
        }
    }

    /// Only the members that stay, in their order.
    pub fn retain(&mut self, stays: impl Fn(u32) -> bool) {
        self.0.retain(|&member| stays(member));
    }

    /// The same after the object is entered or left.
    #[must_use]
    pub fn toggled(&self, object: u32) -> Self {
        self.through(object, Way::Either)
    }

    /// The same after the object, or one of its spheres, is entered or left.
    #[must_use]
    pub fn through(&self, object: u32, way: Way) -> Self {
        let mut members = self.0.clone();
        let place = members.iter().position(|&member| member == object);
        match (place, way) {
            (Some(place), Way::Either | Way::Out) => {
                members.swap_remove(place);
            }
            (None, Way::Either) | (_, Way::In) if members.len() < MOST_MEDIA => {
                members.push(object);
            }
            _ => {}
        }
        Self(members)
    }
}

/// The refractive index of each channel.
pub fn ior_of(medium: Option<u32>, objects: &[ObjectInfo]) -> [f32; 3] {
    medium.map_or([1.0; 3], |object| objects[object as usize].ior)
}

impl Crossing {
    /// Whether a ray of these channels goes through as if there were nothing: the medium stays, or has the same index.
    #[must_use]
    pub fn passes(&self, channels: u32, objects: &[ObjectInfo]) -> bool {
        let [before, after] = [self.before, self.after].map(|medium| ior_of(medium, objects));
        let bent =
            |channel: usize| channels >> channel & 1 != 0 && before[channel] != after[channel];
        self.before == self.after || !(0..3).any(bent)
    }

    /// Whether a ray becomes one a channel here.
    #[must_use]
    pub fn splits(&self, channels: u32, objects: &[ObjectInfo]) -> bool {
        let disperses = |medium| {
            let [red, green, blue] = ior_of(medium, objects);
            red != green || green != blue
        };
        channels & CHANNELS_ALL == CHANNELS_ALL && (disperses(self.before) || disperses(self.after))
    }
}

/// What of the light comes through a way inside a medium.
pub fn transmittance<R: Real>(medium: Option<u32>, way: R, objects: &[ObjectInfo]) -> V3<R> {
    let absorption = medium.map_or([0.0; 3], |object| objects[object as usize].absorption);
    V3(V3::of_f32(absorption).times(way).0.map(|depth| (-depth).exp_negative()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use bytemuck::Zeroable;

    fn objects(priorities: [i32; 3]) -> Vec<ObjectInfo> {
        // No two of one index.
        let glass = |at: usize| ObjectInfo {
            priority: priorities[at],
            ior: [1.1 + 0.1 * at as f32; 3],
            ..ObjectInfo::zeroed()
        };
        [0, 1, 2].map(glass).to_vec()
    }

    /// A ball (0) half under water (1): under water the ball's surface counts, and inside the ball the
    /// water's does not.
    #[test]
    fn inside_the_object_of_higher_priority_others_are_passed_through() {
        let objects = objects([5, 2, 0]);
        let water = Media::default().toggled(1);
        let crossing = water.crossing(0, Way::Either, &objects);
        assert_eq!((crossing.before, crossing.after), (Some(1), Some(0)));
        let both = water.toggled(0);
        assert_eq!(both.medium(&objects), Some(0));
        assert!(
            both.crossing(1, Way::Either, &objects).passes(CHANNELS_ALL, &objects),
            "the water's surface inside the ball"
        );
        let ball = both.toggled(1);
        assert_eq!(
            ball.crossing(0, Way::Either, &objects),
            Crossing { before: Some(0), after: None }
        );
    }

    #[test]
    fn equal_priorities_go_to_the_last_in_the_scene() {
        let objects = objects([0, 0, 0]);
        let media = Media::default().toggled(2).toggled(0);
        assert_eq!(media.medium(&objects), Some(2));
        assert!(media.crossing(1, Way::Either, &objects).passes(CHANNELS_ALL, &objects));
        assert_eq!(media.toggled(2).crossing(1, Way::Either, &objects).after, Some(1));
    }

    /// Into a sphere, into another that overlaps it, out of the first, out of the second: glass begins and ends once.
    #[test]
    fn overlapping_spheres_are_one_body() {
        let objects = objects([0, 0, 0]);
        let steps = [Way::In, Way::In, Way::Out, Way::Out];
        let mut media = Media::default();
        let crossings = steps.map(|way| {
            let crossing = media.crossing(1, way, &objects);
            media = media.through(1, way);
            crossing
        });
        let [first, second, third, last] = crossings;
        assert_eq!(first, Crossing { before: None, after: Some(1) });
        assert!(second.passes(CHANNELS_ALL, &objects) && third.passes(CHANNELS_ALL, &objects));
        assert_eq!(last, Crossing { before: Some(1), after: None });
        assert!(media.is_empty());
        assert!(media.through(1, Way::Out).is_empty(), "out of what it was never in");
    }

    #[test]
    fn the_set_never_grows_beyond_its_words() {
        let full = (0..20).fold(Media::default(), |media, object| media.toggled(object));
        assert_eq!(full.0.len(), MOST_MEDIA);
        assert_eq!(full.toggled(3).0.len(), MOST_MEDIA - 1);
    }

    /// Glass of index 1 in air, and glass in glass of its index; by channel, where only some agree.
    #[test]
    fn media_of_one_index_have_no_surface_between_them() {
        let mut objects = objects([0, 1, 2]);
        (objects[0].ior, objects[1].ior, objects[2].ior) = ([1.0; 3], [1.5; 3], [1.5, 1.5, 1.6]);
        let passes =
            |before, after, channels| Crossing { before, after }.passes(channels, &objects);
        assert!(passes(None, Some(0), CHANNELS_ALL) && !passes(None, Some(1), CHANNELS_ALL));
        assert!(!passes(Some(1), Some(2), CHANNELS_ALL));
        assert!(passes(Some(1), Some(2), 1) && passes(Some(2), Some(1), 2));
        assert!(!passes(Some(1), Some(2), 4));
    }
}
