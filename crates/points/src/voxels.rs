//! Means of the points in each cube of a grid.
//!
//! The grid's corners are multiples of its edge in the coordinates of the file, and only cubes with points are held,
//! so that neither survey coordinates nor a far stray matter. Sums are taken in the order of the file, of distances
//! from a cube's first point; so a cube of one point keeps its numbers, and no digit of a large offset is lost.

use crate::names;
use crate::set::{Attribute, PointSet, Values};
use crate::spacing::median_spacing;
use std::collections::HashMap;
use std::collections::hash_map::Entry;

/// The edge of the cubes that keep one point each.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Voxel {
    /// In the units of the file, greater than zero.
    Edge(f64),
    /// [`AUTO`] times the median distance of positions to the nearest other one.
    Auto,
}

/// Median distances from a point to the nearest other one in an automatic edge. Of points spread at random over a
/// surface it is the mean distance of neighbours, so that the median density about stays, and denser parts are thinned to it.
pub(crate) const AUTO: f64 = 2.0;

/// The points of a set as means of the cubes of this edge, those of cubes with at least `least` points.
///
/// Each mean has the place in the file of its cube's first point, and means are in that order. Positions are
/// means, and so are colours, in linear light. Normals are turned to the side of the cube's first one, added as unit
/// vectors, and the sum is turned to the side of the majority; it has length 1. Attributes that are classes have the value that most
/// points have, of several the smallest: integers, and whatever [`is_class`] finds by its name. Others have their
/// mean, rounded in integers. Values that are no numbers do not count, unless a cube has no others. Points that are no longer there count as
/// [`filtered_out`](PointSet::filtered_out).
///
/// # Panics
/// If the edge is not greater than zero.
#[must_use]
pub fn voxel_means(set: &PointSet, edge: f64, least: usize) -> PointSet {
    assert!(edge > 0.0, "voxel_means: an edge of {edge}");
    let mut voxels = Voxels::new(edge, set, 1);
    for (i, &position) in set.positions.iter().enumerate() {
        let (voxel, _) = voxels.find(position, set.file_index[i]);
        if let Some(colors) = &set.colors {
            voxels.add_color(voxel, &colors[i..=i]);
        }
        if let Some(normals) = &set.normals {
            voxels.add_normal(voxel, normals[i]);
        }
        for (place, attribute) in set.attributes.iter().enumerate() {
            voxels.add_value(voxel, place, attribute.values.get(i));
        }
    }
    let mut means = voxels.means(set.filtered(|_| false), 0, least);
    means.filtered_out += (set.len() - means.len()) as u64;
    means
}

/// The same with an automatic edge, which is returned as well; `None` where all points are in one place.
pub(crate) fn automatic(set: &PointSet) -> (PointSet, Option<f64>) {
    let spacing = median_spacing(&set.positions);
    let edge = spacing.map(|spacing| (AUTO * spacing).clamp(f64::MIN_POSITIVE, f64::MAX));
    (voxel_means(set, edge.unwrap_or(1.0), 1), edge)
}

/// Whether a mean of this attribute means nothing: integers are classes, numbers or flags unless their name says that they
/// are a quantity, and floats are only where it says so.
fn is_class(Attribute { name, values }: &Attribute) -> bool {
    const CLASSES: [&str; 15] = [
        "classification",
        "class",
        "classes",
        "label",
        "labels",
        "segment",
        "cluster",
        "id",
        "pointid",
        "pointsourceid",
        "returnnumber",
        "returnindex",
        "numberofreturns",
        "returncount",
        "userdata",
    ];
    const QUANTITIES: [&str; 18] = [
        "intensity",
        "intensities",
        "i",
        "amplitude",
        "reflectance",
        "reflectivity",
        "deviation",
        "confidence",
        "quality",
        "scanangle",
        "scananglerank",
        "nir",
        "infrared",
        "nearinfrared",
        "alpha",
        "range",
        "time",
        "timestamp",
    ];
    let name = names::plain(name);
    if CLASSES.contains(&name.as_str()) {
        return true;
    }
    !matches!(values, Values::F32(_) | Values::F64(_)) && !QUANTITIES.contains(&name.as_str())
}

/// Cubes with points, in the order of their first points.
pub(crate) struct Voxels {
    edge: f64,
    places: HashMap<[u64; 3], u32>,
    file_index: Vec<u32>,
    counts: Vec<u32>,
    first: Vec<[f64; 3]>,
    /// Of the distances from the first point.
    sums: Vec<[f64; 3]>,
    /// Where points have colours: sums and counts, as many of each cube as there are scales.
    colors: Option<Vec<([f64; 3], u32)>>,
    scales: usize,
    normals: Option<Vec<Normal>>,
    attributes: Vec<Numbers>,
}

/// The normals of a cube.
#[derive(Clone, Copy, Default)]
struct Normal {
    first: [f64; 3],
    /// Of unit vectors on the side of the first.
    sum: [f64; 3],
    /// Those that pointed to that side, less those that did not.
    majority: i64,
}

/// The numbers of one attribute.
enum Numbers {
    Mean(Vec<(f64, u32)>),
    Mode {
        /// The first value of each cube, and how often it came.
        first: Vec<(f64, u32)>,
        /// The same of other values, by cube and bits.
        others: HashMap<(u32, u64), u32>,
    },
}

impl Voxels {
    /// No cubes yet. `set` has the kinds of lists that points have; colours come in `scales` ways.
    pub(crate) fn new(edge: f64, set: &PointSet, scales: usize) -> Self {
        let numbers = |attribute: &Attribute| match is_class(attribute) {
            true => Numbers::Mode { first: Vec::new(), others: HashMap::new() },
            false => Numbers::Mean(Vec::new()),
        };
        Self {
            edge,
            places: HashMap::new(),
            file_index: Vec::new(),
            counts: Vec::new(),
            first: Vec::new(),
            sums: Vec::new(),
            colors: set.colors.is_some().then(Vec::new),
            scales,
            normals: set.normals.is_some().then(Vec::new),
            attributes: set.attributes.iter().map(numbers).collect(),
        }
    }

    /// How many cubes have points.
    pub(crate) fn len(&self) -> usize {
        self.counts.len()
    }

    /// No point has a colour after all.
    pub(crate) fn without_colors(&mut self) {
        self.colors = None;
    }

    /// Adds a point: the cube that has it, and whether it is that cube's first.
    pub(crate) fn find(&mut self, position: [f64; 3], file_index: u32) -> (u32, bool) {
        let cell = position.map(|x| {
            let cell = (x / self.edge).floor();
            // Adding 0 makes -0 the same as 0. Beyond all f64, each number is a cell.
            (if cell.is_finite() { cell + 0.0 } else { x }).to_bits()
        });
        let next = self.counts.len() as u32;
        match self.places.entry(cell) {
            Entry::Vacant(place) => {
                place.insert(next);
                self.file_index.push(file_index);
                self.counts.push(1);
                self.first.push(position);
                self.sums.push([0.0; 3]);
                if let Some(colors) = &mut self.colors {
                    colors.extend(std::iter::repeat_n(([0.0; 3], 0), self.scales));
                }
                if let Some(normals) = &mut self.normals {
                    normals.push(Normal::default());
                }
                for attribute in &mut self.attributes {
                    match attribute {
                        Numbers::Mean(list) => list.push((0.0, 0)),
                        Numbers::Mode { first, .. } => first.push((f64::NAN, 0)),
                    }
                }
                (next, true)
            }
            Entry::Occupied(place) => {
                let voxel = *place.get();
                let at = voxel as usize;
                self.counts[at] += 1;
                let first = self.first[at];
                self.sums[at] = add(self.sums[at], [0, 1, 2].map(|i| position[i] - first[i]));
                (voxel, false)
            }
        }
    }

    /// Adds the colour of a point, by each scale.
    pub(crate) fn add_color(&mut self, voxel: u32, colors: &[[f32; 3]]) {
        let Some(sums) = &mut self.colors else { return };
        let of_voxel = &mut sums[voxel as usize * self.scales..][..self.scales];
        for ((sum, count), color) in of_voxel.iter_mut().zip(colors) {
            if color.iter().all(|channel| !channel.is_nan()) {
                *count += 1;
                *sum = add(*sum, color.map(f64::from));
            }
        }
    }

    /// Adds the normal of a point.
    pub(crate) fn add_normal(&mut self, voxel: u32, normal: [f32; 3]) {
        let Some(normals) = &mut self.normals else { return };
        let of_voxel = &mut normals[voxel as usize];
        let normal = normal.map(f64::from);
        let length = dot(normal, normal).sqrt();
        if !(length > 0.0 && length.is_finite()) {
            return;
        }
        let unit = normal.map(|x| x / length);
        if of_voxel.first == [0.0; 3] {
            of_voxel.first = unit;
        }
        let side = if dot(unit, of_voxel.first) < 0.0 { -1.0 } else { 1.0 };
        of_voxel.majority += side as i64;
        of_voxel.sum = add(of_voxel.sum, unit.map(|x| side * x));
    }

    /// Adds a value of the attribute in this place.
    pub(crate) fn add_value(&mut self, voxel: u32, attribute: usize, value: f64) {
        if value.is_nan() {
            return;
        }
        match &mut self.attributes[attribute] {
            Numbers::Mean(list) => {
                let (sum, count) = &mut list[voxel as usize];
                *sum += value;
                *count += 1;
            }
            Numbers::Mode { first, others } => {
                // Adding 0 makes -0 the same as 0.
                let value = value + 0.0;
                let (known, count) = &mut first[voxel as usize];
                if *count == 0 {
                    *known = value;
                }
                if *known == value {
                    *count += 1;
                } else {
                    *others.entry((voxel, value.to_bits())).or_insert(0) += 1;
                }
            }
        }
    }

    /// Fills a set without points with the means of cubes with so many points, colours by one of the scales.
    pub(crate) fn means(self, mut set: PointSet, scale: usize, least: usize) -> PointSet {
        let counts = self.counts;
        let kept: Vec<usize> =
            (0..counts.len()).filter(|&voxel| counts[voxel] as usize >= least).collect();
        set.positions = (kept.iter())
            .map(|&voxel| {
                let (first, sum) = (self.first[voxel], self.sums[voxel]);
                let mean = [0, 1, 2].map(|i| first[i] + sum[i] / f64::from(counts[voxel]));
                if mean.iter().all(|x| x.is_finite()) { mean } else { first }
            })
            .collect();
        set.file_index = kept.iter().map(|&voxel| self.file_index[voxel]).collect();
        set.colors = self.colors.map(|colors| {
            let mean = |&voxel: &usize| {
                let (sum, count) = colors[voxel * self.scales + scale];
                sum.map(|sum| (sum / f64::from(count)) as f32)
            };
            kept.iter().map(mean).collect()
        });
        set.normals =
            self.normals.map(|normals| kept.iter().map(|&voxel| normals[voxel].mean()).collect());
        for (attribute, numbers) in set.attributes.iter_mut().zip(self.attributes) {
            let whole = !matches!(attribute.values, Values::F32(_) | Values::F64(_));
            let values = numbers.chosen();
            for &voxel in &kept {
                let value = values[voxel];
                attribute.values.push(if whole { value.round() } else { value });
            }
        }
        set
    }
}

impl Normal {
    /// Of length 1; zero where no normal of the cube has a direction.
    fn mean(self) -> [f32; 3] {
        let side = if self.majority < 0 { -1.0 } else { 1.0 };
        let length = dot(self.sum, self.sum).sqrt();
        if length > 0.0 { self.sum.map(|x| (side * x / length) as f32) } else { [0.0; 3] }
    }
}

impl Numbers {
    /// One value a cube; NaN where it has none.
    fn chosen(self) -> Vec<f64> {
        match self {
            Self::Mean(list) => {
                list.into_iter().map(|(sum, count)| sum / f64::from(count)).collect()
            }
            Self::Mode { first: mut best, others } => {
                // Whichever comes first in the map, the best of all is left.
                for ((voxel, bits), count) in others {
                    let value = f64::from_bits(bits);
                    let (known, most) = &mut best[voxel as usize];
                    if count > *most || count == *most && value < *known {
                        (*known, *most) = (value, count);
                    }
                }
                best.into_iter().map(|(value, _)| value).collect()
            }
        }
    }
}

fn add(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| a[i] + b[i])
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests;
