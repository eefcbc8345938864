//! What the x and y of a file are: lengths like z, or longitude and latitude in degrees.
//!
//! A file says so by the names of its columns or by its coordinate reference system. Numbers that only
//! look like degrees are left as they are: a model may have any numbers, and the user is asked.

use crate::meaning::plain;

/// What x and y of a point set are.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Units {
    /// Lengths in one unit, like z.
    #[default]
    Lengths,
    /// Longitude and latitude in degrees. The text says how the file shows it: `its columns are named
    /// lon and lat`.
    Degrees(String),
    /// Nothing in the file says that x and y are degrees, but their numbers look like it.
    LikeDegrees,
}

/// Points by which numbers are judged, at most.
const SAMPLE: usize = 1 << 12;
/// Points spread over a file as they come: every so many, twice as many when there are too many of them.
#[derive(Debug)]
pub(crate) struct Spread {
    pub(crate) positions: Vec<[f64; 3]>,
    /// Points from one to the next.
    stride: u64,
    /// Points that come before the next.
    before: u64,
}

impl Default for Spread {
    fn default() -> Self {
        Self { positions: Vec::new(), stride: 1, before: 0 }
    }
}

impl Spread {
    pub(crate) fn see(&mut self, position: [f64; 3]) {
        if self.before > 0 {
            self.before -= 1;
            return;
        }
        if self.positions.len() == 2 * SAMPLE {
            let mut place = 0;
            self.positions.retain(|_| {
                place += 1;
                place % 2 == 1
            });
            self.stride *= 2;
        }
        self.positions.push(position);
        self.before = self.stride - 1;
    }
}

/// Greatest longitude that is one: files count from -180 to 180, or from 0 to 360.
const LONGITUDE: f64 = 360.0;
const LATITUDE: f64 = 90.0;

/// How the names of x and y show that they are degrees, if they do.
pub(crate) fn named(x: &str, y: &str) -> Option<String> {
    let degrees = is_longitude(x) && is_latitude(y);
    degrees.then(|| {
        let name = |name: &str| crate::meaning::printable(name.trim());
        format!("its columns are named {} and {}", name(x), name(y))
    })
}

/// Whether a column of this name holds longitudes in degrees.
pub(crate) fn is_longitude(name: &str) -> bool {
    is_angle(name, &["longitude", "longitudes", "long", "lon", "lng"], "longitude")
}

/// Whether a column of this name holds latitudes in degrees.
pub(crate) fn is_latitude(name: &str) -> bool {
    is_angle(name, &["latitude", "latitudes", "lat"], "latitude")
}

/// Whether one word of the name is one of these, such as in `LONGITUDE_CENTROID`, `lon_deg` and
/// `decimalLongitude`.
fn is_angle(name: &str, words: &[&str], long: &str) -> bool {
    let whole = name.to_lowercase();
    let other_unit = ["radian", "(rad)", "[rad]", "_rad", "minute", "second"];
    if other_unit.iter().any(|unit| whole.contains(unit)) {
        return false;
    }
    let of_word = |word: &str| {
        let bare = word.trim_end_matches(|c: char| c.is_ascii_digit());
        let bare = ["degrees", "deg", "dd", "wgs"].iter().find_map(|end| bare.strip_suffix(end));
        words.contains(&word) || word.ends_with(long) || bare.is_some_and(|w| words.contains(&w))
    };
    plain(name).split('_').any(of_word)
}

impl Units {
    /// What x and y of these positions are. `declared` is how the file shows that they are degrees, if
    /// it does; a file whose numbers cannot be degrees is not believed, which the second value says.
    pub(crate) fn of(positions: &[[f64; 3]], declared: Option<String>) -> (Self, Option<String>) {
        let sample: Vec<[f64; 3]> =
            positions.iter().step_by(positions.len().div_ceil(SAMPLE).max(1)).copied().collect();
        let Some(reason) = declared else {
            let like = looks_like_degrees(&sample);
            return (if like { Self::LikeDegrees } else { Self::Lengths }, None);
        };
        let beyond = |p: &&[f64; 3]| p[0].abs() > LONGITUDE || p[1].abs() > LONGITUDE;
        if sample.iter().filter(beyond).count() * 2 <= sample.len() {
            return (Self::Degrees(reason), None);
        }
        let [x, y] = [0, 1].map(|axis| median(&sample, axis));
        let note = format!(
            "x and y are not taken as degrees: {reason}, but x is about {x} and y about {y}, beyond any \
             longitude and latitude"
        );
        (Self::Lengths, Some(note))
    }
}

/// Whether x and y look like longitudes and latitudes, and z like metres: an area that is small beside its
/// distance from zero, with heights that are a hundred times wider than it. Models, terrains exaggerated in
/// z and time series begin near zero, or are as wide as high.
fn looks_like_degrees(sample: &[[f64; 3]]) -> bool {
    const FEW: usize = 30;
    /// Over the wider of x and y: hills of 20 m in 2 km are a thousand, mountains in a country 300.
    const LEAST_HEIGHT: f64 = 100.0;
    /// The middle's distance from zero, over the extent.
    const LEAST_OFFSET: f64 = 3.0;
    const LEAST_ASPECT: f64 = 1.0 / 30.0;
    if sample.len() < FEW {
        return false;
    }
    let [x, y, z] = [0, 1, 2].map(|axis| most(sample, axis));
    let extent = |range: [f64; 2]| range[1] - range[0];
    let offset = |range: [f64; 2]| (0.5 * (range[0] + range[1])).abs() / extent(range);
    let inside = |range: [f64; 2], limit: f64| range.iter().all(|value| value.abs() <= limit);
    let (wide, narrow) = (extent(x).max(extent(y)), extent(x).min(extent(y)));
    // Counted, not measured: rows and columns of a grid.
    let fractions =
        sample.iter().any(|p| p[0].fract() != 0.0) && sample.iter().any(|p| p[1].fract() != 0.0);
    inside(x, LONGITUDE)
        && inside(y, LATITUDE)
        // Heights on this planet, and under the sea.
        && inside(z, 12_000.0)
        && narrow > LEAST_ASPECT * wide
        && extent(z) > LEAST_HEIGHT * wide
        && offset(x).max(offset(y)) > LEAST_OFFSET
        && fractions
}

/// Where most values along an axis lie: all but a fiftieth at either end.
fn most(sample: &[[f64; 3]], axis: usize) -> [f64; 2] {
    let mut values: Vec<f64> = sample.iter().map(|p| p[axis]).collect();
    values.sort_unstable_by(f64::total_cmp);
    let rim = values.len() / 50;
    [values[rim], values[values.len() - 1 - rim]]
}

fn median(sample: &[[f64; 3]], axis: usize) -> f64 {
    let mut values: Vec<f64> = sample.iter().map(|p| p[axis]).collect();
    let half = values.len() / 2;
    *values.select_nth_unstable_by(half, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Even places of the unit square, and a wavy height from -1 to 1.
    fn land(count: u32) -> impl Iterator<Item = [f64; 3]> {
        (0..count).map(move |i| {
            let (x, y) = (f64::from(i) * 0.618_034 % 1.0, (f64::from(i) + 0.5) / f64::from(count));
            [x, y, (9.0 * x).sin() * (7.0 * y).cos()]
        })
    }

    fn units_of(scale: [f64; 3], offset: [f64; 3]) -> Units {
        let placed = |p: [f64; 3]| [0, 1, 2].map(|axis| p[axis] * scale[axis] + offset[axis]);
        Units::of(&land(500).map(placed).collect::<Vec<_>>(), None).0
    }

    #[test]
    fn names_of_longitude_and_latitude_are_known_in_pairs() {
        for (x, y) in [
            ("longitude", "latitude"),
            ("lon", "lat"),
            ("LONG", "Lat"),
            ("lng", "lat"),
            ("Longitude (deg)", "Latitude (deg)"),
            ("LONGITUDE_CENTROID", "LATITUDE_CENTROID"),
            ("decimalLongitude", "decimalLatitude"),
            ("lon_wgs84", "lat_wgs84"),
            ("londeg", "latdeg"),
            ("gps.longitude", "gps.latitude"),
        ] {
            assert!(named(x, y).is_some(), "{x} {y}");
        }
        for (x, y) in [
            ("x", "y"),
            ("lon", "y"),
            ("x", "lat"),
            ("easting", "northing"),
            ("lat", "lon"),
            ("lon [rad]", "lat [rad]"),
            ("longitudinal", "lateral"),
            ("elongation", "flat"),
        ] {
            assert_eq!(named(x, y), None, "{x} {y}");
        }
        assert_eq!(named(" lon ", "lat").unwrap(), "its columns are named lon and lat");
    }

    #[test]
    fn areas_in_degrees_are_noticed() {
        let places =
            [[-86.5, 40.1, 250.0], [179.2, -17.0, 10.0], [7.1, 46.0, 1500.0], [0.02, 51.5, 20.0]];
        for place in places {
            // A village, an airfield, a province with hills and a country with mountains.
            for (size, height) in [(0.01, 15.0), (0.03, 4.0), (0.5, 300.0), (4.0, 2500.0)] {
                assert_eq!(
                    units_of([size, size, height], place),
                    Units::LikeDegrees,
                    "{place:?} {size}"
                );
            }
        }
    }

    #[test]
    fn no_other_set_is_taken_for_degrees() {
        for (what, scale, offset) in [
            ("a model", [1.0, 1.0, 0.7], [-0.5, -0.5, -0.3]),
            ("a model far off", [1.0, 1.0, 0.7], [80.0, 70.0, 3.0]),
            ("a terrain exaggerated a thousandfold from zero", [0.1, 0.1, 100.0], [0.0; 3]),
            ("a terrain exaggerated fivefold, at an offset", [10.0, 10.0, 20.0], [70.0, 50.0, 0.0]),
            ("projected metres", [1e3, 1e3, 30.0], [5e5, 4.6e6, 200.0]),
            ("kilometres and metres", [1.0, 1.0, 200.0], [500.0, 4600.0, 10.0]),
            ("time series", [1e-2, 40.0, 90.0], [100.0, 0.0, 0.0]),
            ("pressures", [0.5, 0.5, 1e5], [20.0, 30.0, 1e5]),
            ("a line", [0.01, 0.0, 30.0], [7.0, 46.0, 500.0]),
        ] {
            assert_eq!(units_of(scale, offset), Units::Lengths, "{what}");
        }
        let few: Vec<[f64; 3]> =
            land(10).map(|p| [7.0 + 0.01 * p[0], 46.0 + 0.01 * p[1], 100.0 * p[2]]).collect();
        assert_eq!(Units::of(&few, None).0, Units::Lengths);
        let rows: Vec<[f64; 3]> = (0..400)
            .map(|i| [f64::from(60 + i % 10), f64::from(70 + i / 40), f64::from(i * 9)])
            .collect();
        assert_eq!(Units::of(&rows, None).0, Units::Lengths, "rows and columns");
    }

    #[test]
    fn what_is_declared_is_believed_unless_most_numbers_forbid_it() {
        let why = || Some("it says so".to_owned());
        let mut places: Vec<[f64; 3]> = land(100).map(|p| [7.0 + p[0], 46.0 + p[1], 0.0]).collect();
        places[7] = [-9999.0; 3];
        assert_eq!(Units::of(&places, why()), (Units::Degrees("it says so".to_owned()), None));
        let metres: Vec<[f64; 3]> = land(100).map(|p| [5e5 + p[0], 4.6e6, 0.0]).collect();
        let (units, note) = Units::of(&metres, why());
        assert_eq!(units, Units::Lengths);
        assert!(note.unwrap().contains("y about 4600000"));
    }
}
