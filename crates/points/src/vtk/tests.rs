//! Files made here. Those that VTK itself wrote are in `tests/tables.rs`.

use crate::error::PointsError;
use crate::options::ReadOptions;
use crate::read::read_bytes;
use crate::set::{ColorEncoding, PointSet, Values};
use std::path::Path;

fn try_read(name: &str, file: &[u8]) -> Result<PointSet, PointsError> {
    read_bytes(file, Path::new(name), &ReadOptions::default())
}

fn read(name: &str, file: impl AsRef<[u8]>) -> PointSet {
    try_read(name, file.as_ref()).unwrap_or_else(|error| panic!("{error}"))
}

fn names(set: &PointSet) -> Vec<&str> {
    set.attributes.iter().map(|attribute| attribute.name.as_str()).collect()
}

mod legacy {
    use super::*;

    /// A file: text, and numbers where a type and values are given.
    struct File {
        bytes: Vec<u8>,
        binary: bool,
    }

    impl File {
        fn new(version: &str, binary: bool) -> Self {
            let encoding = if binary { "BINARY" } else { "ASCII" };
            let start = format!("# vtk DataFile Version {version}\na title\n{encoding}\n");
            Self { bytes: start.into_bytes(), binary }
        }

        fn text(mut self, text: &str) -> Self {
            self.bytes.extend(text.as_bytes());
            self
        }

        fn values(mut self, kind: &str, values: &[f64]) -> Self {
            for (i, value) in values.iter().enumerate() {
                match (self.binary, kind) {
                    (false, _) => {
                        let blank = if i % 4 == 3 { "\n" } else { " " };
                        self.bytes.extend(format!("{value}{blank}").as_bytes());
                    }
                    (true, "unsigned_char") => self.bytes.push(*value as u8),
                    (true, "short") => self.bytes.extend((*value as i16).to_be_bytes()),
                    (true, "int" | "vtkIdType") => {
                        self.bytes.extend((*value as i32).to_be_bytes());
                    }
                    (true, "vtktypeint64" | "long") => {
                        self.bytes.extend((*value as i64).to_be_bytes());
                    }
                    (true, "float") => self.bytes.extend((*value as f32).to_be_bytes()),
                    (true, _) => self.bytes.extend(value.to_be_bytes()),
                }
            }
            self.text("\n")
        }
    }

    const XYZ: [f64; 6] = [1.0, 2.0, 3.0, 4.0, 5.0, 6.5];
    const TWO: [[f64; 3]; 2] = [[1.0, 2.0, 3.0], [4.0, 5.0, 6.5]];

    #[test]
    fn points_and_their_data_are_read_in_both_encodings() {
        for binary in [false, true] {
            let file = File::new("3.0", binary)
                .text("DATASET UNSTRUCTURED_GRID\nFIELD FieldData 1\ntime 1 1 double\n")
                .values("double", &[0.25])
                .text("POINTS 2 float\n")
                .values("float", &XYZ)
                .text("CELLS 2 4\n")
                .values("int", &[1.0, 0.0, 1.0, 1.0])
                .text("\nCELL_TYPES 2\n")
                .values("int", &[1.0, 1.0])
                .text("CELL_DATA 2\nSCALARS other float\nLOOKUP_TABLE default\n")
                .values("float", &[9.0, 9.0])
                .text("POINT_DATA 2\nSCALARS density double 1\nLOOKUP_TABLE mine\n")
                .values("double", &[0.1, 0.2])
                .text("LOOKUP_TABLE mine 1\n")
                .values("unsigned_char", &[1.0, 0.0, 0.0, 1.0])
                .text("VECTORS a%20v float\n")
                .values("float", &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0])
                .text("NORMALS n float\n")
                .values("float", &[0.0, 0.0, 1.0, 1.0, 0.0, 0.0])
                .text("SCALARS seen unsigned_char 3\nLOOKUP_TABLE default\n")
                .values("unsigned_char", &[255.0, 0.0, 0.0, 0.0, 0.0, 255.0])
                .text("FIELD FieldData 3\nid 1 2 vtkIdType\n")
                .values("vtkIdType", &[7.0, 8.0])
                .text("METADATA\nINFORMATION 0\n\nshort 2 2 short\n")
                .values("short", &[-1.0, -2.0, -3.0, -4.0])
                .text("not 1 1 float\n")
                .values("float", &[0.0]);
            let set = read("a.vtk", &file.bytes);
            assert_eq!(set.positions, TWO);
            assert_eq!(set.normals, Some(vec![[0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]));
            assert_eq!(set.color_encoding, Some(ColorEncoding::Srgb8));
            assert_eq!(set.colors, Some(vec![[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]));
            let expected = ["density", "a v_0", "a v_1", "a v_2", "id", "short_0", "short_1"];
            assert_eq!(names(&set), expected);
            assert_eq!(set.attribute("density"), Some(&Values::F64(vec![0.1, 0.2])));
            assert_eq!(set.attribute("a v_1"), Some(&Values::F32(vec![1.0, 4.0])));
            assert_eq!(set.attribute("short_1").unwrap().get(1), -4.0);
            let encoding = if binary { "binary" } else { "ascii" };
            assert_eq!(set.format, format!("VTK 3.0, {encoding}, unstructured grid"));
        }
    }

    #[test]
    fn cells_of_version_5_1_are_passed_over() {
        for binary in [false, true] {
            let file = File::new("5.1", binary)
                .text("DATASET POLYDATA\nPOINTS 2 double\n")
                .values("double", &XYZ)
                .text("METADATA\nINFORMATION 2\nNAME a LOCATION b\nDATA 2 0 1\n\n")
                .text("VERTICES 3 2\nOFFSETS vtktypeint64\n")
                .values("vtktypeint64", &[0.0, 1.0, 2.0])
                .text("CONNECTIVITY vtktypeint64\n")
                .values("vtktypeint64", &[0.0, 1.0])
                .text("POINT_DATA 2\nSCALARS a float\nLOOKUP_TABLE default\n")
                .values("float", &[1.0, 2.0]);
            let set = read("a.vtk", &file.bytes);
            assert_eq!(set.positions, TWO);
            assert_eq!(set.attribute("a"), Some(&Values::F32(vec![1.0, 2.0])));
        }
    }

    #[test]
    fn nodes_of_lattices_are_points() {
        for binary in [false, true] {
            let data = |file: File| {
                file.text("POINT_DATA 6\nSCALARS a unsigned_char\nLOOKUP_TABLE default\n")
                    .values("unsigned_char", &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0])
            };
            let file = data(File::new("2.0", binary).text(
                "DATASET STRUCTURED_POINTS\nDIMENSIONS 3 1 2\nORIGIN 10 20 30\nASPECT_RATIO 0.5 1 2\n",
            ));
            let set = read("a.vtk", &file.bytes);
            assert_eq!(set.positions[1], [10.5, 20.0, 30.0]);
            assert_eq!(set.positions[5], [11.0, 20.0, 32.0]);
            assert_eq!(set.attribute("a"), Some(&Values::U8(vec![0, 1, 2, 3, 4, 5])));

            let file = data(
                File::new("2.0", binary)
                    .text("DATASET RECTILINEAR_GRID\nDIMENSIONS 3 1 2\nX_COORDINATES 3 float\n")
                    .values("float", &[1.0, 2.0, 4.0])
                    .text("Y_COORDINATES 1 float\n")
                    .values("float", &[-1.0])
                    .text("Z_COORDINATES 2 double\n")
                    .values("double", &[0.5, 0.75]),
            );
            let set = read("a.vtk", &file.bytes);
            assert_eq!(set.positions[5], [4.0, -1.0, 0.75]);

            let xyz: Vec<f64> = (0..18).map(f64::from).collect();
            let file = data(
                File::new("4.2", binary)
                    .text("DATASET STRUCTURED_GRID\nDIMENSIONS 3 1 2\nPOINTS 6 float\n")
                    .values("float", &xyz),
            );
            let set = read("a.vtk", &file.bytes);
            assert_eq!(set.positions[5], [15.0, 16.0, 17.0]);
        }
    }

    #[test]
    fn colors_bits_and_strings_are_understood() {
        for binary in [false, true] {
            let colors: &[f64] = match binary {
                true => &[255.0, 0.0, 51.0, 255.0, 0.0, 0.0, 0.0, 255.0],
                false => &[1.0, 0.0, 0.2, 1.0, 0.0, 0.0, 0.0, 1.0],
            };
            let file = File::new("3.0", binary)
                .text("DATASET POLYDATA\nPOINTS 2 float\n")
                .values("float", &XYZ)
                .text("POINT_DATA 2\nCOLOR_SCALARS c 4\n")
                .values("unsigned_char", colors)
                .text("FIELD f 2\nname 1 2 string\n")
                .text(if binary { "\u{2}" } else { "ab\n\n" });
            // Lengths of one byte have both upper bits set.
            let mut file = file;
            if binary {
                file.bytes.pop();
                file.bytes.extend(b"\xc2ab\xc0\n");
            }
            let file = file.text("flag 1 2 bit\n");
            let mut file = if binary { file } else { file.text("1 0\n") };
            if binary {
                file.bytes.extend([0b1000_0000, b'\n']);
            }
            let set = read("a.vtk", &file.bytes);
            assert_eq!(names(&set), ["alpha", "flag"]);
            assert_eq!(set.attribute("flag"), Some(&Values::U8(vec![1, 0])));
            let encoded: Vec<f64> =
                set.colors.unwrap()[0].map(|c| ColorEncoding::Srgb8.encode(c)).into();
            assert_eq!(encoded, [255.0, 0.0, 51.0]);
        }
    }

    fn message(text: &str) -> String {
        try_read("a.vtk", text.as_bytes()).unwrap_err().to_string()
    }

    #[test]
    fn what_is_wrong_is_named() {
        let head = "# vtk DataFile Version 3.0\na\nASCII\n";
        for (rest, expected) in [
            ("", "a.vtk: found no DATASET, expected it among the keywords of the file; export"),
            (
                "DATASET OCTREE\n",
                "a.vtk:4: found 'DATASET OCTREE', expected DATASET and one of POLY",
            ),
            ("POINTS 1 float\n0 0 0\n", "a.vtk:4: found 'POINTS 1 float', expected DATASET"),
            ("DATASET POLYDATA\n", "a.vtk: found no POINTS, expected it among the keywords"),
            ("DATASET POLYDATA\nPOINTS\n", "a.vtk:5: found 'POINTS', expected counts of 0 or more"),
            ("DATASET POLYDATA\nPOINTS -1 float\n", "a.vtk:5: found 'POINTS -1 float', expected"),
            (
                "DATASET POLYDATA\nPOINTS 1 complex\n0 0 0\n",
                "a.vtk:5: found 'POINTS 1 complex', \
              expected a type such as float or double; correct the line or export the file again",
            ),
            ("DATASET POLYDATA\nPOINTS 1 string\n0 0 0\n", "a.vtk:5: found 'POINTS 1 string'"),
            (
                "DATASET POLYDATA\nPOINTS 3 float\n0 0 0 1 1 1\n",
                "a.vtk: the header declares 3 points, but the file ends after 2; the file is cut",
            ),
            (
                "DATASET POLYDATA\nPOINTS 3 float\n0 0 0\n1 1 1\nPOINT_DATA 3\n",
                "a.vtk:8: found 'POINT_DATA', expected the 9 values of 'points'",
            ),
            ("DATASET POLYDATA\nPOINTS 18446744073709551615 float\n0 0\n", "found 'POINTS 184467"),
            (
                "DATASET POLYDATA\nPOINTS 6148914691236517205 float\n0 0 0\n",
                "declares 614891469123",
            ),
            (
                "DATASET POLYDATA\nPOINTS 1 float\n0 0 x0\n",
                "a.vtk:6: found 'x0', expected the 3 values of 'points'",
            ),
            (
                "DATASET POLYDATA\nPOINTS 1 float\n0 0 0x\n",
                "a.vtk: found '0x' as the data of 'points', expected what the header says; the",
            ),
            (
                "DATASET POLYDATA\nPOINTS 1 float\n0 0 0\nPOINT_DATA 2\nSCALARS a int\n1 2\n",
                "a.vtk: found 2 as the number of points in POINT_DATA, expected 1, as there are",
            ),
            (
                "DATASET POLYDATA\nPOINTS 1 float\n0 0 0\nPOINT_DATA 1\nSPLINES a int\n1\n",
                "a.vtk:8: found 'SPLINES a int', expected SCALARS, VECTORS, NORMALS, FIELD or",
            ),
            (
                "DATASET POLYDATA\nPOINTS 1 float\n0 0 0\n1 2 3\n",
                "a.vtk:7: found '1 2 3', expected POINTS, DIMENSIONS, CELLS, POINT_DATA or",
            ),
            (
                "DATASET STRUCTURED_POINTS\nDIMENSIONS 1000 1000 1000\n",
                "a.vtk: found 1000 1000 1000 as the dimensions of the lattice, expected at most \
                 1000000 nodes: data is there for no more; export the lattice with data for",
            ),
            ("DATASET STRUCTURED_POINTS\nDIMENSIONS 1 2\n", "expected three numbers behind the"),
            ("DATASET STRUCTURED_POINTS\n", "found no DIMENSIONS"),
            ("DATASET RECTILINEAR_GRID\nX_COORDINATES 1 float\n0\n", "found no X_, Y_ or Z_COORD"),
            (
                "DATASET STRUCTURED_GRID\nDIMENSIONS 2 1 1\nPOINTS 1 float\n0 0 0\n",
                "found 2 as the number of points in DIMENSIONS, expected 1",
            ),
            ("DATASET POLYDATA\nPOINTS 0 float\n", "the file holds no points"),
            ("DATASET POLYDATA\nPOINTS 1 float\nnan 0 0\n", "no usable point: 1 in the file, 1 of"),
            ("DATASET POLYDATA\nFIELD f 9\n", "a.vtk:6: found the end of the file, expected an"),
            (
                "DATASET POLYDATA\nFIELD f 1\na 1\n",
                "a.vtk:6: found 'a 1', expected an array's name",
            ),
        ] {
            let found = message(&(head.to_owned() + rest));
            assert!(found.contains(expected), "{rest:?}: {found}");
        }
        assert!(message("# vtk DataFile Version 3.0\na\nTEXT\n").contains(
            "a.vtk:3: found 'TEXT', expected ASCII or BINARY; correct the line or export the file"
        ));
        assert!(message("# vtk").contains("a.vtk:2: found the end of the file, expected ASCII or"));
        let long = message(&(head.to_owned() + &"A".repeat(70_000)));
        assert!(long.contains("a.vtk:4: found 'AAA") && long.contains("expected a shorter line"));
        let binary = File::new("3.0", true)
            .text("DATASET POLYDATA\nPOINTS 2 float\n")
            .values("float", &XYZ)
            .text("WHAT 1\n");
        let found = try_read("a.vtk", &binary.bytes).unwrap_err().to_string();
        assert!(found.contains("found 'WHAT 1' as the line that ends at byte 106"), "{found}");
        let found = try_read("a.vtk", &binary.bytes[..90]).unwrap_err().to_string();
        assert!(found.contains("declares 2 points needing 24 bytes, but the file ends after 1 in"));
    }
}

mod xml {
    use super::*;

    const HEAD: &str = "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\">";

    fn file(pieces: &str) -> String {
        format!("<?xml version=\"1.0\"?>\n{HEAD}\n<PolyData>{pieces}</PolyData>\n</VTKFile>\n")
    }

    fn piece(points: &str, xyz: &str, data: &str) -> String {
        format!(
            "<Piece NumberOfPoints=\"{points}\"><Points><DataArray type=\"Float32\" \
             NumberOfComponents=\"3\" format=\"ascii\">{xyz}</DataArray></Points>{data}</Piece>"
        )
    }

    fn message(file: impl AsRef<[u8]>) -> String {
        try_read("a.vtu", file.as_ref()).unwrap_err().to_string()
    }

    #[test]
    fn pieces_are_read_one_after_the_other() {
        let data = |names: &[&str]| {
            let arrays = names.iter().map(|name| {
                let kind = if *name == "d" { "Float64" } else { "Int32" };
                format!("<DataArray Name='{name}' type='{kind}'> 1 \n</DataArray>")
            });
            format!("<PointData>{}</PointData>", arrays.collect::<String>())
        };
        let pieces = [
            piece("0", "", ""),
            "<Piece NumberOfPoints='0'/>".to_owned(),
            piece("1", "1 2 3", &data(&["a", "b", "d"])),
            piece("1", "\n4 5\n6.5\n", &data(&["d", "c", "a"])),
        ];
        let set = read("a.vtp", file(&pieces.concat()));
        assert_eq!(set.positions, [[1.0, 2.0, 3.0], [4.0, 5.0, 6.5]]);
        // What a piece lacks, none has.
        assert_eq!(names(&set), ["a", "d"]);
        assert_eq!(set.format, "VTK XML, PolyData, 2 pieces");
    }

    #[test]
    fn arrays_in_base64_and_appended_are_read() {
        // 12 bytes: 1 2 3 as floats.
        let inline = "DAAAAAAAgD8AAABAAABAQA==";
        let apart = "DAAAAA==AACAPwAAAEAAAEBA";
        for text in [inline, apart, " DAAA\nAA== AACAPwAAAE\tAAAEBA "] {
            let file = file(&piece("1", text, "")).replace("\"ascii\"", "\"binary\"");
            assert_eq!(read("a.vtp", file).positions, [[1.0, 2.0, 3.0]], "{text}");
        }
        let appended = |encoding: &str, data: &[u8]| {
            let piece = piece("1", "", "").replace("\"ascii\"", "\"appended\" offset=\"2\"");
            let mut file = file(&piece).replace("</VTKFile>\n", "").into_bytes();
            file.extend(format!("<AppendedData {encoding}>\n  _").bytes());
            file.extend(data);
            file.extend(b"\n</AppendedData></VTKFile>");
            file
        };
        let mut raw = b"xx\x0c\0\0\0".to_vec();
        raw.extend([1.0f32, 2.0, 3.0].map(f32::to_le_bytes).as_flattened());
        for file in [
            appended("encoding=\"raw\"", &raw),
            appended("encoding='base64'", format!("AA{apart}").as_bytes()),
            appended("", format!("AA{inline}").as_bytes()),
        ] {
            assert_eq!(read("a.vtp", file).positions, [[1.0, 2.0, 3.0]]);
        }
        let whole = appended("encoding='raw'", &raw);
        let cut = message(&whole[..whole.len() - 32]);
        assert!(cut.contains("declares 1 values of 'points', but the file ends after 0"), "{cut}");
    }

    #[test]
    fn colors_and_normals_are_found() {
        let array = |name: &str, kind: &str, values: &str| {
            format!(
                "<DataArray Name=\"{name}\" type=\"{kind}\" NumberOfComponents=\"3\" \
                 format=\"ascii\">{values}</DataArray>"
            )
        };
        let data = format!(
            "<PointData Normals=\"up\">{}{}{}{}{}</PointData>",
            array("Normals", "Float32", "9 9 9"),
            array("seen", "UInt8", "255 0 0"),
            array("up", "Float32", "0 0 1"),
            array("Colors", "Float32", "0.5 0.5 0.5"),
            array("text", "String", "1 2 3"),
        );
        let set = read("a.vtp", file(&piece("1", "1 2 3", &data)));
        assert_eq!(set.colors, Some(vec![[1.0, 0.0, 0.0]]));
        assert_eq!(set.normals, Some(vec![[0.0, 0.0, 1.0]]));
        let expected = ["Normals_0", "Normals_1", "Normals_2", "Colors_0", "Colors_1", "Colors_2"];
        assert_eq!(names(&set), expected);
    }

    #[test]
    fn what_is_wrong_is_named() {
        let one = piece("1", "1 2 3", "");
        for (text, expected) in [
            (
                HEAD.replace("PolyData", "PPolyData"),
                "a.vtu: found a list of 0 files (the pieces of a parallel run), expected points; \
                 save the data as VTU or VTP",
            ),
            (HEAD.replace("PolyData", "Table"), "found type='Table', expected PolyData, Unstr"),
            (HEAD.replace("Little", "Middle"), "found byte_order='MiddleEndian', expected Little"),
            (HEAD.replace("version", "header_type"), "found header_type='1.0', expected UInt32"),
            (HEAD.replace("version", "compressor"), "found compressor='1.0', expected vtkZLib"),
            (
                file("<Piece NumberOfPoints=\"-1\"/>"),
                "a.vtu:3: found NumberOfPoints='-1', expected",
            ),
            (
                file("<Piece NumberOfPoints='1'/>"),
                "a.vtu:3: found a piece without Points, expected",
            ),
            (file(&one.replace("3\"", "2\"")), "found NumberOfComponents='2', expected 3"),
            (file(&one.replace("3\"", "x\"")), "found NumberOfComponents='x', expected 0 to 1000"),
            (file(&one.replace("Float32", "String")), "found type='String', expected a type such"),
            (file(&one.replace("ascii", "raw")), "found format='raw', expected ascii, binary or"),
            (file(&one.replace("ascii", "appended")), "found offset='', expected 0 or more"),
            (
                file(&one.replace("ascii\"", "appended\" offset=\"0\"")),
                "a.vtu: found no '_' in the tag AppendedData, expected it behind the description",
            ),
            (
                file(&piece("2", "1 2 3 4", "")),
                "declares 2 values of 'points', but the file ends after 1; the file is cut off",
            ),
            (
                file(&piece("1", "1 b 3", "")),
                "a.vtu: found 'b' as the data of 'points', expected what the header says",
            ),
            (file(&piece("18446744073709551615", "1 2 3", "")), "but the file ends after 1"),
            (file(&one.replace("ascii", "binary")), "the file ends after 0"),
            (
                file(&piece("1", "&", "").replace("ascii", "binary")),
                "a.vtu: found '&' in base64 as the data of 'points'",
            ),
            (
                file(&piece("1", "BAAAAAAAAAA=", "").replace("ascii", "binary")),
                "found a length of 4 bytes where 12 are needed as the data of 'points'",
            ),
            (file("<Piece></Points>"), "found '</Points>', expected the end of the tag that was"),
            (file("<Piece a></Piece>"), "found 'Piece a', expected a tag of XML"),
            (
                file(&"<a>".repeat(100)),
                "found more tags in each other, expected at most 64 tags in",
            ),
            (file("<Piece"), "a.vtu:3: found 'Piece</PolyData', expected a tag of XML"),
            (file("<!-- "), "a.vtu:5: found the end of the file, expected '>'"),
            (file(""), "the file holds no points"),
            (file(&piece("1", "nan 0 0", "")), "found no usable point: 1 in the file, 1 of them"),
        ] {
            let found = message(&text);
            assert!(found.contains(expected), "{text}: {found}");
        }
        // Wherever it is cut off, that is what the message says, and not that there are no points.
        let whole =
            file(&piece("2", "1 2 3 4 5 6", "<DataArray type='Float32' Name='s'>7 8</DataArray>"));
        for end in whole.find("<PolyData").unwrap()..whole.find("</VTKFile").unwrap() {
            let found = message(&whole[..end]);
            assert!(
                found.contains("the end of the file, expected '"),
                "{}: {found}",
                &whole[..end]
            );
        }
        let image = "<VTKFile type='ImageData'><ImageData Origin='0 0 0' Spacing='1 1 1'><Piece \
                     Extent='0 999 0 999 0 999'/></ImageData></VTKFile>";
        assert!(message(image).contains(
            "found 1000 1000 1000 as the dimensions of the lattice, expected at most 1000000 nodes"
        ));
        let count = |extent: &str| image.replace("0 999 0 999 0 999", extent);
        assert_eq!(read("a.vti", count("0 1 2 2 3 5")).positions[1], [1.0, 2.0, 3.0]);
        assert!(message(count("0 1 2")).contains("found Extent='0 1 2', expected 6 numbers"));
        assert!(message(count("0 -9 0 0 0 0")).contains("expected ends that do not lie before"));
        let far = "-9223372036854775808 9223372036854775807 0 0 0 0";
        assert!(message(count(far)).contains("expected ends that do not lie before"));
    }
}
