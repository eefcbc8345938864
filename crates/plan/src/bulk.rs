//! What a scene is framed, centred and measured by: its points without strays ([`points::Strays`]).

use crate::ground::{Standing, below};
use crate::shapes::scatter_kind;
use crate::{PlanError, isolated};
use points::{
    Apart, Cloud, CloudError, ObjectPoints, PointSet, Strays, Watch, bounds_of, origin_of,
    rough_origin,
};
use rayon::prelude::*;
use scene::{Neighbors, Object, Scene, SurfaceKind};
use std::sync::Arc;

/// Strays among particles that lie this part of the bulk's diagonal outside it, or less, are in the picture as well.
const RIM: f64 = 0.05;

/// Positions in the world of the points of an object.
pub(crate) type World = Arc<Vec<[f64; 3]>>;

/// The points of all objects without strays, and without those that `drop_isolated` drops.
pub(crate) struct Bulk {
    pub sets: Vec<Arc<PointSet>>,
    pub world: Vec<World>,
    /// What volumes are made of, and what is drawn as spheres or discs: strays as well where they lie no farther than
    /// the bulk's diagonal from its box. A droplet counts; a grid of cells over empty space is of no use.
    pub particles: Vec<(Arc<PointSet>, World)>,
    /// Of surfaces whose noise is smoothed: all points that are no farther off, with which of them are strays.
    with_strays: Vec<Option<(Arc<PointSet>, Vec<bool>)>>,
    pub apart: Vec<(usize, Apart)>,
    /// How many isolated points each object lost.
    pub isolated: Vec<u64>,
    /// Points of all objects, strays included.
    pub point_count: u64,
    bounds: [[f64; 3]; 2],
    /// Along a Hilbert curve, where that is the cloud's.
    orders: Vec<Option<Vec<u32>>>,
}

impl Bulk {
    /// `files` are the sets as read, in the coordinates of their files; grounds have none, and get theirs here, across
    /// the axis nearest to `up`. Fails where `drop_isolated` meets points that
    /// f32 cannot bear, or the watcher asks for an end.
    pub(crate) fn of(
        scene: &Scene,
        sets: &[Arc<PointSet>],
        (files, up): (&[Arc<PointSet>], [f64; 3]),
        watch: &dyn Watch,
    ) -> Result<Self, PlanError> {
        watch.stage("looking for strays", sets.iter().map(|set| set.len() as u64).sum());
        let placed = |(object, set): (&Object, &Arc<PointSet>)| Arc::new(placed(object, set));
        let world: Vec<World> = scene.objects.iter().zip(sets).map(placed).collect();
        let all: Vec<&[[f64; 3]]> = world.iter().map(|world| &world[..]).collect();
        let origin = rough_origin(&all).ok_or(CloudError::Empty)?;
        let mut found = Vec::new();
        let mut done = 0;
        for world in all {
            let strays = Strays::find_watched(world, origin, watch, done);
            found.push(strays.ok_or(PlanError::Interrupted)?);
            done += world.len() as u64;
            watch.done(done);
        }
        let mut bulk = Self {
            sets: Vec::new(),
            world: Vec::new(),
            particles: Vec::new(),
            with_strays: Vec::new(),
            apart: Vec::new(),
            isolated: Vec::new(),
            point_count: 0,
            bounds: [[0.0; 3]; 2],
            orders: Vec::new(),
        };
        for (index, (object, strays)) in scene.objects.iter().zip(found).enumerate() {
            bulk.add(object, strays, (&sets[index], &world[index], &files[index]));
            match object.is_ground() {
                true => bulk.isolated.push(0),
                false => bulk.drop_isolated(object, watch)?,
            }
        }
        bulk.bounds =
            bounds_of(bulk.world.iter().map(|world| &world[..])).ok_or(CloudError::Empty)?;
        bulk.add_grounds(scene, up);
        if origin_of(bulk.bounds) != origin {
            bulk.orders.fill(None);
        }
        Ok(bulk)
    }

    /// The points of grounds, below those of all other objects. They do not count for the bounds.
    fn add_grounds(&mut self, scene: &Scene, up: [f64; 3]) {
        for (index, ground) in scene.objects.iter().enumerate().filter(|(_, one)| one.is_ground()) {
            let standing = (scene.objects.iter().enumerate())
                .filter(|(_, object)| !object.is_ground())
                .map(|(other, object)| {
                    let is_surface = object.surface.kind == SurfaceKind::Points;
                    let (set, world) = match is_surface {
                        true => (&self.sets[other], &self.world[other]),
                        false => (&self.particles[other].0, &self.particles[other].1),
                    };
                    Standing { object, set, world }
                });
            let standing: Vec<Standing<'_>> = standing.collect();
            let up = ground.ground_up().unwrap_or_else(|| Object::nearest_axis(up));
            let set = Arc::new(below(&standing, up));
            let world: World = Arc::new(placed(ground, &set));
            self.point_count += set.len() as u64;
            self.particles[index] = (Arc::clone(&set), Arc::clone(&world));
            (self.sets[index], self.world[index], self.orders[index]) = (set, world, None);
        }
    }

    /// Positions in the world of the objects that are no ground.
    pub(crate) fn without_grounds(&self, scene: &Scene) -> Vec<World> {
        let all = scene.objects.iter().zip(&self.world);
        all.filter(|(object, _)| !object.is_ground()).map(|(_, world)| Arc::clone(world)).collect()
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
            self.with_strays.push(None);
            return;
        }
        let index = self.sets.len();
        let [low, high] = strays.bulk;
        let sides = [0, 1, 2].map(|axis| high[axis] - low[axis]);
        let diagonal = sides.iter().map(|side| side * side).sum::<f64>().sqrt();
        let without = |places: &[u32]| {
            let mut keep = vec![true; world.len()];
            places.iter().for_each(|&place| keep[place as usize] = false);
            kept(set, world, &keep)
        };
        let is_volume = object.volume.is_some() || object.surface.kind != SurfaceKind::Points;
        // Of the particles at the rim nothing is lost.
        if !is_volume || strays.farthest > RIM * diagonal {
            let apart = strays.apart(index, &file.positions);
            self.apart.push((index, Apart { is_volume, ..apart }));
        }
        let (bulk_set, bulk_world) = without(&strays.places);
        let far = |&&place: &&u32| strays.distance(&world[place as usize]) > diagonal;
        let far: Vec<u32> = strays.places.iter().filter(far).copied().collect();
        self.with_strays.push(draws_strays(object).then(|| {
            let mut keep = vec![true; set.len()];
            far.iter().for_each(|&place| keep[place as usize] = false);
            let mut is_stray = vec![false; set.len()];
            strays.places.iter().for_each(|&place| is_stray[place as usize] = true);
            let is_stray = is_stray.iter().zip(&keep).filter(|(_, keep)| **keep);
            (Arc::new(set.filtered(|i| keep[i])), is_stray.map(|(is_stray, _)| *is_stray).collect())
        }));
        self.particles.push(match (is_volume, far.is_empty()) {
            (false, _) => (Arc::clone(&bulk_set), Arc::clone(&bulk_world)),
            (true, true) => all,
            (true, false) => without(&far),
        });
        self.sets.push(bulk_set);
        self.world.push(bulk_world);
        self.orders.push(None);
    }

    /// The points of an object with those of its strays that are drawn if it has noise, and which these are.
    pub(crate) fn near_strays(&self, object: usize) -> Option<&(Arc<PointSet>, Vec<bool>)> {
        self.with_strays[object].as_ref()
    }

    /// Drops the isolated points of the last object, where it asks for that: after its strays, since one of these makes
    /// the deviations so large that no other point is beyond them.
    fn drop_isolated(&mut self, object: &Object, watch: &dyn Watch) -> Result<(), PlanError> {
        let index = self.isolated.len();
        self.isolated.push(0);
        let deviations = object.surface.drop_isolated;
        if deviations > 0.0 {
            let set = &self.sets[index];
            let keep =
                isolated::near_points(set, object.surface.neighbors.count(), deviations, watch)?;
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

    /// The points of an object that are drawn: strays say nothing about a surface, but each sphere stands for itself.
    pub(crate) fn drawn(&self, scene: &Scene, index: usize) -> &Arc<PointSet> {
        match scene.objects[index].surface.kind {
            SurfaceKind::Points => &self.sets[index],
            SurfaceKind::Spheres(_) | SurfaceKind::Discs(_) => &self.particles[index].0,
        }
    }

    /// The cloud of what is drawn: of each object these points, which are all of its bulk or some.
    pub(crate) fn cloud(
        &self,
        scene: &Scene,
        surfaces: &[Arc<PointSet>],
        watch: &dyn Watch,
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
        Cloud::within(self.bounds, &object_points, watch)
    }
}

/// Whether strays are drawn, if the points have noise.
fn draws_strays(object: &Object) -> bool {
    let is_smoothed = matches!(object.surface.neighbors, Neighbors::Auto { .. });
    let is_surface = object.volume.is_none() && object.surface.kind == SurfaceKind::Points;
    is_smoothed
        && is_surface
        && object.surface.drop_isolated == 0.0
        && scatter_kind(object).is_some()
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
