//! Tables as certain programs write them: preambles, names in comments, several tables in a file;
//! and text that is none.

use crate::assign::{Column, Columns};
use crate::error::PointsError;
use crate::options::ReadOptions;
use crate::read::read_bytes;
use crate::set::{PointSet, Values};
use std::path::Path;

fn read_as(text: &str, columns: Columns) -> Result<PointSet, PointsError> {
    let options = ReadOptions { columns, ..ReadOptions::default() };
    read_bytes(text.as_bytes(), Path::new("a.txt"), &options)
}

fn read(text: &str) -> PointSet {
    read_as(text, Columns::default()).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn names(set: &PointSet) -> Vec<&str> {
    set.attributes.iter().map(|attribute| attribute.name.as_str()).collect()
}

fn said(text: &str, list: &str) -> Result<PointSet, String> {
    read_as(text, Columns::in_order(list).unwrap()).map_err(|error| error.to_string())
}

/// Numbered points `1 2 3`, `4 5 6`, … with something before and after, one a line.
fn rows(count: usize, line: impl Fn(usize, [f64; 3]) -> String) -> String {
    let point = |i: usize| [0.0, 1.0, 2.0].map(|step| ((3 * i) as f64 + step) * 1.5);
    (0..count).map(|i| line(i, point(i)) + "\n").collect()
}

/// The model of COLMAP: a list of images of any length ends each line.
#[test]
fn comments_name_columns_before_a_list_of_any_length() {
    let comments = "# 3D point list with one line of data per point:\n\
        #   POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as (IMAGE_ID, POINT2D_IDX)\n\
        # Number of points: 2, mean track length: 2.33\n";
    for tracks in [["16 6542 15 7345", "16 6519 15 7322 14 7212"], ["1 2", "3 4"], ["", "1 2"]] {
        let rows = ["63390 1.5 2 -3 115 121 122 1.25 ", "7 2 0 -1 102 209 250 1.75 "];
        let text = format!("{comments}{}{}\n{}{}\n", rows[0], tracks[0], rows[1], tracks[1]);
        let set = read(&text);
        assert_eq!(set.positions, [[1.5, 2.0, -3.0], [2.0, 0.0, -1.0]], "{tracks:?}");
        assert_eq!(names(&set), ["POINT3D_ID", "ERROR"]);
        assert!(set.colors.is_some());
        assert_eq!(
            (set.format.as_str(), set.notes.len()),
            ("text, separated by blanks, names in line 2", 0)
        );
    }
    let short = format!("{comments}1 2 3 4 5\n");
    let error = read_as(&short, Columns::default()).unwrap_err().to_string();
    assert!(error.contains("a.txt:4: found 5 values, expected 8 values as in line 2"), "{error}");
}

/// A list of names in a comment counts, whatever separates it.
#[test]
fn comments_name_columns() {
    let row = |i: usize, [x, y, z]: [f64; 3]| format!("{i} 7.5 {x} {y} {z} 9");
    for comment in [
        "# LFID SHOTNUMBER LONGITUDE_CENTROID LATITUDE_CENTROID ELEVATION_CENTROID RH10",
        "# LFID TIME GLON GLAT ZG RH10",
        "// Columns: id, time, Easting, Northing, Elevation, q",
        "#id;t;X;Y;Z;q",
        "% number\ttime\tutm_x\tutm_y\tutm_z\tq",
    ] {
        let text = comment.to_owned() + "\n# made by hand\n" + &rows(9, row);
        let set = read(&text);
        let expected_columns = comment.matches(' ').count() + comment.matches([';', '\t']).count();
        assert!(expected_columns >= 4, "{comment}");
        assert_eq!(set.positions[2], [9.0, 10.5, 12.0], "{comment}");
        assert_eq!(set.notes.len(), 0, "{comment}: {:?}", set.notes);
    }
    // Fewer names than columns.
    let set = read(&("# id t x y z\n".to_owned() + &rows(9, row)));
    assert_eq!(set.positions[1], [4.5, 6.0, 7.5]);
    assert_eq!(names(&set), ["id", "t", "column_6"]);
    assert_eq!(set.notes, ["line 1 names 5 of the 6 columns"]);
}

#[test]
fn extended_xyz_files_state_their_columns() {
    let text = "2\nLattice=\"5 0 0 0 5 0 0 0 5\" Properties=id:I:1:species:S:1:pos:R:3:forces:R:3:free:L:1 \
                energy=-1.5\n4 H 1 2 3 0.5 0.25 0 T\n5 8 4 5 6 0 0 1 F\n";
    let set = read(text);
    assert_eq!(set.positions, [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
    assert_eq!(names(&set), ["id", "forces_0", "forces_1", "forces_2"]);
    assert_eq!(set.attribute("forces_1"), Some(&Values::F64(vec![0.25, 0.0])));
    assert!(set.notes.is_empty());
    // The usual columns, and further frames.
    let frame = "1\nLattice=\"5 0 0 0 5 0 0 0 5\"\nO 1 2 3\n";
    let set = read(&frame.repeat(3));
    assert_eq!(set.positions, [[1.0, 2.0, 3.0]]);
    assert_eq!(set.notes, ["only the first of several frames was read"]);
    let set = read(&"2\nframe, at 300 K\nO 1 2 3\nH 4 5 6\n".repeat(2));
    assert_eq!((set.len(), set.notes.len()), (2, 1));
}

/// Ansys CFD-Post: names of planes above, faces below.
#[test]
fn sections_called_data_are_read() {
    let block = |name: &str, faces: &str| {
        let rows = rows(9, |i, [x, y, z]| format!("{x:e}, {y:e}, {z:e}, {i}.5"));
        format!(
            "\n[Name]\n{name}\n\n[Data]\nX [ m ], Y [ m ], Z [ m ], Pressure [ Pa ]\n{rows}\n{faces}"
        )
    };
    let set = read(&block("Plane 1", ""));
    assert_eq!((set.len(), set.positions[2]), (9, [9.0, 10.5, 12.0]));
    assert_eq!(names(&set), ["Pressure [ Pa ]"]);
    assert_eq!(set.notes, ["the lines up to 5 are not part of the table, and passed over"]);
    let set = read(&(block("Plane 1", "[Faces]\n0, 1, 2\n1, 2, 3\n") + &block("Plane 2", "")));
    assert_eq!((set.len(), set.positions[11]), (18, [9.0, 10.5, 12.0]));
    assert_eq!(set.notes[1], "passed over: Faces");
}

#[test]
fn zones_of_tecplot_are_read() {
    let rows = rows(4, |_, [x, y, z]| format!("{x} {y} {z} 7"));
    for (variables, zone, cells) in [
        ("VARIABLES = \"X\" \"Y\" \"Z\" \"T\"", "ZONE T=\"a\", I=4, F=POINT", ""),
        ("Variables=X, Y, Z, T", "zone i=4, DATAPACKING=POINT\n STRANDID=0, SOLUTIONTIME=0", ""),
        (
            "VARIABLES = \"X\"\n\"Y\"\n\"Z\"\n\"T\"",
            "ZONE N=4, E=2, F=FEPOINT, ET=TRIANGLE",
            "1 2 3\n2 3 4\n",
        ),
    ] {
        let one = format!("{zone}\n{rows}{cells}");
        let set = read(&format!("TITLE = \"a b\"\n{variables}\n{one}{one}"));
        assert_eq!(set.len(), 8, "{variables}");
        assert_eq!(set.positions[5], [4.5, 6.0, 7.5]);
        assert_eq!(names(&set), ["T"]);
    }
    let text = "VARIABLES = X Y Z\nZONE I=4, DATAPACKING=BLOCK\n1 2 3 4\n1 2 3 4\n1 2 3 4\n";
    let error = read_as(text, Columns::default()).unwrap_err().to_string();
    assert!(
        error.starts_with(
            "a.txt:2: found a zone that stores one variable after the other, expected"
        ),
        "{error}"
    );
}

#[test]
fn preambles_are_passed_over_and_said_to_be() {
    let named = rows(9, |_, [x, y, z]| format!("{x},{y},{z}"));
    for above in [
        "Job: quarry\nDate, 2024, 5, 17\nOperator: N. N.\n\nX,Y,Z\n",
        "Leica report\nStation,1,2,3,4\nEasting [m],Northing [m],Height [m]\n",
        "key: value\nother: 12 and 13\nx,y,z\n",
    ] {
        let set = read(&(above.to_owned() + &named));
        assert_eq!((set.len(), set.positions[8]), (9, [36.0, 37.5, 39.0]), "{above}");
        assert!(set.notes[0].contains("not part of the table, and passed over"), "{:?}", set.notes);
    }
    let nameless = rows(20, |_, [x, y, z]| format!("{x} {y} {z}"));
    let set = read(&("Survey of the quarry\nby N. N.\n----\n".to_owned() + &nameless));
    assert_eq!(set.len(), 20);
    assert_eq!(set.notes, ["the lines up to 3 are not part of the table, and passed over"]);
    // What spreadsheets write to say what separates.
    let set = read(&("sep=,\n".to_owned() + "x,y,z\n" + &named));
    assert_eq!((set.len(), set.notes.len()), (9, 0));
    // R names the rows, and not the column of their names.
    let set = read("\"x\" \"y\" \"z\"\n\"1\" 7 8 9\n\"2\" 4 5 6\n");
    assert_eq!(set.positions, [[7.0, 8.0, 9.0], [4.0, 5.0, 6.0]]);
    assert!(set.notes[0].contains("all columns but the first"));
}

#[test]
fn text_that_is_no_table_is_refused() {
    let numbers = "viewport=0,0,640,480\nclip=1,2,3,4\n";
    let log = rows(30, |i, [x, y, z]| format!("step {i} loss {x} rate {y} norm {z}"));
    let short = "Intrinsics\n525 0 319\n0 525 239\n0 0 1\n";
    for text in [
        numbers,
        "[window]\nname = a\nsize = 1, 2, 3, 4\n",
        "size: 640, 480, 3\n",
        "shape (640, 480, 3, 1)\n",
        "viewport 0, 0, 640, 480\n",
        &log,
        "2024-01-02 10:00:00 INFO 1 2 3\n2024-01-02 10:00:01 INFO 4 5 6\n",
        short,
        "{\"points\": [[1, 2, 3], [4, 5, 6], [7, 8, 9]]}\n",
        "[[1, 2, 3],\n [4, 5, 6],\n [7, 8, 9]]\n",
        "points:\n  - [1, 2, 3]\n  - [4, 5, 6]\n",
        "int a[] = {\n 1, 2, 3, 4,\n 5, 6, 7, 8,\n};\n",
        "In 1999, 3, 4 and 5 of 12, 13, 14 were found.\nThe 2, 3, 4 others were not.\n",
        "[camera]\neye = [1.0, 2.0, 3.0]\n[[lights]]\ndirection = [1.0, 2.0, 3.0]\n",
        "date,open,high,low\n1,2,3,4\n2,3,4,5\n",
        "1 SIMPLE_RADIAL 3072 2304 2559.81 1536 1152 -0.02\n2 PINHOLE 3 4 5 6 7 8\n",
    ] {
        let error = read_as(text, Columns::default());
        let error = error.map(|set| format!("{:?} {:?}", set.positions, set.notes)).unwrap_err();
        assert!(error.to_string().contains("expected"), "{error}");
    }
    let error = read_as(numbers, Columns::default()).unwrap_err().to_string();
    assert_eq!(
        error,
        "a.txt:1: found 'viewport=0,0,640,480', expected 3 numbers or more: x y z; correct the line \
         or export the file again"
    );
}

#[test]
fn columns_are_what_the_user_says() {
    let text = "1,10,20,30,TREE,255,0,7\n2,11,21,31,x y,0,1,8\n3,12,22,35,,9,9,9\n";
    let set = said(text, "_,y,x,z,_,red,green,blue").unwrap();
    assert_eq!(set.positions[0], [20.0, 10.0, 30.0]);
    assert!(set.attributes.is_empty() && set.colors.is_some() && set.notes.is_empty());
    assert_eq!(set.format, "text, separated by commas, columns as asked for: y x z red green blue");
    // What comes after the list keeps what it is.
    let set = said("1 2 3 4 5 6 7\n", "x,y,z,temp").unwrap();
    assert_eq!(names(&set), ["temp", "column_5", "column_6", "column_7"]);
    let set = said("a b c temp\n1 2 3 4\n", "z,y,x").unwrap();
    assert_eq!((set.positions[0], names(&set)), ([3.0, 2.0, 1.0], vec!["temp"]));
    let set = said("1 2 3 9 8 7\n", "x,y,z,r,g,b").unwrap();
    assert!(set.colors.is_some());

    let named = |named: &[(&str, Column)]| Columns {
        named: named.iter().map(|(name, column)| ((*name).to_owned(), column.clone())).collect(),
        left_out: vec![],
    };
    let name = |name: &str| Column::Name(name.to_owned());
    let columns = named(&[("x", name("E")), ("y", name("N")), ("z", Column::Number(1))]);
    let set = read_as("q E N z\n1 2 3 4\n", columns).unwrap();
    assert_eq!((set.positions[0], names(&set)), ([2.0, 3.0, 1.0], vec!["column_4"]));
    // Without names, the position is where it would be.
    let only = named(&[
        ("red", Column::Number(6)),
        ("green", Column::Number(5)),
        ("blue", Column::Number(4)),
    ]);
    let set = read_as("1 2 3 9 8 7 6\n", only).unwrap();
    assert_eq!((set.positions[0], names(&set)), ([1.0, 2.0, 3.0], vec!["column_7"]));

    let wrong =
        |text: &str, columns: &Columns| read_as(text, columns.clone()).unwrap_err().to_string();
    for (text, columns, expected) in [
        (
            "1 2 3 4\n",
            named(&[("x", Column::Number(2))]),
            "a.txt: found only x as the columns of the position, expected x, y and z",
        ),
        (
            "1 2 3 4\n",
            named(&[("red", Column::Number(9))]),
            "a.txt: found 9 as the column of 'red', expected a number from 1 to 4",
        ),
        (
            "x y z q\n1 2 3 4\n",
            named(&[("temp", name("t"))]),
            "a.txt: found 't' as the column of 'temp', expected one of 'x', 'y', 'z', 'q'",
        ),
        (
            "1 2 3 4\n",
            named(&[("red", Column::Number(2))]),
            "as the column of both 'y' and 'red', expected a column for each",
        ),
        (
            "x,y,z,q\n1,2,3,a\n",
            named(&[("red", name("q"))]),
            "a.txt: found text in column 4 as the column of 'red', expected numbers",
        ),
        (
            "1 2\n",
            Columns::in_order("x,y,z").unwrap(),
            "found 3 as the column of 'z', expected a number from 1 to 2",
        ),
    ] {
        let found = wrong(text, &columns);
        assert!(found.contains(expected), "{found}");
    }
}

/// As COMSOL writes them: names with units, and names with blanks in them between wide gaps.
#[test]
fn comments_name_columns_with_units() {
    let row = |_, [x, y, z]: [f64; 3]| format!("{x} {y} {z} 293.15 7");
    for comment in [
        "% x                       y                      z                 T (K)   p [Pa]",
        "% X                       Y                      Z          comp1.T (K) @ t=0   p (Pa) @ t=1",
        "% x y z T (K) p (Pa)",
    ] {
        let set = read(&format!("% Dimension: 3\n{comment}\n{}", rows(3, row)));
        assert_eq!(set.positions[1], [4.5, 6.0, 7.5], "{comment}");
        assert!(names(&set)[0].contains("T (K)"), "{comment}: {:?}", names(&set));
        assert_eq!((names(&set).len(), set.notes.len()), (2, 0), "{comment}");
    }
}

/// Columns of text count in the places that messages name and that `--columns` takes.
#[test]
fn points_may_have_names() {
    let row = |i, [x, y, z]: [f64; 3]| {
        format!("CP{i},{},{},{z},ROAD,{}", 4.6e6 + y, 5e5 + x, 0.5 * i as f64 * z)
    };
    let text = rows(20, row);
    let set = read(&text);
    assert_eq!(set.positions[1], [500_004.5, 4_600_006.0, 7.5]);
    assert_eq!(names(&set), ["intensity"]);
    assert!(
        set.notes[0].contains("column 2 is like a northing and column 3 like an easting"),
        "{:?}",
        set.notes
    );
    assert_eq!(said(&text, "_,x,y,z").unwrap().positions[1], [4_600_006.0, 500_004.5, 7.5]);
}

/// Units in a line of their own, below the names.
#[test]
fn units_may_stand_below_names() {
    let row = |_, [x, y, z]: [f64; 3]| format!("{x},{y},{z},293.15");
    let set = read(&format!("X,Y,Z,T\nm,m,m,K\n{}", rows(3, row)));
    assert_eq!((set.positions[1], names(&set)), ([4.5, 6.0, 7.5], vec!["T"]));
    assert_eq!(set.notes, ["line 2 is not part of the table, and passed over"]);
}

/// Whoever names only a label does not mean to lose the colour.
#[test]
fn colours_without_names_are_noted() {
    let row = |i: usize, [x, y, z]: [f64; 3]| {
        format!("{x} {y} {z} {} {} {} {}", i * 37 % 256, i * 53 % 256, i * 71 % 256, i % 3)
    };
    let text = rows(40, row);
    let set = said(&text, "x,y,z,_,_,_,classification").unwrap();
    assert_eq!((names(&set), set.notes.len()), (vec!["classification"], 0));
    assert_eq!(said(&text, "x,y,z,red,green,blue").unwrap().notes, [""; 0]);
    let number = |name: &str, place| (name.to_owned(), Column::Number(place));
    let label = Columns { named: vec![number("classification", 7)], left_out: vec![] };
    let set = read_as(&text, label).unwrap();
    assert!(set.colors.is_none());
    assert!(
        set.notes[0]
            .starts_with("column_4, column_5, column_6 are like a colour, but have no names"),
        "{:?}",
        set.notes
    );
}
