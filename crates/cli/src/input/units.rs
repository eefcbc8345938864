//! What is reported about degrees and metres.

use super::Input;
use crate::progress::Progress;
use plan::MapProjection;
use points::PointSet;
use scene::Units;
use std::sync::Arc;

impl Input {
    /// Says which points are taken for degrees, and which only look like it.
    pub(super) fn note_units(&self, sets: &[Arc<PointSet>], progress: &Progress) {
        for (index, (object, set)) in self.scene.objects.iter().zip(sets).enumerate() {
            let known = sets[..index].iter().any(|earlier| Arc::ptr_eq(earlier, set));
            if known || object.units != Units::Auto {
                continue;
            }
            let file = object.points.display();
            if let points::Units::Degrees(reason) = &set.units {
                progress.note(&format!(
                    "{file}: x and y are taken as longitude and latitude in degrees, since {reason}, and \
                     projected to metres; --set objects.{index}.units=scene leaves them as they are"
                ));
            }
            if let Some(note) = looks_like_degrees(&set.units, index) {
                progress.warn(&format!("{file}: {note}"));
            }
        }
    }
}

/// The doubt about numbers that look like degrees, of an object of this index.
pub fn looks_like_degrees(units: &points::Units, index: usize) -> Option<String> {
    (*units == points::Units::LikeDegrees).then(|| {
        format!(
            "x and y look like longitude and latitude in degrees beside heights in metres, but nothing in the \
             file says so, and they are left as they are; --set objects.{index}.units=degrees projects them to \
             metres"
        )
    })
}

pub(super) fn note_projection(projection: &MapProjection, progress: &Progress) {
    let [longitude, latitude] = projection.center;
    progress.note(&format!(
        "degrees become metres east (x) and north (y) of longitude {longitude}, latitude {latitude} \
         ({projection}); camera, lights and transforms are in these"
    ));
    if projection.stretch > 0.01 {
        progress.warn(&format!(
            "the points in degrees reach so far that lengths are up to {:.0} % too long away from the \
             centre; choose a smaller part by objects.filter for true proportions",
            100.0 * projection.stretch
        ));
    }
}
