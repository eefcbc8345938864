//! Tests of rows that become points.

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
    let wanted = Wanted::Some { colors: false, normals: true, attributes: vec!["b".to_owned()] };
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
    let rows: Vec<[f64; 5]> =
        (0..12).map(|i| [f64::from(i), 0.0, -0.0, f64::from(i % 3), f64::from(10 * i)]).collect();
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
    let voxel = Some(Voxel::Edge(4.0));
    assert_eq!(kept(Filter { voxel, ..all() }), [0, 4, 8]);
    assert_eq!(kept(Filter { voxel, classes, ..all() }), [2, 5, 8]);
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
