//! What the columns of a table mean: by their names, or, where they have none, by how many there
//! are and what stands in them.
//!
//! The outcome depends on the names and on the first rows alone, so one file is always read in one
//! way, and what was assumed is said in the set's `format`.

use crate::field::{Field, Type};

/// Names of positions, the likelier before: the first that a table has is taken, axis by axis.
const POSITION: [&[&str]; 3] = [
    &[
        "x",
        "points_0",
        "points_x",
        "point_x",
        "pos_x",
        "position_x",
        "coord_x",
        "x_coord",
        "x_coordinate",
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
        "point_y",
        "pos_y",
        "position_y",
        "coord_y",
        "y_coord",
        "y_coordinate",
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
        "point_z",
        "pos_z",
        "position_z",
        "coord_z",
        "z_coord",
        "z_coordinate",
        "pz",
        "elevation",
        "elev",
        "height",
        "altitude",
        "alt",
        "h",
    ],
];
/// Names of the three numbers of a colour.
const COLOR: [[&str; 3]; 12] = [
    ["red", "green", "blue"],
    ["r", "g", "b"],
    ["rf", "gf", "bf"],
    ["diffuse_red", "diffuse_green", "diffuse_blue"],
    ["color_r", "color_g", "color_b"],
    ["color_red", "color_green", "color_blue"],
    ["colour_r", "colour_g", "colour_b"],
    ["colour_red", "colour_green", "colour_blue"],
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

const RED: [&str; 3] = ["red", "green", "blue"];
const NX: [&str; 3] = ["nx", "ny", "nz"];

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
    fn column(&self, place: usize) -> impl Iterator<Item = f64> + '_ {
        self.values.iter().skip(place).step_by(self.columns.max(1)).copied()
    }

    fn all(&self, places: [usize; 3], fits: impl Fn(f64) -> bool) -> bool {
        places.iter().all(|&place| self.column(place).filter(|value| !value.is_nan()).all(&fits))
    }

    fn is_float(&self, place: usize) -> bool {
        self.floats.get(place).is_some_and(|&float| float)
    }

    /// Whether three columns could be whole numbers from 0 to `most`.
    fn counts_to(&self, places: [usize; 3], most: f64) -> bool {
        self.all(places, |value| value.fract() == 0.0 && (0.0..=most).contains(&value))
    }

    /// Whether each row of three columns has length 1, but for 1 % and zero vectors.
    fn unit_vectors(&self, [x, y, z]: [usize; 3]) -> bool {
        let rows = self.column(x).zip(self.column(y)).zip(self.column(z));
        let mut lengths = rows.map(|((x, y), z)| (x * x + y * y + z * z).sqrt());
        let mut units = 0;
        let fit = lengths.all(|length| {
            units += u64::from(length > 0.0);
            length == 0.0 || length.is_nan() || (length - 1.0).abs() <= 0.01
        });
        fit && units > 0
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

    /// What three columns without a name are, if that can be told.
    fn triple(&self, first: usize) -> Option<Triple> {
        let places = [first, first + 1, first + 2];
        if self.unit_vectors(places) {
            return Some(Triple::Normal);
        }
        let float = places.iter().any(|&place| self.is_float(place));
        if float && self.all(places, |value| (0.0..=1.0).contains(&value)) {
            return Some(Triple::Color(Type::F32));
        }
        self.counts_to(places, 65535.0).then_some(Triple::Color(Type::U16))
    }
}

/// Three columns that belong together.
#[derive(Clone, Copy, PartialEq)]
enum Triple {
    Color(Type),
    Normal,
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
    let place =
        |axis: &[&str]| axis.iter().find_map(|name| plain.iter().position(|other| other == name));
    let [x, y, z] = POSITION;
    Some([place(x)?, place(y)?, place(z)?])
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
    for (axis, names) in ["x", "y", "z"].into_iter().zip(POSITION) {
        if let Some(place) = names.iter().find_map(|name| find(name)) {
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
        field.unwrap_or_else(|| {
            let name = match names[place].trim() {
                "" => format!("column_{}", place + 1),
                name => printable(name),
            };
            Field::new(name, stated(place).unwrap_or(Type::F64))
        })
    });
    rest.collect()
}

/// Columns without names. The first three are x y z; then, if the columns look like it:
///
/// | columns | further ones |
/// |---|---|
/// | 4 | intensity |
/// | 6 | a colour or a normal |
/// | 7 | intensity and one of these, or one of these and intensity |
/// | 9 | two of these |
/// | 10 | intensity and two of these, or two of these and intensity |
///
/// Three columns look like a normal if each row has length 1 (or 0); like a colour if they are
/// whole numbers from 0 to 65535, or fractions from 0 to 1. All else is named `column_4` and so on.
///
/// `kinds` are the columns' types where the file states them.
pub(crate) fn by_place(sample: &Sample, kinds: Option<&[Type]>) -> Vec<Field> {
    let kind = |place: usize| kinds.map_or(Type::F64, |kinds| kinds[place]);
    let named = |place: usize, name: &str| Field::new(name, kind(place));
    let column = |place: usize| named(place, &format!("column_{}", place + 1));
    let names = ["x", "y", "z"].into_iter().enumerate();
    let mut fields: Vec<Field> = names.map(|(place, name)| named(place, name)).collect();
    let triples = |places: &[usize]| -> Option<Vec<Field>> {
        let found: Vec<_> = places.iter().map(|&p| sample.triple(p)).collect::<Option<_>>()?;
        let normals = found.iter().filter(|&&triple| triple == Triple::Normal).count();
        if normals > 1 || found.len() - normals > 1 {
            return None;
        }
        let fields = found.into_iter().flat_map(|triple| match triple {
            Triple::Color(kind) => RED.map(|name| Field::new(name, kind)),
            Triple::Normal => NX.map(|name| Field::new(name, Type::F32)),
        });
        Some(fields.collect())
    };
    let rest = match sample.columns {
        4 => Some(vec![named(3, "intensity")]),
        6 => triples(&[3]),
        9 => triples(&[3, 6]),
        7 | 10 => {
            let places = |first: usize| (first..sample.columns - 2).step_by(3).collect::<Vec<_>>();
            let intensity = |place| vec![named(place, "intensity")];
            let after = triples(&places(4)).map(|rest| [intensity(3), rest].concat());
            let last = sample.columns - 1;
            after.or_else(|| triples(&places(3)).map(|rest| [rest, intensity(last)].concat()))
        }
        _ => None,
    };
    fields.extend(rest.unwrap_or_else(|| (3..sample.columns).map(column).collect()));
    fields
}

/// A name without what exporters add to it: `"X [m]"`, `//X`, `Points:0` and `Normal.X` become `x`,
/// `x`, `points_0` and `normal_x`.
fn plain(name: &str) -> String {
    let name = name.trim().trim_start_matches(['/', '#', '%']).trim().to_lowercase();
    let unit = name.strip_suffix([')', ']']).and_then(|rest| rest.rfind(['(', '[']));
    let name = match unit {
        Some(start) if start > 0 => &name[..start],
        _ => &name,
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
    let names: Vec<&str> = fields.iter().take(MOST).map(|field| field.name.as_str()).collect();
    let more = if fields.len() > MOST { " …" } else { "" };
    names.join(" ") + more
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(names: &[&str], row: &[f64]) -> Vec<String> {
        let names: Vec<String> = names.iter().map(|&name| name.to_owned()).collect();
        let sample = Sample { columns: names.len(), values: row.to_vec(), floats: Vec::new() };
        by_names(&names, None, &sample).into_iter().map(|field| field.name).collect()
    }

    fn placed(row: &[f64], floats: bool) -> String {
        let sample =
            Sample { columns: row.len(), values: row.to_vec(), floats: vec![floats; row.len()] };
        listed(&by_place(&sample, None))
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
        ] {
            assert_eq!(named(&names, &row), expected, "{names:?}");
        }
        // A better name leaves a worse one for what it says.
        assert_eq!(named(&["height", "Z", "x", "Y"], &row[..4]), ["height", "z", "x", "y"]);
        assert_eq!(named(&["x", "y", "z", "r", ""], &row[..5]), ["x", "y", "z", "r", "column_5"]);
    }

    #[test]
    fn columns_without_names_are_told_by_their_values() {
        for (row, floats, expected) in [
            (&[1.0, 2.0, 3.0][..], true, "x y z"),
            (&[1.0, 2.0, 3.0, 4.0], true, "x y z intensity"),
            (&[1.0, 2.0, 3.0, 4.0, 5.0], true, "x y z column_4 column_5"),
            (&[1.0, 2.0, 3.0, 255.0, 0.0, 7.0], false, "x y z red green blue"),
            (&[1.0, 2.0, 3.0, 0.0, 0.0, -1.0], false, "x y z nx ny nz"),
            (&[1.0, 2.0, 3.0, 0.6, 0.0, 0.8], true, "x y z nx ny nz"),
            (&[1.0, 2.0, 3.0, 0.6, 0.0, 0.7], true, "x y z red green blue"),
            (&[1.0, 2.0, 3.0, 0.6, 0.0, 7.7], true, "x y z column_4 column_5 column_6"),
            (&[1.0, 2.0, 3.0, -9.0, 4.0, 5.0, 6.0], false, "x y z intensity red green blue"),
            (&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 0.5], false, "x y z red green blue intensity"),
            (
                &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 0.0, 1.0, 0.0],
                false,
                "x y z red green blue nx ny nz",
            ),
            (
                &[1.0, 2.0, 3.0, 0.5, 0.0, 1.0, 0.0, 4.0, 5.0, 6.0],
                false,
                "x y z intensity nx ny nz red green blue",
            ),
        ] {
            assert_eq!(placed(row, floats), expected, "{row:?}");
        }
    }
}
