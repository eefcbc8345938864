//! From the pixels that kernels wrote to the film that files are made of.

use crate::diagnostic::Fitted;
use crate::{Plan, Window};
use film::Film;
use kernels::layout::{FilmPixel, FitOutcome};

/// A picture that is being filled, tile by tile, and what its rays did.
#[derive(Debug)]
pub struct Picture {
    film: Film,
    origin: [f64; 3],
    /// Points tested by all rays.
    pub tests: u64,
    /// Pixels that hit a surface.
    pub hits: u64,
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
        film.extra = plan
            .diagnostics
            .iter()
            .map(|diagnostic| (diagnostic.name().to_owned(), vec![0.0; window.pixels()]))
            .collect();
        Self { film, origin: plan.cloud.origin, tests: 0, hits: 0 }
    }

    /// Puts the pixels of one tile, row by row, where they belong. `plan` is the picture's own, and
    /// `outcomes` says how its fits ended, by slot.
    pub fn put(
        &mut self,
        plan: &Plan,
        outcomes: &[FitOutcome],
        tile: &Window,
        pixels: &[FilmPixel],
    ) {
        assert_eq!(pixels.len(), tile.pixels(), "one pixel for each of the tile");
        assert_eq!(outcomes.len(), plan.cloud.points.len(), "one outcome a point");
        let fitted = Fitted { points: &plan.cloud.points, outcomes };
        let film = &mut self.film;
        let (x0, y0) = (tile.origin[0] - film.window.x, tile.origin[1] - film.window.y);
        for (row, pixels) in (y0..).zip(pixels.chunks(tile.size[0] as usize)) {
            let first = row as usize * film.window.width as usize + x0 as usize;
            for (at, pixel) in (first..).zip(pixels) {
                self.tests += u64::from(pixel.counts[0]);
                let [x, y, z, depth] = pixel.position_depth;
                let [nx, ny, nz, object] = pixel.normal_object;
                film.color[at] = pixel.color;
                film.depth[at] = depth;
                film.normal[at] = [nx, ny, nz];
                film.object[at] = object;
                for (diagnostic, (_, plane)) in plan.diagnostics.iter().zip(&mut film.extra) {
                    plane[at] = diagnostic.value(pixel, fitted);
                }
                if object >= 0.0 {
                    self.hits += 1;
                    let local = [x, y, z];
                    film.position[at] =
                        [0, 1, 2].map(|axis| (self.origin[axis] + f64::from(local[axis])) as f32);
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
