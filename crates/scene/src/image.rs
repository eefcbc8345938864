//! `[image]`: size and sampling of the picture.

use crate::keys::Absent::{Value, Words};
use crate::keys::{Kind, Table, count, key, numbers};
use crate::read::Reader;

/// Size and sampling of the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImageSettings {
    /// Width and height in pixels, each 1 to 16384.
    pub size: [u32; 2],
    /// Rays a pixel, 1 to 65536. 1 is a ray through each pixel's centre.
    pub samples: u32,
    /// How a pixel's samples lie about its centre, where it has several.
    pub filter: Filter,
    /// Side in pixels of the square that they lie in, 0.1 to 16; `None` is 1 for the box, 2 for the
    /// triangle and 3 for the Gaussian.
    pub filter_width: Option<f64>,
    /// Leave the background out and premultiply the colours by coverage.
    pub transparent: bool,
}

/// How a pixel's samples lie about its centre, along each axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Filter {
    /// Normally distributed, cut at three standard deviations.
    Gaussian,
    /// Thinning out evenly towards the edges.
    Triangle,
    /// Evenly.
    Box,
}

pub(crate) static IMAGE: Table = Table {
    header: "[image]",
    doc: "Size and sampling of the picture.",
    whole: None,
    keys: &[
        key("size", Kind::Size { max: 16_384 }, Value("[640, 480]"), "Width and height."),
        key(
            "samples",
            count(1, 65_536, "rays a pixel"),
            Value("1"),
            "1 is one ray through each pixel's centre, without jitter. With more, the colours and `A` \
             are means over rays about the centre, which smooths edges; `Z`, `P`, `N`, `object` and \
             diagnostics are those of one more ray, through the centre.",
        ),
        key(
            "filter",
            Kind::Choice(&["gaussian", "triangle", "box"]),
            Value("\"gaussian\""),
            "How the rays of a pixel lie about its centre along each axis, where it has several: \
             normally distributed and cut at three standard deviations, thinning out evenly, or \
             evenly.",
        ),
        key(
            "filter_width",
            Kind::Number(numbers(0.1, 16.0, "pixels")),
            Words(
                "3 for gaussian (half a pixel a standard deviation), 2 for triangle, 1 for box",
                "3.0",
            ),
            "Side of the square about the pixel's centre that its rays lie in.",
        ),
        key(
            "transparent",
            Kind::Bool,
            Value("false"),
            "Leave the background out and premultiply the colours by coverage. Behind coloured glass too, whose \
             coverage is one a channel: AR, AG, AB.",
        ),
    ],
};

impl ImageSettings {
    pub(crate) fn read(table: &Reader<'_>) -> Self {
        Self {
            size: table.counts("size"),
            samples: table.count("samples"),
            filter: match table.text("filter").as_str() {
                "triangle" => Filter::Triangle,
                "box" => Filter::Box,
                _ => Filter::Gaussian,
            },
            filter_width: table.written("filter_width").map(|_| table.number("filter_width")),
            transparent: table.flag("transparent"),
        }
    }
}

impl Default for ImageSettings {
    fn default() -> Self {
        Self::read(&Reader::defaults(&IMAGE))
    }
}
