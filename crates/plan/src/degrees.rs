//! Objects whose x and y are longitude and latitude in degrees: projected to metres before anything else.
//!
//! The projection is azimuthal equidistant on the ellipsoid of WGS84: the distance of a point from the centre and
//! its direction there are those of the geodesic (Karney, Algorithms for geodesics, J. Geodesy 87, 2013).
//! Every place on Earth has its place, across the antimeridian and at the poles too; z stays the height, so
//! that a plain stays level. Lengths across the direction to the centre grow by 1 + d²/6R² at the distance d
//! (docs/method.md, section 1). All objects of a scene share one centre, and so line up.

use crate::PlanError;
use geographiclib_rs::{Geodesic, InverseGeodesic};
use points::{PointSet, Sensor, Units, Watch};
use rayon::prelude::*;
use scene::{Object, Scene};
use std::fmt;
use std::sync::Arc;

/// Points of an object by which the centre is chosen, at most.
const SAMPLE: usize = 1 << 16;
/// Points that a thread projects at once.
const PART: usize = 1 << 12;
/// Mean radius of the Earth in metres.
const RADIUS: f64 = 6.371e6;

/// From longitude and latitude in degrees to metres east and north of a centre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapProjection {
    /// Longitude and latitude of the centre, in degrees: it is at x = 0, y = 0.
    pub center: [f64; 2],
    /// How much too long lengths across the direction to the centre are, at most, for nineteen of twenty
    /// points: 0.01 is 1 %.
    pub stretch: f64,
}

/// In the notation of PROJ, which every geographic information system takes.
impl fmt::Display for MapProjection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [longitude, latitude] = self.center;
        write!(f, "+proj=aeqd +lat_0={latitude} +lon_0={longitude} +ellps=WGS84 +units=m")
    }
}

/// Whether x and y of an object are degrees: the scene has the last word.
#[must_use]
pub fn in_degrees(object: &Object, set: &PointSet) -> bool {
    match object.units {
        scene::Units::Degrees => true,
        scene::Units::Scene => false,
        scene::Units::Auto => matches!(set.units, Units::Degrees(_)),
    }
}

/// The sets with those that are in degrees projected, and how; `None` where none is.
pub(crate) fn projected(
    scene: &Scene,
    sets: &[Arc<PointSet>],
    watch: &dyn Watch,
) -> Result<(Vec<Arc<PointSet>>, Option<MapProjection>), PlanError> {
    let mut out = sets.to_vec();
    let asked: Vec<usize> =
        (0..sets.len()).filter(|&i| in_degrees(&scene.objects[i], &sets[i])).collect();
    for &i in &asked {
        check(i, &scene.objects[i], &sets[i])?;
    }
    let places: Vec<&[[f64; 3]]> = asked.iter().map(|&i| &sets[i].positions[..]).collect();
    let Some(projection) = MapProjection::of(&places) else { return Ok((out, None)) };
    watch.stage("projecting degrees", asked.len() as u64);
    for (n, &i) in asked.iter().enumerate() {
        watch.done(n as u64);
        // A file that several objects use is projected once.
        let known = asked[..n].iter().find(|&&earlier| Arc::ptr_eq(&sets[earlier], &sets[i]));
        out[i] = match known {
            Some(&earlier) => Arc::clone(&out[earlier]),
            None => Arc::new(projection.whole(&sets[i])),
        };
    }
    Ok((out, Some(projection)))
}

fn is_place(p: &[f64; 3]) -> bool {
    p[0].abs() <= 360.0 && p[1].abs() <= 90.0
}

/// Fails at the first point that is nowhere on Earth.
fn check(index: usize, object: &Object, set: &PointSet) -> Result<(), PlanError> {
    let Some(at) = set.positions.iter().position(|p| !is_place(p)) else { return Ok(()) };
    let [x, y, _] = set.positions[at];
    let beyond = set.positions.iter().filter(|p| !is_place(p)).count();
    let axis_of = |p: &[f64; 3]| p[1].abs() <= 360.0 && p[0].abs() <= 90.0;
    let advice = if set.positions.iter().all(axis_of) {
        "the two look swapped: longitude belongs in x; name the columns longitude and latitude, or export them in \
         that order".to_owned()
    } else if beyond * 2 > set.len() {
        format!("if x and y are lengths, set units = \"scene\" (--set objects.{index}.units=scene)")
    } else {
        "leave such points out by objects.filter: range = { x = [-180, 360], y = [-90, 90] }"
            .to_owned()
    };
    Err(PlanError::NoPlace {
        name: object.name.clone(),
        file: object.points_as_written.clone(),
        index: set.file_index.get(at).copied().unwrap_or_default(),
        place: [x, y],
        count: beyond,
        advice,
    })
}

/// Where longitudes and latitudes lie: twice the longitudes, counted from -180 and from 0, and once the
/// latitudes.
type Extent = [[f64; 2]; 3];

impl MapProjection {
    /// The projection about the middle of the boxes of these places, in degrees; `None` without any.
    ///
    /// A box is that of most points, so that a few strays do not move it. Longitudes are counted across the
    /// antimeridian where the box is narrower so. Of places all around a pole, the pole is the middle. The
    /// middle is rounded to a tenth of the box's size or less: it stays where it is if few points come or go.
    pub(crate) fn of(places: &[&[[f64; 3]]]) -> Option<Self> {
        let extents = places.iter().filter_map(|places| extent(places));
        let joined =
            |a: Extent, b: Extent| [0, 1, 2].map(|i| [a[i][0].min(b[i][0]), a[i][1].max(b[i][1])]);
        let [from_west, from_zero, latitudes] = extents.reduce(joined)?;
        let width = |range: [f64; 2]| range[1] - range[0];
        let longitudes = if width(from_zero) < width(from_west) { from_zero } else { from_west };
        let around = width(longitudes) > 180.0;
        let middle = |range: [f64; 2]| 0.5 * (range[0] + range[1]);
        let center = if around && latitudes[0] > 0.0 {
            [0.0, 90.0]
        } else if around && latitudes[1] < 0.0 {
            [0.0, -90.0]
        } else {
            let [longitude, latitude] = [longitudes, latitudes].map(middle);
            let size = width(latitudes).max(width(longitudes) * latitude.to_radians().cos());
            // The whole globe has no middle.
            let longitude = if width(longitudes) > 340.0 { 0.0 } else { rounded(longitude, size) };
            let wrapped = if longitude >= 180.0 { longitude - 360.0 } else { longitude };
            // The difference may have lost its last digits.
            [rounded(wrapped, size), rounded(latitude, size).clamp(-90.0, 90.0)]
        };
        let mut projection = Self { center, stretch: 0.0 };
        projection.stretch = projection.stretch_of(places);
        Some(projection)
    }

    /// Metres east and north of the centre; z as it is.
    pub(crate) fn apply(&self, geodesic: &Geodesic, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let [longitude, latitude] = self.center;
        let (distance, azimuth, _, _): (f64, f64, f64, f64) =
            geodesic.inverse(latitude, longitude, y, x);
        let (east, north) = azimuth.to_radians().sin_cos();
        [distance * east, distance * north, z]
    }

    /// A set with its sensors.
    fn whole(&self, set: &PointSet) -> PointSet {
        let geodesic = Geodesic::wgs84();
        let moved = |sensor: &Sensor| {
            let position = self.apply(&geodesic, sensor.position);
            Sensor { position, ..sensor.clone() }
        };
        let sensors = set.sensors.iter().filter(|sensor| is_place(&sensor.position));
        PointSet {
            positions: self.all(&set.positions),
            sensors: sensors.map(moved).collect(),
            ..set.clone()
        }
    }

    /// The same of many.
    pub(crate) fn all(&self, places: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let geodesic = Geodesic::wgs84();
        let places = places.par_iter().with_min_len(PART);
        places.map(|&place| self.apply(&geodesic, place)).collect()
    }

    fn stretch_of(&self, places: &[&[[f64; 3]]]) -> f64 {
        const FEW: usize = 512;
        let geodesic = Geodesic::wgs84();
        let all: usize = places.iter().map(|places| places.len()).sum();
        let sample = places.iter().copied().flatten().step_by(all.div_ceil(FEW).max(1));
        let mut distances: Vec<f64> =
            sample.map(|&place| self.apply(&geodesic, place)).map(|[x, y, _]| x.hypot(y)).collect();
        distances.sort_unstable_by(f64::total_cmp);
        let Some(&far) = distances.get(distances.len() * 19 / 20) else { return 0.0 };
        let angle = (far / RADIUS).min(std::f64::consts::PI);
        if angle < 1e-4 { angle * angle / 6.0 } else { angle / angle.sin().max(1e-3) - 1.0 }
    }
}

/// The box of most points: what lies between the twentieth parts at either end, widened as if points lay
/// evenly.
fn extent(places: &[[f64; 3]]) -> Option<Extent> {
    let sample = || places.iter().step_by(places.len().div_ceil(SAMPLE).max(1));
    let most = |mut values: Vec<f64>| {
        values.sort_unstable_by(f64::total_cmp);
        let rim = values.len() / 20;
        let (&low, &high) = (values.get(rim)?, values.get(values.len() - 1 - rim)?);
        let more = (high - low) * rim as f64 / (values.len() - 2 * rim) as f64;
        Some([low - more, high + more])
    };
    let from_zero = |p: &[f64; 3]| p[0].rem_euclid(360.0);
    let from_west = |p: &[f64; 3]| (p[0] + 180.0).rem_euclid(360.0) - 180.0;
    Some([
        most(sample().map(from_west).collect())?,
        most(sample().map(from_zero).collect())?,
        most(sample().map(|p| p[1]).collect())?,
    ])
}

/// Rounded to the largest power of ten that is a tenth of `size` at most.
fn rounded(value: f64, size: f64) -> f64 {
    // A ten-thousandth of a millimetre is enough, of a single point too.
    let digits = (1.0 - size.log10().floor()).clamp(0.0, 12.0) as usize;
    // As text, so that what is printed is what is meant.
    format!("{value:.digits$}").parse().map_or(value, |rounded: f64| rounded + 0.0)
}

#[cfg(test)]
mod tests;
