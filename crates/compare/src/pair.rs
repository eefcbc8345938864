//! Two pictures, one over the other.

use crate::flip::Flip;
use crate::measure::{Measures, Tally};
use crate::picture::{Picture, Plane, Rect};
use rayon::prelude::*;
use std::sync::Arc;

/// Two pictures of one size. Values are compared in linear light, unless both are integers in sRGB.
#[derive(Debug, Clone)]
pub struct Pair {
    a: Arc<Picture>,
    b: Arc<Picture>,
    /// Whether either was integers in sRGB: of what is brighter than white, it knows nothing.
    on_screen: bool,
}

/// Why two pictures cannot be compared, or not so.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CompareError {
    /// The display windows have different sizes.
    #[error(
        "found a display window of {}x{} pixels against one of {}x{}, expected equal sizes; render both \
         at one --size", a[0], a[1], b[0], b[1]
    )]
    Sizes {
        /// Width and height of the first.
        a: [u32; 2],
        /// Width and height of the second.
        b: [u32; 2],
    },
    /// No name is in both.
    #[error(
        "found no channel that both have: the first has {a}, the second {b}; compare files with channels \
         of the same names"
    )]
    NoChannel {
        /// Channels of the first.
        a: String,
        /// Channels of the second.
        b: String,
    },
    /// A name that was asked for is not in both.
    #[error(
        "--channels {name}: found it {found}, expected a channel or layer that both files have: {known}; \
         leave it out or choose one of these"
    )]
    Unknown {
        /// As asked for.
        name: String,
        /// Where it is.
        found: &'static str,
        /// The channels of both.
        known: String,
    },
    /// The data windows have no pixel in common.
    #[error(
        "channel '{name}': found data windows without a common pixel, {a} and {b}; compare crops that \
         overlap"
    )]
    NoOverlap {
        /// The channel.
        name: String,
        /// Data window of the first.
        a: String,
        /// Data window of the second.
        b: String,
    },
}

/// The layer of a channel: what stands before its last dot; `RGBA` for `R`, `G`, `B` and `A`, and none
/// for any other name without a dot.
#[must_use]
pub fn layer_of(channel: &str) -> Option<&str> {
    match channel.rsplit_once('.') {
        Some((layer, _)) => Some(layer),
        None => ["R", "G", "B", "A"].contains(&channel).then_some("RGBA"),
    }
}

impl Pair {
    /// Puts `b` over `a`, upper left corners of their display windows together.
    ///
    /// # Errors
    /// Where their sizes differ or no channel is in both.
    pub fn new(a: Picture, b: Picture) -> Result<Self, CompareError> {
        if a.size != b.size {
            return Err(CompareError::Sizes { a: a.size, b: b.size });
        }
        let srgb = [&a, &b].map(|picture| picture.srgb_bits.is_some());
        let on_screen = srgb.contains(&true);
        let [a, b] = match srgb {
            [true, true] => [a, b],
            _ => [a, b].map(Picture::into_linear),
        };
        let pair = Self { a: Arc::new(a), b: Arc::new(b), on_screen };
        if pair.common().is_empty() {
            return Err(CompareError::NoChannel {
                a: listed(pair.a.channels.keys()),
                b: listed(pair.b.channels.keys()),
            });
        }
        Ok(pair)
    }

    /// A picture over itself: what two files of the same bytes are.
    ///
    /// # Errors
    /// Where it has no channel.
    pub fn same(picture: Picture) -> Result<Self, CompareError> {
        if picture.channels.is_empty() {
            return Err(CompareError::NoChannel { a: listed([""; 0]), b: listed([""; 0]) });
        }
        let on_screen = picture.srgb_bits.is_some();
        let picture = Arc::new(picture);
        Ok(Self { a: Arc::clone(&picture), b: picture, on_screen })
    }

    /// The first picture.
    #[must_use]
    pub fn a(&self) -> &Picture {
        &self.a
    }

    /// The second picture.
    #[must_use]
    pub fn b(&self) -> &Picture {
        &self.b
    }

    /// Whether values are integers in sRGB, over their largest.
    #[must_use]
    pub fn is_srgb(&self) -> bool {
        self.a.srgb_bits.is_some()
    }

    /// Names of the channels that both have: layer by layer in alphabetical order, `RGBA` first; within
    /// a layer, R, G, B and A before others.
    #[must_use]
    pub fn common(&self) -> Vec<&str> {
        let names = self.a.channels.keys().map(String::as_str);
        let mut common: Vec<&str> =
            names.filter(|name| self.b.channels.contains_key(*name)).collect();
        common.sort_by_key(|name| {
            let layer =
                if layer_of(name) == Some("RGBA") { "" } else { layer_of(name).unwrap_or(name) };
            let channel = name.rsplit('.').next().unwrap_or(name);
            let rank = ["R", "G", "B", "A"].iter().position(|known| *known == channel);
            (layer, rank.unwrap_or(4), *name)
        });
        common
    }

    /// Names of the channels that only the first has, and of those that only the second has.
    #[must_use]
    pub fn unmatched(&self) -> [Vec<&str>; 2] {
        [(&self.a, &self.b), (&self.b, &self.a)].map(|(one, other)| {
            let names = one.channels.keys().map(String::as_str);
            names.filter(|name| !other.channels.contains_key(*name)).collect()
        })
    }

    /// The common channels that `names` mean, in the order of [`common`](Self::common): channels or layers; all where no
    /// name is given.
    ///
    /// # Errors
    /// A name that means none.
    pub fn selected(&self, names: &[String]) -> Result<Vec<&str>, CompareError> {
        let common = self.common();
        if names.is_empty() {
            return Ok(common);
        }
        let means = |name: &str, channel: &str| {
            channel == name
                || layer_of(channel) == Some(name)
                || (name == "RGB" && ["R", "G", "B"].contains(&channel))
        };
        for name in names {
            let known_by =
                |picture: &Picture| picture.channels.keys().any(|channel| means(name, channel));
            if !common.iter().any(|channel| means(name, channel)) {
                let found = match (known_by(&self.a), known_by(&self.b)) {
                    (true, _) => "in the first file alone",
                    (_, true) => "in the second file alone",
                    _ => "in neither file",
                };
                let known = listed(&common);
                return Err(CompareError::Unknown { name: name.clone(), found, known });
            }
        }
        let asked = |channel: &&str| names.iter().any(|name| means(name, channel));
        Ok(common.into_iter().filter(asked).collect())
    }

    /// The pixels that both have of all these channels.
    ///
    /// # Errors
    /// Where there is none.
    pub fn region(&self, channels: &[&str]) -> Result<Rect, CompareError> {
        let mut region: Option<Rect> = None;
        for name in channels {
            let [a, b] = self.planes(name).map(|plane| plane.window);
            let no_overlap = || {
                let shown = |r: Rect| format!("{}x{} at {},{}", r.width, r.height, r.x, r.y);
                CompareError::NoOverlap { name: (*name).to_owned(), a: shown(a), b: shown(b) }
            };
            let common = a.intersection(&b).ok_or_else(no_overlap)?;
            let within = region.unwrap_or(common).intersection(&common);
            region = Some(within.ok_or_else(no_overlap)?);
        }
        Ok(region.unwrap_or(Rect { x: 0, y: 0, width: 0, height: 0 }))
    }

    /// Looks at all pixels within `region` of a channel.
    ///
    /// # Panics
    /// Where `region` leaves the channel, or the channel is not in both pictures.
    #[must_use]
    pub fn tally<'a>(&'a self, channel: &'a str, region: Rect) -> Tally<'a> {
        let planes = self.planes(channel);
        for plane in planes {
            assert!(
                plane.window.intersection(&region) == Some(region),
                "compare: the region {region:?} leaves the window {:?}",
                plane.window
            );
        }
        Tally::of(channel, planes, region)
    }

    /// Measures all pixels within `region` of these channels together.
    ///
    /// # Panics
    /// Where `region` is empty or leaves a channel, or a channel is not in both pictures.
    #[must_use]
    pub fn measure(&self, channels: &[&str], region: Rect) -> Measures {
        let tallies: Vec<Tally<'_>> =
            channels.iter().map(|channel| self.tally(channel, region)).collect();
        Measures::of(&tallies.iter().collect::<Vec<_>>())
    }

    /// The three of these channels that FLIP is of: `R`, `G` and `B`, or else those of the first layer,
    /// in alphabetical order, that has them.
    #[must_use]
    pub fn colors(&self, channels: &[&str]) -> Option<[String; 3]> {
        let layers = channels.iter().filter_map(|name| name.strip_suffix('R'));
        let named = |layer: &str| ["R", "G", "B"].map(|channel| format!("{layer}{channel}"));
        let complete = |names: &[String; 3]| names.iter().all(|n| channels.contains(&n.as_str()));
        std::iter::once("").chain(layers.filter(|l| l.ends_with('.'))).map(named).find(complete)
    }

    /// FLIP of three channels within `region`, the first picture taken as the reference: of high
    /// dynamic range unless either picture was of integers. Then also FLIP as a screen shows them, cut at white,
    /// where that is another.
    ///
    /// # Panics
    /// As [`measure`](Self::measure).
    #[must_use]
    pub fn flip(&self, colors: &[String; 3], region: Rect) -> (Flip, Option<Flip>) {
        let [a, b] = self.rgb(colors, region);
        let size = [region.width as usize, region.height as usize];
        match self.on_screen {
            true => (Flip::ldr(&a, &b, size), None),
            false => (Flip::hdr(&a, &b, size), Some(Flip::ldr(&a, &b, size))),
        }
    }

    /// Linear colours of both pictures.
    fn rgb(&self, colors: &[String; 3], region: Rect) -> [Vec<[f32; 3]>; 2] {
        let width = region.width as usize;
        [0, 1].map(|index| {
            let planes = colors.each_ref().map(|name| self.planes(name)[index]);
            let mut pixels = vec![[0.0; 3]; region.pixels()];
            let rows = pixels.par_chunks_mut(width).enumerate();
            rows.for_each_init(
                || vec![0.0; width],
                |values, (y, row)| {
                    let y = region.y + y as i64;
                    for (channel, plane) in planes.iter().enumerate() {
                        plane.samples.copy_to(plane.index(region.x, y), values);
                        for (pixel, &value) in row.iter_mut().zip(values.iter()) {
                            let linear = |v: f64| film::linear_from_srgb(v);
                            pixel[channel] =
                                if self.is_srgb() { linear(value) } else { value } as f32;
                        }
                    }
                },
            );
            pixels
        })
    }

    pub(crate) fn planes(&self, name: &str) -> [&Plane; 2] {
        [&self.a, &self.b].map(|picture: &Arc<Picture>| {
            let Some(plane) = picture.channels.get(name) else {
                unreachable!("compare: the channel '{name}' is not in both pictures")
            };
            plane
        })
    }

    /// Second less first of each channel within `region`, as planes for [`film::write_planes`]. Equal
    /// infinities and NaN on both sides give 0.
    ///
    /// # Panics
    /// As [`measure`](Self::measure).
    #[must_use]
    pub fn differences(&self, channels: &[&str], region: Rect) -> Vec<(String, Vec<f32>)> {
        let planes = channels.iter().map(|name| {
            let [a, b] = self.planes(name).map(|plane| plane.values(region));
            let less = |(a, b): (f64, f64)| match a == b || (a.is_nan() && b.is_nan()) {
                true => 0.0,
                false => (b - a) as f32,
            };
            ((*name).to_owned(), a.zip(b).map(less).collect())
        });
        planes.collect()
    }
}

fn listed(names: impl IntoIterator<Item = impl AsRef<str>>) -> String {
    let names: Vec<String> = names.into_iter().map(|name| name.as_ref().to_owned()).collect();
    if names.is_empty() { "none".to_owned() } else { names.join(", ") }
}
