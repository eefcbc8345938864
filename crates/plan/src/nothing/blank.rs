//! Pictures that show nothing.

use crate::Plan;
use film::{Film, Tone};
use kernels::layout::VOLUME_ISOSURFACE;

/// Fewer pixels may well be of one colour.
const FEWEST: usize = 16;
/// Part of the pixels that may show light in the dark; and faint light, along which surfaces lie.
const LEAKING: f64 = 0.005;
const GRAZING: f64 = 0.05;
const FAINT: f32 = 0.02;
/// Coverage that 8 bits show.
const COVERED: f32 = 0.5 / 255.0;

/// Brighter than what 8 bits take for white.
const WHITE: f32 = 1.005;

/// How a picture is looked at.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Shown {
    /// Whether something in the scene sends light without covering anything, so that alpha does not say whether it is seen.
    pub glows: bool,
    /// How a file of 8 bits is made of the picture, if one is.
    pub eight_bit: Option<Tone>,
}

impl Shown {
    /// The picture of a plan, in a file of 8 bits or not.
    #[must_use]
    pub fn of(plan: &Plan, eight_bit: Option<Tone>) -> Self {
        let marched = plan.volumes.infos.iter().any(|info| info.mode != VOLUME_ISOSURFACE);
        let glows = marched && plan.volumes.stops.iter().any(|stop| stop.emission != [0.0; 3]);
        Self { glows, eight_bit }
    }
}

/// What is wrong with a picture that shows nothing, in a sentence which says what may be the cause; `None` where it shows
/// something, or is smaller than 16 pixels. Where a file of 8 bits is made of it, what that does not show is not seen.
#[must_use]
pub fn blank(film: &Film, shown: Shown) -> Option<String> {
    let colors = film.color.as_slice();
    let (first, rest) = colors.split_first().filter(|_| colors.len() >= FEWEST)?;
    let rgb = |color: &[f32; 4]| [color[0], color[1], color[2]];
    let is_one_color = rest.iter().all(|color| rgb(color) == rgb(first));
    let is_uncovered = || {
        colors.iter().all(|color| color[3] == 0.0) && film.object.iter().all(|object| *object < 0.0)
    };
    if (is_one_color || !shown.glows) && is_uncovered() {
        return Some(
            "the picture shows nothing but the background: no ray met anything; objects may lie outside the picture, be \
             smaller than a pixel, have no surface, or be transparent; render without [camera] to see where they are"
                .to_owned(),
        );
    }
    // Through the finest gaps of a surface a ray finds light, and where it only grazes the surface, not all of it is dark.
    let hits = colors.iter().filter(|color| color[3] > 0.0).count();
    let lit = |above: f32| {
        let lit = colors.iter().filter(|color| rgb(color).iter().any(|x| *x > above)).count();
        lit as f64 / hits.max(1) as f64
    };
    if hits >= FEWEST && lit(0.0) <= GRAZING && lit(FAINT) <= LEAKING {
        return Some(
            "the picture is black all over: no light reaches what is seen; the camera may be inside an object, the lights \
             hidden by one or too weak, or what is seen has an albedo of 0; add a light of kind \"headlight\""
                .to_owned(),
        );
    }
    if is_one_color {
        return Some(format!(
            "the picture is one colour all over, {:?}: what is seen may be only the inside of an object, a part of a flat \
             one, or something before a background of its own colour; move camera.eye, or leave [camera] out",
            rgb(first)
        ));
    }
    unseen_in_eight_bits(film, shown.eight_bit?)
}

/// What is wrong with a picture that has something, of which a file of 8 bits shows nothing.
fn unseen_in_eight_bits(film: &Film, tone: Tone) -> Option<String> {
    let bytes = film::shown_bytes(film, tone);
    let first = *bytes.first()?;
    let brightest = film.color.iter().flat_map(|color| &color[..3]).copied().fold(0.0, f32::max);
    let is_one = bytes.iter().all(|color| *color == first);
    let covered = film.color.iter().map(|color| color[3]).fold(0.0, f32::max);
    if is_one && covered < COVERED {
        return Some(format!(
            "the picture shows nothing but the background in 8 bits: what is in it covers at most {covered:.1e} of a pixel, \
             and sends too little light to be seen; raise the extinction or the emission of volumes, or the radius of what \
             is smaller than a pixel"
        ));
    }
    if bytes.iter().all(|color| color[..3] == [0; 3]) {
        // So that the brightest colour becomes a middle grey.
        let stops = (0.2 / f64::from(brightest)).log2().ceil();
        let exposure = match stops <= 40.0 {
            true => format!(", or give --exposure {stops}"),
            false => String::new(),
        };
        return Some(format!(
            "the picture is black all over in 8 bits: its brightest colour is {brightest:.1e}; move the lights nearer, make \
             them stronger{exposure}"
        ));
    }
    if is_one && first[..3] == [255; 3] && brightest > WHITE {
        return Some(format!(
            "the picture is white all over in 8 bits: it is as bright as white or brighter, up to {brightest:.3}; \
             make the lights or the background weaker, or give --tone reinhard"
        ));
    }
    // A part of one surface, from near, may well look flat; what has an edge in the picture is to be seen.
    let has_edge = film.color.iter().any(|color| color[3] < 1.0 - COVERED);
    (is_one && has_edge).then(|| {
        format!(
            "the picture is one colour all over in 8 bits, {:?}: what is seen differs from the rest by less than a step; \
             give it another colour, or background.color one",
            &first[..3]
        )
    })
}
