//! Point sets and files gone through once for their ranges, and once more for histograms and spacing.
//!
//! Of a file no more is held than a few blocks of points, the hashes and the sample of [`Distinct`], and the
//! counts of [`Columns`]: some 150 MB, whatever the number of points. A file whose points take less than
//! [`HELD_BYTES`] is read once and held.

use super::bulk::Bulk;
use super::columns::{Colors, Columns};
use super::{Dropped, PointSummary};
use crate::distinct::Distinct;
use crate::error::PointsError;
use crate::options::{ReadOptions, Wanted};
use crate::read::Input;
use crate::set::PointSet;
use crate::spacing::Nearest;
use crate::stream::in_blocks;
use crate::watch::Watch;
use std::path::Path;

/// Points of a file that take no more are held for the second pass.
const HELD_BYTES: usize = 1 << 25;

/// Summarises a point file of any size in memory that does not grow with it: in one pass, or two where it is
/// larger than a few megabytes. What comes through a pipe is held as it comes.
///
/// # Errors
/// As [`read_with`](crate::read_with), and if the file changes while it is read.
pub fn summarize(
    path: &Path,
    options: &ReadOptions,
    watch: &dyn Watch,
) -> Result<PointSummary, PointsError> {
    let input = Input::open(path)?;
    let pass =
        |name,
         options: &ReadOptions,
         take: &mut (dyn FnMut(Option<PointSet>) -> Option<PointSet> + Send)| {
            watch.stage(name, input.length());
            let read =
                |options: &ReadOptions| input.read(path, options, &mut |done, _| watch.done(done));
            in_blocks(options, read, take)
        };

    let (mut first, mut held) = (First::new(), Held::default());
    let set = pass("reading points", options, &mut |block| {
        let Some(block) = block else {
            (first, held) = (First::new(), Held::default());
            return None;
        };
        first.see(&block, Colors::Stored);
        held.take(block)
    })?;
    let (mut second, wanted) = first.second_pass(&set);
    if let Some(blocks) = &held.blocks {
        second.bulk = Bulk::of_blocks(blocks);
    }
    let Some(wanted) = wanted else { return Ok(second.finish(&set)) };
    if let Some(blocks) = held.blocks {
        watch.stage("counting values", blocks.len() as u64);
        for (block, done) in blocks.iter().zip(1..) {
            second.see(block, Colors::Stored);
            watch.done(done);
        }
        return Ok(second.finish(&set));
    }
    let options = ReadOptions { wanted, ..options.clone() };
    let again = pass("counting values", &options, &mut |block| {
        match &block {
            Some(block) => second.see(block, Colors::Stored),
            None => second.begin_again(),
        }
        block
    })?;
    let counts = |set: &PointSet| [set.non_finite, set.invalid, set.filtered_out];
    if second.seen != second.points || counts(&again) != counts(&set) {
        return Err(PointsError::Changed { path: path.into() });
    }
    Ok(second.finish(&set))
}

impl PointSummary {
    /// Summarises a point set that is held.
    pub fn of(set: &PointSet) -> Self {
        let mut first = First::new();
        first.see(set, Colors::Linear);
        let (mut second, wanted) = first.second_pass(set);
        second.bulk = Bulk::of(&set.positions);
        if wanted.is_some() {
            second.see(set, Colors::Linear);
        }
        second.finish(set)
    }
}

/// Blocks of a file whose points take little memory.
struct Held {
    /// `None` if they take too much.
    blocks: Option<Vec<PointSet>>,
    bytes: usize,
}

impl Default for Held {
    fn default() -> Self {
        Self { blocks: Some(Vec::new()), bytes: 0 }
    }
}

impl Held {
    /// Keeps a block, or gives it back.
    fn take(&mut self, block: PointSet) -> Option<PointSet> {
        self.bytes += block.bytes();
        if self.bytes > HELD_BYTES {
            self.blocks = None;
        }
        match &mut self.blocks {
            Some(blocks) => {
                blocks.push(block);
                None
            }
            None => Some(block),
        }
    }
}

/// What the first pass finds out.
struct First {
    points: u64,
    min: [f64; 3],
    max: [f64; 3],
    columns: Columns,
    distinct: Distinct,
}

impl First {
    fn new() -> Self {
        Self {
            points: 0,
            min: [f64::NAN; 3],
            max: [f64::NAN; 3],
            columns: Columns::default(),
            distinct: Distinct::new(),
        }
    }

    fn see(&mut self, block: &PointSet, colors: Colors) {
        for position in &block.positions {
            for (axis, &coordinate) in position.iter().enumerate() {
                // Least and greatest of a number and NaN are the number.
                self.min[axis] = self.min[axis].min(coordinate);
                self.max[axis] = self.max[axis].max(coordinate);
            }
            self.distinct.see(position);
        }
        self.points += block.positions.len() as u64;
        self.columns.see(block, colors);
    }

    /// What the second pass begins with, and which numbers have to go past in it: `None` if it is not needed.
    fn second_pass(mut self, set: &PointSet) -> (Second, Option<Wanted>) {
        let values = self.columns.second_pass(set);
        let coincident = self.distinct.coincident();
        let bulk = Bulk::of_distinct(&self.distinct);
        let nearest = Nearest::new(self.distinct);
        let no_values = || Wanted::Some { colors: false, normals: false, attributes: Vec::new() };
        let wanted = values.or_else(|| nearest.needs_all().then(no_values));
        let second = Second {
            points: self.points,
            min: self.min,
            max: self.max,
            coincident,
            columns: self.columns,
            bulk,
            nearest,
            seen: 0,
        };
        (second, wanted)
    }
}

/// What the second pass adds.
struct Second {
    points: u64,
    min: [f64; 3],
    max: [f64; 3],
    coincident: (u64, bool),
    columns: Columns,
    bulk: Bulk,
    nearest: Nearest,
    /// Points that went past.
    seen: u64,
}

impl Second {
    fn see(&mut self, block: &PointSet, colors: Colors) {
        if self.nearest.needs_all() {
            block.positions.iter().for_each(|position| self.nearest.see(position));
        }
        self.bulk.see(&block.positions);
        self.seen += block.positions.len() as u64;
        self.columns.count(block, colors);
    }

    fn begin_again(&mut self) {
        // The same points once more bring no other neighbours.
        self.seen = 0;
        self.bulk.begin_again();
        self.columns.begin_again();
    }

    /// `set` has all that is known of the file besides its points.
    fn finish(self, set: &PointSet) -> PointSummary {
        let (coincident, coincident_counted) = self.coincident;
        let found = self.bulk.finish(self.points, [self.min, self.max]);
        let (spacing, spacing_sample) = self.nearest.median().unzip();
        PointSummary {
            format: set.format.clone(),
            points: self.points,
            dropped: Dropped { non_finite: set.non_finite, invalid: set.invalid },
            filtered_out: set.filtered_out,
            min: self.min,
            max: self.max,
            bulk: found.bulk,
            apart: found.apart,
            attributes: self.columns.finish(),
            coincident,
            coincident_counted,
            dimension: None,
            noise: None,
            spacing,
            spacing_sample: spacing_sample.flatten(),
            notes: set.notes.clone(),
            units: set.units.clone(),
            sensors: set.sensors.clone(),
        }
    }
}
