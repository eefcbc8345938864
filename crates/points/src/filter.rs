//! Which points of a file are kept.

use crate::voxels::Voxel;
use std::fmt;

/// Which points of a file are kept. The default is all of them.
///
/// The conditions are applied in the order of the fields, while the file is read: `every` counts
/// the points of the file, whatever the others drop; `voxel` comes last, so that a point is the mean of
/// what all others keep in its cube.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Filter {
    /// The first point of the file and every n-th after it; 0 and 1 keep all.
    pub every: u32,
    /// Lowest and highest corner of a box in the file's coordinates, both ends within.
    pub bounds: Option<[[f64; 3]; 2]>,
    /// Attributes, or `x`, `y`, `z`, with the least and the greatest value that is kept.
    pub ranges: Vec<(String, [f64; 2])>,
    /// Values of `classification` that are kept.
    pub classes: Option<Vec<u32>>,
    /// Cubes, from the origin of the file's coordinates on, of whose points one is made
    /// ([`voxel_means`](crate::voxel_means)).
    pub voxel: Option<Voxel>,
}

/// The attribute that [`Filter::classes`] is about.
pub(crate) const CLASSIFICATION: &str = "classification";

impl Filter {
    /// Whether every point is kept.
    pub fn keeps_all(&self) -> bool {
        self.every <= 1
            && self.bounds.is_none()
            && self.ranges.is_empty()
            && self.classes.is_none()
            && self.voxel.is_none()
    }

    /// Names of the attributes that are looked at.
    pub(crate) fn names(&self) -> impl Iterator<Item = &str> {
        let classes = self.classes.is_some().then_some(CLASSIFICATION);
        self.ranges.iter().map(|(name, _)| name.as_str()).chain(classes)
    }
}

impl fmt::Display for Filter {
    /// As a scene file says it.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut parts = Vec::new();
        if self.every > 1 {
            parts.push(format!("every = {}", self.every));
        }
        if let Some([min, max]) = self.bounds {
            parts.push(format!("box = {{ min = {min:?}, max = {max:?} }}"));
        }
        if !self.ranges.is_empty() {
            let range =
                |(name, [min, max]): &(String, [f64; 2])| format!("{name} = [{min}, {max}]");
            let ranges: Vec<_> = self.ranges.iter().map(range).collect();
            parts.push(format!("range = {{ {} }}", ranges.join(", ")));
        }
        if let Some(classes) = &self.classes {
            parts.push(format!("classification = {classes:?}"));
        }
        match self.voxel {
            Some(Voxel::Edge(edge)) => parts.push(format!("voxel = {edge}")),
            Some(Voxel::Auto) => parts.push("voxel = \"auto\"".to_owned()),
            None => {}
        }
        write!(f, "{}", parts.join(", "))
    }
}

/// A filter at work on a file, but for its voxels.
pub(crate) struct Sieve {
    filter: Filter,
    /// Where in a row the filter's names stand, in the order of [`Filter::names`].
    places: Vec<usize>,
    /// Points of the file that are to be passed over before the next is looked at.
    to_skip: u32,
}

impl Sieve {
    /// `places` are those of [`Filter::names`] in the rows to come.
    pub(crate) fn new(filter: &Filter, places: Vec<usize>) -> Self {
        Self { filter: filter.clone(), places, to_skip: 0 }
    }

    /// Whether the next point of the file is passed over whatever it is. To be asked once a point.
    pub(crate) fn skips(&mut self) -> bool {
        if self.to_skip > 0 {
            self.to_skip -= 1;
            return true;
        }
        self.to_skip = self.filter.every.saturating_sub(1);
        false
    }

    /// Whether a point that is not skipped, with a finite position, is kept.
    pub(crate) fn keeps(&self, position: [f64; 3], row: &[f64]) -> bool {
        let within = |[min, max]: [f64; 2], value: f64| value >= min && value <= max;
        let in_box = |[min, max]: [[f64; 3]; 2]| {
            (0..3).all(|axis| within([min[axis], max[axis]], position[axis]))
        };
        let mut ranges = self.filter.ranges.iter().zip(&self.places);
        let in_ranges = ranges.all(|((_, range), &place)| within(*range, row[place]));
        let of_a_class = |classes: &Vec<u32>| {
            self.places
                .last()
                .is_some_and(|&place| classes.iter().any(|&class| f64::from(class) == row[place]))
        };
        self.filter.bounds.is_none_or(in_box)
            && in_ranges
            && self.filter.classes.as_ref().is_none_or(of_a_class)
    }
}
