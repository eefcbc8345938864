//! Points sorted by cell, each coordinate and the scalars in a list of its own.

use kernels::layout::VolumeInfo;
use plan::Volumes;

/// Places after the last point, so that eight can be read from anywhere.
const PADDING: usize = 8;

/// The points of a volume.
pub struct Cells {
    /// Lowest corner, a reach below the lowest point.
    pub origin: [f32; 3],
    pub inverse_edge: f32,
    pub resolution: [usize; 3],
    /// The first point of each cell, and one after the last.
    pub first: Vec<u32>,
    pub x: Vec<f32>,
    pub y: Vec<f32>,
    pub z: Vec<f32>,
    pub scalar: Vec<f32>,
}

impl Cells {
    /// So many cells a reach, but no more than twice as many as there are points (or 64³).
    pub fn of(info: &VolumeInfo, volumes: &Volumes, a_reach: f64) -> Self {
        let range = volumes.point_ranges().find(|(of, _)| of.object == info.object);
        let points = &volumes.points[range.map_or(0..0, |(_, range)| range)];
        let (origin, high) = (info.grid.origin, info.high);
        let extent = [0, 1, 2].map(|i| f64::from(high[i]) - f64::from(origin[i]));
        let most = (2.0 * points.len() as f64).max(262_144.0);
        let least = (extent.iter().product::<f64>() / most).cbrt();
        let edge = (f64::from(info.square_radius).sqrt() / a_reach).max(least);
        let resolution = extent.map(|length| (length * 1.000_01 / edge).ceil().max(1.0) as usize);
        let mut cells = Self {
            origin,
            inverse_edge: (1.0 / edge) as f32,
            resolution,
            first: vec![0; resolution.iter().product::<usize>() + 1],
            x: vec![],
            y: vec![],
            z: vec![],
            scalar: vec![],
        };
        let own: Vec<usize> = points.iter().map(|p| cells.cell_of(p.position)).collect();
        own.iter().for_each(|&cell| cells.first[cell + 1] += 1);
        for cell in 1..cells.first.len() {
            cells.first[cell] += cells.first[cell - 1];
        }
        let mut next = cells.first.clone();
        let mut order = vec![0; points.len()];
        for (index, &cell) in own.iter().enumerate() {
            order[next[cell] as usize] = index;
            next[cell] += 1;
        }
        let list = |of: fn(&kernels::layout::VolumePoint) -> f32| {
            let all = order.iter().map(|&i| of(&points[i]));
            all.chain([0.0; PADDING]).collect()
        };
        cells.x = list(|p| p.position[0]);
        cells.y = list(|p| p.position[1]);
        cells.z = list(|p| p.position[2]);
        cells.scalar = list(|p| p.scalar);
        cells
    }

    pub fn bytes(&self) -> usize {
        4 * (self.first.len() + 4 * self.x.len())
    }

    fn cell_of(&self, position: [f32; 3]) -> usize {
        let at = [0, 1, 2].map(|i| {
            let cell = (position[i] - self.origin[i]) * self.inverse_edge;
            (cell.max(0.0) as usize).min(self.resolution[i] - 1)
        });
        at[0] + self.resolution[0] * (at[1] + self.resolution[1] * at[2])
    }
}
