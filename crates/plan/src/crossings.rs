//! Whether a place is inside a closed surface of points: by counting how often straight lines from it cross the surface
//! (docs/method.md, section 6).
//!
//! Of each point near a line, the plane through its neighbours stands for the surface. What lines meet at a grazing angle,
//! at a gap between points, or at the very place, tells nothing: those lines have no vote.

use crate::neighborhoods::at_most;
use kernels::layout::Point;
use points::NeighborSearch;
use rayon::prelude::*;
use std::collections::HashMap;

/// Lines, evenly over all directions.
const LINES: usize = 64;
/// Neighbours of a plane.
const NEIGHBORS: usize = 16;
/// Points that the reach of neighbourhoods is measured at.
const SAMPLED: usize = 512;
/// The share of these whose neighbourhoods are taken to be no wider.
const WIDEST: f64 = 0.95;
/// Of a neighbourhood's reach: how far from its point a plane stands for the surface for certain.
const CERTAIN: f64 = 0.6;
/// Of a reach, over the cosine: planes this near to each other along a line are one sheet.
const ONE_SHEET: f64 = 0.4;
/// The cosine between a line and a normal from which on the line does not graze.
const STEEP: f64 = 0.25;
/// Lines with a vote that say something.
const FEWEST: u32 = 8;
/// The share of all votes that is beyond doubt.
const CLEAR: f64 = 0.9;
/// The share of all votes that a place needs to be inside.
const INSIDE: f64 = 2.0 / 3.0;

/// What lines from a place say.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Votes {
    /// Lines that cross the surface an odd number of times.
    pub inside: u32,
    /// Lines that cross it an even number of times.
    pub outside: u32,
}

impl Votes {
    /// Where nothing of the surface is around.
    const NOWHERE: Self = Self { inside: 0, outside: LINES as u32 };

    pub fn says_inside(self) -> bool {
        f64::from(self.inside) > INSIDE * f64::from(self.inside + self.outside)
    }

    /// Whether nearly all say the same.
    pub fn is_clear(self) -> bool {
        let all = self.inside + self.outside;
        all >= FEWEST && f64::from(self.inside.max(self.outside)) >= CLEAR * f64::from(all)
    }
}

type V3 = [f64; 3];

fn dot(a: V3, b: V3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn minus(a: V3, b: V3) -> V3 {
    [0, 1, 2].map(|axis| a[axis] - b[axis])
}

fn position(point: &Point) -> V3 {
    point.position.map(f64::from)
}

/// Asks lines from a place about the surface of these points, which are in the same coordinates.
pub(crate) fn votes(points: &[Point], place: V3) -> Votes {
    if points.len() <= 3 || !is_around(points, place) {
        return Votes::NOWHERE;
    }
    let search = NeighborSearch::new(points, 0);
    let k = at_most(NEIGHBORS, points.len());
    let reach = usual_reach(points, &search, k);
    let lines: Vec<V3> = (0..LINES).map(direction).collect();
    let near: Vec<Vec<u32>> =
        lines.par_iter().map(|&line| near_line(points, place, line, reach)).collect();
    let mut places: Vec<u32> = near.iter().flatten().copied().collect();
    places.sort_unstable();
    places.dedup();
    let lists = search.nearest_of(&places, k);
    let planes: HashMap<u32, Plane> = (places.par_iter().zip(lists.par_chunks(k)))
        .filter_map(|(&at, list)| Some((at, Plane::of(points, at, list)?)))
        .collect();
    let said = near.par_iter().zip(&lines).filter_map(|(near, &line)| {
        let planes: Vec<&Plane> = near.iter().filter_map(|at| planes.get(at)).collect();
        crossings(&planes, place, line)
    });
    let [inside, outside] = said
        .map(|crossings| if crossings % 2 == 1 { [1, 0] } else { [0, 1] })
        .reduce(|| [0, 0], |a, b| [a[0] + b[0], a[1] + b[1]]);
    Votes { inside, outside }
}

/// Whether the place is in the box around the points, or so near to it that a surface between them may bulge around it.
fn is_around(points: &[Point], place: V3) -> bool {
    (0..3).all(|axis| {
        let along = |point: &Point| f64::from(point.position[axis]);
        let low = points.iter().map(along).fold(f64::INFINITY, f64::min);
        let high = points.iter().map(along).fold(f64::NEG_INFINITY, f64::max);
        let margin = 0.01 * (high - low);
        place[axis] > low - margin && place[axis] < high + margin
    })
}

/// A direction of a spherical Fibonacci lattice, turned so that no line lies in a plane of coordinates.
fn direction(i: usize) -> V3 {
    let golden = std::f64::consts::PI * (3.0 - 5f64.sqrt());
    let z = 1.0 - (2.0 * i as f64 + 1.0) / LINES as f64;
    let (sin, cos) = (golden * i as f64 + 0.7).sin_cos();
    let level = (1.0 - z * z).sqrt();
    let [x, y] = [level * cos, level * sin];
    let ((s, c), (t, d)) = (0.61f64.sin_cos(), 0.37f64.sin_cos());
    let [x, z] = [c * x + s * z, c * z - s * x];
    [x, d * y - t * z, d * z + t * y]
}

/// The distance to the last of k neighbours that nearly all points have, or less.
fn usual_reach(points: &[Point], search: &NeighborSearch<'_>, k: usize) -> f64 {
    let count = points.len().min(SAMPLED);
    let places: Vec<u32> = (0..count).map(|i| (i * points.len() / count) as u32).collect();
    let lists = search.nearest_of(&places, k);
    let mut reaches: Vec<f32> = (places.iter().zip(lists.chunks(k)))
        .map(|(&at, list)| search.reach(at as usize, list))
        .collect();
    reaches.sort_by(f32::total_cmp);
    f64::from(reaches[((count - 1) as f64 * WIDEST) as usize])
}

/// Points that are no farther from a line, and not behind where it starts.
fn near_line(points: &[Point], place: V3, line: V3, reach: f64) -> Vec<u32> {
    let is_near = |point: &Point| {
        let away = minus(position(point), place);
        let along = dot(away, line);
        along > -reach && dot(away, away) - along * along <= reach * reach
    };
    (0u32..).zip(points).filter(|(_, point)| is_near(point)).map(|(at, _)| at).collect()
}

/// The plane through a point's neighbours.
struct Plane {
    center: V3,
    normal: V3,
    point: V3,
    reach: f64,
}

impl Plane {
    /// `None` where all neighbours lie in one place.
    fn of(points: &[Point], at: u32, list: &[u32]) -> Option<Self> {
        let point = position(&points[at as usize]);
        let others = list.iter().filter_map(|&other| points.get(other as usize)).map(position);
        let around: Vec<V3> = others.chain([point]).map(|other| minus(other, point)).collect();
        let square = around.iter().map(|&y| dot(y, y)).fold(0.0, f64::max);
        if square <= 0.0 {
            return None;
        }
        let weights: Vec<f64> = around.iter().map(|&y| (-dot(y, y) / square).exp()).collect();
        let total: f64 = weights.iter().sum();
        let weighted = || around.iter().zip(&weights);
        let mean = [0, 1, 2].map(|i| weighted().map(|(y, w)| w * y[i]).sum::<f64>() / total);
        let spread = [0, 1, 2].map(|i| {
            [0, 1, 2]
                .map(|j| weighted().map(|(y, w)| w * (y[i] - mean[i]) * (y[j] - mean[j])).sum())
        });
        let center = [0, 1, 2].map(|axis| point[axis] + mean[axis]);
        Some(Self { center, normal: thinnest(spread), point, reach: square.sqrt() })
    }
}

/// The direction along which a symmetric matrix is least, by Jacobi's rotations.
fn thinnest(mut m: [V3; 3]) -> V3 {
    let mut axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for turn in 0..18 {
        let [p, q] = [[0, 1], [0, 2], [1, 2]][turn % 3];
        if m[p][q] == 0.0 {
            continue;
        }
        let angle = 0.5 * (2.0 * m[p][q]).atan2(m[p][p] - m[q][q]);
        let (s, c) = angle.sin_cos();
        for row in &mut m {
            let [a, b] = [row[p], row[q]];
            [row[p], row[q]] = [c * a + s * b, c * b - s * a];
        }
        let [a, b] = [m[p], m[q]];
        m[p] = [0, 1, 2].map(|i| c * a[i] + s * b[i]);
        m[q] = [0, 1, 2].map(|i| c * b[i] - s * a[i]);
        let [a, b] = [axes[p], axes[q]];
        axes[p] = [0, 1, 2].map(|i| c * a[i] + s * b[i]);
        axes[q] = [0, 1, 2].map(|i| c * b[i] - s * a[i]);
    }
    let least = (0..3).min_by(|&a, &b| m[a][a].total_cmp(&m[b][b])).unwrap_or(0);
    axes[least]
}

/// Where a line meets a plane.
struct Meeting {
    /// Along the line.
    t: f64,
    /// Between the line and the normal.
    cosine: f64,
    /// Half the thickness of a sheet here, along the line.
    depth: f64,
}

/// How many sheets a line crosses; `None` where that is in doubt.
fn crossings(planes: &[&Plane], place: V3, line: V3) -> Option<u32> {
    let (mut certain, mut doubtful) = (Vec::new(), Vec::new());
    for plane in planes {
        let across = dot(plane.normal, line);
        let cosine = across.abs();
        let is_level = cosine < 0.05; // it meets the plane far away, if at all
        let t = match is_level {
            true => dot(minus(plane.point, place), line),
            false => dot(minus(plane.center, place), plane.normal) / across,
        };
        let x = [0, 1, 2].map(|axis| place[axis] + t * line[axis]);
        let off = minus(x, plane.point);
        let distance = dot(off, off).sqrt() / plane.reach;
        let meeting = Meeting { t, cosine, depth: ONE_SHEET * plane.reach / cosine.max(STEEP) };
        if distance <= CERTAIN && !is_level {
            certain.push(meeting);
        } else if distance <= 1.0 {
            doubtful.push(meeting);
        }
    }
    certain.sort_by(|a, b| a.t.total_cmp(&b.t));
    let sheets: Vec<&[Meeting]> =
        certain.chunk_by(|a, b| b.t - a.t <= a.depth.max(b.depth)).collect();
    // Where planes end that no other goes on from, there is a gap or a rim.
    let goes_on = |doubt: &Meeting| {
        certain.iter().any(|meeting| (meeting.t - doubt.t).abs() <= meeting.depth.max(doubt.depth))
    };
    let ahead = |t: f64| t > 0.0;
    if doubtful.iter().any(|doubt| doubt.t > -doubt.depth && !goes_on(doubt)) {
        return None;
    }
    let mut count = 0;
    for sheet in sheets {
        let ahead_of = sheet.iter().filter(|meeting| ahead(meeting.t)).count();
        if ahead_of == 0 {
            continue;
        }
        let mean = sheet.iter().map(|meeting| meeting.cosine).sum::<f64>() / sheet.len() as f64;
        if ahead_of < sheet.len() || mean < STEEP {
            return None;
        }
        count += 1;
    }
    Some(count)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sphere(count: u32, radius: f64, center: V3) -> Vec<Point> {
        let golden = std::f64::consts::PI * (3.0 - 5f64.sqrt());
        (0..count)
            .map(|index| {
                let z = 1.0 - (2.0 * f64::from(index) + 1.0) / f64::from(count);
                let (sin, cos) = (golden * f64::from(index)).sin_cos();
                let level = (1.0 - z * z).sqrt();
                let place = [level * cos, level * sin, z];
                let position = [0, 1, 2].map(|i| (center[i] + radius * place[i]) as f32);
                Point { position, index }
            })
            .collect()
    }

    #[test]
    fn a_place_in_a_sphere_is_inside() {
        for count in [100, 1_000, 20_000] {
            let points = sphere(count, 1.0, [0.0; 3]);
            // Of a hundred points, neighbourhoods are as wide as the sphere near its surface.
            let farthest = if count > 100 { 0.9 } else { 0.4 };
            for place in [[0.0; 3], [0.3, -0.2, 0.5], [0.0, 0.0, farthest]] {
                let votes = votes(&points, place);
                assert!(votes.says_inside() && votes.is_clear(), "{count}, {place:?}: {votes:?}");
            }
            for place in [[0.75, 0.75, 0.0], [0.7, -0.7, 0.7], [0.0, 0.0, 1.2]] {
                let votes = votes(&points, place);
                let is_sure = votes.is_clear() || count == 100;
                assert!(!votes.says_inside() && is_sure, "{count}, {place:?}: {votes:?}");
            }
        }
    }

    #[test]
    fn near_the_surface_both_sides_are_told_apart() {
        let points = sphere(20_000, 1.0, [0.0; 3]);
        let votes = |radius: f64| votes(&points, [0.48 * radius, 0.6 * radius, 0.64 * radius]);
        assert!(votes(0.98).says_inside() && votes(0.98).is_clear(), "{:?}", votes(0.98));
        assert!(!votes(1.02).says_inside() && votes(1.02).is_clear(), "{:?}", votes(1.02));
    }

    #[test]
    fn of_a_shell_the_hollow_is_outside() {
        let mut points = sphere(8_000, 1.0, [0.0; 3]);
        points.extend(sphere(4_000, 0.6, [0.0; 3]));
        for (place, inside) in [([0.1, 0.0, 0.2], false), ([0.8, 0.0, 0.0], true)] {
            let votes = votes(&points, place);
            assert!(votes.says_inside() == inside && votes.is_clear(), "{place:?}: {votes:?}");
        }
    }

    /// Above a level sheet lines up cross nothing, lines down one sheet: nobody can say, and so it is outside.
    #[test]
    fn an_open_sheet_has_no_inside() {
        let at = |i: u32| f64::from(i) / 50.0;
        let sheet = |i: u32| {
            let [x, z] = [at(i % 100) - 1.0, at(i / 100) - 1.0];
            [x as f32, (0.3 * (3.0 * x).sin() * (2.0 * z).cos()) as f32, z as f32]
        };
        let points: Vec<Point> =
            (0..10_000).map(|index| Point { position: sheet(index), index }).collect();
        for place in [[0.1, 0.28, 0.0], [0.1, -0.2, 0.1]] {
            let votes = votes(&points, place);
            assert!(!votes.says_inside() && !votes.is_clear(), "{place:?}: {votes:?}");
        }
    }

    #[test]
    fn few_points_and_copies_have_no_inside() {
        let copies = vec![Point { position: [0.0; 3], index: 0 }; 50];
        for points in [&[][..], &copies[..3], &copies] {
            assert!(!votes(points, [0.0; 3]).says_inside());
        }
    }
}
