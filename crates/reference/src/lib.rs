//! The kernels' twins on the CPU, generic over f32 and f64. No Vulkan here.
//!
//! One source: in f32 it must give lavapipe's pixels to the bit, which the end-to-end tests check;
//! in f64 it says how far both are from the truth. It is also what renders where no Vulkan exists.
#![forbid(unsafe_code)]

pub mod accumulate;
pub mod albedo;
mod around;
mod batch;
pub mod blend;
mod block;
pub mod camera_rays;
mod direction;
pub mod disc;
pub mod disc_bin;
pub mod disc_trace;
pub mod eigen;
pub mod environment;
mod film;
pub mod fit;
pub mod fit_polynomials;
pub mod gap;
pub mod grid;
pub mod grid_build;
pub mod grid_trace;
pub mod image;
pub mod isosurface;
pub mod least_squares;
pub mod levels;
pub mod light;
pub mod march;
mod material;
pub mod media;
pub mod optics;
mod path;
pub mod point_lights;
pub mod polynomial;
pub mod projection;
pub mod real;
pub mod refine;
pub mod rim;
pub mod sampler;

pub mod shape;
mod sky;
mod steps;
pub mod surface_hit;
mod to_light;
pub mod volume;
mod wave;

use accumulate::accumulate;
use albedo::slots_of;
use bytemuck::Zeroable;
use camera_rays::Ray;
use disc_bin::{DiscLists, disc_bin};
use fit_polynomials::Fitted;
use grid_build::CellLists;
use grid_trace::grid_trace;
use kernels::layout::{FilmPixel, FitOutcome, FitParams, VOLUME_LIGHTS};
use levels::Levels;
use plan::{CENTER, Picture, Plan, Rays, StructureKind, Window};
use point_lights::point_lights;
use points::{Cloud, Grids, NeighborSearch, Rims, SlotRange, Watch, plan_grids};
use polynomial::Polynomial;
use rayon::prelude::*;
use real::Real;
use refine::{PointCells, Refined, Surroundings};
use std::borrow::Cow;
use surface_hit::{Hit, surface_hit};
use wave::PixelTrace;

/// Points fitted, and rows of pixels traced, between two looks at the watcher.
const FIT_BATCH: usize = 1 << 14;
const ROWS: usize = 16;

/// A scene on the CPU, ready to be traced.
#[derive(Debug)]
pub struct Reference<R> {
    /// By slot.
    pub polynomials: Vec<Polynomial<R>>,
    /// How each fit ended, by slot.
    pub outcomes: Vec<FitOutcome>,
    /// Where the grids lie.
    pub grids: Grids,
    /// The points of each cell.
    pub lists: CellLists,
    /// The points of each cell, each once; empty where nothing is refined.
    pub point_cells: PointCells,
    /// Of the points of all volumes: how much of each light's reaches them; empty where no volume is lit.
    pub visible: Vec<[R; VOLUME_LIGHTS as usize]>,
}

/// The fits of all points, by slot, and the rims among them; `None` where the watcher asked for an end. The
/// neighbours come from a k-d tree: what preparation on the CPU costs.
#[must_use]
pub fn fit_surfaces<R: Real>(plan: &Plan, watch: &dyn Watch) -> Option<(Vec<Fitted<R>>, Rims)> {
    let cloud = &plan.cloud;
    let mut fitted: Vec<Fitted<R>> = Vec::with_capacity(cloud.points.len());
    let mut rims = Rims::default();
    for (object, params) in (0u32..).zip(&plan.fits) {
        fit_points(cloud, params, (&mut fitted, &mut rims), watch)?;
        for shapes in plan.shapes.iter().filter(|shapes| shapes.object == object) {
            let mut planes = Vec::new();
            if let Some(params) = shapes.plane_fit() {
                fit_points(cloud, &params, (&mut planes, &mut rims), watch)?;
            }
            fitted.extend(shape::shapes_of(&cloud.points, shapes, &planes));
        }
    }
    Some((fitted, rims))
}

/// Adds the fits of some points of an object, by slot, and the rims among them; `None` where the watcher asked for an
/// end.
fn fit_points<R: Real>(
    cloud: &Cloud,
    params: &FitParams,
    (fitted, rims): (&mut Vec<Fitted<R>>, &mut Rims),
    watch: &dyn Watch,
) -> Option<()> {
    if params.point_count > 0 {
        let slots = SlotRange { first_slot: params.first_slot, count: params.point_count };
        let range = slots.range();
        let search = NeighborSearch::new(&cloud.points[range.clone()], slots.first_slot);
        let k = params.neighbors as usize;
        let smoothed = match params.feature_size < 0.0 {
            true => Some(Smoothed::smooth_sizes(&search, range.len(), k, watch)?),
            false => None,
        };
        watch.stage("fitting surfaces", cloud.points.len() as u64);
        watch.done(fitted.len() as u64);
        for first in (0..range.len()).step_by(FIT_BATCH) {
            if watch.interrupted() {
                return None;
            }
            let batch = first..range.len().min(first + FIT_BATCH);
            let lists = match &smoothed {
                Some(all) => Cow::Borrowed(&all.lists[batch.start * k..batch.end * k]),
                None => Cow::Owned(search.nearest(batch.clone(), k)),
            };
            let fits: Vec<_> = lists
                .par_chunks(k)
                .zip(range.start + first..range.start + batch.end)
                .map(|(list, slot)| {
                    let size = smoothed.as_ref().map(|all| all.sizes[slot - range.start]);
                    fit_polynomials::fit_polynomial(&cloud.points, slot, list, params, size)
                })
                .collect();
            let slots = (range.start + first) as u32..;
            for ((slot, fit), list) in slots.zip(&fits).zip(lists.chunks(k)) {
                let fit: &Fitted<R> = fit;
                if Rims::is_open(&fit.rim) {
                    rims.add(slot, &fit.rim, list);
                }
            }
            fitted.extend(fits);
            watch.done(fitted.len() as u64);
        }
    }
    Some(())
}

/// The neighbours of all points of an object, and the sizes that those say.
struct Smoothed {
    lists: Vec<u32>,
    sizes: Vec<f32>,
}

impl Smoothed {
    /// Twin of `smooth_sizes`; `None` where the watcher asked for an end.
    fn smooth_sizes(
        search: &NeighborSearch<'_>,
        count: usize,
        k: usize,
        watch: &dyn Watch,
    ) -> Option<Self> {
        watch.stage("measuring feature sizes", count as u64);
        let mut lists = Vec::with_capacity(count * k);
        for first in (0..count).step_by(FIT_BATCH) {
            if watch.interrupted() {
                return None;
            }
            lists.extend(search.nearest(first..count.min(first + FIT_BATCH), k));
            watch.done((lists.len() / k) as u64);
        }
        let each = || lists.par_chunks(k).enumerate();
        let reaches: Vec<f32> = each().map(|(at, list)| search.reach(at, list)).collect();
        let size = |(at, list)| search.smoothed_size(at, list, &reaches);
        let sizes = each().map(size).collect();
        Some(Self { lists, sizes })
    }
}

impl<R: Real> Reference<R> {
    /// Fits the surfaces of a plan and builds the grid; `None` where the watcher asked for an end.
    #[must_use]
    pub fn new(plan: &Plan, watch: &dyn Watch) -> Option<Self> {
        let cloud = &plan.cloud;
        let (fitted, rims) = fit_surfaces::<R>(plan, watch)?;
        let outcomes: Vec<FitOutcome> = fitted
            .iter()
            .map(|fit| FitOutcome {
                trust: fit.polynomial.trust.to_f32(),
                kind: fit.kind,
                feature_size: fit.feature_size.to_f32(),
            })
            .collect();
        let mut polynomials: Vec<Polynomial<R>> =
            fitted.into_iter().map(|fit| fit.polynomial).collect();
        watch.stage("building the grid", cloud.points.len() as u64);
        let grids = plan_grids(
            &cloud.points,
            &outcomes,
            plan.grid_resolution,
            plan.takes(StructureKind::Tree),
        );
        let point_cells = if plan.refines() {
            grid_build::list_points(&grids, &polynomials, &cloud.order)
        } else {
            PointCells::default()
        };
        rim::clip_balls(&mut polynomials, &rims.clips(&cloud.points, &outcomes));
        let lists = grid_build::build_grids(&grids, &polynomials, &cloud.order, watch);
        polynomials.extend(plan.volumes.stand_ins().iter().map(Polynomial::from));
        let visible = Vec::new();
        let mut reference = Self { polynomials, outcomes, grids, lists, point_cells, visible };
        reference.visible = point_lights(&reference, plan, watch)?;
        Some(reference)
    }

    /// Traces one picture of the plan that this was made for; `None` where the watcher asked for an
    /// end.
    #[must_use]
    pub fn frame(&self, plan: &Plan, watch: &dyn Watch) -> Option<Picture> {
        let mut picture = plan.picture();
        let samples = u64::from(plan.samples) + u64::from(plan.takes_centers());
        watch.stage("tracing", plan.window.pixels() as u64 * samples);
        let mut done = 0;
        for tile in plan.tiles() {
            let discs = self.bin_discs(plan, &tile);
            for first in (0..tile.size[1]).step_by(ROWS) {
                let rows = Window {
                    origin: [tile.origin[0], tile.origin[1] + first],
                    size: [tile.size[0], (ROWS as u32).min(tile.size[1] - first)],
                };
                let centers =
                    plan.takes_centers().then(|| self.trace(plan, &rows, CENTER, discs.as_ref()).0);
                done += if centers.is_some() { rows.pixels() as u64 } else { 0 };
                let (pixels, traced) =
                    self.sampled(plan, &rows, discs.as_ref(), watch, &mut done)?;
                picture.put(plan, &self.outcomes, &rows, (&pixels, centers.as_deref()));
                picture.rays += traced;
            }
        }
        Some(picture)
    }

    /// The pixels of one window with all their samples; `done` counts rays.
    fn sampled(
        &self,
        plan: &Plan,
        window: &Window,
        discs: Option<&DiscLists>,
        watch: &dyn Watch,
        done: &mut u64,
    ) -> Option<(Vec<FilmPixel>, Rays)> {
        let (mut pixels, mut sums, mut rays) = (Vec::new(), Vec::new(), Rays::default());
        for sample in 0..plan.samples {
            if watch.interrupted() {
                return None;
            }
            let traced = self.trace(plan, window, sample, discs);
            pixels = traced.0;
            rays += traced.1;
            if plan.samples > 1 {
                accumulate(&mut sums, &mut pixels, sample, plan.samples);
            }
            *done += window.pixels() as u64;
            watch.done(*done);
        }
        Some((pixels, rays))
    }

    /// The points of each screen tile of a tile of the picture, if it is to be traced by discs and
    /// they are not too many.
    #[must_use]
    pub fn bin_discs(&self, plan: &Plan, tile: &Window) -> Option<DiscLists> {
        let params = plan.discs_of(tile, &self.grids);
        plan.by_discs(tile).then(|| disc_bin(&params, &self.polynomials)).flatten()
    }

    /// One sample of the pixels of one window, row by row, and the rays that it took; through the grid, or, inside a tile of the
    /// picture whose discs are given, by them. [`CENTER`] is not followed beyond the first surface, unless the plan asks.
    #[must_use]
    pub fn trace(
        &self,
        plan: &Plan,
        window: &Window,
        sample: u32,
        discs: Option<&DiscLists>,
    ) -> (Vec<FilmPixel>, Rays) {
        let levels = Levels::<R>::from(&self.grids);
        let (camera, params) = (plan.camera_of(window, sample), plan.wave_of(window, sample));
        let albedos = albedo::Albedos {
            levels: &levels,
            lists: &self.lists,
            polynomials: &self.polynomials,
            objects: &plan.objects,
            colors: &plan.colors,
            images: image::Images { infos: &plan.images, texels: &plan.texels },
        };
        let traced: Vec<(FilmPixel, Rays)> = (0..window.size[0] * window.size[1])
            .into_par_iter()
            .map(|i| {
                let pixel = [i % window.size[0], i / window.size[0]];
                let in_picture = [0, 1].map(|axis| window.origin[axis] + pixel[axis]);
                let mut trace = PixelTrace {
                    reference: self,
                    plan,
                    levels: &levels,
                    params: &params,
                    albedos: &albedos,
                    pixel: in_picture,
                    film: FilmPixel::zeroed(),
                    rays: Rays { camera: 1, ..Rays::default() },
                    ends_at_first: sample == CENTER && !plan.follows_centers(),
                };
                let ray = camera_rays::camera_ray(&camera, &plan.filter, pixel);
                trace.run(ray, discs);
                (trace.film, trace.rays)
            })
            .collect();
        let rays = traced.iter().fold(Rays::default(), |sum, (_, rays)| sum + *rays);
        (traced.into_iter().map(|(film, _)| film).collect(), rays)
    }

    /// Where a ray that has ended meets the surface, with its object, and the iterations that took.
    fn settle(
        &self,
        plan: &Plan,
        levels: &Levels<R>,
        ray: &mut Ray<R>,
    ) -> (Option<(Hit<R>, u32)>, u32) {
        let surroundings = Surroundings {
            levels,
            polynomials: &self.polynomials,
            points: &plan.cloud.points,
            outcomes: &self.outcomes,
            cells: &self.point_cells,
            objects: &plan.objects,
        };
        let mut iterations = 0;
        while let Some(hit) = surface_hit(ray, &self.polynomials) {
            let object = self.polynomials[ray.hit_slot as usize].object;
            let info = &plan.objects[object as usize];
            let is_shape = !slots_of(info).contains(&ray.hit_slot);
            if info.max_iterations == 0 || is_shape {
                let mut hit = hit;
                if info.blends != 0 && !is_shape {
                    let (x, n) = (hit.position, hit.normal);
                    let (lists, polynomials) = (&self.lists, &self.polynomials);
                    let blended =
                        blend::blended_normal(levels, lists, polynomials, x, n, slots_of(info));
                    if blended.dot(ray.direction) < R::of(0.0) {
                        hit.normal = blended; // at an outline it may look away
                    }
                }
                return (Some((hit, object)), iterations);
            }
            match surroundings.refine(ray, hit) {
                Refined::Accepted(hit, more) => return (Some((hit, object)), iterations + more),
                Refined::Rejected(more) => {
                    iterations += more;
                    refine::resume(ray);
                    grid_trace(ray, levels, &self.lists, &self.polynomials, false);
                }
            }
        }
        (None, iterations)
    }
}
