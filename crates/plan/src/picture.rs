//! From the pixels that kernels wrote to the film that files are made of.

use crate::diagnostic::Fitted;
use crate::{Plan, Window};
use film::Film;
use kernels::layout::{FilmPixel, FitOutcome, NONE};

/// A picture that is being filled, tile by tile, and what its rays did.
#[derive(Debug)]
pub struct Picture {
    film: Film,
    /// Points tested by all rays.
    pub tests: u64,
    /// Pixels that hit a surface.
    pub hits: u64,
    /// Rays, by kind.
    pub rays: Rays,
}

/// Rays, by kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Rays {
    /// From the camera.
    pub camera: u64,
    /// Towards lights.
    pub shadow: u64,
    /// From mirrors, and from glass inwards.
    pub reflected: u64,
    /// Into and out of glass, or through a surface that changes no medium.
    pub refracted: u64,
    /// Scattered to all sides, by matt surfaces and in volumes.
    pub scattered: u64,
}

impl Rays {
    /// Of every kind.
    #[must_use]
    pub fn all(&self) -> u64 {
        self.camera + self.shadow + self.reflected + self.refracted + self.scattered
    }
}

impl std::ops::Add for Rays {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            camera: self.camera + other.camera,
            shadow: self.shadow + other.shadow,
            reflected: self.reflected + other.reflected,
            refracted: self.refracted + other.refracted,
            scattered: self.scattered + other.scattered,
        }
    }
}

impl std::ops::AddAssign for Rays {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Picture {
    pub(crate) fn new(plan: &Plan) -> Self {
        let window = film::Window {
            x: plan.window.origin[0],
            y: plan.window.origin[1],
            width: plan.window.size[0],
            height: plan.window.size[1],
        };
        let mut film = Film::empty(plan.image_size, window, plan.transparent);
        film.channel_alpha = plan.channel_alpha.then(|| vec![[0.0; 3]; window.pixels()]);
        let diagnostics = plan.diagnostics.iter().map(|diagnostic| diagnostic.name());
        let extras = plan.extras.iter().flat_map(|extra| extra.channels().iter().copied());
        film.extra = diagnostics
            .chain(extras)
            .map(|name| (name.to_owned(), vec![0.0; window.pixels()]))
            .collect();
        Self { film, tests: 0, hits: 0, rays: Rays::default() }
    }

    /// Puts the pixels of one tile, row by row, where they belong. `plan` is the picture's own, and
    /// `outcomes` says how its fits ended, by slot. Surfaces and diagnostics are those of `centers`, the rays through the
    /// pixels' centres, where the plan [takes](Plan::takes_centers) them.
    pub fn put(
        &mut self,
        plan: &Plan,
        outcomes: &[FitOutcome],
        tile: &Window,
        (pixels, centers): (&[FilmPixel], Option<&[FilmPixel]>),
    ) {
        assert_eq!(pixels.len(), tile.pixels(), "one pixel for each of the tile");
        let centers = centers.unwrap_or(pixels);
        assert_eq!(centers.len(), tile.pixels(), "one centre for each pixel of the tile");
        assert_eq!(outcomes.len(), plan.cloud.points.len(), "one outcome a point");
        let fitted = Fitted { points: &plan.cloud.points, outcomes };
        let film = &mut self.film;
        let x0 = tile.origin[0] - film.window.x;
        let origin = plan.provenance.origin;
        let columns = tile.size[0] as usize;
        for ((row, pixels), centers) in
            (tile.origin[1]..).zip(pixels.chunks(columns)).zip(centers.chunks(columns))
        {
            let first = (row - film.window.y) as usize * film.window.width as usize + x0 as usize;
            let pixels = (tile.origin[0]..).zip(pixels).zip(centers);
            for (at, ((column, pixel), center)) in (first..).zip(pixels) {
                self.tests += u64::from(pixel.counts[0]);
                film.color[at] = pixel.color;
                if let Some(alpha) = &mut film.channel_alpha {
                    alpha[at] = pixel.alpha;
                }
                let pixel = &seen(center);
                let [x, y, z, depth] = pixel.position_depth;
                let [nx, ny, nz, object] = pixel.normal_object;
                film.depth[at] = depth;
                film.normal[at] = [nx, ny, nz];
                film.object[at] = object;
                let world = (object >= 0.0).then(|| {
                    let world = [(x, 0), (y, 1), (z, 2)]
                        .map(|(local, axis)| plan.cloud.origin[axis] + f64::from(local));
                    plan.sight.on_ray([column, row], world)
                });
                let mut planes = film.extra.iter_mut();
                for (diagnostic, (_, plane)) in plan.diagnostics.iter().zip(&mut planes) {
                    plane[at] = diagnostic.value(pixel, fitted);
                }
                for extra in &plan.extras {
                    let values = extra.values(world, pixel.along, &plan.volumes);
                    for (value, (_, plane)) in
                        values[..extra.channels().len()].iter().zip(&mut planes)
                    {
                        plane[at] = *value;
                    }
                }
                if let Some(world) = world {
                    self.hits += 1;
                    film.position[at] = [0, 1, 2].map(|axis| (world[axis] - origin[axis]) as f32);
                }
            }
        }
    }

    /// The finished film.
    #[must_use]
    pub fn finish(self) -> Film {
        self.film
    }
}

/// A pixel with what is the same for all that show no surface, which kernels do not write.
fn seen(pixel: &FilmPixel) -> FilmPixel {
    if pixel.normal_object[3] >= 0.0 {
        return *pixel;
    }
    let [tests, cells, ..] = pixel.counts;
    FilmPixel {
        position_depth: [0.0, 0.0, 0.0, f32::INFINITY],
        normal_object: [0.0, 0.0, 0.0, -1.0],
        counts: [tests, cells, NONE, pixel.counts[3]],
        ..*pixel
    }
}
