//! Where a scan was taken from.
//!
//! Files say it in their own ways: E57 by the pose of a scan, PTX by its head, PCD by VIEWPOINT. What they
//! do not say, points in rows and columns may show: seen from the sensor, directions follow columns and
//! rows ([`Pixels::axes`]).

use crate::upright::{self, FOLLOWS, correlation};
use std::ops::Range;

/// Where a scan was taken from, and which points it has.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensor {
    /// Where it stood, in the coordinates of the points.
    pub position: [f64; 3],
    /// Unit vectors to its right, up and ahead, in the coordinates of the points. What lies ahead of a
    /// scanner that turns is where its file counts angles from.
    pub axes: [[f64; 3]; 3],
    /// Its points, by their places in the file ([`PointSet::file_index`](crate::PointSet::file_index)).
    pub points: Range<u32>,
    /// Columns and rows of the scan, if it has them.
    pub image: Option<[u32; 2]>,
}

/// Right, up and ahead of a camera: x to the right, y down, z ahead.
pub(crate) const CAMERA: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]];
/// Those of a scanner: z up, x where angles are counted from.
pub(crate) const SCANNER: [[f64; 3]; 3] = [[0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]];

/// Where a sensor stands and how it is turned: points in the file are `rotation · local + translation`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pose {
    /// Rows of a matrix whose columns are unit vectors, each across the others.
    pub(crate) rotation: [[f64; 3]; 3],
    pub(crate) translation: [f64; 3],
}

impl Pose {
    pub(crate) const IDENTITY: Self = Self {
        rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        translation: [0.0; 3],
    };

    /// That of a quaternion w, x, y, z of any length. One without a direction, or a translation that is
    /// not finite, gives none.
    pub(crate) fn of_quaternion(q: [f64; 4], translation: [f64; 3]) -> Option<Self> {
        let norm = q.iter().map(|c| c * c).sum::<f64>().sqrt();
        if !(norm > 0.0 && norm.is_finite() && translation.iter().all(|x| x.is_finite())) {
            return None;
        }
        let [w, x, y, z] = q.map(|c| c / norm);
        let rotation = [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
            [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
            [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
        ];
        Some(Self { rotation, translation })
    }

    /// A direction of the sensor in the file.
    pub(crate) fn turned(&self, v: [f64; 3]) -> [f64; 3] {
        self.rotation.map(|r| r[0] * v[0] + r[1] * v[1] + r[2] * v[2])
    }

    /// A point of the file, as the sensor sees it.
    fn local(&self, p: [f64; 3]) -> [f64; 3] {
        let d = [0, 1, 2].map(|i| p[i] - self.translation[i]);
        let r = &self.rotation;
        [0, 1, 2].map(|i| r[0][i] * d[0] + r[1][i] * d[1] + r[2][i] * d[2])
    }

    /// A sensor that stands so, whose axes it has itself.
    pub(crate) fn sensor(
        &self,
        axes: [[f64; 3]; 3],
        points: Range<u32>,
        image: Option<[u32; 2]>,
    ) -> Sensor {
        let axes = axes.map(|axis| self.turned(axis));
        Sensor { position: self.translation, axes, points, image }
    }
}

/// Points that are looked at, at most.
const SAMPLE: u64 = 1 << 12;
/// By how much the square of a correlation with coordinates may exceed that with angles.
const SLACK: f64 = 1e-3;

/// Points in rows and columns, spread over a scan.
#[derive(Debug, Clone)]
pub(crate) struct Pixels {
    /// Points from one that is looked at to the next.
    step: u64,
    seen: u64,
    /// Column and row, and where the point is.
    list: Vec<([f64; 2], [f64; 3])>,
    /// Least and greatest column and row, of points without a measurement as well.
    extent: Option<[[f64; 2]; 2]>,
}

impl Pixels {
    /// Of a scan of so many points, measured or not.
    pub(crate) fn new(points: u64) -> Self {
        Self { step: points.div_ceil(SAMPLE).max(1), seen: 0, list: Vec::new(), extent: None }
    }

    /// Takes the next point. One that was not measured has a position that is zero or not finite.
    pub(crate) fn see(&mut self, pixel: [f64; 2], position: [f64; 3]) {
        let [low, high] = self.extent.unwrap_or([pixel; 2]);
        self.extent = Some([
            [low[0].min(pixel[0]), low[1].min(pixel[1])],
            [high[0].max(pixel[0]), high[1].max(pixel[1])],
        ]);
        let measured = position != [0.0; 3] && position.iter().all(|x| x.is_finite());
        // So that columns and rows do not beat with the step.
        let turn = self.seen / self.step;
        if measured && self.seen % self.step == turn * 7 % self.step {
            self.list.push((pixel, position));
        }
        self.seen += 1;
    }

    /// Columns and rows that points have; `None` where there is only one of either.
    pub(crate) fn size(&self) -> Option<[u32; 2]> {
        let [low, high] = self.extent?;
        let count = |i: usize| {
            let count = high[i] - low[i] + 1.0;
            (count >= 2.0 && count <= f64::from(u32::MAX)).then_some(count as u32)
        };
        Some([count(0)?, count(1)?])
    }

    /// The axes that a sensor in this pose has, if that is where the scan was taken from: a camera's,
    /// whose view follows columns and rows, or a scanner's, whose heights follow rows. `rows_go_down` says
    /// that this is certain, so that upright is what they say.
    pub(crate) fn axes(&self, pose: &Pose, rows_go_down: bool) -> Option<[[f64; 3]; 3]> {
        let placed = |&(pixel, position): &([f64; 2], [f64; 3])| (pose.local(position), pixel);
        let list: Vec<([f64; 3], [f64; 2])> = self.list.iter().map(placed).collect();
        if list.len() < upright::FEWEST {
            return None;
        }
        if let Some(view) = upright::camera_of(&list) {
            let (over_depth, plain) = (view.over_depth, view.plain);
            let follows =
                (0..2).all(|i| over_depth[i] * over_depth[i] + SLACK >= plain[i] * plain[i]);
            // A lattice in a plane, too, is more likely a map than a wall that was measured without noise.
            if !follows || plain.iter().all(|plain| plain * plain > upright::IS) {
                return None;
            }
            let sign = |positive: bool| if positive { 1.0 } else { -1.0 };
            let ahead = [0.0, 0.0, sign(view.is_ahead)];
            // Right, up and back are a right-handed system: two of them say where the third is.
            return Some(match rows_go_down {
                true => {
                    let up = [0.0, -sign(over_depth[1] > 0.0), 0.0];
                    [cross(ahead, up), up, ahead]
                }
                false => {
                    let right = [sign(over_depth[0] > 0.0), 0.0, 0.0];
                    [right, cross(right, ahead), ahead]
                }
            });
        }
        let heights: Vec<f64> = list.iter().map(|(p, _)| p[2].atan2(p[0].hypot(p[1]))).collect();
        let rows: Vec<f64> = list.iter().map(|(_, pixel)| pixel[1]).collect();
        let follows = correlation(&heights, &rows);
        (follows * follows > FOLLOWS).then_some(SCANNER)
    }
}

/// A scan of a file that has a pose for each.
#[derive(Debug)]
pub(crate) struct Scan {
    pub(crate) pose: Pose,
    /// Whether the file says that this is the pose.
    pub(crate) is_posed: bool,
    /// Whether its points are angles and ranges, which only a sensor has.
    pub(crate) has_angles: bool,
    /// Of one with columns and rows.
    pub(crate) pixels: Option<Pixels>,
    /// Places in the file.
    pub(crate) points: Range<u32>,
}

/// The sensors of scans. Programs write that a scan stands in the origin, unturned, where they know no
/// pose; so where no scan of a file has another, only angles or what columns and rows show are believed.
pub(crate) fn of_scans(scans: &[Scan]) -> Vec<Sensor> {
    let any = scans.iter().any(|scan| scan.is_posed && scan.pose != Pose::IDENTITY);
    let sensor = |scan: &Scan| {
        let finite = scan.pose.translation.iter().all(|x| x.is_finite());
        let shown = scan.pixels.as_ref().and_then(|pixels| pixels.axes(&scan.pose, false));
        let known = scan.is_posed && any || scan.has_angles;
        let axes = shown.or(known.then_some(SCANNER)).filter(|_| finite)?;
        let image = scan.pixels.as_ref().and_then(Pixels::size);
        (!scan.points.is_empty()).then(|| scan.pose.sensor(axes, scan.points.clone(), image))
    };
    scans.iter().filter_map(sensor).collect()
}

pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests;
