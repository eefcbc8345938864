//! Twin of `glsl/shared/sky.glsl`: directions that light comes from in the background, drawn by how bright it is there.

use crate::direction::on_circle;
use crate::environment::{turned, turned_back};
use crate::image::Images;
use crate::real::{Real, V3};
use kernels::layout::BackgroundInfo;
use std::f64::consts::{FRAC_1_PI, PI};

/// Where an environment is bright, as kernels have it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sky<'a> {
    pub images: Images<'a>,
    pub background: &'a BackgroundInfo,
    /// Of the plan.
    pub table: &'a [f32],
}

/// A direction that was drawn.
pub(crate) struct DrawnDirection<R> {
    /// Unit, in the world.
    pub towards: V3<R>,
    /// How densely directions are drawn there, per steradian.
    pub density: R,
}

impl Sky<'_> {
    fn size(&self) -> [usize; 2] {
        [self.table[0], self.table[1]].map(|count| count.to_bits() as usize)
    }

    fn rows_of_turn(&self) -> &[kernels::layout::ImageInfo] {
        let at = self.background.environment as usize;
        &self.images.infos[at + 1..at + 4]
    }

    fn density_in<R: Real>(&self, [columns, rows]: [usize; 2], row: usize, column: usize) -> R {
        R::of_f32(self.table[3 + 2 * rows + columns * (rows + row) + column])
    }

    /// How densely directions are drawn around one of the world, per steradian.
    pub fn density_of<R: Real>(&self, direction: V3<R>) -> R {
        let own = turned(self.rows_of_turn(), direction);
        let V3([x, y, z]) = own;
        let level = (x * x + z * z).sqrt();
        let u = R::of(0.5) + x.arc_tangent(-z) * R::of(0.5 / PI);
        let v = level.arc_tangent(y) * R::of(FRAC_1_PI);
        let size = self.size();
        let cell = |at: R, count: usize| {
            let at = at.max(R::of(0.0)) * R::of_u32(count as u32);
            (at.to_u32() as usize).min(count - 1)
        };
        self.density_in(size, cell(v, size[1]), cell(u, size[0]))
    }

    /// Which of so many cumulative shares, from `first` on, a number in [0, 1) falls to, and how far within it.
    fn fall_to<R: Real>(&self, first: usize, count: usize, u: R) -> (usize, R) {
        let shares = &self.table[first..first + count];
        let at = shares[..count - 1].partition_point(|&share| R::of_f32(share) <= u);
        let before = if at > 0 { R::of_f32(shares[at - 1]) } else { R::of(0.0) };
        (at, (u - before) / (R::of_f32(shares[at]) - before))
    }

    /// The direction that u in the unit square stands for.
    pub fn draw<R: Real>(&self, u: [R; 2]) -> DrawnDirection<R> {
        let [columns, rows] = self.size();
        let (row, down) = self.fall_to(3 + rows, rows, u[1]);
        let (column, across) = self.fall_to(3 + 2 * rows + columns * row, columns, u[0]);
        let [border, next] = [2, 3].map(|i| R::of_f32(self.table[i + row]));
        let y = border + down * (next - border);
        let level = (R::of(1.0) - y * y).max(R::of(0.0)).sqrt();
        let turns = (R::of_u32(column as u32) + across) / R::of_u32(columns as u32);
        let [cosine, sine] = on_circle(turns);
        let own = V3([-level * sine, y, level * cosine]);
        DrawnDirection {
            towards: turned_back(self.rows_of_turn(), own),
            density: self.density_in([columns, rows], row, column),
        }
    }
}
