//! Tables without names, of many programs.

use super::*;

fn guess(rows: &[Vec<f64>], floats: bool) -> Guess {
    let columns = rows[0].len();
    let values = rows.iter().flatten().copied().collect();
    by_place(&Sample { columns, values, floats: vec![floats; columns] }, None, None)
}

fn placed(row: &[f64], floats: bool) -> String {
    meaning::listed(&guess(&[row.to_vec()], floats).fields)
}

/// 500 points of a curve, each with what `rest` makes of its number.
fn table(rest: impl Fn(usize) -> Vec<f64>) -> Vec<Vec<f64>> {
    let row = |i: usize| {
        let t = i as f64 / 100.0;
        [vec![t.sin(), t.cos(), 0.01 * t], rest(i)].concat()
    };
    (0..500).map(row).collect()
}

fn taken(rest: impl Fn(usize) -> Vec<f64>) -> (String, Option<String>) {
    let guess = guess(&table(rest), false);
    (meaning::listed(&guess.fields), guess.note)
}

/// A number from 0 to 255 that does not go with others of another seed.
fn noise(i: usize, seed: usize) -> f64 {
    let mixed = (i * 2_654_435_761 + seed * 40_503).wrapping_mul(2_246_822_519) >> 13;
    (mixed % 256) as f64
}

#[test]
fn single_rows_are_taken_by_what_stands_in_them() {
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
        (&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 0.0, 1.0, 0.0], false, "x y z red green blue nx ny nz"),
        (
            &[1.0, 2.0, 3.0, 0.5, 0.0, 1.0, 0.0, 4.0, 5.0, 6.0],
            false,
            "x y z intensity nx ny nz red green blue",
        ),
    ] {
        assert_eq!(placed(row, floats), expected, "{row:?}");
    }
}

#[test]
fn labels_and_opacities_are_no_channels() {
    let vivid = |i| vec![noise(i, 1), noise(i, 2), noise(i, 3)];
    let red = |_| vec![200.0, 40.0, 20.0];
    let label = |i: usize| vec![(i % 13) as f64];
    for (rest, expected) in [
        (&(|i| [red(i), label(i)].concat()) as &dyn Fn(usize) -> Vec<f64>, "red green blue label"),
        (&|i| [red(i), vec![255.0]].concat(), "red green blue alpha"),
        (&|i| [red(i), label(i), vec![-100.0]].concat(), "red green blue label column_8"),
        (&|i| [vivid(i), label(i)].concat(), "red green blue label"),
        (&|i| [vivid(i), vec![255.0]].concat(), "red green blue alpha"),
        (&|i| [vivid(i), vec![255.0], label(i)].concat(), "red green blue alpha label"),
        (&|i| [vivid(i), label(i), vec![noise(i, 9)]].concat(), "red green blue label column_8"),
        (&|i| [vec![noise(i, 4)], vivid(i), label(i)].concat(), "intensity red green blue label"),
        (&|i| [vec![-9.5], vivid(i), label(i)].concat(), "intensity red green blue label"),
        (&|i| [vivid(i), vec![0.5], label(i)].concat(), "red green blue intensity label"),
        (&|i| [vec![0.0], vivid(i)].concat(), "intensity red green blue"),
        (&|i| [vec![0.5], label(i)].concat(), "intensity label"),
        (&|i| label(i), "label"),
        (&|i| vec![noise(i, 1)], "intensity"),
        (&|i| [vivid(i), vec![0.6, 0.0, 0.8], label(i)].concat(), "red green blue nx ny nz label"),
        (&|i| [vec![0.6, 0.0, 0.8], vivid(i)].concat(), "nx ny nz red green blue"),
        (
            &|i| [vec![0.5, 7.5, 3.0, 1.5], vivid(i)].concat(),
            "column_4 column_5 column_6 column_7 red green blue",
        ),
    ] {
        let (found, note) = taken(rest);
        assert_eq!(found, format!("x y z {expected}"), "{note:?}");
        assert!(note.is_some(), "{found}");
    }
}

/// Return numbers, classes and the like have the range of colours, but few values.
#[test]
fn few_different_values_are_no_colour() {
    let (found, note) = taken(|i| vec![noise(i, 1), (i % 3) as f64, (i % 2) as f64]);
    assert_eq!(found, "x y z column_4 column_5 label");
    assert!(note.unwrap().contains("columns 4 to 6 are from 0 to 255, but one has fewer than 4"));
    assert_eq!(taken(|_| vec![1.0, 1.0, 2.0]).0, "x y z column_4 column_5 label");
    assert_eq!(taken(|_| vec![0.0, 0.0, 0.0]).0, "x y z column_4 column_5 label");
    // Two colours are few values, too, but bright ones.
    let (found, note) = taken(|i| [[255.0, 0.0, 0.0], [255.0; 3]][i % 2].to_vec());
    assert_eq!(found, "x y z red green blue");
    assert!(note.unwrap().contains("columns 4 to 6 have few different values for a colour"));
    // Greys are as good as any colour.
    let (found, note) = taken(|i| vec![noise(i, 1); 3]);
    assert_eq!((found.as_str(), note), ("x y z red green blue", None));
}

#[test]
fn plain_tables_are_taken_without_a_word() {
    assert_eq!(taken(|_| vec![]), ("x y z".to_owned(), None));
    let vivid = |i| vec![noise(i, 1), noise(i, 2), noise(i, 3)];
    assert_eq!(taken(vivid), ("x y z red green blue".to_owned(), None));
    let normal = |i: usize| vec![(i as f64).sin(), (i as f64).cos(), 0.0];
    assert_eq!(taken(normal), ("x y z nx ny nz".to_owned(), None));
}

/// Of an intensity and a colour of the same range, the channels that go together are the colour.
#[test]
fn intensities_before_and_after_a_colour_are_told_by_correlation() {
    let shade = |i: usize| noise(i, 1) / 2.0;
    let colour =
        |i| vec![(shade(i) + 90.0).floor(), (shade(i) + 60.0).floor(), (shade(i) * 1.5).floor()];
    let (found, note) = taken(|i| [colour(i), vec![noise(i, 5)]].concat());
    assert_eq!(found, "x y z red green blue intensity");
    assert!(!note.unwrap().contains("could be"));
    assert_eq!(
        taken(|i| [vec![noise(i, 5)], colour(i)].concat()).0,
        "x y z intensity red green blue"
    );
    // Where nothing goes together, the usual order is taken, and the other one named.
    let (found, note) = taken(|i| (0..4).map(|seed| noise(i, seed)).collect());
    assert_eq!(found, "x y z intensity red green blue");
    assert!(note.unwrap().contains("columns 4 to 6 could be the colour, too"));
}

#[test]
fn points_numbers_are_no_coordinates() {
    let survey = |first: fn(usize) -> f64, n: f64, e: f64| -> Vec<Vec<f64>> {
        let row = |i: usize| vec![first(i), n + noise(i, 1), e + noise(i, 2), 110.5];
        (0..20).map(row).collect()
    };
    let listed = |rows: &[Vec<f64>]| {
        let guess = guess(rows, false);
        (meaning::listed(&guess.fields), guess.note.unwrap())
    };
    let (found, note) = listed(&survey(|i| i as f64 + 1.0, 4_600_000.0, 500_000.0));
    assert_eq!(found, "point_number y x z");
    assert_eq!(
        note,
        "the columns have no names and were taken for point_number y x z, judging by 20 rows (column \
         1 counts up by one; column 2 is like a northing and column 3 like an easting); --columns or \
         [objects.columns] says otherwise"
    );
    let (found, note) = listed(&survey(|i| i as f64, 2_600_000.0, 1_200_000.0));
    assert_eq!(found, "point_number x y z");
    assert!(note.contains("if the northing comes before the easting, x and y are exchanged"));
    assert_eq!(listed(&survey(|i| i as f64 * 2.0, 10.0, 20.0)).0, "x y z intensity");
    // Some points were deleted, and their numbers with them.
    let gaps = |i: usize| (i * 3 + i % 2) as f64;
    let row = |i: usize| vec![gaps(i), 7.5 + noise(i, 1), 0.25 + noise(i, 2), 0.5];
    let (found, note) = listed(&(0..20).map(row).collect::<Vec<_>>());
    assert_eq!(found, "point_number x y z");
    assert!(note.contains("(column 1 rises by whole numbers)"), "{note}");
    // What does not rise, or rises where the others are whole numbers too, is a coordinate.
    let row = |i: usize| vec![noise(i, 3), 7.5 + noise(i, 1), 0.25 + noise(i, 2), 0.5];
    let (found, note) = listed(&(0..20).map(row).collect::<Vec<_>>());
    assert_eq!(found, "x y z intensity");
    assert!(note.contains("(column 1 has only whole numbers)"), "{note}");
    let row = |i: usize| vec![i as f64 * 2.0, 7.5 + noise(i, 1), 0.25 + noise(i, 2), 9.0];
    assert_eq!(listed(&(0..20).map(row).collect::<Vec<_>>()).0, "x y z label");
    // The masses of a simulation's particles.
    let row = |i: usize| vec![0.001, 7.5 + noise(i, 1), 0.25 + noise(i, 2), noise(i, 3), 0.5];
    let (found, note) = listed(&(0..20).map(row).collect::<Vec<_>>());
    assert_eq!(found, "x y z column_4 column_5");
    assert!(note.contains("(column 1 is the same throughout)"), "{note}");
    // The first row of a lattice counts up, too.
    let lattice: Vec<Vec<f64>> = (0..20).map(|i| vec![f64::from(i), 0.0, 0.5, 7.0]).collect();
    assert_eq!(listed(&lattice).0, "x y z label");
}

#[test]
fn colours_up_to_255_may_have_fractions() {
    let half = |i: usize, seed: usize| noise(i, seed) / 2.0;
    for (name, color) in [
        (
            "spread over the range",
            Box::new(|i| vec![half(i, 1), half(i, 2), half(i, 3)])
                as Box<dyn Fn(usize) -> Vec<f64>>,
        ),
        (
            "alike",
            Box::new(|i| {
                vec![half(i, 1) / 3.0 + 100.5, half(i, 1) / 3.0 + 120.25, half(i, 1) / 4.0 + 90.0]
            }),
        ),
        ("uniform", Box::new(|_| vec![127.5, 63.75, 0.0])),
    ] {
        let guess = guess(&table(&*color), true);
        assert_eq!(meaning::listed(&guess.fields), "x y z red green blue", "{name}");
        assert_eq!(guess.fields[3].kind, Type::F32, "{name}");
        assert!(guess.note.unwrap().contains("the colour in columns 4 to 6"), "{name}");
    }
    // A number with fractions before or after a colour of whole ones.
    let bytes = |i| vec![noise(i, 1), noise(i, 2), noise(i, 3)];
    let found = taken(|i| [bytes(i), vec![half(i, 4)]].concat());
    assert_eq!(found.0, "x y z red green blue intensity");
    assert!(!found.1.unwrap().contains("could be the colour"));
    assert_eq!(
        taken(|i| [vec![half(i, 4)], bytes(i)].concat()).0,
        "x y z intensity red green blue"
    );
    // Other measurements: little range, one below 0, one beyond 255.
    let others = |last: fn(f64) -> f64| move |i| vec![half(i, 1), half(i, 2), last(half(i, 3))];
    for last in [|x| x / 10.0, |x| x - 60.0, |x| 3.0 * x] as [fn(f64) -> f64; 3] {
        assert_eq!(taken(others(last)).0, "x y z column_4 column_5 column_6");
    }
}
