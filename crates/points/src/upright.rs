//! Which way is up in a file: by its format, and in maps of points, which have rows and columns, by how
//! the points lie.
//!
//! A depth camera has x to the right, y down and z forward, so that x/z grows with the column and y/z
//! with the row. A spinning lidar has z up; its maps are far wider than high, or all around.

use crate::set::PointSet;

/// Which way is up in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Upwards {
    /// +y, as in most models.
    #[default]
    Y,
    /// +z, as in surveys.
    Z,
    /// -y, as in what a depth camera sees.
    MinusY,
}

impl Upwards {
    /// As `--up` takes it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Y => "y",
            Self::Z => "z",
            Self::MinusY => "-y",
        }
    }
}

/// Points of a map that are looked at.
const SAMPLE: usize = 1 << 16;
/// Fewer say nothing.
pub(crate) const FEWEST: usize = 16;
/// How large the square of a correlation is that shows one number to follow another: that of tan θ with
/// θ is 0.97 within 60 degrees, which covers lenses that are no pinholes.
pub(crate) const FOLLOWS: f64 = 0.9;
/// That of a lattice, whose x is its column, but for what 32 bits round.
pub(crate) const IS: f64 = 0.999_999;
/// Maps this many times as wide as high are those of lidars, if they have no more rows (or columns,
/// where a driver writes beam after beam) than lidars have beams.
const FAR_WIDER: u64 = 4;
const MOST_BEAMS: u64 = 256;
/// Parts of a circle, of which points all around are missing from few.
const SECTORS: usize = 36;
const FEW: usize = 6;

/// A point, and its place in the map.
type Placed = ([f64; 3], u64);

/// Which way is up in points that come in rows and columns, and why; `None` where they do not show it.
/// `by_columns` says that one column comes after the other.
pub(crate) fn of_map(
    set: &PointSet,
    [columns, rows]: [u64; 2],
    by_columns: bool,
) -> Option<(Upwards, &'static str)> {
    // What was not measured is zero in some files.
    let there = |p: &&Placed| p.0 != [0.0; 3];
    let step = set.len().div_ceil(SAMPLE).max(1);
    let places = set.file_index.iter().map(|&index| u64::from(index));
    let points: Vec<Placed> = set.positions.iter().copied().zip(places).step_by(step).collect();
    let points: Vec<&Placed> = points.iter().filter(there).collect();
    if points.len() < FEWEST || columns < 2 || rows < 2 {
        return None;
    }
    let length = if by_columns { rows } else { columns };
    let minor = |p: &&Placed| (p.1 % length) as f64;
    let major = |p: &&Placed| (p.1 / length) as f64;
    let each = |value: &dyn Fn(&&Placed) -> f64| points.iter().map(value).collect();
    let (minor, major): (Vec<f64>, Vec<f64>) = (each(&minor), each(&major));
    let (columns_of, rows_of) = if by_columns { (major, minor) } else { (minor, major) };

    let list: Vec<([f64; 3], [f64; 2])> = (points.iter().zip(columns_of.iter().zip(&rows_of)))
        .map(|(p, (&column, &row))| (p.0, [column, row]))
        .collect();
    if let Some(view) = camera_of(&list) {
        return Some(match view.over_depth[1] > 0.0 {
            true => (Upwards::MinusY, "as a depth camera sees it"),
            false => (Upwards::Y, "as a camera sees it that looks along -z"),
        });
    }
    if is_lattice(&list) {
        return None;
    }
    let (long, short) = (columns.max(rows), columns.min(rows));
    if short <= MOST_BEAMS && long >= FAR_WIDER * short {
        return Some((Upwards::Z, "as in the rows of a lidar's beams"));
    }
    let mut sectors = [false; SECTORS];
    for p in &points {
        let turn = p.0[1].atan2(p.0[0]) / std::f64::consts::TAU + 0.5;
        sectors[((turn * SECTORS as f64) as usize).min(SECTORS - 1)] = true;
    }
    let empty = sectors.iter().filter(|sector| !**sector).count();
    (empty <= FEW).then_some((Upwards::Z, "as around a scanner"))
}

/// How the view of a camera in the origin, which looks along z, follows columns and rows.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CameraView {
    /// Whether points have positive z rather than negative.
    pub(crate) is_ahead: bool,
    /// Correlations of x/|z| with the column, and of y/|z| with the row.
    pub(crate) over_depth: [f64; 2],
    /// Those of x and of y.
    pub(crate) plain: [f64; 2],
}

/// Points with their columns and rows, of which a camera in the origin could have seen all; `None` where
/// some are before it and some are not.
fn view_of(list: &[([f64; 3], [f64; 2])]) -> Option<CameraView> {
    let ahead = list.iter().filter(|(p, _)| p[2] > 0.0).count();
    let few = list.len() / 100;
    if ahead > few && ahead < list.len() - few {
        return None;
    }
    let of = |value: &dyn Fn(&[f64; 3]) -> f64, axis: usize| {
        let values: Vec<f64> = list.iter().map(|(p, _)| value(p)).collect();
        let pixels: Vec<f64> = list.iter().map(|(_, pixel)| pixel[axis]).collect();
        correlation(&values, &pixels)
    };
    let over = |p: &[f64; 3], axis: usize| if p[2] == 0.0 { 0.0 } else { p[axis] / p[2].abs() };
    Some(CameraView {
        is_ahead: ahead > few,
        over_depth: [0, 1].map(|axis| of(&|p| over(p, axis), axis)),
        plain: [0, 1].map(|axis| of(&|p| p[axis], axis)),
    })
}

impl CameraView {
    fn is_lattice(&self) -> bool {
        let square = |r: [f64; 2], axis: usize| r[axis] * r[axis];
        (0..2).all(|i| square(self.plain, i) > IS && square(self.over_depth, i) <= IS)
    }
}

/// Whether points over a plane follow columns and rows by themselves, seen from nowhere.
fn is_lattice(list: &[([f64; 3], [f64; 2])]) -> bool {
    view_of(list).is_some_and(|view| view.is_lattice())
}

/// How a camera in the origin saw points with these columns and rows; `None` where none did.
pub(crate) fn camera_of(list: &[([f64; 3], [f64; 2])]) -> Option<CameraView> {
    let view = view_of(list)?;
    let [across, down] = view.over_depth;
    let follows = across * across > FOLLOWS && down * down > FOLLOWS;
    (follows && !view.is_lattice()).then_some(view)
}

/// How much two lists of numbers rise and fall together, from -1 to 1; 0 where one is constant.
pub(crate) fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let count = a.len().max(1) as f64;
    let mean = |list: &[f64]| list.iter().sum::<f64>() / count;
    let (mean_a, mean_b) = (mean(a), mean(b));
    let sum = |of: &dyn Fn(f64, f64) -> f64| {
        a.iter().zip(b).map(|(a, b)| of(a - mean_a, b - mean_b)).sum::<f64>()
    };
    let (both, square_a, square_b) = (sum(&|a, b| a * b), sum(&|a, _| a * a), sum(&|_, b| b * b));
    let product = square_a * square_b;
    if product > 0.0 && product.is_finite() { both / product.sqrt() } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A map of these points, by column and row; `None` is not measured.
    fn map(
        [columns, rows]: [u64; 2],
        point: impl Fn(f64, f64) -> Option<[f64; 3]>,
    ) -> Option<Upwards> {
        let of = |by_columns: bool| {
            let length = if by_columns { rows } else { columns };
            let mut set = PointSet::default();
            for place in 0..columns * rows {
                let (minor, major) = ((place % length) as f64, (place / length) as f64);
                let (column, row) = if by_columns { (major, minor) } else { (minor, major) };
                if let Some(point) = point(column, row) {
                    set.positions.push(point);
                    set.file_index.push(place as u32);
                }
            }
            of_map(&set, [columns, rows], by_columns).map(|(up, _)| up)
        };
        assert_eq!(of(false), of(true), "the order in memory changes nothing");
        of(false)
    }

    /// A number between 0 and 1 that looks random.
    fn noise(column: f64, row: f64) -> f64 {
        ((column * 12.9898 + row * 78.233).sin() * 43758.5453).fract().abs()
    }

    /// Sizes and focal lengths of depth cameras; a tenth of the pixels is not measured.
    #[test]
    fn depth_cameras_have_y_down() {
        for (size, focal) in [
            ([640, 576], 504.0),
            ([320, 240], 220.0),
            ([1280, 720], 640.0),
            ([512, 512], 180.0),
            ([640, 60], 600.0),
        ] {
            let (x0, y0) = (0.5 * size[0] as f64, 0.5 * size[1] as f64);
            for sign in [1.0, -1.0] {
                for missing in [None, Some([0.0; 3])] {
                    let up = map(size, |column, row| {
                        if noise(row, column) < 0.1 {
                            return missing;
                        }
                        let z = 0.8 + 3.0 * noise((column / 50.0).floor(), (row / 50.0).floor());
                        let (x, y) = ((column - x0) / focal * z, (row - y0) / focal * z);
                        Some([x, sign * y, sign * z])
                    });
                    // With z backwards, y is up.
                    let expected = if sign > 0.0 { Upwards::MinusY } else { Upwards::Y };
                    assert_eq!(up, Some(expected), "{size:?}");
                }
            }
        }
    }

    /// Spinning lidars, whole turns and less, and beams in rows and in columns; a scanner that stands.
    #[test]
    fn lidars_have_z_up() {
        let lidar = |turn: f64, beam: f64, reach: f64| {
            let across = reach * beam.cos();
            Some([across * turn.cos(), across * turn.sin(), reach * beam.sin()])
        };
        for (size, around) in [
            ([2048, 64], 1.0),
            ([1024, 128], 1.0),
            ([512, 128], 1.0),
            ([1800, 16], 1.0),
            ([600, 64], 0.3),
            ([2000, 1000], 1.0),
        ] {
            let [columns, rows] = size.map(|n| n as f64);
            let up = map(size, |column, row| {
                let turn = std::f64::consts::TAU * around * column / columns;
                let beam = (0.3 - 0.7 * row / rows) * if size[1] > 500 { 3.0 } else { 1.0 };
                lidar(turn, beam, 3.0 + 20.0 * noise((column / 20.0).floor(), row))
            });
            assert_eq!(up, Some(Upwards::Z), "{size:?}");
        }
        let up = map([32, 1800], |column, row| {
            lidar(
                std::f64::consts::TAU * row / 1800.0,
                0.2 - 0.02 * column,
                5.0 + noise(column, row),
            )
        });
        assert_eq!(up, Some(Upwards::Z));
        // From above the ground: all points have positive z.
        let up = map([1024, 64], |column, row| {
            let p = lidar(std::f64::consts::TAU * column / 1024.0, 0.2 - 0.01 * row, 6.0)?;
            Some([p[0], p[1], p[2] + 20.0])
        });
        assert_eq!(up, Some(Upwards::Z));
    }

    /// A terrain over a lattice is seen by no camera, and a handful of points shows nothing.
    #[test]
    fn lattices_do_not_show_which_way_is_up() {
        let height = |column: f64, row: f64| 30.0 + 5.0 * (0.1 * column).sin() * (0.07 * row).cos();
        let up =
            map([200, 150], |column, row| Some([column - 100.0, row - 75.0, height(column, row)]));
        assert_eq!(up, None);
        assert_eq!(map([2, 2], |column, row| Some([column, row, 1.0])), None);
    }
}
