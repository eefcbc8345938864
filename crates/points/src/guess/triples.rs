//! Three columns that belong together: a colour, a normal.

use crate::field::Type;
use crate::guess::evidence::{Column, Evidence, LEAST_SHADES, Scale};

/// A column of a colour in which all values are at most this is taken for something else where there
/// are few different values: return numbers, classes.
const DARK: f64 = 20.0;
/// A colour of few different values has some as bright.
const BRIGHT: f64 = 128.0;
/// Of more columns, too few rows show no colour.
const MOST_OF_FEW_ROWS: usize = 12;
/// Numbers from 0 to 255 with fractions are a colour only if each channel has a range of [`WIDE`], or if
/// one reaches [`HALF`] and the sum of their three correlations is [`CLOSE`].
const WIDE: f64 = 64.0;
const HALF: f64 = 127.0;
const CLOSE: f64 = 2.0;
/// By how much the sum of three correlations must be larger to decide between two triples.
const CORRELATED: f64 = 0.5;

/// Where they are.
pub(super) struct Triples {
    pub(super) normal: Option<usize>,
    pub(super) color: Option<ColorTriple>,
    /// Other columns that could be the colour just as well.
    rival: Option<usize>,
    /// Three columns in the range of a colour that were not taken for one.
    refused: Option<usize>,
}

/// A colour.
#[derive(Clone, Copy)]
pub(super) struct ColorTriple {
    pub(super) first: usize,
    pub(super) kind: Type,
    scale: Scale,
    likeness: Likeness,
}

/// How far three columns are like a colour, the likeliest first.
#[derive(Clone, Copy, PartialEq, PartialOrd, Debug)]
enum Likeness {
    /// Each has several different values.
    Varied,
    /// There are too few rows to say.
    FewRows,
    /// They have two or three different values.
    FewShades,
    /// They are the same throughout.
    Uniform,
}

impl ColorTriple {
    pub(super) fn end(self) -> usize {
        self.first + 3
    }

    /// Stands for a normal, where only its being there counts.
    pub(super) fn not_one(first: usize) -> Self {
        let (scale, likeness) = (Scale::Fractions, Likeness::FewRows);
        Self { first, kind: Type::F32, scale, likeness }
    }

    fn at(evidence: &Evidence, first: usize) -> Option<Self> {
        let scale = evidence.scale(first)?;
        let likeness = likeness(evidence, first, scale)?;
        Some(Self { first, kind: scale.kind(), scale, likeness })
    }
}

impl Triples {
    /// Looks for a normal and a colour from a column on.
    pub(super) fn find(evidence: &Evidence, from: usize) -> Self {
        let columns = evidence.columns.len();
        let starts = || from..(columns + 1).saturating_sub(3).max(from);
        let normal = starts().find(|&first| evidence.unit_vectors(first));
        let free = |first: &usize| normal.is_none_or(|normal| first.abs_diff(normal) >= 3);
        let all: Vec<ColorTriple> =
            starts().filter(free).filter_map(|first| ColorTriple::at(evidence, first)).collect();
        let (color, rival) = choose(evidence, all);
        // Far from the position, what has few different values is no sign of a colour.
        let near = |color: &ColorTriple| {
            color.likeness < Likeness::FewShades
                || color.first <= from + 1
                || normal.is_some_and(|normal| color.first <= normal + 4)
        };
        let color = color.filter(near);
        let refused = starts()
            .filter(free)
            .find(|&first| color.is_none() && evidence.scale(first) == Some(Scale::Bytes))
            .filter(|&first| evidence.three(first).iter().any(|column| column.max > DARK));
        Self { normal, color, rival, refused }
    }

    /// The first column of the first triple.
    pub(super) fn start(&self) -> Option<usize> {
        self.normal.into_iter().chain(self.color.map(|color| color.first)).min()
    }

    /// The first column after the last triple.
    pub(super) fn end(&self) -> Option<usize> {
        let normal = self.normal.map(|normal| normal + 3);
        normal.into_iter().chain(self.color.map(ColorTriple::end)).max()
    }

    /// Whether the one triple that was found can hardly be anything else.
    pub(super) fn are_certain(&self, evidence: &Evidence) -> bool {
        let color =
            |color: ColorTriple| color.likeness == Likeness::Varied && color.scale == Scale::Bytes;
        let normal = |first| evidence.three(first).iter().any(|column| !column.is_constant());
        !evidence.few_rows() && (self.color.is_some_and(color) || self.normal.is_some_and(normal))
    }

    /// What makes them doubtful.
    pub(super) fn doubts(&self, evidence: &Evidence) -> Vec<String> {
        let mut doubts = Vec::new();
        if let Some(color) = self.color {
            let place = evidence.columns_in_words(color.first, 3);
            match color.likeness {
                Likeness::Uniform => {
                    doubts.push(format!("the colour in {place} is the same throughout"));
                }
                Likeness::FewShades => {
                    doubts.push(format!("{place} have few different values for a colour"));
                }
                Likeness::FewRows => {}
                Likeness::Varied if color.scale == Scale::Words => {
                    doubts.push(format!("the colour in {place} goes beyond 255"));
                }
                Likeness::Varied if color.scale == Scale::Averages => {
                    doubts.push(format!("the colour in {place} has fractions"));
                }
                Likeness::Varied if color.scale == Scale::Fractions => {
                    doubts.push(format!("the colour in {place} is made of fractions"));
                }
                Likeness::Varied => {}
            }
        }
        if let Some(rival) = self.rival {
            doubts
                .push(format!("{} could be the colour, too", evidence.columns_in_words(rival, 3)));
        }
        if let Some(first) = self.refused {
            doubts.push(format!(
                "{} are from 0 to 255, but one has fewer than {LEAST_SHADES} different values, which \
                 is unlike a colour",
                evidence.columns_in_words(first, 3)
            ));
        }
        if evidence.few_rows() && (self.color.is_some() || self.normal.is_some()) {
            doubts.push("so few rows prove little".to_owned());
        }
        doubts
    }
}

/// How like a colour three columns are whose numbers have its range.
fn likeness(evidence: &Evidence, first: usize, scale: Scale) -> Option<Likeness> {
    let three = evidence.three(first);
    if scale == Scale::Averages {
        return likeness_of_averages(evidence, three);
    }
    if evidence.few_rows() {
        return (evidence.columns.len() <= MOST_OF_FEW_ROWS).then_some(Likeness::FewRows);
    }
    let (dark, bright) = match scale {
        Scale::Fractions => (0.0, 0.5),
        Scale::Bytes | Scale::Averages | Scale::Words => (DARK, BRIGHT),
    };
    let varied = |column: &&Column| column.distinct >= LEAST_SHADES;
    let brightest = three.iter().map(|column| column.max).fold(0.0, f64::max);
    if three.iter().all(varied) {
        Some(Likeness::Varied)
    } else if three.iter().all(|column| column.is_constant()) {
        (brightest > dark).then_some(Likeness::Uniform)
    } else if three.iter().any(varied) {
        let bright = |column: &&Column| column.max >= bright && !column.is_constant();
        three.iter().all(bright).then_some(Likeness::FewShades)
    } else {
        (brightest >= bright).then_some(Likeness::FewShades)
    }
}

/// The same of numbers from 0 to 255 with fractions, which anything can be.
fn likeness_of_averages(evidence: &Evidence, three: [&Column; 3]) -> Option<Likeness> {
    let bright = three.iter().any(|column| column.max >= HALF);
    if evidence.few_rows() {
        return (bright && evidence.columns.len() == 6).then_some(Likeness::FewRows);
    }
    if three.iter().all(|column| column.is_constant()) {
        return bright.then_some(Likeness::Uniform);
    }
    let varied = three.iter().all(|column| column.distinct >= LEAST_SHADES);
    let wide = three.iter().all(|column| column.max - column.min >= WIDE);
    (varied && (wide || (bright && together(three) >= CLOSE))).then_some(Likeness::Varied)
}

/// The colour among those that are possible, and another that is just as likely.
fn choose(evidence: &Evidence, mut all: Vec<ColorTriple>) -> (Option<ColorTriple>, Option<usize>) {
    // A number with fractions beside a colour of whole ones is something else.
    if all.iter().any(|color| color.scale != Scale::Averages) {
        all.retain(|color| color.scale != Scale::Averages);
    }
    // A label or an opacity after a colour can pass for its last channel.
    let is_label = |place| evidence.is_label(place);
    let has_label = |color: &ColorTriple| (color.first..color.end()).any(is_label);
    if all.iter().any(|color| !has_label(color)) {
        all.retain(|color| !has_label(color));
    }
    let firsts: Vec<usize> = all.iter().map(|color| color.first).collect();
    all.retain(|color| {
        let last = color.end() - 1;
        let has_before = color.first.checked_sub(1).is_some_and(|first| firsts.contains(&first));
        !(has_before && (is_label(last) || evidence.is_opaque(last, color.kind)))
    });
    let Some(best) =
        all.iter().map(|color| color.likeness).reduce(|a, b| if b < a { b } else { a })
    else {
        return (None, None);
    };
    all.retain(|color| color.likeness == best);
    let usual = match all.as_slice() {
        // Of four, the first is more often an intensity than the last.
        [a, b] if a.first + 1 == b.first => *b,
        [a, ..] => *a,
        [] => return (None, None),
    };
    let mut others = all.iter().filter(|color| color.first != usual.first);
    if best != Likeness::Varied {
        return (Some(usual), others.next().map(|other| other.first));
    }
    // The channels of a colour go up and down together more than others do with them.
    let score = |color: &ColorTriple| together(evidence.three(color.first));
    let usual_score = score(&usual);
    let likelier = |color: &&ColorTriple| score(color) > usual_score + CORRELATED;
    if let Some(better) = others.clone().find(likelier) {
        return (Some(*better), None);
    }
    let as_likely = |color: &&ColorTriple| score(color) + CORRELATED >= usual_score;
    (Some(usual), others.find(as_likely).map(|other| other.first))
}

/// How much three columns go up and down together: the sum of their correlations.
fn together([a, b, c]: [&Column; 3]) -> f64 {
    [correlation(a, b), correlation(b, c), correlation(a, c)].into_iter().sum()
}

/// Pearson's correlation without its sign; 0 where a column is constant.
fn correlation(a: &Column, b: &Column) -> f64 {
    let pairs = || {
        let both = a.values.iter().zip(&b.values);
        both.filter(|(a, b)| a.is_finite() && b.is_finite())
    };
    let count = pairs().count().max(1) as f64;
    let mean_a = pairs().map(|(a, _)| a).sum::<f64>() / count;
    let mean_b = pairs().map(|(_, b)| b).sum::<f64>() / count;
    let sum = |of: &dyn Fn(f64, f64) -> f64| {
        pairs().map(|(a, b)| of(a - mean_a, b - mean_b)).sum::<f64>()
    };
    let scale = (sum(&|a, _| a * a) * sum(&|_, b| b * b)).sqrt();
    if scale > 0.0 { (sum(&|a, b| a * b) / scale).abs() } else { 0.0 }
}
