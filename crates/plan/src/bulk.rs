//! What a scene is framed, centred and measured by: its points without strays ([`points::Strays`]).

use crate::{PlanError, isolated};
use points::{
    Cloud, CloudError, ObjectPoints, PointSet, Strays, Watch, bounds_of, origin_of, rough_origin,
};
use rayon::prelude::*;
use scene::{Object, Scene};
use std::fmt;
use std::sync::Arc;

/// Positions in the world of the points of an object.
pub(crate) type World = Arc<Vec<[f64; 3]>>;

/// The strays of an object, in words that a message needs.
#[derive(Debug, Clone, PartialEq)]
pub struct Apart {
    /// Index of the object.
    pub object: usize,
    /// How many there are.
    pub count: u64,
    /// Of how many points.
    pub of: u64,
    /// How far the farthest lies from the box around all others, in scene units; 0 where none lies outside.
    pub farthest: f64,
    /// The longest side of that box.
    pub size: f64,
    /// The option of the command line that leaves out those that lie outside it, if any do.
    pub filter: Option<String>,
}

impl fmt::Display for Apart {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { count, of, farthest, size, filter, .. } = self;
        let (lie, they, show, count_not) = match count {
            1 => ("lies", "it", "shows", "does"),
            _ => ("lie", "they", "show", "do"),
        };
        write!(f, "{count} of {of} points {lie} far from all others")?;
        if *farthest > 0.0 {
            let [farthest, size] = [short(*farthest), short(*size)];
            write!(f, ", up to {farthest} outside the rest, which is {size} wide")?;
        }
        write!(f, "; {they} {show} no surface and {count_not} not count for the view")?;
        match filter {
            Some(filter) => write!(f, "; {filter} leaves out what lies outside"),
            None => Ok(()),
        }
    }
}

/// A length to three digits, without an exponent where it needs none.
fn short(length: f64) -> String {
    let exponent = length.abs().log10().floor();
    match (-4.0..=6.0).contains(&exponent) {
        true => format!("{length:.*}", (2.0 - exponent).max(0.0) as usize),
        false => format!("{length:.2e}"),
    }
}

/// The points of all objects without strays, and without those that `drop_isolated` drops.
pub(crate) struct Bulk {
    pub sets: Vec<Arc<PointSet>>,
    pub world: Vec<World>,
    /// What volumes are made of: strays as well where they lie no farther than the bulk's diagonal from its box. A
    /// droplet counts; a grid of cells over empty space is of no use.
    pub particles: Vec<(Arc<PointSet>, World)>,
    pub apart: Vec<Apart>,
    /// How many isolated points each object lost.
    pub isolated: Vec<u64>,
    /// Points of all objects, strays included.
    pub point_count: u64,
    bounds: [[f64; 3]; 2],
    /// Along a Hilbert curve, where that is the cloud's.
    orders: Vec<Option<Vec<u32>>>,
}

impl Bulk {
    /// `files` are the sets as read, in the coordinates of their files. Fails where `drop_isolated` meets points that
    /// f32 cannot bear, or the watcher asks for an end.
    pub(crate) fn of(
        scene: &Scene,
        sets: &[Arc<PointSet>],
        files: &[Arc<PointSet>],
        watch: &dyn Watch,
    ) -> Result<Self, PlanError> {
        watch.stage("sorting points", sets.iter().map(|set| set.len() as u64).sum());
        let placed = |(object, set): (&Object, &Arc<PointSet>)| Arc::new(placed(object, set));
        let world: Vec<World> = scene.objects.iter().zip(sets).map(placed).collect();
        let all: Vec<&[[f64; 3]]> = world.iter().map(|world| &world[..]).collect();
        let origin = rough_origin(&all).ok_or(CloudError::Empty)?;
        let mut found = Vec::new();
        let mut done = 0;
        for world in all {
            if watch.interrupted() {
                return Err(PlanError::Interrupted);
            }
            found.push(Strays::find(world, origin));
            done += world.len() as u64;
            watch.done(done);
        }
        let mut bulk = Self {
            sets: Vec::new(),
            world: Vec::new(),
            particles: Vec::new(),
            apart: Vec::new(),
            isolated: Vec::new(),
            point_count: 0,
            bounds: [[0.0; 3]; 2],
            orders: Vec::new(),
        };
        for (index, (object, strays)) in scene.objects.iter().zip(found).enumerate() {
            bulk.add(object, strays, (&sets[index], &world[index], &files[index]));
            bulk.drop_isolated(object, watch)?;
        }
        bulk.bounds =
            bounds_of(bulk.world.iter().map(|world| &world[..])).ok_or(CloudError::Empty)?;
        if origin_of(bulk.bounds) != origin {
            bulk.orders.fill(None);
        }
        Ok(bulk)
    }

    fn add(
        &mut self,
        object: &Object,
        strays: Strays,
        (set, world, file): (&Arc<PointSet>, &World, &PointSet),
    ) {
        self.point_count += set.len() as u64;
        let all = (Arc::clone(set), Arc::clone(world));
        if strays.places.is_empty() {
            self.sets.push(Arc::clone(set));
            self.world.push(Arc::clone(world));
            self.particles.push(all);
            self.orders.push(Some(strays.order));
            return;
        }
        let [low, high] = strays.bulk;
        let sides = [0, 1, 2].map(|axis| high[axis] - low[axis]);
        let diagonal = sides.iter().map(|side| side * side).sum::<f64>().sqrt();
        self.apart.push(Apart {
            object: self.sets.len(),
            count: strays.places.len() as u64,
            of: world.len() as u64,
            farthest: strays.farthest,
            size: sides.into_iter().fold(0.0, f64::max),
            filter: strays.filter(self.sets.len(), &file.positions),
        });
        let without = |places: &[u32]| {
            let mut keep = vec![true; world.len()];
            places.iter().for_each(|&place| keep[place as usize] = false);
            kept(set, world, &keep)
        };
        let (bulk_set, bulk_world) = without(&strays.places);
        let far = |&&place: &&u32| strays.distance(&world[place as usize]) > diagonal;
        let far: Vec<u32> = strays.places.iter().filter(far).copied().collect();
        self.particles.push(match (object.volume.is_some(), far.is_empty()) {
            (false, _) => (Arc::clone(&bulk_set), Arc::clone(&bulk_world)),
            (true, true) => all,
            (true, false) => without(&far),
        });
        self.sets.push(bulk_set);
        self.world.push(bulk_world);
        self.orders.push(None);
    }

    /// Drops the isolated points of the last object, where it asks for that: after its strays, since one of these makes
    /// the deviations so large that no other point is beyond them.
    fn drop_isolated(&mut self, object: &Object, watch: &dyn Watch) -> Result<(), PlanError> {
        let index = self.isolated.len();
        self.isolated.push(0);
        let deviations = object.surface.drop_isolated;
        if deviations > 0.0 {
            let set = &self.sets[index];
            let keep = isolated::near_points(set, object.surface.neighbors, deviations, watch)?;
            let dropped = keep.iter().filter(|keep| !**keep).count();
            if dropped > 0 {
                let (set, world) = kept(set, &self.world[index], &keep);
                self.isolated[index] = dropped as u64;
                self.point_count -= dropped as u64;
                self.particles[index] = (Arc::clone(&set), Arc::clone(&world));
                self.sets[index] = set;
                self.world[index] = world;
                self.orders[index] = None;
            }
        }
        Ok(())
    }

    /// The cloud of what carries a surface: of each object these points, which are all of its bulk or some.
    pub(crate) fn cloud(
        &self,
        scene: &Scene,
        surfaces: &[Arc<PointSet>],
    ) -> Result<Cloud, CloudError> {
        let is_whole = |index: usize| Arc::ptr_eq(&self.sets[index], &surfaces[index]);
        let world: Vec<World> = (scene.objects.iter().zip(surfaces).enumerate())
            .map(|(index, (object, surface))| match is_whole(index) {
                true => Arc::clone(&self.world[index]),
                false => Arc::new(placed(object, surface)),
            })
            .collect();
        let object_points: Vec<ObjectPoints<'_>> = (world.iter().zip(surfaces).enumerate())
            .map(|(index, (positions, surface))| ObjectPoints {
                positions,
                file_index: &surface.file_index,
                order: self.orders[index].as_deref().filter(|_| is_whole(index)),
            })
            .collect();
        Cloud::within(self.bounds, &object_points)
    }
}

/// The points of a set that are to be kept, with their places in the world.
fn kept(set: &PointSet, world: &World, keep: &[bool]) -> (Arc<PointSet>, World) {
    let positions = world.iter().zip(keep).filter(|&(_, keep)| *keep).map(|(&p, _)| p);
    (Arc::new(set.filtered(|i| keep[i])), Arc::new(positions.collect()))
}

/// The points of an object in the world.
fn placed(object: &Object, set: &PointSet) -> Vec<[f64; 3]> {
    let positions = set.positions.par_iter().with_min_len(1 << 14);
    positions.map(|&p| object.transform.apply(p)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_short() {
        let of = [6.905_1, 590.14, 4.627e6, 1e30, 0.004_29, 2.0, 1e-9, 123_456.0].map(short);
        assert_eq!(
            of,
            ["6.90", "590", "4627000", "1.00e30", "0.00429", "2.00", "1.00e-9", "123456"]
        );
    }

    #[test]
    fn the_line_says_how_many_lie_how_far_off() {
        let one = Apart {
            object: 0,
            count: 1,
            of: 501,
            farthest: 590.1,
            size: 2.0,
            filter: Some("F".into()),
        };
        assert_eq!(
            one.to_string(),
            "1 of 501 points lies far from all others, up to 590 outside the rest, which is 2.00 wide; it shows \
             no surface and does not count for the view; F leaves out what lies outside"
        );
        let inside = Apart { count: 3, farthest: 0.0, filter: None, ..one };
        assert_eq!(
            inside.to_string(),
            "3 of 501 points lie far from all others; they show no surface and do not count for the view"
        );
    }
}
