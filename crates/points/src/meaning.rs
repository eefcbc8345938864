//! What the columns of a table mean by their names; where they have none, see [`guess`](crate::guess).
//!
//! The outcome depends only on the names and on the first rows, so one file is always read in one
//! way, and the set's `format` reports what was assumed.

use crate::field::{Field, Type};
use crate::guess::numbered;
use crate::units;

/// Names of positions, the likelier before: the first that a table has is taken, axis by axis.
const POSITION: [&[&str]; 3] = [
    &[
        "x",
        "points_0",
        "points_x",
        "points_m_xyz_0",
        "point_x",
        "pos_x",
        "position_x",
        "coord_x",
        "x_coord",
        "x_coordinate",
        "xcoord",
        "x_location",
        "px",
        "easting",
        "east",
        "longitude",
        "lon",
        "long",
        "lng",
    ],
    &[
        "y",
        "points_1",
        "points_y",
        "points_m_xyz_1",
        "point_y",
        "pos_y",
        "position_y",
        "coord_y",
        "y_coord",
        "y_coordinate",
        "ycoord",
        "y_location",
        "py",
        "northing",
        "north",
        "latitude",
        "lat",
    ],
    &[
        "z",
        "points_2",
        "points_z",
        "points_m_xyz_2",
        "point_z",
        "pos_z",
        "position_z",
        "coord_z",
        "z_coord",
        "z_coordinate",
        "zcoord",
        "z_location",
        "pz",
        "elevation",
        "elev",
        "height",
        "altitude",
        "alt",
        "ele",
        "h",
    ],
];
/// Names that stand for an axis only where all three are there.
const POSITION_OF_THREE: [[&str; 3]; 6] = [
    ["e", "n", "h"],
    ["e", "n", "z"],
    ["e", "n", "u"],
    ["glon", "glat", "zg"],
    ["rechtswert", "hochwert", "höhe"],
    ["rechtswert", "hochwert", "hoehe"],
];
/// Names that may have something before or after them, the same for all three axes, such as
/// `longitude_centroid`.
const POSITION_WITH_MORE: [&[&str]; 3] = [
    &["longitude", "lon", "easting", "east"],
    &["latitude", "lat", "northing", "north"],
    &["elevation", "elev", "height", "altitude", "alt", "z"],
];
/// What may stand before or after x, y and z.
const FRAMES: [&str; 12] = [
    "utm", "ecef", "enu", "map", "local", "world", "global", "geo", "center", "centre", "centroid",
    "m",
];
/// Names of the three numbers of a colour.
const COLOR: [[&str; 3]; 14] = [
    ["red", "green", "blue"],
    ["r", "g", "b"],
    ["rf", "gf", "bf"],
    ["diffuse_red", "diffuse_green", "diffuse_blue"],
    ["color_r", "color_g", "color_b"],
    ["color_red", "color_green", "color_blue"],
    ["colour_r", "colour_g", "colour_b"],
    ["colour_red", "colour_green", "colour_blue"],
    ["colorr", "colorg", "colorb"],
    ["scalar_r", "scalar_g", "scalar_b"],
    ["rgb_r", "rgb_g", "rgb_b"],
    ["rgb_0", "rgb_1", "rgb_2"],
    ["color_0", "color_1", "color_2"],
    ["colors_0", "colors_1", "colors_2"],
];
/// Names of the three numbers of a normal.
const NORMAL: [[&str; 3]; 8] = [
    ["nx", "ny", "nz"],
    ["n_x", "n_y", "n_z"],
    ["normal_x", "normal_y", "normal_z"],
    ["normals_x", "normals_y", "normals_z"],
    ["normalx", "normaly", "normalz"],
    ["normal_0", "normal_1", "normal_2"],
    ["normals_0", "normals_1", "normals_2"],
    ["n_0", "n_1", "n_2"],
];
/// Other names that become one name.
const OTHERS: [(&str, &[&str]); 2] = [
    ("intensity", &["intensity", "scalar_intensity", "i"]),
    ("classification", &["classification", "scalar_classification", "class"]),
];

/// Names of arrays of positions, of colours and of normals.
const POSITIONS: [&str; 14] = [
    "xyz",
    "points",
    "positions",
    "position",
    "pos",
    "point",
    "coords",
    "coordinates",
    "coord",
    "location",
    "locations",
    "vertices",
    "vertex",
    "pts",
];
const COLORS: [&str; 9] =
    ["rgb", "rgba", "colors", "color", "colours", "colour", "rgbs", "vertex_colors", "diffuse"];
const NORMALS: [&str; 4] = ["normals", "normal", "norms", "vertex_normals"];

pub(crate) const RED: [&str; 3] = ["red", "green", "blue"];
pub(crate) const NX: [&str; 3] = ["nx", "ny", "nz"];

/// Rows from the beginning of a table, by which columns are judged.
#[derive(Default)]
pub(crate) struct Sample {
    pub(crate) columns: usize,
    /// Row after row.
    pub(crate) values: Vec<f64>,
    /// Which columns are written with a decimal point or exponent, or are of a float type: those
    /// may have fractions further on. Without an entry, they are not.
    pub(crate) floats: Vec<bool>,
}

/// Rows that are looked at.
pub(crate) const SAMPLE_ROWS: usize = 1000;

impl Sample {
    /// Rows of so many floats.
    pub(crate) fn of_columns(columns: usize, values: Vec<f64>) -> Self {
        Self { columns, values, floats: vec![true; columns] }
    }

    pub(crate) fn column(&self, place: usize) -> impl Iterator<Item = f64> + '_ {
        self.values.iter().skip(place).step_by(self.columns.max(1)).copied()
    }

    fn all(&self, places: [usize; 3], fits: impl Fn(f64) -> bool) -> bool {
        places.iter().all(|&place| self.column(place).filter(|value| !value.is_nan()).all(&fits))
    }

    pub(crate) fn is_float(&self, place: usize) -> bool {
        self.floats.get(place).is_some_and(|&float| float)
    }

    /// How three columns that are known to be a colour store it: whole numbers (of 8 bits, unless
    /// one beyond 255 comes; the collector sees to that), or fractions of 1.
    fn color_kind(&self, places: [usize; 3]) -> Type {
        let whole = self.all(places, |value| value.fract() == 0.0);
        let small = self.all(places, |value| value <= 1.0);
        let float = places.iter().any(|&place| self.is_float(place));
        // Fractions well above 1 are averages of bytes.
        let fractions = !whole && self.all(places, |value| value < 10.0);
        if fractions || (whole && small && float) { Type::F32 } else { Type::U16 }
    }
}

/// Names for the numbers of an array with several a point: those of x y z, of a colour or of a
/// normal where its name says that; else its name and a number from 0 on, or its name alone.
pub(crate) fn spread(name: &str, width: usize) -> Vec<String> {
    let plain = plain(name);
    let is = |names: &[&str]| names.contains(&plain.as_str());
    let names: &[&str] = match width {
        1 => &[name],
        3 if is(&POSITIONS) => &["x", "y", "z"],
        3 if is(&COLORS) => &RED,
        4 if is(&COLORS) => &["red", "green", "blue", "alpha"],
        3 if is(&NORMALS) => &NX,
        _ => return (0..width).map(|number| format!("{name}_{number}")).collect(),
    };
    names.iter().map(|&name| name.to_owned()).collect()
}

/// A name for messages and attributes: short, on one line, whatever it is.
pub(crate) fn printable(name: &str) -> String {
    const LONGEST: usize = 100;
    name.chars().take(LONGEST).map(|sign| if sign.is_control() { '_' } else { sign }).collect()
}

/// Whether an array of this name holds positions.
pub(crate) fn is_position(name: &str) -> bool {
    POSITIONS.contains(&plain(name).as_str())
}

/// The places of x, y and z among these names.
pub(crate) fn positions_among(names: &[&str]) -> Option<[usize; 3]> {
    let plain: Vec<String> = names.iter().map(|name| plain(name)).collect();
    positions_of(&plain)
}

/// The same of names without what exporters add.
fn positions_of(plain: &[String]) -> Option<[usize; 3]> {
    let place = |name: &str| plain.iter().position(|other| other == name);
    let likeliest = |axis: &[&str]| axis.iter().find_map(|name| place(name));
    let all = |names: [&str; 3]| {
        let [x, y, z] = names.map(place);
        Some([x?, y?, z?])
    };
    let [x, y, z] = POSITION.map(likeliest);
    let plainest = || Some([x?, y?, z?]);
    plainest()
        .or_else(|| POSITION_OF_THREE.into_iter().find_map(all))
        .or_else(|| with_more(plain))
        .or_else(|| Some([longitude(plain)?, latitude(plain)?, z.or_else(|| height(plain))?]))
}

/// Names with longitude or latitude in them, such as `decimalLongitude`.
fn longitude(plain: &[String]) -> Option<usize> {
    plain.iter().position(|name| units::is_longitude(name))
}

fn latitude(plain: &[String]) -> Option<usize> {
    plain.iter().position(|name| units::is_latitude(name))
}

/// The first name with a height in it, such as `GPSAltitude`, `alt_m`, `ele` and `h_ph`: what z is beside longitude and
/// latitude. A height over ground or in feet,
/// that of the geoid, or how exact one is, is none.
fn height(plain: &[String]) -> Option<usize> {
    const WORDS: [&str; 12] = [
        "elevation",
        "elevations",
        "elev",
        "ele",
        "height",
        "hgt",
        "altitude",
        "alt",
        "msl",
        "h",
        "z",
        "ellh",
    ];
    const LONG: [&str; 4] = ["elevation", "height", "altitude", "elev"];
    const OTHER: [&str; 16] = [
        "agl",
        "relative",
        "rel",
        "above",
        "geoid",
        "geoidal",
        "undulation",
        "accuracy",
        "acc",
        "error",
        "err",
        "std",
        "sigma",
        "ref",
        "ft",
        "feet",
    ];
    plain.iter().position(|name| {
        let mut words = name.split('_');
        let is_height =
            |word: &str| WORDS.contains(&word) || LONG.iter().any(|long| word.ends_with(long));
        words.clone().any(is_height) && !words.any(|word| OTHER.contains(&word))
    })
}

/// Positions whose names have the same before and after what stands for the axis.
fn with_more(plain: &[String]) -> Option<[usize; 3]> {
    let [x, y, z] = POSITION_WITH_MORE;
    plain.iter().enumerate().find_map(|(place, name)| {
        let around = |axis: &&str| {
            let (before, after) = name.split_once(*axis)?;
            let apart = (before.is_empty() || before.ends_with('_'))
                && (after.is_empty() || after.starts_with('_'));
            apart.then(|| (before.to_owned(), after.to_owned()))
        };
        let same = |axes: &[&str], before: &str, after: &str| {
            let names = axes.iter().map(|axis| format!("{before}{axis}{after}"));
            names.into_iter().find_map(|name| plain.iter().position(|other| *other == name))
        };
        let of = |axes: [&[&str]; 2], (before, after): (String, String)| {
            Some([place, same(axes[0], &before, &after)?, same(axes[1], &before, &after)?])
        };
        let words = x.iter().filter_map(around).find_map(|both| of([y, z], both));
        words.or_else(|| {
            let (before, after) = around(&"x")?;
            let frame = before.trim_matches('_').to_owned() + after.trim_matches('_');
            let axes: [&[&str]; 2] = [&["y"], &["z"]];
            FRAMES.contains(&&*frame).then(|| of(axes, (before, after)))?
        })
    })
}

/// Columns by their names. `kinds` are their types where the file states them; what is not stated
/// is found from the sample.
pub(crate) fn by_names(names: &[String], kinds: Option<&[Type]>, sample: &Sample) -> Vec<Field> {
    let plain: Vec<String> = names.iter().map(|name| plain(name)).collect();
    let find = |name: &str| plain.iter().position(|other| other == name);
    let stated = |place: usize| kinds.map(|kinds| kinds[place]);
    let mut fields: Vec<Option<Field>> = vec![None; names.len()];
    let set = |fields: &mut [Option<Field>], place: usize, name: &str, kind: Type| {
        let kind = stated(place).unwrap_or(kind);
        fields[place].get_or_insert_with(|| Field::new(name, kind));
    };
    let position = match positions_of(&plain) {
        Some(places) => places.map(Some),
        None => POSITION.map(|names| names.iter().find_map(|name| find(name))),
    };
    for (axis, place) in ["x", "y", "z"].into_iter().zip(position) {
        if let Some(place) = place {
            set(&mut fields, place, axis, Type::F64);
        }
    }
    let triple =
        |sets: &[[&str; 3]]| sets.iter().find_map(|[a, b, c]| Some([find(a)?, find(b)?, find(c)?]));
    if let Some(places) = triple(&COLOR) {
        // Floats may hold bytes.
        let whole = places.into_iter().filter_map(stated).find(|kind| !kind.is_float());
        let kind = whole.unwrap_or_else(|| sample.color_kind(places));
        for (place, name) in places.into_iter().zip(RED) {
            fields[place].get_or_insert_with(|| Field::new(name, kind));
        }
    }
    if let Some(places) = triple(&NORMAL) {
        for (place, name) in places.into_iter().zip(NX) {
            set(&mut fields, place, name, Type::F32);
        }
    }
    for (canonical, names) in OTHERS {
        if let Some(place) = names.iter().find_map(|name| find(name)) {
            set(&mut fields, place, canonical, Type::F64);
        }
    }
    let rest = fields.into_iter().enumerate().map(|(place, field)| {
        let field = field.unwrap_or_else(|| {
            let name = match names[place].trim() {
                "" => numbered(place),
                name => printable(name),
            };
            Field::new(name, stated(place).unwrap_or(Type::F64))
        });
        field.called(names[place].trim())
    });
    rest.collect()
}

/// A name without what exporters add to it: `"X [m]"`, `//X`, `Points:0`, `Normal.X` and `Position[X]
/// (m)` become `x`, `x`, `points_0`, `normal_x` and `position_x`.
pub(crate) fn plain(name: &str) -> String {
    let name = name.trim().trim_start_matches(['/', '#', '%']).trim().trim_matches('\'');
    let name = name.to_lowercase();
    let unit = name.strip_suffix([')', ']']).and_then(|rest| rest.rfind(['(', '[']));
    let name = match unit {
        Some(start) if start > 0 => &name[..start],
        _ => &name,
    };
    // An index or a component, where a unit followed.
    let name = match name.trim().strip_suffix(']').and_then(|rest| rest.split_once('[')) {
        Some((name, of)) if !name.is_empty() => format!("{name}_{of}"),
        _ => name.to_owned(),
    };
    let joined = name.trim().replace([' ', '.', ':', '-'], "_");
    joined.trim_matches('_').to_owned()
}

/// Whether names for all of x, y and z are among these.
pub(crate) fn name_positions<'a>(names: impl Iterator<Item = &'a str>) -> bool {
    positions_among(&names.collect::<Vec<_>>()).is_some()
}

/// The fields as they are listed in a set's `format`.
pub(crate) fn listed(fields: &[Field]) -> String {
    const MOST: usize = 12;
    let names = || fields.iter().map(|field| field.name.as_str()).filter(|name| !name.is_empty());
    let more = if names().count() > MOST { " …" } else { "" };
    names().take(MOST).collect::<Vec<_>>().join(" ") + more
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(names: &[&str], row: &[f64]) -> Vec<String> {
        let names: Vec<String> = names.iter().map(|&name| name.to_owned()).collect();
        let sample = Sample { columns: names.len(), values: row.to_vec(), floats: Vec::new() };
        by_names(&names, None, &sample).into_iter().map(|field| field.name).collect()
    }

    #[test]
    fn names_of_many_programs_mean_the_same() {
        let expected = ["x", "y", "z", "red", "green", "blue"];
        let row = [0.0; 6];
        for names in [
            ["x", "y", "z", "red", "green", "blue"],
            ["//X", "Y", "Z", "R", "G", "B"],
            ["Easting", "Northing", "Elevation", "Red", "Green", "Blue"],
            ["Points:0", "Points:1", "Points:2", "RGB:0", "RGB:1", "RGB:2"],
            ["X [m]", "Y [m]", "Z [m]", "Color.R", "Color.G", "Color.B"],
            ["Position[X] (m)", "Position[Y] (m)", "Position[Z] (m)", "'r'", "'g'", "'b'"],
            ["X Location (m)", "Y Location (m)", "Z Location (m)", "colorR", "colorG", "colorB"],
            ["lon", "lat", "ele", "scalar_R", "scalar_G", "scalar_B"],
        ] {
            assert_eq!(named(&names, &row), expected, "{names:?}");
        }
        // A better name leaves a worse one for what it says.
        assert_eq!(named(&["height", "Z", "x", "Y"], &row[..4]), ["height", "z", "x", "y"]);
        assert_eq!(named(&["x", "y", "z", "r", ""], &row[..5]), ["x", "y", "z", "r", "column_5"]);
        assert_eq!(named(&["n", "E", "H", "q"], &row[..4]), ["y", "x", "z", "q"]);
        assert_eq!(named(&["utm_x", "utm_y", "utm_z"], &row[..3]), ["x", "y", "z"]);
        assert_eq!(named(&["v_x", "v_y", "v_z"], &row[..3]), ["v_x", "v_y", "v_z"]);
        let lvis = ["LFID", "LONGITUDE_CENTROID", "LATITUDE_CENTROID", "ELEVATION_CENTROID"];
        assert_eq!(named(&lvis, &row[..4]), ["LFID", "x", "y", "z"]);
    }
}
