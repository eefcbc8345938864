//! Points: which of a file are read, once for all objects that have it, and what is reported about them.

use super::{Input, leave_out_folder};
use crate::errors::Failure;
use crate::progress::Progress;
use points::{Dropped, PointSet, ReadOptions, Wanted, Watch};
use scene::{Object, Scene};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

impl Input {
    /// Reads of every object's points what a render needs, and reports those that are of no use or left out. How a
    /// point file is shown is decided by its points.
    pub fn read_points(&mut self, progress: &Progress) -> Result<Vec<Arc<PointSet>>, Failure> {
        let Some(point_file) = &self.point_file else {
            return self.read_as(plan::read_options, progress);
        };
        let mut sets = self.read_as(|object| point_file.options(object), progress)?;
        let up = self.up_of(&sets);
        let read_all = || {
            let object = &self.scene.objects[0];
            let options = ReadOptions { wanted: Wanted::All, ..plan::read_options(object) };
            progress.stage(
                "reading attributes",
                fs::metadata(&object.points).map_or(0, |file| file.len()),
            );
            let set =
                points::read_with(&object.points, &options, &mut |done, _| progress.done(done));
            progress.clear();
            Ok(set?)
        };
        let Some(first) = sets.first_mut() else { return Ok(sets) };
        let mut values = point_file.choose(&self.scene, first, up, read_all, progress)?;
        if !values.is_empty() {
            values.extend(point_file.values.iter().cloned());
            let quality = point_file.quality;
            self.scene = Scene::for_point_file(&self.path, self.up, quality, &values)?;
            self.options.apply(&mut self.scene, &self.path, false)?;
            leave_out_folder(&mut self.scene, &self.path);
        }
        Ok(sets)
    }

    /// The same with everything that the files have.
    pub fn read_all(&self, progress: &Progress) -> Result<Vec<Arc<PointSet>>, Failure> {
        let all = |object: &Object| ReadOptions {
            wanted: Wanted::All,
            filter: plan::point_filter(&object.filter),
            columns: plan::point_columns(&object.columns),
            ..ReadOptions::default()
        };
        self.read_as(all, progress)
    }

    /// Reads each file once for all objects with the same filter and columns.
    fn read_as(
        &self,
        options: impl Fn(&Object) -> ReadOptions,
        progress: &Progress,
    ) -> Result<Vec<Arc<PointSet>>, Failure> {
        let mut jobs: Vec<(PathBuf, &Path, ReadOptions)> = Vec::new();
        let mut job_of = Vec::new();
        for object in &self.scene.objects {
            // Its points follow from those of the others, in the plan.
            if object.is_ground() {
                job_of.push(None);
                continue;
            }
            let (file, options) = (same_file(&object.points), options(object));
            let known = jobs.iter().position(|job| {
                let known = (&job.2.filter, &job.2.columns);
                job.0 == file && known == (&options.filter, &options.columns)
            });
            if let Some(job) = known {
                jobs[job].2.wanted = jobs[job].2.wanted.or(&options.wanted);
            } else {
                jobs.push((file, &object.points, options));
            }
            job_of.push(Some(known.unwrap_or(jobs.len() - 1)));
        }
        let sets = jobs
            .iter()
            .map(|(_, path, options)| Ok(Arc::new(read_file(path, options, progress)?)))
            .collect::<Result<Vec<_>, Failure>>()?;
        let set_of =
            |job: Option<usize>| job.map_or_else(Arc::default, |job| Arc::clone(&sets[job]));
        Ok(job_of.into_iter().map(set_of).collect())
    }
}

/// One name for all names of a file.
pub(super) fn same_file(path: &Path) -> PathBuf {
    fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf())
}

/// Reads one point file, and tells of points that are of no use or left out.
pub fn read_file(
    path: &Path,
    options: &ReadOptions,
    progress: &Progress,
) -> Result<PointSet, Failure> {
    progress.stage("reading points", fs::metadata(path).map_or(0, |file| file.len()));
    let set = points::read_with(path, options, &mut |done, _| progress.done(done))?;
    progress.clear();
    let dropped = Dropped { non_finite: set.non_finite, invalid: set.invalid };
    note_points(path, &set.notes, dropped, set.len() as u64 + set.filtered_out, progress);
    if !options.filter.keeps_all() {
        let (kept, all) = (set.len(), set.len() as u64 + set.filtered_out);
        let file = path.display();
        progress.note(&format!("{file}: kept {kept} of {all} points ({})", options.filter));
    }
    Ok(set)
}

/// Says what a reader assumed, and how many points are of no use besides so many that are.
pub fn note_points(
    path: &Path,
    notes: &[String],
    dropped: Dropped,
    usable: u64,
    progress: &Progress,
) {
    let file = path.display();
    for note in notes {
        progress.note(&format!("{file}: {note}"));
    }
    for (count, why) in [
        (dropped.non_finite, "whose position is infinite or not a number"),
        (dropped.invalid, "which the file marks as invalid"),
    ] {
        if count > 0 {
            let all = usable + dropped.count();
            progress.warn(&format!("{file}: dropped {count} of {all} points, {why}"));
        }
    }
}
