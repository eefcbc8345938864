//! Rows of numbers into a point set: which field is what, and where its values go.
//!
//! Every reader hands its points to a [`Collector`], so what is a colour, a normal or an attribute
//! is decided here, once, by the names and types of the fields; the filter is applied here, before
//! anything is kept.

use crate::color::{self, Color, Verdict};
use crate::error::PointsError;
use crate::field::{Field, Type};
use crate::filter::Sieve;
use crate::meaning;
use crate::names;
use crate::options::ReadOptions;
use crate::set::{Attribute, PointSet, Values};
use crate::stream::Outlet;
use crate::units::{self, Spread, Units};
use std::collections::{HashMap, HashSet, TryReserveError};
use std::path::Path;

/// Names of a position, in any letter case.
const POSITION: [&str; 3] = ["x", "y", "z"];
/// Names that exporters give to the three numbers of a normal, in any letter case.
const NORMAL: [[&str; 3]; 2] = [["nx", "ny", "nz"], ["normal_x", "normal_y", "normal_z"]];

/// Takes points one by one.
pub(crate) struct Collector<'a> {
    path: &'a Path,
    /// Places of x, y, z in a row.
    position: [usize; 3],
    color: Option<Color>,
    normal: Option<[usize; 3]>,
    /// Places of the attributes that are kept, in the order of `set.attributes`.
    attributes: Vec<usize>,
    /// `None` where the filter keeps all.
    sieve: Option<Sieve>,
    /// The filter, in words.
    filter: String,
    set: PointSet,
    /// Where points go, block by block, if not into the set.
    outlet: Option<Outlet>,
    /// Points of a block.
    block: usize,
    /// Points that went there.
    handed_over: u64,
    /// Points spread over the file.
    sample: Spread,
    /// How the file shows that x and y are degrees, if it does.
    degrees: Option<String>,
}

impl<'a> Collector<'a> {
    /// Decides what each field of a row is. A row has one number for each of `fields`, in order.
    ///
    /// Fails if there is no position, a name that the filter asks for is missing, or the user names
    /// columns that are not there.
    pub(crate) fn new(
        fields: &[Field],
        path: &'a Path,
        options: &ReadOptions,
    ) -> Result<Self, PointsError> {
        match options.columns.is_empty() {
            true => Self::of_named(fields, path, options),
            false => Self::of_named(&options.columns.applied(fields, path)?, path, options),
        }
    }

    /// The same of fields whose names are already those that the user gives them.
    pub(crate) fn of_named(
        fields: &[Field],
        path: &'a Path,
        options: &ReadOptions,
    ) -> Result<Self, PointsError> {
        // Longitude and latitude are a position by their names; other names are left to readers.
        let in_degrees = |axis| {
            let names: Vec<&str> = fields.iter().map(|field| field.name.as_str()).collect();
            let places = meaning::positions_among(&names).ok_or(axis)?;
            units::named(names[places[0]], names[places[1]]).map(|_| places).ok_or(axis)
        };
        let position = triple(fields, POSITION).or_else(in_degrees);
        let position = position.map_err(|axis| PointsError::Missing {
            path: path.into(),
            missing: format!("number '{axis}'"),
            place: format!("among the fields of a point ({})", listed(fields)),
            help: "export positions as the numbers x, y and z, or name them by --columns or \
                   [objects.columns]",
        })?;
        let mut color = Color::find(fields);
        let mut normal = NORMAL.into_iter().find_map(|names| triple(fields, names).ok());
        let taken = |place: &usize| {
            position.contains(place)
                || color.as_ref().is_some_and(|color| color.contains(*place))
                || normal.is_some_and(|normal| normal.contains(place))
        };

        let single_positions = position.iter().all(|&place| fields[place].kind == Type::F32);
        let mut set = PointSet { single_positions, ..PointSet::default() };
        let mut places = Vec::new();
        let names = distinct_names(fields);
        let others: Vec<usize> = (0..fields.len())
            .filter(|place| !taken(place) && !fields[*place].is_left_out())
            .collect();
        let wanted = options.wanted.attributes_among(others.iter().map(|&place| &*names[place]));
        for (&place, wanted) in others.iter().zip(wanted) {
            let name = names[place].clone();
            if !wanted {
                set.left_out.push(name);
                continue;
            }
            places.push(place);
            set.attributes.push(Attribute { name, values: Values::of(fields[place].kind) });
        }
        if !options.wanted.colors() {
            color = None;
        }
        if !options.wanted.normals() {
            normal = None;
        }
        set.colors = color.is_some().then(Vec::new);
        set.normals = normal.is_some().then(Vec::new);

        let filter = &options.filter;
        let sieve = match filter.keeps_all() {
            true => None,
            false => {
                let places = filter.names().map(|name| {
                    let place = names::find(names.iter().map(String::as_str), name);
                    place.ok_or_else(|| PointsError::Missing {
                        path: path.into(),
                        missing: format!("attribute '{name}', which the filter asks for"),
                        place: format!("among the fields of a point ({})", listed(fields)),
                        help: "name one of them in [objects.filter]",
                    })
                });
                Some(Sieve::new(filter, places.collect::<Result<_, _>>()?))
            }
        };
        let filter = filter.to_string();
        let (outlet, block) = (options.outlet.clone(), Outlet::block_of(&set));
        let [x, y] = [position[0], position[1]].map(|place| fields[place].original_name());
        let degrees = units::named(x, y);
        Ok(Self {
            path,
            position,
            color,
            normal,
            attributes: places,
            sieve,
            filter,
            set,
            outlet,
            block,
            handed_over: 0,
            sample: Spread::default(),
            degrees,
        })
    }

    /// The file says that x and y are longitude and latitude in degrees, in the way that the text says.
    pub(crate) fn is_in_degrees(&mut self, how: String) {
        self.degrees = Some(how);
    }

    /// Asks for memory for this many points at once, so that too little of it is an error. The
    /// number must be bounded by what the file has bytes for, as that of
    /// [`Source::records`](crate::source::Source::records) is. Nothing is asked for where a filter
    /// keeps an unknown part, or where points are not held.
    pub(crate) fn expect(&mut self, points: u64) -> Result<(), PointsError> {
        if points > u64::from(u32::MAX) {
            return Err(PointsError::TooMany { path: self.path.into(), found: points });
        }
        if self.sieve.is_some() || self.outlet.is_some() {
            return Ok(());
        }
        let set = &mut self.set;
        let count = points as usize;
        let mut ask = || -> Result<(), TryReserveError> {
            set.positions.try_reserve_exact(count)?;
            set.file_index.try_reserve_exact(count)?;
            if let Some(colors) = &mut set.colors {
                colors.try_reserve_exact(count)?;
            }
            if let Some(normals) = &mut set.normals {
                normals.try_reserve_exact(count)?;
            }
            for attribute in &mut set.attributes {
                attribute.values.try_reserve_exact(count)?;
            }
            Ok(())
        };
        ask().map_err(|_| PointsError::OutOfMemory { path: self.path.into(), points })
    }

    /// Takes the next point of the file.
    pub(crate) fn push(&mut self, row: &[f64]) -> Result<(), PointsError> {
        let index = self.next_index()?;
        let position = self.position.map(|place| row[place]);
        if let Some(color) = &mut self.color {
            color.see(row);
        }
        let skipped = self.sieve.as_mut().is_some_and(Sieve::skips);
        let set = &mut self.set;
        if !position.iter().all(|coordinate| coordinate.is_finite()) {
            set.non_finite += 1;
            return Ok(());
        }
        if skipped || self.sieve.as_mut().is_some_and(|sieve| !sieve.keeps(position, row)) {
            set.filtered_out += 1;
            return Ok(());
        }
        self.sample.see(position);
        set.positions.push(position);
        set.file_index.push(index);
        if let (Some(colors), Some(color)) = (&mut set.colors, &self.color) {
            colors.push(color.stored(row).map(|stored| stored as f32));
        }
        if let (Some(normals), Some(normal)) = (&mut set.normals, self.normal) {
            normals.push(normal.map(|place| row[place] as f32));
        }
        for (attribute, &place) in set.attributes.iter_mut().zip(&self.attributes) {
            attribute.values.push(row[place]);
        }
        if self.outlet.is_some() && self.set.positions.len() >= self.block {
            self.hand_over();
        }
        Ok(())
    }

    /// No point of the file had a colour, although the fields have one.
    pub(crate) fn without_colors(&mut self) {
        self.hand_over();
        (self.color, self.set.colors) = (None, None);
    }

    /// Points of the file that were kept.
    pub(crate) fn kept(&self) -> u64 {
        self.handed_over + self.set.positions.len() as u64
    }

    fn hand_over(&mut self) {
        if let Some(outlet) = &self.outlet
            && !self.set.is_empty()
        {
            self.handed_over += self.set.positions.len() as u64;
            outlet.take(&mut self.set);
        }
    }

    /// Passes over the next point of the file, which the file itself calls invalid.
    pub(crate) fn push_invalid(&mut self) -> Result<(), PointsError> {
        self.next_index()?;
        if let Some(sieve) = &mut self.sieve {
            sieve.skips();
        }
        self.set.invalid += 1;
        Ok(())
    }

    /// Place in the file of the point that comes.
    fn next_index(&mut self) -> Result<u32, PointsError> {
        let found = self.handed_over + self.set.in_file();
        u32::try_from(found)
            .ok()
            .filter(|&index| index < u32::MAX)
            .ok_or_else(|| PointsError::TooMany { path: self.path.into(), found: found + 1 })
    }

    /// The set, which must not be empty. `format` is the file format in words.
    pub(crate) fn finish(mut self, format: &str) -> Result<PointSet, PointsError> {
        self.hand_over();
        let mut set = self.set;
        if self.handed_over == 0 && set.positions.is_empty() {
            let path = self.path.into();
            return Err(match set.filtered_out {
                0 if set.in_file() == 0 => PointsError::WithoutPoints { path },
                0 => PointsError::NoPoints {
                    path,
                    in_file: set.in_file(),
                    non_finite: set.non_finite,
                    invalid: set.invalid,
                },
                usable => PointsError::FilteredOut { path, usable, filter: self.filter },
            });
        }
        if let (Some(color), Some(colors)) = (&self.color, &mut set.colors) {
            let Verdict { encoding, note } = color.verdict();
            match encoding {
                Some(encoding) => color::decode(encoding, colors),
                None => set.colors = None,
            }
            set.color_encoding = encoding;
            set.notes.extend(note);
        }
        set.format = format.to_owned();
        let (units, doubt) = Units::of(&self.sample.positions, self.degrees);
        set.units = units;
        set.notes.extend(doubt);
        Ok(set)
    }
}

/// Place of the field of this name. A name in other letter case does where the exact one is
/// missing.
fn find(fields: &[Field], name: &str) -> Option<usize> {
    let place = |fits: &dyn Fn(&str) -> bool| fields.iter().position(|field| fits(&field.name));
    place(&|other| other == name).or_else(|| place(&|other| other.eq_ignore_ascii_case(name)))
}

/// Places of three fields; fails with the first name that is none.
fn triple<'n>(fields: &[Field], names: [&'n str; 3]) -> Result<[usize; 3], &'n str> {
    let place = |name: &'n str| find(fields, name).ok_or(name);
    let [x, y, z] = names;
    Ok([place(x)?, place(y)?, place(z)?])
}

/// The names of the fields; those that are there before get a number.
fn distinct_names(fields: &[Field]) -> Vec<String> {
    let mut taken: HashSet<String> = HashSet::new();
    // The last number of each name that came before.
    let mut numbers: HashMap<&str, u64> = HashMap::new();
    let mut names = Vec::with_capacity(fields.len());
    for field in fields {
        let mut name = field.name.clone();
        while !taken.insert(name.clone()) {
            let number = numbers.entry(&field.name).or_insert(1);
            *number += 1;
            name = format!("{}_{number}", field.name);
        }
        names.push(name);
    }
    names
}

/// The names of the fields, for messages: not more than a line holds.
fn listed(fields: &[Field]) -> String {
    const MOST: usize = 20;
    let name = |field: &Field| format!("'{}'", field.original_name());
    let names: Vec<_> = fields.iter().take(MOST).map(name).collect();
    let more = if fields.len() > MOST { ", …" } else { "" };
    match names.as_slice() {
        [] => "none".to_owned(),
        names => format!("{}{more}", names.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::Type;
    use crate::filter::Filter;
    use crate::options::Wanted;

    fn fields(names: &[(&str, Type)]) -> Vec<Field> {
        names.iter().map(|&(name, kind)| Field::new(name, kind)).collect()
    }

    fn xyz_and(others: &[(&str, Type)]) -> Vec<Field> {
        let xyz = [("x", Type::F64), ("y", Type::F64), ("z", Type::F64)];
        fields(&[&xyz, others].concat())
    }

    fn collect(
        fields: &[Field],
        rows: &[&[f64]],
        options: &ReadOptions,
    ) -> Result<PointSet, PointsError> {
        let mut collector = Collector::new(fields, Path::new("a"), options)?;
        for row in rows {
            collector.push(row)?;
        }
        collector.finish("rows")
    }

    #[test]
    fn names_that_come_twice_are_numbered() {
        let fields = xyz_and(&[("a", Type::F32), ("a", Type::U8), ("a_2", Type::U8)]);
        let set = collect(&fields, &[&[0.0, 1.0, 2.0, 3.0, 4.0, 5.0]], &ReadOptions::default());
        let set = set.unwrap();
        assert_eq!(set.attribute("a"), Some(&Values::F32(vec![3.0])));
        assert_eq!(set.attribute("a_2"), Some(&Values::U8(vec![4])));
        assert_eq!(set.attribute("a_2_2"), Some(&Values::U8(vec![5])));
    }

    #[test]
    fn what_is_not_wanted_is_named_but_not_held() {
        let fields = xyz_and(&[
            ("nx", Type::F32),
            ("ny", Type::F32),
            ("nz", Type::F32),
            ("red", Type::U8),
            ("green", Type::U8),
            ("blue", Type::U8),
            ("a", Type::F64),
            ("b", Type::U8),
        ]);
        let wanted =
            Wanted::Some { colors: false, normals: true, attributes: vec!["b".to_owned()] };
        let options = ReadOptions { wanted, ..ReadOptions::default() };
        let set = collect(&fields, &[&[0.0; 11]], &options).unwrap();
        assert_eq!((set.colors, set.color_encoding), (None, None));
        assert_eq!(set.normals, Some(vec![[0.0; 3]]));
        assert_eq!(set.left_out, ["a"]);
        assert_eq!(set.attributes.len(), 1);
    }

    #[test]
    fn filters_are_applied_in_their_order() {
        let fields = xyz_and(&[("Classification", Type::U8), ("intensity", Type::U16)]);
        // x from 0 to 11, class 0 to 2 in turn, intensity ten times x.
        let rows: Vec<[f64; 5]> = (0..12)
            .map(|i| [f64::from(i), 0.0, -0.0, f64::from(i % 3), f64::from(10 * i)])
            .collect();
        let rows: Vec<&[f64]> = rows.iter().map(|row| &row[..]).collect();
        let kept = |filter: Filter| {
            let options = ReadOptions { filter, ..ReadOptions::default() };
            let set = collect(&fields, &rows, &options).unwrap();
            assert_eq!(set.len() as u64 + set.filtered_out, 12);
            set.file_index
        };
        let all = Filter::default;
        assert_eq!(kept(Filter { every: 5, ..all() }), [0, 5, 10]);
        let bounds = Some([[2.0, -1.0, 0.0], [4.0, 1.0, 0.0]]);
        assert_eq!(kept(Filter { bounds, ..all() }), [2, 3, 4]);
        assert_eq!(kept(Filter { bounds, every: 2, ..all() }), [2, 4]);
        let ranges = vec![("intensity".to_owned(), [30.0, 70.0]), ("X".to_owned(), [0.0, 6.5])];
        assert_eq!(kept(Filter { ranges: ranges.clone(), ..all() }), [3, 4, 5, 6]);
        let classes = Some(vec![2, 6]);
        assert_eq!(kept(Filter { classes: classes.clone(), ..all() }), [2, 5, 8, 11]);
        assert_eq!(kept(Filter { ranges, classes: classes.clone(), ..all() }), [5]);
        assert_eq!(kept(Filter { voxel: Some(4.0), ..all() }), [0, 4, 8]);
        assert_eq!(kept(Filter { voxel: Some(4.0), classes, ..all() }), [2, 5, 8]);
    }

    #[test]
    fn filters_that_keep_nothing_or_ask_for_what_is_not_there_are_errors() {
        let read = |filter| {
            let options = ReadOptions { filter, ..ReadOptions::default() };
            collect(&xyz_and(&[]), &[&[1.0, 2.0, 3.0]], &options).unwrap_err().to_string()
        };
        let ranges = vec![("z".to_owned(), [0.0, 1.5])];
        let none = read(Filter { ranges, every: 3, ..Filter::default() });
        assert_eq!(
            none,
            "a: the filter (every = 3, range = { z = [0, 1.5] }) keeps none of 1 points; widen it"
        );
        let missing = read(Filter { classes: Some(vec![2]), ..Filter::default() });
        assert_eq!(
            missing,
            "a: found no attribute 'classification', which the filter asks for, expected it among \
             the fields of a point ('x', 'y', 'z'); name one of them in [objects.filter]"
        );
    }
}
