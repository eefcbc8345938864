//! Gaussians.

use super::*;

#[test]
fn what_lacks_a_part_of_gaussians_is_none() {
    let of = |names: &str, values: &str| {
        let properties: String =
            names.split(' ').map(|name| format!("property float {name}\n")).collect();
        let file =
            format!("ply\nformat ascii 1.0\nelement vertex 1\n{properties}end_header\n{values}\n");
        read_bytes(file.as_bytes()).unwrap()
    };
    for names in ["x y z f_dc_0 f_dc_1 opacity", "x y z f_dc_0 f_dc_1 f_dc_2"] {
        let set = of(names, "1 2 3 4 5 6");
        assert_eq!((set.colors.as_ref(), set.attributes.len()), (None, 3), "{names}");
        assert_eq!(set.format, "PLY 1.0, ascii");
    }
    // No number stays none, and what is infinite is at an end.
    let names = "x y z f_dc_0 f_dc_1 f_dc_2 opacity scale_0";
    let set = of(names, "1 2 3 nan inf -inf nan -inf");
    let colors = set.colors.as_ref().unwrap()[0];
    assert!(colors[0].is_nan() && colors[1..] == [1.0, 0.0], "{colors:?}");
    assert!(set.attribute("opacity").unwrap().get(0).is_nan());
    assert_eq!(set.attribute("scale_0").unwrap().get(0), 0.0);
}

/// The filter sees what `info` shows, not the logit.
#[test]
fn gaussians_are_filtered_by_their_opacity() {
    let properties: String = "x y z f_dc_0 f_dc_1 f_dc_2 opacity"
        .split(' ')
        .map(|name| format!("property float {name}\n"))
        .collect();
    let lines = "0 0 0 0 0 0 -3\n1 0 0 0 0 0 0\n2 0 0 0 0 0 3\n";
    let file = format!("ply\nformat ascii 1.0\nelement vertex 3\n{properties}end_header\n{lines}");
    let ranges = vec![("opacity".to_owned(), [0.5, 1.0])];
    let options = ReadOptions {
        filter: crate::Filter { ranges, ..Default::default() },
        ..Default::default()
    };
    let set = crate::read_bytes(file.as_bytes(), Path::new("a.ply"), &options).unwrap();
    assert_eq!(set.file_index, [1, 2]);
}
