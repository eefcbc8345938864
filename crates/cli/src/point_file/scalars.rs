//! Which of the points' numbers is a scalar that colours can show, and between which values.

use points::{PointSet, Values};

/// Numbers that are looked at for a range.
const SAMPLE: usize = 1 << 20;
/// Numbers that are looked at for a count.
const COUNTED: usize = 1000;
/// Names, without letter case and separators, of what numbers points, names their kind, or lays images over them.
const NO_SCALARS: [&str; 27] = [
    "id",
    "ids",
    "index",
    "indices",
    "pointid",
    "pointids",
    "pointindex",
    "pointnumber",
    "particleid",
    "globalids",
    "vtkoriginalpointids",
    "vtkghosttype",
    "row",
    "column",
    "rowindex",
    "columnindex",
    "label",
    "class",
    "classification",
    "flags",
    "alpha",
    "opacity",
    "textureu",
    "texturev",
    "returnnumber",
    "numberofreturns",
    "userdata",
];
/// Names of places in a texture, where both are there.
const PLACES: [[&str; 2]; 2] = [["u", "v"], ["s", "t"]];
/// What the names of a vector's parts end in.
const PARTS: [[&str; 3]; 4] =
    [["_0", "_1", "_2"], [":0", ":1", ":2"], ["x", "y", "z"], ["X", "Y", "Z"]];

/// The place of the first attribute that is a scalar with several values.
pub(super) fn first_scalar(set: &PointSet) -> Option<usize> {
    let names: Vec<&str> = set.attributes.iter().map(|attribute| attribute.name.as_str()).collect();
    (0..names.len()).find(|&place| {
        let values = &set.attributes[place].values;
        is_scalar(names[place], &names) && varies(values) && !counts(values)
    })
}

fn is_scalar(name: &str, all: &[&str]) -> bool {
    let is_sign = |sign: &char| sign.is_alphanumeric();
    let plain: String = name.chars().filter(is_sign).flat_map(char::to_lowercase).collect();
    let has = |name: &str| all.iter().any(|other| other.eq_ignore_ascii_case(name));
    let is_part = PARTS.iter().any(|parts| {
        let own = parts.iter().find_map(|part| name.strip_suffix(part));
        own.is_some_and(|vector| parts[..2].iter().all(|part| has(&format!("{vector}{part}"))))
    });
    let is_place =
        PLACES.iter().any(|pair| pair.contains(&plain.as_str()) && pair.iter().all(|p| has(p)));
    !NO_SCALARS.contains(&plain.as_str()) && !is_part && !is_place
}

/// Whether there are two values.
fn varies(values: &Values) -> bool {
    let mut finite = values.iter().filter(|value| value.is_finite());
    let first = finite.next();
    finite.any(|value| Some(value) != first)
}

/// Whether each value is one more than that before, as the numbers of points are.
fn counts(values: &Values) -> bool {
    let some: Vec<f64> = values.iter().take(COUNTED).collect();
    some.len() > 2 && some.windows(2).all(|pair| pair[1] - pair[0] == 1.0)
}

/// The values below which these parts of `count` numbers lie; `None` where none is finite.
pub(super) fn part_of<const N: usize>(
    values: impl Iterator<Item = f64>,
    count: usize,
    parts: [f64; N],
) -> Option<[f64; N]> {
    let step = count.div_ceil(SAMPLE).max(1);
    let mut some: Vec<f64> = values.step_by(step).filter(|value| value.is_finite()).collect();
    let last = some.len().checked_sub(1)?;
    let mut value = |part: f64| {
        let place = (part * last as f64).round() as usize;
        *some.select_nth_unstable_by(place, f64::total_cmp).1
    };
    Some(parts.map(&mut value))
}

#[cfg(test)]
mod tests {
    use super::*;
    use points::Attribute;

    fn first(attributes: &[(&str, &[f64])]) -> Option<usize> {
        let attribute = |(name, values): &(&str, &[f64])| Attribute {
            name: (*name).to_owned(),
            values: Values::F64(values.to_vec()),
        };
        let attributes = attributes.iter().map(attribute).collect();
        first_scalar(&PointSet { attributes, ..PointSet::default() })
    }

    #[test]
    fn numbers_of_points_parts_of_vectors_and_constants_are_passed_over() {
        let varied: &[f64] = &[3.0, 1.0, 2.0, 2.0];
        for name in ["id", "Point_ID", "classification", "vtkOriginalPointIds", "alpha"] {
            assert_eq!(first(&[(name, varied), ("density", varied)]), Some(1), "{name}");
        }
        let vector = [("v_0", varied), ("v_1", varied), ("v_2", varied), ("p", varied)];
        assert_eq!(first(&vector), Some(3));
        let vector = [("vx", varied), ("vy", varied), ("vz", varied), ("p", varied)];
        assert_eq!(first(&vector), Some(3));
        assert_eq!(first(&[("u", varied), ("v", varied), ("p", varied)]), Some(2));
        // Of particles, u is their energy.
        assert_eq!(first(&[("u", varied), ("h", varied)]), Some(0));
        assert_eq!(
            first(&[("m", &[2.0; 4]), ("n", &[4.0, 5.0, 6.0, 7.0]), ("p", varied)]),
            Some(2)
        );
        assert_eq!(first(&[("m", &[f64::NAN; 4]), ("n", &[2.0; 4])]), None);
        assert_eq!(first(&[]), None);
    }

    #[test]
    fn parts_of_a_range_leave_the_ends_out() {
        let values = (0..=100).map(f64::from).chain([f64::NAN, f64::INFINITY]);
        assert_eq!(part_of(values, 103, [0.02, 0.98]), Some([2.0, 98.0]));
        assert_eq!(part_of([f64::NAN].into_iter(), 1, [0.0, 1.0]), None);
    }
}
