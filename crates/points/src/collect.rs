//! Rows of numbers into a point set: which field is what, and where its values go.
//!
//! Every reader hands its points to a [`Collector`], so what is a colour, a normal or an attribute
//! is decided here, once, by the names and types of the fields; the filter is applied here, before
//! anything is kept.

use crate::color::{self, Color, Meanings, Verdict};
use crate::error::PointsError;
use crate::field::{Field, Type};
use crate::filter::Sieve;
use crate::meaning;
use crate::names;
use crate::options::ReadOptions;
use crate::set::{Attribute, PointSet, Values};
use crate::stream::Outlet;
use crate::units::{self, Spread, Units};
use crate::voxels::{self, Voxel, Voxels};
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
    /// The cubes whose means are to be the points, and whatever colours may mean until the file ends.
    voxels: Option<(Voxels, Option<Meanings>)>,
    /// Whether the edge of cubes is found from all points, which have to be held for that.
    voxel_is_automatic: bool,
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
        let voxels = match filter.voxel {
            Some(Voxel::Edge(edge)) => {
                let meanings = color.as_ref().map(Meanings::of);
                let scales = meanings.as_ref().map_or(1, Meanings::len);
                Some((Voxels::new(edge, &set, scales), meanings))
            }
            _ => None,
        };
        let voxel_is_automatic = filter.voxel == Some(Voxel::Auto);
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
            voxels,
            voxel_is_automatic,
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
        if skipped || self.sieve.as_ref().is_some_and(|sieve| !sieve.keeps(position, row)) {
            set.filtered_out += 1;
            return Ok(());
        }
        self.sample.see(position);
        if self.voxels.is_some() {
            self.push_into_voxel(position, index, row);
            return Ok(());
        }
        let set = &mut self.set;
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

    /// Adds a point to its cube; any but the first of a cube count as left out.
    fn push_into_voxel(&mut self, position: [f64; 3], index: u32, row: &[f64]) {
        let Some((voxels, meanings)) = &mut self.voxels else { return };
        let (voxel, is_first) = voxels.find(position, index);
        self.set.filtered_out += u64::from(!is_first);
        if let (Some(meanings), Some(color)) = (meanings, &self.color) {
            voxels.add_color(voxel, meanings.linear(color.stored(row).map(|stored| stored as f32)));
        }
        if let Some(normal) = self.normal {
            voxels.add_normal(voxel, normal.map(|place| row[place] as f32));
        }
        for (attribute, &place) in self.attributes.iter().enumerate() {
            voxels.add_value(voxel, attribute, row[place]);
        }
    }

    /// No point of the file had a colour, although the fields have one.
    pub(crate) fn without_colors(&mut self) {
        self.hand_over();
        (self.color, self.set.colors) = (None, None);
        if let Some((voxels, meanings)) = &mut self.voxels {
            voxels.without_colors();
            *meanings = None;
        }
    }

    /// The position that a row has.
    pub(crate) fn position_of(&self, row: &[f64]) -> [f64; 3] {
        self.position.map(|place| row[place])
    }

    /// Points of the file that came so far: the place in the file of the next one.
    pub(crate) fn seen(&self) -> u32 {
        let set = &self.set;
        (self.kept() + set.non_finite + set.invalid + set.filtered_out) as u32
    }

    /// Points of the file that were kept.
    pub(crate) fn kept(&self) -> u64 {
        let voxels = self.voxels.as_ref().map_or(0, |(voxels, _)| voxels.len());
        self.handed_over + self.set.positions.len() as u64 + voxels as u64
    }

    fn hand_over(&mut self) {
        if let Some(outlet) = &self.outlet
            && !self.set.is_empty()
            && !self.voxel_is_automatic
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
        let set = &self.set;
        let found = self.kept() + set.non_finite + set.invalid + set.filtered_out;
        u32::try_from(found)
            .ok()
            .filter(|&index| index < u32::MAX)
            .ok_or_else(|| PointsError::TooMany { path: self.path.into(), found: found + 1 })
    }

    /// The set, which must not be empty. `format` is the file format in words.
    pub(crate) fn finish(mut self, format: &str) -> Result<PointSet, PointsError> {
        self.hand_over();
        if self.kept() == 0 {
            return Err(self.no_points());
        }
        let mut set = self.set;
        let verdict = self.color.as_ref().filter(|_| set.colors.is_some()).map(Color::verdict);
        let Verdict { encoding, note } = verdict.unwrap_or_default();
        set.color_encoding = encoding;
        set.notes.extend(note);
        match (encoding, &mut set.colors) {
            (Some(encoding), Some(colors)) => color::decode(encoding, colors),
            _ => set.colors = None,
        }
        let are_means = self.voxels.is_some() || self.voxel_is_automatic;
        if let Some((mut voxels, meanings)) = self.voxels {
            let scale = meanings.zip(encoding).map(|(meanings, of)| meanings.place(of));
            if scale.is_none() {
                voxels.without_colors();
            }
            set = voxels.means(set, scale.unwrap_or(0), 1);
        } else if self.voxel_is_automatic {
            let (means, edge) = voxels::automatic(&set);
            set = means;
            set.voxel = edge;
            set.notes.extend(edge.map(|edge| {
                format!("voxel = \"auto\" takes cubes of {edge:.3e}, twice the median distance of points")
            }));
        }
        if let (true, Some(outlet)) = (are_means, &self.outlet) {
            // Colours go there as the file would store them.
            if let (Some(encoding), Some(colors)) = (encoding, &mut set.colors) {
                let stored = |linear: &mut f32| *linear = encoding.encode(*linear) as f32;
                colors.iter_mut().flatten().for_each(stored);
            }
            outlet.take(&mut set);
        }
        set.format = format.to_owned();
        let (units, doubt) = Units::of(&self.sample.positions, self.degrees);
        set.units = units;
        set.notes.extend(doubt);
        Ok(set)
    }

    /// Why there is no point.
    fn no_points(&self) -> PointsError {
        let (set, path) = (&self.set, self.path.into());
        match set.filtered_out {
            0 if set.in_file() == 0 => PointsError::WithoutPoints { path },
            0 => PointsError::NoPoints {
                path,
                in_file: set.in_file(),
                non_finite: set.non_finite,
                invalid: set.invalid,
            },
            usable => PointsError::FilteredOut { path, usable, filter: self.filter.clone() },
        }
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
mod tests;
