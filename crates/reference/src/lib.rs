//! The kernels' twins on the CPU, generic over f32 and f64. No Vulkan here.
//!
//! One source: in f32 it must give lavapipe's pixels to the bit, which the end-to-end tests check;
//! in f64 it says how far both are from the truth. It is also what renders where no Vulkan exists.
#![forbid(unsafe_code)]

pub mod albedo;
mod batch;
pub mod blend;
pub mod camera_rays;
pub mod disc;
pub mod disc_bin;
pub mod disc_trace;
pub mod eigen;
pub mod environment;
pub mod fit;
pub mod fit_polynomials;
pub mod gap;
pub mod grid;
pub mod grid_build;
pub mod grid_trace;
pub mod image;
pub mod least_squares;
pub mod polynomial;
pub mod projection;
pub mod real;
pub mod refine;
pub mod shade;
pub mod surface_hit;

use camera_rays::Ray;
use disc_bin::{DiscLists, disc_bin};
use disc_trace::disc_trace;
use grid::Grid;
use grid_build::CellLists;
use grid_trace::grid_trace;
use kernels::layout::{FilmPixel, FitOutcome, GridInfo};
use plan::{Picture, Plan, Window};
use points::{NeighborSearch, Watch, plan_grid};
use polynomial::Polynomial;
use rayon::prelude::*;
use real::Real;
use refine::{PointCells, Refined, Surroundings};
use surface_hit::{Hit, surface_hit};

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
    /// Where the grid lies.
    pub grid: GridInfo,
    /// The points of each cell.
    pub lists: CellLists,
    /// The points of each cell, each once; empty where nothing is refined.
    pub point_cells: PointCells,
}

impl<R: Real> Reference<R> {
    /// Fits the surfaces of a plan and builds the grid; `None` where the watcher asked for an end.
    #[must_use]
    pub fn new(plan: &Plan, watch: &dyn Watch) -> Option<Self> {
        let cloud = &plan.cloud;
        let mut fitted: Vec<(Polynomial<R>, u32, R)> = Vec::with_capacity(cloud.points.len());
        watch.stage("fitting surfaces", cloud.points.len() as u64);
        for (object, params) in cloud.objects.iter().zip(&plan.fits) {
            let range = object.range();
            let search = NeighborSearch::new(&cloud.points[range.clone()], object.first_slot);
            let k = params.neighbors as usize;
            let sizes = (params.feature_size < 0.0).then(|| search.smoothed_sizes(k));
            for first in (0..range.len()).step_by(FIT_BATCH) {
                if watch.interrupted() {
                    return None;
                }
                let batch = first..range.len().min(first + FIT_BATCH);
                let lists = search.nearest(batch.clone(), k);
                let fits: Vec<_> = lists
                    .par_chunks(k)
                    .zip(range.start + first..range.start + batch.end)
                    .map(|(list, slot)| {
                        let size = sizes.as_ref().map(|sizes| sizes[slot - range.start]);
                        fit_polynomials::fit_polynomial(&cloud.points, slot, list, params, size)
                    })
                    .collect();
                fitted.extend(fits);
                watch.done(fitted.len() as u64);
            }
        }
        let outcomes: Vec<FitOutcome> = fitted
            .iter()
            .map(|&(polynomial, kind, h)| FitOutcome {
                trust: polynomial.trust.to_f32(),
                kind,
                feature_size: h.to_f32(),
            })
            .collect();
        let polynomials: Vec<Polynomial<R>> = fitted.into_iter().map(|fit| fit.0).collect();
        watch.stage("building the grid", 1);
        let grid = plan_grid(&cloud.points, &outcomes, plan.grid_resolution);
        let lists = grid_build::build_grid(&grid, &polynomials, &cloud.order);
        let point_cells = if plan.refines() {
            grid_build::list_points(&Grid::from(&grid), &polynomials, &cloud.order)
        } else {
            PointCells::default()
        };
        watch.done(1);
        Some(Self { polynomials, outcomes, grid, lists, point_cells })
    }

    /// Traces one picture of the plan that this was made for; `None` where the watcher asked for an
    /// end.
    #[must_use]
    pub fn frame(&self, plan: &Plan, watch: &dyn Watch) -> Option<Picture> {
        let mut picture = plan.picture();
        watch.stage("tracing", plan.window.pixels() as u64);
        let mut done = 0;
        for tile in plan.tiles() {
            let discs = self.bin_discs(plan, &tile);
            for first in (0..tile.size[1]).step_by(ROWS) {
                if watch.interrupted() {
                    return None;
                }
                let rows = Window {
                    origin: [tile.origin[0], tile.origin[1] + first],
                    size: [tile.size[0], (ROWS as u32).min(tile.size[1] - first)],
                };
                picture.put(plan, &self.outcomes, &rows, &self.trace(plan, &rows, discs.as_ref()));
                done += rows.pixels() as u64;
                watch.done(done);
            }
        }
        Some(picture)
    }

    /// The points of each screen tile of a tile of the picture, if it is to be traced by discs and
    /// they are not too many.
    #[must_use]
    pub fn bin_discs(&self, plan: &Plan, tile: &Window) -> Option<DiscLists> {
        let params = plan.discs_of(tile, &self.grid);
        plan.by_discs(tile).then(|| disc_bin(&params, &self.polynomials)).flatten()
    }

    /// The pixels of one window, row by row; through the grid, or, inside a tile of the picture
    /// whose discs are given, by them.
    #[must_use]
    pub fn trace(&self, plan: &Plan, window: &Window, discs: Option<&DiscLists>) -> Vec<FilmPixel> {
        let grid = Grid::<R>::from(&self.grid);
        let (camera, params) = (plan.camera_of(window), plan.shade_of(window));
        let albedos = albedo::Albedos {
            grid: &grid,
            lists: &self.lists,
            polynomials: &self.polynomials,
            objects: &plan.objects,
            colors: &plan.colors,
            images: image::Images { infos: &plan.images, texels: &plan.texels },
        };
        let shading = shade::Shading { params: &params, albedos, lights: &plan.lights };
        (0..window.size[0] * window.size[1])
            .into_par_iter()
            .map(|i| {
                let pixel = [i % window.size[0], i / window.size[0]];
                let mut ray = camera_rays::camera_ray(&camera, &grid, pixel);
                match discs {
                    Some(discs) => {
                        let in_picture = [0, 1].map(|axis| window.origin[axis] + pixel[axis]);
                        disc_trace(&mut ray, in_picture, discs, &self.polynomials);
                    }
                    None => grid_trace(&mut ray, &grid, &self.lists, &self.polynomials),
                }
                let (hit, iterations) = self.settle(plan, &grid, &mut ray);
                shade::shade(&ray, hit, iterations, &shading)
            })
            .collect()
    }

    /// Where a ray that has ended meets the surface, with its object, and the iterations that took.
    fn settle(
        &self,
        plan: &Plan,
        grid: &Grid<R>,
        ray: &mut Ray<R>,
    ) -> (Option<(Hit<R>, u32)>, u32) {
        let surroundings = Surroundings {
            grid,
            polynomials: &self.polynomials,
            outcomes: &self.outcomes,
            cells: &self.point_cells,
            objects: &plan.objects,
        };
        let mut iterations = 0;
        while let Some(hit) = surface_hit(ray, &self.polynomials) {
            let object = self.polynomials[ray.hit_slot as usize].object;
            let info = &plan.objects[object as usize];
            if info.max_iterations == 0 {
                let mut hit = hit;
                if info.blends != 0 {
                    let (x, n) = (hit.position, hit.normal);
                    let (lists, polynomials) = (&self.lists, &self.polynomials);
                    hit.normal = blend::blended_normal(grid, lists, polynomials, x, n, object);
                }
                return (Some((hit, object)), iterations);
            }
            match surroundings.refine(ray, hit) {
                Refined::Accepted(hit, more) => return (Some((hit, object)), iterations + more),
                Refined::Rejected(more) => {
                    iterations += more;
                    refine::resume(ray, grid);
                    grid_trace(ray, grid, &self.lists, &self.polynomials);
                }
            }
        }
        (None, iterations)
    }
}
