//! Closed forms of the measures, FLIP against its authors' program, and pairs of pictures in memory.

use super::*;
use film::Samples;
use std::collections::BTreeMap;

mod threads;

fn plane(window: Rect, values: Vec<f32>) -> Plane {
    Plane { window, samples: Samples::from_f32(values) }
}

fn whole(width: i64, height: i64) -> Rect {
    Rect { x: 0, y: 0, width, height }
}

/// A linear picture of these channels over its whole display window.
fn picture(size: [u32; 2], channels: &[(&str, Vec<f32>)]) -> Picture {
    let window = whole(size[0].into(), size[1].into());
    let named = channels.iter().map(|(n, values)| ((*n).to_owned(), plane(window, values.clone())));
    Picture { size, channels: named.collect(), srgb_bits: None, headers: Vec::new() }
}

fn measured(a: &[f32], b: &[f32]) -> Measures {
    let size = [a.len() as u32, 1];
    let pair = Pair::new(picture(size, &[("V", a.to_vec())]), picture(size, &[("V", b.to_vec())]));
    let pair = pair.unwrap();
    pair.measure(&["V"], pair.region(&["V"]).unwrap())
}

#[test]
fn equal_planes_differ_by_nothing_and_have_an_infinite_psnr() {
    let values = [0.0, -0.0, 1.5, f32::INFINITY, f32::NEG_INFINITY, f32::NAN];
    let m = measured(&values, &values);
    assert_eq!((m.max_abs, m.mean, m.rmse, m.psnr), (0.0, 0.0, 0.0, f64::INFINITY));
    assert_eq!((m.values, m.differing, m.nan), (6, 0, 0));
    assert_eq!((m.worst.x, m.worst.y, m.worst.a), (0, 0, 0.0));
    assert_eq!(measured(&[0.0], &[-0.0]).max_abs, 0.0);
}

/// Differences 0, 1, 2, 3: mean 6/4, mean square 14/4, and the peak is the largest value, 8.
#[test]
fn measures_meet_their_closed_forms() {
    let m = measured(&[1.0, 2.0, 8.0, 4.0], &[1.0, 3.0, 6.0, 1.0]);
    assert_eq!((m.max_abs, m.mean, m.peak), (3.0, 1.5, 8.0));
    assert!((m.rmse - 3.5f64.sqrt()).abs() < 1e-15, "{m:?}");
    assert!((m.psnr - 10.0 * (64.0f64 / 3.5).log10()).abs() < 1e-12, "{m:?}");
    assert_eq!(m.percentiles, [1.0, 3.0, 3.0], "ranks 2, 4 and 4 of 4");
    assert_eq!(m.differing, 3);
    let worst = Worst { channel: "V".to_owned(), x: 3, y: 0, a: 4.0, b: 1.0 };
    assert_eq!(m.worst, worst);
    // Values within 0 to 1 have the peak 1: a difference of 0.1 everywhere is 20 dB.
    let m = measured(&[0.0, 0.5], &[0.1, 0.6]);
    assert!((m.psnr - 20.0).abs() < 1e-5, "f32 rounds 0.1: {m:?}");
}

#[test]
fn percentiles_are_nearest_ranks() {
    let (a, b): (Vec<f32>, Vec<f32>) = (vec![0.0; 200], (0..200).map(|i| i as f32).rev().collect());
    assert_eq!(measured(&a, &b).percentiles, [99.0, 189.0, 197.0]);
}

#[test]
fn what_is_no_number_or_infinite_against_a_number_is_infinitely_far() {
    let (inf, nan) = (f32::INFINITY, f32::NAN);
    for (a, b, not_numbers) in
        [(nan, 1.0, 1), (1.0, nan, 1), (nan, inf, 1), (inf, 1.0, 0), (inf, -inf, 0)]
    {
        let m = measured(&[0.0, a, 0.0], &[0.5, b, 0.0]);
        assert_eq!((m.max_abs, m.mean, m.rmse), (f64::INFINITY, f64::INFINITY, f64::INFINITY));
        assert_eq!((m.psnr, m.nan, m.differing), (f64::NEG_INFINITY, not_numbers, 2), "{a} {b}");
        assert_eq!((m.worst.x, m.worst.y), (1, 0));
        assert_eq!(m.percentiles[0], 0.5, "one pixel does not hide the others");
    }
}

#[test]
fn integers_differ_exactly_where_f32_would_not_tell() {
    let difference = difference(f64::from(u32::MAX), f64::from(u32::MAX - 1));
    assert_eq!(difference, 1.0);
}

#[test]
fn a_crop_is_compared_where_it_lies() {
    let all: Vec<f32> = (0..48).map(|i| i as f32).collect();
    let a = picture([8, 6], &[("R", all.clone())]);
    let window = Rect { x: 3, y: 2, width: 4, height: 3 };
    let mut inside: Vec<f32> = window.places().map(|[x, y]| all[(8 * y + x) as usize]).collect();
    let crop = |values: Vec<f32>| {
        let channels = BTreeMap::from([("R".to_owned(), plane(window, values))]);
        Picture { size: [8, 6], channels, srgb_bits: None, headers: Vec::new() }
    };
    for reversed in [false, true] {
        let (a, b) = (a.clone(), crop(inside.clone()));
        let pair = if reversed { Pair::new(b, a) } else { Pair::new(a, b) }.unwrap();
        let region = pair.region(&["R"]).unwrap();
        assert_eq!(region, window);
        assert_eq!(pair.measure(&["R"], region).max_abs, 0.0);
    }
    inside[5] += 1.0;
    let pair = Pair::new(a, crop(inside.clone())).unwrap();
    let m = pair.measure(&["R"], window);
    assert_eq!((m.worst.x, m.worst.y, m.max_abs), (4, 3, 1.0), "the second of the second row");

    let elsewhere = Picture {
        channels: BTreeMap::from([(
            "R".to_owned(),
            plane(Rect { x: 0, y: 0, width: 3, height: 6 }, vec![0.0; 18]),
        )]),
        ..crop(Vec::new())
    };
    let error = Pair::new(crop(inside), elsewhere).unwrap().region(&["R"]).unwrap_err();
    assert!(matches!(error, CompareError::NoOverlap { .. }), "{error}");
}

#[test]
fn names_mean_channels_and_layers_of_both() {
    let names = ["A", "B", "G", "N.X", "N.Y", "R", "Z", "a.b.c"];
    let planes = |names: &[&'static str]| -> Vec<(&str, Vec<f32>)> {
        names.iter().map(|&name| (name, vec![0.0])).collect()
    };
    let a = picture([1, 1], &planes(&[&names[..], &["left"]].concat()));
    let b = picture([1, 1], &planes(&[&names[..], &["right"]].concat()));
    let pair = Pair::new(a, b).unwrap();
    let selected = |asked: &[&str]| {
        let asked: Vec<String> = asked.iter().map(|&name| name.to_owned()).collect();
        pair.selected(&asked).map(|found| found.join(" ")).map_err(|error| error.to_string())
    };
    assert_eq!(selected(&[]).unwrap(), "R G B A N.X N.Y Z a.b.c");
    assert_eq!(selected(&["N", "Z"]).unwrap(), "N.X N.Y Z");
    assert_eq!(selected(&["RGB"]).unwrap(), "R G B");
    assert_eq!(selected(&["RGBA", "R"]).unwrap(), "R G B A");
    assert_eq!(selected(&["a.b"]).unwrap(), "a.b.c");
    for (name, place) in [("left", "first file alone"), ("right", "second"), ("X", "neither")] {
        let message = selected(&["R", name]).unwrap_err();
        assert!(message.contains(place) && message.contains("A, N.X, N.Y, Z"), "{message}");
    }
    assert_eq!(pair.unmatched(), [vec!["left"], vec!["right"]]);
    let other = picture([1, 1], &planes(&["right"]));
    let error = Pair::new(picture([1, 1], &planes(&["left"])), other).unwrap_err();
    assert!(matches!(error, CompareError::NoChannel { .. }), "{error}");
    let error = Pair::new(picture([2, 1], &[]), picture([1, 2], &[])).unwrap_err();
    assert!(error.to_string().contains("2x1 pixels against one of 1x2"), "{error}");
}

/// Three parts, two of which have an `R`. One has its name in its channel already, and a data window of its own.
#[test]
fn parts_are_one_picture_and_layers_where_their_names_are_the_same() {
    use exr::meta::attribute::IntegerBounds;
    use exr::meta::header::{ImageAttributes, LayerAttributes};
    use exr::prelude::{
        AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, Vec2, WritableImage,
    };
    let part = |name: &str, position, size: (usize, usize), channel: &str| {
        let attributes = LayerAttributes {
            layer_name: Some(name.into()),
            layer_position: position,
            ..LayerAttributes::default()
        };
        let samples = FlatSamples::F32(vec![0.5; size.0 * size.1]);
        let list = [AnyChannel::new(channel, samples)].into_iter().collect();
        Layer::new(size, attributes, Encoding::SMALL_LOSSLESS, AnyChannels::sort(list))
    };
    let display = IntegerBounds { position: Vec2(10, 20), size: Vec2(8, 6) };
    let layers = vec![
        part("left", Vec2(10, 20), (8, 6), "R"),
        part("right", Vec2(10, 20), (8, 6), "R"),
        part("depth", Vec2(13, 19), (2, 3), "depth.Z"),
    ];
    let file = tempfile::NamedTempFile::new().unwrap();
    let image = Image::from_layers(ImageAttributes::new(display), layers);
    image.write().to_file(file.path()).unwrap();

    let picture = Picture::read(file.path()).unwrap();
    assert_eq!((picture.size, picture.headers.len()), ([8, 6], 3));
    let names: Vec<&String> = picture.channels.keys().collect();
    assert_eq!(names, ["depth.Z", "left.R", "right.R"]);
    assert_eq!(picture.channels["left.R"].window, whole(8, 6));
    let above = Rect { x: 3, y: -1, width: 2, height: 3 };
    assert_eq!(picture.channels["depth.Z"].window, above, "one row above the display window");
    let pair = Pair::new(picture.clone(), picture).unwrap();
    assert_eq!(pair.region(&["left.R"]).unwrap(), whole(8, 6));
    assert_eq!(pair.region(&["depth.Z"]).unwrap(), above);
    let common = Rect { y: 0, height: 2, ..above };
    assert_eq!(pair.region(&["left.R", "depth.Z"]).unwrap(), common);
    assert_eq!(pair.measure(&["depth.Z"], above).values, 6);
}

#[test]
fn flip_is_of_the_top_colors_or_of_the_first_layer_that_has_three() {
    let planes: Vec<(&str, Vec<f32>)> =
        ["x.R", "x.G", "left.R", "left.G", "left.B", "R", "G", "B"].map(|n| (n, vec![0.0])).into();
    let of = |count: usize| {
        let pair = Pair::new(picture([1, 1], &planes[..count]), picture([1, 1], &planes)).unwrap();
        pair.colors(&pair.common()).map(|names| names.join(" "))
    };
    assert_eq!(of(8).unwrap(), "R G B");
    assert_eq!(of(5).unwrap(), "left.R left.G left.B");
    assert_eq!(of(4), None);
}

#[test]
fn bytes_against_floats_are_compared_in_linear_light() {
    let mut bytes = picture([1, 1], &[("R", vec![188.0 / 255.0]), ("A", vec![0.5])]);
    bytes.srgb_bits = Some(8);
    // sRGB 188 of 255 is 0.50289 in linear light, and an EXR holds it multiplied by alpha.
    let pair = Pair::new(bytes.clone(), picture([1, 1], &[("R", vec![0.251_443])])).unwrap();
    assert!(!pair.is_srgb());
    let m = pair.measure(&["R"], whole(1, 1));
    assert!(m.max_abs < 1e-6, "{m:?}");
    let pair = Pair::new(bytes.clone(), bytes).unwrap();
    assert!(pair.is_srgb());
    assert_eq!(pair.measure(&["R"], whole(1, 1)).worst.a, f64::from(188.0f32 / 255.0));
}

#[test]
fn false_colors_span_the_map_and_mark_what_is_no_number() {
    let a = picture([4, 1], &[("R", vec![0.0; 4]), ("G", vec![0.0; 4])]);
    let b =
        picture([4, 1], &[("R", vec![0.0, 1.0, 0.5, 0.0]), ("G", vec![0.0, 0.5, 2.0, f32::NAN])]);
    let pair = Pair::new(a, b).unwrap();
    let of = |scale| FalseColor::of(&pair, &["G", "R"], whole(4, 1), scale);
    let [dark, pale] = [0.0, 1.0].map(|part| {
        let colorous::Color { r, g, b } = colorous::MAGMA.eval_continuous(part);
        [r, g, b]
    });
    let own = of(None);
    assert_eq!(own.scale, 2.0, "the largest finite difference");
    assert_eq!((own.pixels[0], own.pixels[2], own.pixels[3]), (dark, pale, NOT_A_NUMBER));
    let limited = of(Some(0.75));
    assert_eq!((limited.pixels[1], limited.pixels[2]), (pale, pale));
    assert_eq!(of(Some(0.0)).scale, 2.0, "a limit of 0 is no scale");
    let differences = pair.differences(&["R"], whole(4, 1));
    assert_eq!(differences, [("R".to_owned(), vec![0.0, 1.0, 0.5, 0.0])]);
}

const SIZE: [usize; 2] = [48, 32];

/// Red grows to the right, green downwards, blue is a checkerboard of 8 x 8 pixels.
fn colors() -> Vec<[f32; 3]> {
    let color = |x: usize, y: usize| {
        let blue = if (x / 8 + y / 8).is_multiple_of(2) { 0.75 } else { 0.125 };
        [x as f32 / SIZE[0] as f32, y as f32 / SIZE[1] as f32, blue]
    };
    (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| color(x, y))).collect()
}

/// One white pixel; a square half as bright; all columns moved by one; red and blue swapped; black.
fn changes(pixels: &[[f32; 3]]) -> [Vec<[f32; 3]>; 5] {
    let at = |x: usize, y: usize| y * SIZE[0] + x;
    let mut point = pixels.to_vec();
    point[at(20, 10)] = [1.0; 3];
    let mut square = pixels.to_vec();
    for y in 8..20 {
        for x in 8..24 {
            square[at(x, y)] = square[at(x, y)].map(|c| 0.5 * c);
        }
    }
    let moved = (0..pixels.len()).map(|i| pixels[at((i + SIZE[0] - 1) % SIZE[0], i / SIZE[0])]);
    let swapped = pixels.iter().map(|&[r, g, b]| [b, g, r]).collect();
    [point, square, moved.collect(), swapped, vec![[0.0; 3]; pixels.len()]]
}

#[track_caller]
fn assert_near(found: f64, expected: f64, what: &str) {
    // Both sides compute in f32 and raise to powers under 1, which magnifies the rounding of small
    // differences; the largest deviation seen is 1.2e-5.
    assert!((found - expected).abs() < 2e-5, "{what}: {found} against {expected}");
}

/// Mean, value at column 20 of row 10, and largest value, by `flip_evaluator.evaluate` of version 1.7
/// of the authors' program.
#[test]
fn ldr_flip_is_that_of_the_authors_program() {
    let reference = colors();
    let expected = [
        [0.003_162_25, 0.292_689_53, 0.292_689_53],
        [0.106_018_18, 0.575_434_3, 0.699_448_8],
        [0.180_953_61, 0.083_550_83, 0.969_192_5],
        [0.581_161_44, 0.460_143_36, 0.967_577_64],
        [0.977_050_3, 0.968_483_8, 0.992_402_14],
    ];
    for (test, [mean, at, max]) in changes(&reference).iter().zip(expected) {
        let flip = Flip::ldr(&reference, test, SIZE);
        assert_near(flip.mean, mean, "mean");
        assert_near(flip.map[10 * SIZE[0] + 20].into(), at, "pixel");
        assert_near(flip.max, max, "max");
        assert_eq!(flip.exposures, None);
    }
}

#[test]
fn hdr_flip_is_that_of_the_authors_program() {
    let reference: Vec<[f32; 3]> = colors().iter().map(|pixel| pixel.map(|c| 8.0 * c)).collect();
    let expected = [
        [0.002_428_35, 0.134_395_61, 0.134_395_61],
        [0.093_331_73, 0.572_760_3, 0.608_766_7],
        [0.164_645_88, 0.061_035_19, 0.950_785_3],
        [0.535_836_52, 0.577_928_7, 0.968_043_6],
        [0.978_950_26, 0.977_095_7, 0.987_417_4],
    ];
    for (test, [mean, at, max]) in changes(&reference).iter().zip(expected) {
        let flip = Flip::hdr(&reference, test, SIZE);
        assert_near(flip.mean, mean, "mean");
        assert_near(flip.map[10 * SIZE[0] + 20].into(), at, "pixel");
        assert_near(flip.max, max, "max");
    }
}

/// A square of 4 x 4 pixels 4096 times as bright: eleven exposures, of which each pixel takes its worst.
#[test]
fn hdr_flip_of_a_wide_range_is_that_of_the_authors_program() {
    let mut reference = colors();
    for at in (2..6).flat_map(|y| (2..6).map(move |x| y * SIZE[0] + x)) {
        reference[at] = reference[at].map(|c| 4096.0 * c);
    }
    let expected =
        [[0.003_074_9, 0.261_853_25, 0.261_853_25], [0.104_808_36, 0.636_428, 0.659_292_5]];
    for (test, [mean, at, max]) in changes(&reference).iter().zip(expected) {
        let flip = Flip::hdr(&reference, test, SIZE);
        let Some(([first, last], 11)) = flip.exposures else { panic!("{:?}", flip.exposures) };
        assert_near(first, -8.505_859, "first exposure");
        assert_near(last, 2.097_590, "last exposure");
        assert_near(flip.mean, mean, "mean");
        assert_near(flip.map[10 * SIZE[0] + 20].into(), at, "pixel");
        assert_near(flip.max, max, "max");
    }
}

#[test]
fn flip_of_equal_pictures_is_0_and_of_no_number_is_1() {
    let bright: Vec<[f32; 3]> = colors().iter().map(|pixel| pixel.map(|c| 1e30 * c)).collect();
    let mut odd = bright.clone();
    odd[7] = [f32::INFINITY, f32::NAN, -4.0];
    for pixels in [colors(), bright.clone(), odd.clone(), vec![[0.0; 3]; 48 * 32]] {
        for flip in [Flip::ldr(&pixels, &pixels, SIZE), Flip::hdr(&pixels, &pixels, SIZE)] {
            assert_eq!((flip.mean, flip.max, flip.percentiles), (0.0, 0.0, [0.0; 3]));
        }
    }
    for flip in [Flip::ldr(&bright, &odd, SIZE), Flip::hdr(&odd, &bright, SIZE)] {
        assert_eq!(flip.map[7], 1.0);
        assert!(flip.map.iter().all(|value| (0.0..=1.0).contains(value)));
    }
    // One pixel is smaller than any filter.
    assert!(Flip::hdr(&[[1.0; 3]], &[[0.5; 3]], [1, 1]).mean > 0.1);
}

#[test]
fn headers_differ_by_type_value_or_absence() {
    let attribute = |name: &str, kind: &str, bytes: &[u8]| film::ExrAttribute {
        name: name.to_owned(),
        kind: kind.to_owned(),
        bytes: bytes.to_vec(),
    };
    let header =
        |attributes: &[film::ExrAttribute]| film::ExrHeader { attributes: attributes.to_vec() };
    let [same, old, new] = [("same", "x"), ("owner", "me"), ("owner", "you")]
        .map(|(n, v)| attribute(n, "string", v.as_bytes()));
    let a = [header(&[same.clone(), old, attribute("n", "int", &[1, 0, 0, 0])])];
    let b =
        [header(&[attribute("n", "float", &[0, 0, 128, 63]), new, same.clone()]), header(&[same])];
    let shown = |a: &[film::ExrHeader], b: &[film::ExrHeader]| -> Vec<String> {
        let differing = differing_attributes(a, b).into_iter();
        let text = |value: Option<String>| value.unwrap_or_else(|| "none".to_owned());
        differing.map(|d| format!("{} {} {} {}", d.part, d.name, text(d.a), text(d.b))).collect()
    };
    assert_eq!(shown(&a, &b), ["0 n 1 1.0", "0 owner me you", "1 same none x"]);
    assert!(shown(&a, &a).is_empty());
}
