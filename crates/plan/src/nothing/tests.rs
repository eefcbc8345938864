//! Tests of pictures that show nothing; what is known before one is rendered is tested from the command line.

use super::*;
use film::{Film, Window};

fn film(color: Vec<[f32; 4]>) -> Film {
    let count = color.len();
    let size = [count as u32, 1];
    Film {
        size,
        window: Window { x: 0, y: 0, width: size[0], height: size[1] },
        transparent: false,
        channel_alpha: None,
        depth: vec![f32::INFINITY; count],
        position: vec![[0.0; 3]; count],
        normal: vec![[0.0; 3]; count],
        object: color.iter().map(|color| if color[3] > 0.0 { 0.0 } else { -1.0 }).collect(),
        extra: Vec::new(),
        color,
    }
}

fn says(color: Vec<[f32; 4]>) -> Option<String> {
    blank(&film(color), Shown::default())
        .map(|line| line.split(':').next().unwrap_or_default().to_owned())
}

#[test]
fn pictures_without_anything_are_known() {
    let nothing = "the picture shows nothing but the background";
    assert_eq!(says(vec![[0.2, 0.2, 0.2, 0.0]; 64]).as_deref(), Some(nothing));
    // An environment is no object.
    let sky = (0..64).map(|i| [i as f32, 0.0, 0.0, 0.0]).collect();
    assert_eq!(says(sky).as_deref(), Some(nothing));
    let black = vec![[0.0, 0.0, 0.0, 1.0]; 1000];
    assert_eq!(says(black.clone()).as_deref(), Some("the picture is black all over"));
    // A pixel of a thousand is a leak, ten are something.
    for (lit, is_black) in [(1, true), (5, true), (10, false)] {
        let mut color = black.clone();
        color[..lit].fill([0.5, 0.4, 0.3, 1.0]);
        assert_eq!(says(color).is_some(), is_black, "{lit}");
    }
    // Faint light grazes more.
    for (lit, is_black) in [(49, true), (60, false)] {
        let mut color = black.clone();
        color[..lit].fill([0.01, 0.01, 0.01, 1.0]);
        assert_eq!(says(color).is_some(), is_black, "{lit}");
    }
    let one = says(vec![[0.2, 0.3, 0.4, 1.0]; 64]).expect("a warning");
    assert!(one.starts_with("the picture is one colour all over"), "{one}");
}

#[test]
fn pictures_with_something_are_not_named() {
    // Something small before black.
    let mut small = vec![[0.0; 4]; 10_000];
    small[7] = [0.1, 0.1, 0.1, 1.0];
    assert_eq!(says(small), None);
    // A silhouette.
    let mut silhouette = vec![[0.2, 0.2, 0.2, 0.0]; 64];
    silhouette[..32].fill([0.0, 0.0, 0.0, 1.0]);
    assert_eq!(says(silhouette), None);
    // Fewer pixels than say anything.
    assert_eq!(says(vec![[0.0; 4]; 4]), None);
}

fn says_as(color: Vec<[f32; 4]>, shown: Shown) -> Option<String> {
    blank(&film(color), shown).map(|line| line.split(':').next().unwrap_or_default().to_owned())
}

/// Light that covers nothing has an alpha of 0.
#[test]
fn what_only_glows_is_seen_by_its_colors() {
    let glowing = Shown { glows: true, ..Shown::default() };
    let mut glow = vec![[0.0; 4]; 64];
    glow[20..40].fill([0.3, 0.1, 0.0, 0.0]);
    assert_eq!(says_as(glow.clone(), glowing), None);
    assert_eq!(says_as(glow, Shown { eight_bit: Some(film::Tone::default()), ..glowing }), None);
    let nothing = "the picture shows nothing but the background";
    assert_eq!(says_as(vec![[0.0; 4]; 64], glowing).as_deref(), Some(nothing));
}

/// 8 bits show no less than half a step: 0.5/255/12.92 = 1.5e-4 above black, and about 0.0045 below white.
#[test]
fn what_eight_bits_do_not_show_is_named_where_a_file_has_them() {
    let tone = film::Tone::default();
    let in_eight = Shown { eight_bit: Some(tone), ..Shown::default() };
    let half_of = |one: [f32; 4], other: [f32; 4]| -> Vec<[f32; 4]> {
        (0..64).map(|i| if i % 2 == 0 { one } else { other }).collect()
    };
    let dark = [0.0, 0.0, 0.0, 0.0];
    for (one, other, expected) in [
        ([1.4e-4, 0.0, 0.0, 1.0], dark, Some("the picture is black all over in 8 bits")),
        ([1.6e-4, 0.0, 0.0, 1.0], dark, None),
        (
            [3.0, 1.0, 1.0, 1.0],
            [0.999, 1.0, 1.0, 0.0],
            Some("the picture is white all over in 8 bits"),
        ),
        ([1.0, 1.0, 1.0, 1.0], [0.99, 1.0, 1.0, 0.0], None),
        (
            [0.5, 0.5, 0.5, 1.0],
            [0.5001, 0.5, 0.5, 0.0],
            Some("the picture is one colour all over in 8 bits, [188, 188, 188]"),
        ),
        (
            [1e-5, 0.0, 0.0, 1e-3],
            dark,
            Some("the picture shows nothing but the background in 8 bits"),
        ),
        ([3e-3, 0.0, 0.0, 1e-3], dark, None),
    ] {
        let color = half_of(one, other);
        assert_eq!(says_as(color.clone(), in_eight).as_deref(), expected, "{one:?}");
        assert_eq!(says(color), None, "all bits show {one:?}");
    }
    // Four stops more, and it is seen.
    let brighter = film::Tone { exposure: 4.0, ..tone };
    let brighter = Shown { eight_bit: Some(brighter), ..Shown::default() };
    assert_eq!(says_as(half_of([1.4e-4, 0.0, 0.0, 1.0], dark), brighter), None);
    // A silhouette in a transparent film is seen by its alpha.
    let mut transparent = film(half_of([1e-6, 0.0, 0.0, 1.0], dark));
    transparent.transparent = true;
    let line = blank(&transparent, in_eight).expect("black, though not empty");
    assert!(
        line.starts_with("the picture is black all over in 8 bits: its brightest colour is 1.0e-6"),
        "{line}"
    );
    assert!(line.contains("--exposure 18"), "{line}");
}
