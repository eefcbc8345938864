//! Twin of `glsl/shared/grid.glsl`: cells of the uniform grid, and a ray's steps through them.

use crate::real::{NO_HIT, Real, V3};
use kernels::layout::GridInfo;
use points::BALL_MARGIN;

const PARALLEL: f64 = 1e-20;

/// The grid's place and size, in either precision.
#[derive(Debug, Clone, Copy)]
pub struct Grid<R> {
    /// Lowest corner.
    pub origin: V3<R>,
    edge: R,
    /// Cells along each axis.
    pub resolution: [u32; 3],
    /// 1 / edge of a cell.
    pub inverse_edge: R,
}

impl<R: Real> From<&GridInfo> for Grid<R> {
    fn from(info: &GridInfo) -> Self {
        Self {
            origin: V3::of_f32(info.origin),
            edge: R::of_f32(info.edge),
            resolution: info.resolution,
            inverse_edge: R::of_f32(info.inverse_edge),
        }
    }
}

/// A trust ball, grown so that rounding loses no cell that a hit lies in.
#[derive(Debug, Clone, Copy)]
pub struct Ball<R> {
    center: V3<R>,
    radius: R,
}

impl<R: Real> Ball<R> {
    /// Around the center, with the trust radius b.
    pub fn new(center: V3<R>, trust: R) -> Self {
        Self { center, radius: trust * R::of(f64::from(BALL_MARGIN)) }
    }

    /// Around the center, not grown.
    pub fn exact(center: V3<R>, radius: R) -> Self {
        Self { center, radius }
    }
}

impl<R: Real> Grid<R> {
    /// Cells in all.
    #[must_use]
    pub fn cell_count(&self) -> u32 {
        self.resolution.iter().product()
    }

    /// Place of a cell in the list of cells.
    #[must_use]
    pub fn cell_id(&self, cell: [u32; 3]) -> u32 {
        cell[0] + self.resolution[0] * (cell[1] + self.resolution[1] * cell[2])
    }

    /// Inverse of [`Grid::cell_id`].
    #[must_use]
    pub fn cell_of_id(&self, id: u32) -> [u32; 3] {
        let row = id / self.resolution[0];
        [id % self.resolution[0], row % self.resolution[1], row / self.resolution[1]]
    }

    /// The cell that holds x, or the nearest one where x lies outside.
    #[must_use]
    pub fn cell_of(&self, x: V3<R>) -> [u32; 3] {
        let at = (x - self.origin).times(self.inverse_edge);
        [0, 1, 2].map(|axis| {
            let last = R::of_u32(self.resolution[axis]) - R::of(1.0);
            at.0[axis].floor().max(R::of(0.0)).min(last).to_u32()
        })
    }

    /// Whether x lies in the grid.
    #[must_use]
    pub fn holds(&self, x: V3<R>) -> bool {
        let at = (x - self.origin).times(self.inverse_edge);
        let within =
            |axis: usize| at.0[axis] >= R::of(0.0) && at.0[axis] < R::of_u32(self.resolution[axis]);
        (0..3).all(within)
    }

    /// Lowest and highest cell (inclusive) of those that the ball could meet.
    #[must_use]
    pub fn cells_around(&self, ball: &Ball<R>) -> [[u32; 3]; 2] {
        let radius = V3::splat(ball.radius);
        [self.cell_of(ball.center - radius), self.cell_of(ball.center + radius)]
    }

    /// Whether the ball and the cell's box have a point in common.
    #[must_use]
    pub fn ball_meets_cell(&self, cell: [u32; 3], ball: &Ball<R>) -> bool {
        let corner = |offset: u32| {
            V3([0, 1, 2]
                .map(|axis| self.origin.0[axis] + R::of_u32(cell[axis] + offset) * self.edge))
        };
        let (low, high) = (corner(0), corner(1));
        let away =
            (low - ball.center).zip(ball.center - high, R::max).zip(V3::splat(R::of(0.0)), R::max);
        away.dot(away) <= ball.radius * ball.radius
    }

    /// Distances along the ray to the faces that it leaves through of the box of cells at most `around` from the
    /// cell, axis by axis.
    #[must_use]
    pub fn exits_of(&self, cell: [u32; 3], around: u32, o: V3<R>, d: V3<R>) -> V3<R> {
        V3([0, 1, 2].map(|axis| {
            let d = d.0[axis];
            let (cell, around) = (cell[axis] as i32, around as i32);
            let face = if d > R::of(0.0) { cell + around + 1 } else { cell - around };
            let face = self.origin.0[axis] + R::of(f64::from(face)) * self.edge;
            if d.abs() > R::of(PARALLEL) { (face - o.0[axis]) / d } else { R::of(NO_HIT) }
        }))
    }

    /// The first cell of a ray within a range of distances, or none where it misses the grid there.
    #[must_use]
    pub fn enter(&self, o: V3<R>, d: V3<R>, range: [R; 2]) -> Option<u32> {
        let along = |axis: usize| R::of_u32(self.resolution[axis]) * self.edge;
        let high = self.origin + V3([0, 1, 2].map(along));
        let [near, far] = clip_to_box(range, self.origin, high, o, d);
        (near <= far).then(|| self.cell_id(self.cell_of(o + d.times(near))))
    }

    /// Where a ray's way through the cell begins and ends.
    #[must_use]
    pub fn way_through(&self, cell: [u32; 3], o: V3<R>, d: V3<R>) -> [R; 2] {
        let enters = -self.exits_of(cell, 0, o, -d);
        let enter = enters.x().max(enters.y().max(enters.z()));
        [enter, nearest_exit(self.exits_of(cell, 0, o, d))]
    }

    /// The next cell behind the face at the nearest of the exits t of the box of cells `around` the cell
    /// (ties: the lower axis), or none outside. Along the other axes it is where the ray is then, in the box, and
    /// never behind where it was.
    #[must_use]
    pub fn step(
        &self,
        cell: [u32; 3],
        around: u32,
        t: V3<R>,
        o: V3<R>,
        d: V3<R>,
    ) -> Option<[u32; 3]> {
        let crossed = if t.x() <= t.y() && t.x() <= t.z() {
            0
        } else if t.y() <= t.z() {
            1
        } else {
            2
        };
        let reached = self.cell_of(o + d.times(nearest_exit(t)));
        let next = [0, 1, 2].map(|axis| {
            let (from, around) = (cell[axis] as i32, around as i32);
            let ahead = d.0[axis] > R::of(0.0);
            let low = if ahead { from } else { from - around };
            let high = if ahead { from + around } else { from };
            match (axis == crossed, ahead) {
                (true, true) => high + 1,
                (true, false) => low - 1,
                (false, _) => (reached[axis] as i32).clamp(low, high),
            }
        });
        let inside = (0..3).all(|axis| (next[axis] as u32) < self.resolution[axis]);
        inside.then(|| next.map(|at| at as u32))
    }
}

/// How many cells around one are empty with it, where `range` is its range of points: the range of an empty one
/// begins at the distance to the next that is not.
pub fn empty_around(range: [u32; 2]) -> u32 {
    if range[0] == range[1] { range[0].max(1) - 1 } else { 0 }
}

/// Where a ray is within a box: the first over the second, nowhere.
pub fn within_box<R: Real>(low: V3<R>, high: V3<R>, o: V3<R>, d: V3<R>) -> [R; 2] {
    clip_to_box([R::of(0.0), R::of(NO_HIT)], low, high, o, d)
}

/// The part of a range of distances that lies within a box.
fn clip_to_box<R: Real>(range: [R; 2], low: V3<R>, high: V3<R>, o: V3<R>, d: V3<R>) -> [R; 2] {
    let [mut near, mut far] = range;
    for axis in 0..3 {
        let (o, d) = (o.0[axis], d.0[axis]);
        let (low, high) = (low.0[axis], high.0[axis]);
        if d.abs() > R::of(PARALLEL) {
            let (a, b) = ((low - o) / d, (high - o) / d);
            near = near.max(a.min(b));
            far = far.min(a.max(b));
        } else if !(o >= low && o <= high) {
            (near, far) = (R::of(NO_HIT), R::of(-NO_HIT));
        }
    }
    [near, far]
}

/// The least of three exits.
pub fn nearest_exit<R: Real>(t: V3<R>) -> R {
    t.x().min(t.y().min(t.z()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit_cells(resolution: [u32; 3]) -> Grid<f64> {
        Grid::from(&GridInfo { origin: [0.0; 3], edge: 1.0, resolution, inverse_edge: 1.0 })
    }

    fn walk(grid: &Grid<f64>, o: V3<f64>, d: V3<f64>) -> Vec<[u32; 3]> {
        let mut visited = Vec::new();
        let mut next = grid.enter(o, d, [0.0, NO_HIT]).map(|id| grid.cell_of_id(id));
        while let Some(cell) = next {
            visited.push(cell);
            next = grid.step(cell, 0, grid.exits_of(cell, 0, o, d), o, d);
        }
        visited
    }

    #[test]
    fn a_ray_visits_the_cells_on_its_way_in_order() {
        let grid = unit_cells([4, 4, 4]);
        let visited = walk(&grid, V3([-1.0, 0.5, 0.5]), V3([1.0, 0.0, 0.0]));
        assert_eq!(visited, [[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0]]);
        let visited = walk(&grid, V3([3.5, 3.5, 2.5]), V3([0.0, 0.0, -1.0]));
        assert_eq!(visited, [[3, 3, 2], [3, 3, 1], [3, 3, 0]], "from inside, backwards");
        assert!(walk(&grid, V3([-1.0, 4.5, 0.5]), V3([1.0, 0.0, 0.0])).is_empty(), "misses");
        assert!(walk(&grid, V3([5.0, 0.5, 0.5]), V3([1.0, 0.0, 0.0])).is_empty(), "behind");
        let diagonal = V3([1.0, 1.0, 1.0]).normalize();
        let visited = walk(&grid, V3::splat(-1.0), diagonal);
        assert_eq!((visited.first(), visited.last()), (Some(&[0, 0, 0]), Some(&[3, 3, 3])));
    }

    #[test]
    fn a_ball_meets_the_cells_it_touches_and_no_corner_it_misses() {
        let grid = unit_cells([3, 3, 3]);
        let ball = Ball::new(V3([1.5, 1.5, 1.5]), 0.8);
        let [low, high] = grid.cells_around(&ball);
        assert_eq!((low, high), ([0, 0, 0], [2, 2, 2]));
        let met = (0..27).filter(|&id| grid.ball_meets_cell(grid.cell_of_id(id), &ball)).count();
        // The middle, 6 faces at 0.5, 12 edges at 0.71; the 8 corners at 0.87 are out of reach.
        assert_eq!(met, 19);
    }
}
