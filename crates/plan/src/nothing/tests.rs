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
    blank(&film(color)).map(|line| line.split(':').next().unwrap_or_default().to_owned())
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
