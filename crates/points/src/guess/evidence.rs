//! What the first rows of a table show of each column.

use crate::field::Type;
use crate::meaning::Sample;

/// With fewer rows, neither a small number of different values nor the same value throughout says
/// much.
const FEW_ROWS: usize = 8;
/// Different values that are counted; there may be more.
const MOST_DISTINCT: usize = 64;
/// A column with fewer different values is hardly a channel of a colour.
pub(super) const LEAST_SHADES: usize = 4;
/// A label has no more different values, and none above.
const MOST_LABELS: usize = 40;
const GREATEST_LABEL: f64 = 100.0;
/// Where only few rows are there.
const GREATEST_LABEL_OF_FEW: f64 = 20.0;

/// What is known of all columns.
pub(super) struct Evidence {
    pub(super) rows: usize,
    pub(super) columns: Vec<Column>,
    /// The places of the columns in the file, where they are not the same.
    places: Option<Vec<usize>>,
}

/// What is known of one column. What is not finite does not count.
pub(super) struct Column {
    pub(super) values: Vec<f64>,
    /// Whether all values are whole.
    whole: bool,
    pub(super) min: f64,
    pub(super) max: f64,
    /// How many different values there are, up to [`MOST_DISTINCT`].
    pub(super) distinct: usize,
    /// Whether it is written with a decimal point, or of a float type.
    pub(super) float: bool,
}

/// In which range the numbers of a colour are.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum Scale {
    /// From 0 to 1.
    Fractions,
    /// Whole, from 0 to 255.
    Bytes,
    /// From 0 to 255, with digits after the point.
    Averages,
    /// Whole, from 0 to 65535.
    Words,
}

impl Scale {
    /// How the collector is to take it. It finds bytes in fields of 16 bits by itself.
    pub(super) fn kind(self) -> Type {
        if matches!(self, Self::Fractions | Self::Averages) { Type::F32 } else { Type::U16 }
    }
}

impl Column {
    fn of(values: Vec<f64>, float: bool) -> Self {
        let finite = || values.iter().copied().filter(|value| value.is_finite());
        let mut distinct: Vec<f64> = Vec::new();
        for value in finite() {
            if distinct.len() == MOST_DISTINCT {
                break;
            }
            if let Err(place) = distinct.binary_search_by(|other| other.total_cmp(&value)) {
                distinct.insert(place, value);
            }
        }
        Self {
            whole: finite().next().is_some() && finite().all(|value| value.fract() == 0.0),
            min: finite().fold(f64::INFINITY, f64::min),
            max: finite().fold(f64::NEG_INFINITY, f64::max),
            distinct: distinct.len(),
            float,
            values,
        }
    }

    pub(super) fn is_constant(&self) -> bool {
        self.distinct <= 1
    }

    /// Whether each value is the one before it and one more.
    fn counts_up(&self) -> bool {
        self.whole && self.values.windows(2).all(|pair| pair[1] - pair[0] == 1.0)
    }

    /// Whether each value is whole and greater than the one before it.
    fn rises(&self) -> bool {
        self.whole && self.values.windows(2).all(|pair| pair[1] > pair[0])
    }
}

impl Evidence {
    pub(super) fn of(sample: &Sample, places: Option<&[usize]>) -> Self {
        let columns: Vec<Column> = (0..sample.columns)
            .map(|place| Column::of(sample.column(place).collect(), sample.is_float(place)))
            .collect();
        let rows = columns.first().map_or(0, |column| column.values.len());
        Self { rows, columns, places: places.map(<[usize]>::to_vec) }
    }

    /// The place of a column in the file.
    pub(super) fn place(&self, column: usize) -> usize {
        self.places.as_ref().map_or(column, |places| places[column])
    }

    /// Columns as messages call them: `column 4`, `columns 4 to 6`.
    pub(super) fn columns_in_words(&self, first: usize, count: usize) -> String {
        let [from, to] = [first, first + count - 1].map(|column| self.place(column) + 1);
        if count == 1 { format!("column {from}") } else { format!("columns {from} to {to}") }
    }

    /// Whether a name stands before the numbers of each point.
    pub(super) fn are_named(&self) -> bool {
        self.place(0) > 0
    }

    pub(super) fn few_rows(&self) -> bool {
        self.rows < FEW_ROWS
    }

    /// What shows that the first column is the points' number rather than a coordinate, if anything does:
    /// it counts up by one, and neither do the others nor does the next one stay the same, as the rows
    /// of a lattice do; or it rises by whole numbers where the next three have fractions.
    pub(super) fn counts_points(&self) -> Option<&'static str> {
        let [first, others @ ..] = self.columns.as_slice() else { return None };
        if others.len() < 3 || self.rows < 3 {
            return None;
        }
        let others = &others[..3];
        if first.counts_up() {
            let is_lattice = others[0].is_constant() || others.iter().any(Column::counts_up);
            return (!is_lattice).then_some("counts up by one");
        }
        let rises = !self.few_rows() && first.rises() && others.iter().all(|other| !other.whole);
        rises.then_some("rises by whole numbers")
    }

    /// What is unlike a coordinate in the first column, where more than a position is there.
    pub(super) fn oddity_of_first(&self) -> Option<&'static str> {
        let [first, others @ ..] = self.columns.as_slice() else { return None };
        if others.len() < 3 || self.few_rows() {
            None
        } else if first.is_constant() {
            Some("is the same throughout")
        } else if first.counts_up() {
            Some("counts up by one")
        } else if first.whole && !others[1].whole {
            Some("has only whole numbers")
        } else {
            None
        }
    }

    /// Whether two columns can only be a northing and then an easting: in the zones of UTM, eastings
    /// have six digits before the point, and northings seven.
    pub(super) fn northing_before_easting(&self, first: usize) -> bool {
        let [northing, easting] = [&self.columns[first], &self.columns[first + 1]];
        northing.min >= 1e6 && northing.max < 1e7 && easting.min >= 1e5 && easting.max < 1e6
    }

    /// Whether a column is like the coordinates of a survey.
    pub(super) fn is_large(&self, place: usize) -> bool {
        self.columns[place].min >= 1e4
    }

    /// Whether three columns are the vectors of length 1, but for 1 %, or of length 0.
    pub(super) fn unit_vectors(&self, first: usize) -> bool {
        let [x, y, z] = self.three(first).map(|column| &column.values);
        let mut units = 0;
        let fit = x.iter().zip(y).zip(z).all(|((x, y), z)| {
            let length = (x * x + y * y + z * z).sqrt();
            units += u64::from(length > 0.0);
            length == 0.0 || length.is_nan() || (length - 1.0).abs() <= 0.01
        });
        fit && units > 0
    }

    /// In which range three columns are that can be a colour.
    pub(super) fn scale(&self, first: usize) -> Option<Scale> {
        let three = self.three(first);
        let within = |most: f64| three.iter().all(|column| column.min >= 0.0 && column.max <= most);
        let whole = three.iter().all(|column| column.whole);
        if within(1.0) && three.iter().any(|column| column.float) {
            Some(Scale::Fractions)
        } else if whole && within(255.0) {
            Some(Scale::Bytes)
        } else if whole && within(65535.0) && !three.iter().any(|column| self.counts(column)) {
            Some(Scale::Words)
        } else if !whole && within(255.0) {
            Some(Scale::Averages)
        } else {
            None
        }
    }

    fn counts(&self, column: &Column) -> bool {
        !self.few_rows() && column.counts_up()
    }

    pub(super) fn three(&self, first: usize) -> [&Column; 3] {
        [0, 1, 2].map(|step| &self.columns[first + step])
    }

    /// Whether a column has few, small whole numbers, as names of classes have.
    pub(super) fn is_label(&self, place: usize) -> bool {
        let column = &self.columns[place];
        if !column.whole || column.min < -1.0 {
            return false;
        }
        match self.few_rows() {
            true => column.max <= GREATEST_LABEL_OF_FEW && !column.float,
            false => {
                column.max <= GREATEST_LABEL
                    && column.distinct <= MOST_LABELS
                    && 2 * column.distinct <= self.rows
            }
        }
    }

    /// Whether a column is full opacity throughout, beside a colour of this kind.
    pub(super) fn is_opaque(&self, place: usize, color: Type) -> bool {
        let column = &self.columns[place];
        let full: &[f64] = if color.is_float() { &[1.0] } else { &[255.0, 65535.0] };
        column.is_constant() && full.contains(&column.max)
    }
}
