//! From the numbers of the scans, which may differ, to rows of one kind.

use super::xml::{Codec, Scan};
use crate::field::{Field, Type};

const CARTESIAN: [&str; 3] = ["cartesianX", "cartesianY", "cartesianZ"];
const SPHERICAL: [&str; 3] = ["sphericalRange", "sphericalAzimuth", "sphericalElevation"];
const COLOR: [&str; 3] = ["colorRed", "colorGreen", "colorBlue"];
const NORMAL: [&str; 3] = ["normalX", "normalY", "normalZ"];
/// What says whether something else counts.
const STATES: [&str; 5] = [
    "cartesianInvalidState",
    "sphericalInvalidState",
    "isColorInvalid",
    "isIntensityInvalid",
    "isTimeStampInvalid",
];
/// Names of the standard, and those that they have here.
const NAMES: [(&str, &str); 5] = [
    ("rowIndex", "row_index"),
    ("columnIndex", "column_index"),
    ("returnIndex", "return_index"),
    ("returnCount", "number_of_returns"),
    ("timeStamp", "gps_time"),
];
/// What points without a valid colour have: the colour of objects without any, 0.8, of 255 in sRGB.
const NO_COLOR: f64 = 231.0;

/// How points become rows.
pub(super) struct Layout {
    pub(super) fields: Vec<Field>,
    /// Whether rows have colours and normals: they follow the position.
    colors: Option<Type>,
    normals: bool,
    /// By scan.
    scans: Vec<Places>,
}

/// Where in a scan's record things are.
struct Places {
    cartesian: Option<[usize; 3]>,
    spherical: Option<[usize; 3]>,
    color: Option<[usize; 3]>,
    /// Lowest value and span of each colour.
    color_spans: [[f64; 2]; 3],
    normal: Option<[usize; 3]>,
    /// Of [`STATES`].
    states: [Option<usize>; 5],
    /// Of the attributes of the rows, and whether a number of `isIntensityInvalid` or
    /// `isTimeStampInvalid` makes them invalid.
    others: Vec<(Option<usize>, Option<usize>)>,
}

impl Layout {
    pub(super) fn new(scans: &[Scan]) -> Self {
        let three = |scan: &Scan, names: [&str; 3]| -> Option<[usize; 3]> {
            let [a, b, c] = names.map(|name| scan.find(name));
            Some([a?, b?, c?])
        };
        let has = |names| scans.iter().any(|scan| three(scan, names).is_some());
        let mut fields = vec![];
        // A scan without positions leaves none to find, so that an error says so.
        let all = |names| scans.iter().all(|scan| three(scan, names).is_some());
        let positions =
            scans.iter().all(|scan| three(scan, CARTESIAN).or(three(scan, SPHERICAL)).is_some());
        if positions {
            let single = all(CARTESIAN)
                && scans.iter().all(|scan| {
                    CARTESIAN.iter().all(|name| {
                        scan.find(name)
                            .is_some_and(|place| matches!(scan.columns[place].codec, Codec::Single))
                    })
                });
            let kind = if single { Type::F32 } else { Type::F64 };
            fields.extend(["x", "y", "z"].map(|name| Field::new(name, kind)));
        }
        let colors = has(COLOR).then(|| color_type(scans));
        if let Some(kind) = colors {
            fields.extend(["red", "green", "blue"].map(|name| Field::new(name, kind)));
        }
        let normals = has(NORMAL);
        if normals {
            fields.extend(["nx", "ny", "nz"].map(|name| Field::new(name, Type::F32)));
        }
        let mut names: Vec<&str> = Vec::new();
        for column in scans.iter().flat_map(|scan| &scan.columns) {
            let name = column.name.as_str();
            let known = [CARTESIAN, SPHERICAL, COLOR, NORMAL].iter().any(|n| n.contains(&name));
            if !known && !STATES.contains(&name) && !names.contains(&name) {
                names.push(name);
            }
        }
        for &name in &names {
            let here = NAMES.iter().find(|(standard, _)| *standard == name);
            let here = here.map_or(name, |(_, here)| here);
            fields.push(Field::new(here, held(scans, name)));
        }
        let places = scans.iter().map(|scan| {
            let states = STATES.map(|name| scan.find(name));
            let color = three(scan, COLOR);
            Places {
                cartesian: three(scan, CARTESIAN),
                spherical: three(scan, SPHERICAL),
                color,
                color_spans: [0, 1, 2].map(|channel| {
                    let place = color.map(|places| places[channel]);
                    color_span(scan, channel, place)
                }),
                normal: three(scan, NORMAL),
                states,
                others: names
                    .iter()
                    .map(|&name| {
                        let state = match name {
                            "intensity" => states[3],
                            "timeStamp" => states[4],
                            _ => None,
                        };
                        (scan.find(name), state)
                    })
                    .collect(),
            }
        });
        let scans = places.collect();
        Self { fields, colors, normals, scans }
    }

    /// Whether a scan has angles and ranges, and no positions.
    pub(super) fn has_angles(&self, index: usize) -> bool {
        self.scans[index].cartesian.is_none()
    }

    /// Makes the row of a point of a scan; false if the point is invalid.
    pub(super) fn fill(
        &self,
        index: usize,
        scan: &Scan,
        values: &[f64],
        row: &mut Vec<f64>,
    ) -> bool {
        let places = &self.scans[index];
        let valid = |state: usize| places.states[state].is_none_or(|place| values[place] == 0.0);
        let of = |places: [usize; 3]| places.map(|place| values[place]);
        let local =
            match (places.cartesian.filter(|_| valid(0)), places.spherical.filter(|_| valid(1))) {
                (Some(places), _) => of(places),
                (None, Some(places)) => {
                    let [range, azimuth, elevation] = of(places);
                    let across = range * elevation.cos();
                    [across * azimuth.cos(), across * azimuth.sin(), range * elevation.sin()]
                }
                (None, None) => return false,
            };
        row.clear();
        let turned = |v: [f64; 3]| scan.pose.turned(v);
        let position = turned(local);
        row.extend([0, 1, 2].map(|axis| position[axis] + scan.pose.translation[axis]));
        if let Some(kind) = self.colors {
            let full = if kind == Type::U8 { 255.0 } else { 65535.0 };
            let color = places.color.filter(|_| valid(2));
            row.extend([0, 1, 2].map(|channel| match color {
                _ if kind.is_float() => color.map_or(f64::NAN, |places| values[places[channel]]),
                None => (NO_COLOR / 255.0 * full).round(),
                Some(places) => {
                    let [low, span] = self.scans[index].color_spans[channel];
                    let part = (values[places[channel]] - low) / span;
                    (part.clamp(0.0, 1.0) * full).round()
                }
            }));
        }
        if self.normals {
            row.extend(places.normal.map_or([0.0; 3], |places| turned(of(places))));
        }
        row.extend(places.others.iter().map(|&(place, state)| {
            let valid = state.is_none_or(|state| values[state] == 0.0);
            place.filter(|_| valid).map_or(f64::NAN, |place| values[place])
        }));
        true
    }
}

/// The type of all values of this name: what is missing in a scan, or may be invalid, is NaN.
fn held(scans: &[Scan], name: &str) -> Type {
    let state = match name {
        "intensity" => Some(STATES[3]),
        "timeStamp" => Some(STATES[4]),
        _ => None,
    };
    let types: Vec<Option<Type>> = scans
        .iter()
        .map(|scan| {
            let kind = scan.columns[scan.find(name)?].codec.held();
            let always = state.is_none_or(|state| scan.find(state).is_none());
            (always || kind.is_float()).then_some(kind)
        })
        .collect();
    match types.as_slice() {
        [Some(first), rest @ ..] if rest.iter().all(|kind| *kind == Some(*first)) => *first,
        _ => Type::F64,
    }
}

/// 8 bits where all scans have integers of 0 to 255 at most, floats where no scan says what is full
/// intensity, else 16 bits.
fn color_type(scans: &[Scan]) -> Type {
    let has_limits = |scan: &Scan| {
        COLOR.iter().zip(&scan.color_limits).any(|(name, limits)| {
            scan.find(name)
                .is_some_and(|place| limits.or(scan.columns[place].codec.limits()).is_some())
        })
    };
    if !scans.iter().any(has_limits) {
        return Type::F32;
    }
    let is_byte = |scan: &Scan| {
        COLOR.iter().enumerate().all(|(channel, name)| match scan.find(name) {
            None => true,
            Some(place) => color_span(scan, channel, Some(place)) == [0.0, 255.0],
        })
    };
    if scans.iter().all(is_byte) { Type::U8 } else { Type::U16 }
}

/// Lowest value of a colour, and how much the highest is over it.
fn color_span(scan: &Scan, channel: usize, place: Option<usize>) -> [f64; 2] {
    let own = place.and_then(|place| scan.columns[place].codec.limits());
    let [low, high] = scan.color_limits[channel].or(own).unwrap_or([0.0, 1.0]);
    if high > low { [low, high - low] } else { [0.0, 255.0] }
}
