use crate::collect::Collector;
use crate::field::{Field, Type};
use crate::filter::Filter;
use crate::options::ReadOptions;
use crate::set::{ColorEncoding, PointSet};
use std::path::Path;

fn decode(byte: u8) -> f32 {
    ColorEncoding::Srgb8.decode(byte.into())
}

/// Points with these colours, in three numbers of a type, or in one under this name.
fn read_as(names: &[&str], kind: Type, colors: &[&[f64]], filter: Filter) -> PointSet {
    let mut fields: Vec<Field> = ["x", "y", "z"].map(|name| Field::new(name, Type::F64)).into();
    fields.extend(names.iter().map(|name| Field::new(*name, kind)));
    let options = ReadOptions { filter, ..ReadOptions::default() };
    let mut collector = Collector::new(&fields, Path::new("a"), &options).unwrap();
    for color in colors {
        collector.push(&[&[0.0; 3], *color].concat()).unwrap();
    }
    collector.finish("rows").unwrap()
}

fn read(kind: Type, colors: &[&[f64]]) -> PointSet {
    read_as(&["red", "green", "blue"], kind, colors, Filter::default())
}

/// The colours of two points, 200 40 20 and 255 0 1 in bytes, in every encoding.
#[test]
fn one_colour_has_one_linear_value_in_every_encoding() {
    let bytes = [[200.0, 40.0, 20.0], [255.0, 0.0, 1.0]];
    let expected = [[decode(200), decode(40), decode(20)], [1.0, 0.0, decode(1)]];
    for (kind, factor, encoding) in [
        (Type::U8, 1.0, ColorEncoding::Srgb8),
        (Type::U16, 257.0, ColorEncoding::Srgb16),
        (Type::U16, 256.0, ColorEncoding::Srgb16High),
        (Type::U16, 1.0, ColorEncoding::Srgb8),
        (Type::I32, 1.0, ColorEncoding::Srgb8),
        (Type::I64, 257.0, ColorEncoding::Srgb16),
        (Type::F32, 1.0, ColorEncoding::Srgb8),
        (Type::F64, 257.0, ColorEncoding::Srgb16),
        (Type::F64, 1.0 / 255.0, ColorEncoding::Fraction),
        // A writer's rounding may take 1 a little too far.
        (Type::F64, 1.000_000_1 / 255.0, ColorEncoding::Fraction),
        (Type::F64, 1.000_000_1, ColorEncoding::Fraction255),
        (Type::F64, 257.000_01, ColorEncoding::Fraction65535),
        // As a table of text may come, of which the first rows are whole.
        (Type::U16, 1.0 / 255.0, ColorEncoding::Fraction),
    ] {
        let stored = bytes.map(|color| color.map(|byte| byte * factor));
        let set = read(kind, &[&stored[0], &stored[1]]);
        assert_eq!(set.color_encoding, Some(encoding), "{kind:?} {factor}");
        assert!(set.notes.is_empty(), "{:?}", set.notes);
        let exact = factor == 1.0 || factor >= 256.0 && factor.fract() == 0.0;
        for (found, expected) in set.colors.unwrap().iter().flatten().zip(expected.as_flattened()) {
            // Stored in 32 bits, and up to 2.4 times as much in linear light.
            let tolerance = if exact { 0.0 } else { 4e-7 * expected };
            assert!((found - expected).abs() <= tolerance, "{kind:?} {factor}: {found} {expected}");
        }
    }
}

/// 236 is 236 of 255, unless another point of the file has more.
#[test]
fn the_greatest_number_of_the_file_decides_whatever_is_kept() {
    let first = || Filter { every: 2, ..Filter::default() };
    for (kind, dark, bright, alone, together) in [
        (Type::U16, 236.0, 257.0, ColorEncoding::Srgb8, ColorEncoding::Srgb16),
        (Type::F32, 1.0, 200.0, ColorEncoding::Fraction, ColorEncoding::Srgb8),
        (Type::F32, 0.5, 200.0, ColorEncoding::Fraction, ColorEncoding::Fraction255),
        (Type::F64, 200.5, 40_000.0, ColorEncoding::Fraction255, ColorEncoding::Fraction65535),
    ] {
        for filter in [Filter::default(), first()] {
            let names = ["red", "green", "blue"];
            let set = read_as(&names, kind, &[&[dark; 3]], filter.clone());
            assert_eq!(set.color_encoding, Some(alone), "{kind:?} {dark}");
            assert_eq!(set.colors.unwrap(), [[alone.decode(dark); 3]]);
            let set = read_as(&names, kind, &[&[dark; 3], &[bright; 3]], filter);
            assert_eq!(set.color_encoding, Some(together), "{kind:?} {bright}");
            assert_eq!(set.colors.unwrap()[0], [together.decode(dark); 3]);
        }
    }
}

#[test]
fn fractions_a_little_or_seldom_above_one_are_fractions_and_said() {
    let set = read(Type::F32, &[&[0.5, 1.5, 0.0]]);
    assert_eq!(set.colors.unwrap()[0][1], 1.0);
    assert_eq!(
        set.notes,
        [
            "colours are taken for fractions of 1, although 1 of their numbers are above, up to 1.5; those \
          count as 1"
        ]
    );
    let mut rows: Vec<&[f64]> = vec![&[0.5, 0.25, 0.75]; 100];
    rows.push(&[300.0, 0.5, 0.5]);
    let set = read(Type::F32, &rows);
    assert_eq!((set.color_encoding, set.notes.len()), (Some(ColorEncoding::Fraction), 1));
    // Nor does one number that is no colour make bytes black.
    let mut rows: Vec<&[f64]> = vec![&[200.0, 100.0, 50.0]; 1000];
    rows.push(&[1e30, 0.0, 0.0]);
    assert_eq!(read(Type::F32, &rows).color_encoding, Some(ColorEncoding::Srgb8));
}

#[test]
fn colors_that_are_all_zero_were_not_written() {
    for kind in [Type::U8, Type::U16, Type::I32, Type::F32] {
        let set = read(kind, &[&[0.0; 3], &[0.0, 0.0, -1.0]]);
        assert_eq!((set.colors, set.color_encoding), (None, None), "{kind:?}");
        // LAS has fields of 16 bits for colours whether it has colours or not.
        assert_eq!(set.notes.len(), usize::from(kind != Type::U16));
    }
}

#[test]
fn bytes_with_a_sign_are_bytes_and_what_is_no_number_stays_none() {
    let set = read(Type::I8, &[&[-56.0, 40.0, -1.0]]);
    assert_eq!(set.colors.unwrap(), [[decode(200), decode(40), 1.0]]);
    let set = read(Type::F32, &[&[f64::NAN, f64::INFINITY, -3.0], &[200.0, 40.0, 20.0]]);
    let [first, second] = set.colors.unwrap()[..] else { panic!("two") };
    assert!(first[0].is_nan() && first[1..] == [1.0, 0.0], "{first:?}");
    assert_eq!(second, [decode(200), decode(40), decode(20)]);
}

#[test]
fn packed_colors_come_apart() {
    let expected = [decode(128), decode(64), decode(255)];
    let float = |bits: u32| f64::from(f32::from_bits(bits));
    for (kind, stored) in [
        (Type::U32, f64::from(0xff80_40ff_u32)),
        (Type::I32, -8_371_969.0),
        (Type::I64, f64::from(0x0080_40ff_u32)),
        (Type::F32, float(0x0080_40ff)),
        (Type::F64, float(0x0080_40ff)),
        // As text may have it.
        (Type::F64, f64::from(0x0080_40ff_u32)),
    ] {
        for name in ["rgb", "rgba", "RGB"] {
            let set = read_as(&[name], kind, &[&[stored]], Filter::default());
            assert_eq!(set.colors.unwrap(), [expected], "{kind:?} {stored}");
        }
    }
    // With an alpha of 255, red below 128: else it is no number.
    let set = read_as(&["rgb"], Type::F32, &[&[float(0xff40_80ff)]], Filter::default());
    assert_eq!(set.colors.unwrap(), [[decode(64), decode(128), 1.0]]);
}

#[test]
fn a_number_called_rgb_that_holds_no_colour_is_said() {
    let rows: [&[f64]; 3] = [&[0.25], &[f64::NAN], &[0.5]];
    let set = read_as(&["rgb"], Type::F32, &rows, Filter::default());
    assert_eq!(set.colors, None);
    assert_eq!(
        set.notes,
        [
            "the numbers called rgb hold no colours (found 0.25, expected 0xRRGGBB in 32 bits), so the \
          points count as without"
        ]
    );
}

#[test]
fn info_has_the_numbers_of_the_file() {
    for (encoding, stored) in [
        (ColorEncoding::Fraction, vec![0.0, 0.7843, 0.123_456_7, 1.0]),
        (ColorEncoding::Fraction255, vec![0.5, 127.25, 254.999]),
        (ColorEncoding::Fraction65535, vec![0.5, 30_000.25, 65_534.5]),
        (ColorEncoding::Srgb16High, vec![256.0, 51_200.0, 65_280.0]),
    ] {
        for stored in stored {
            assert_eq!(encoding.encode(encoding.decode(stored)), stored, "{encoding:?}");
        }
    }
}
