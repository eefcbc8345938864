//! What may be typed for `render`.

use super::parse::{channels_parser, parse_crop, parse_exposure, parse_samples};
use super::{DeviceArgs, Overrides, ProgressArgs, SourceArgs, ViewArgs};
use crate::errors::Failure;
use crate::point_file::ColorBy;
use crate::source::PIPE;
use clap::builder::ArgPredicate;
use clap::{Args, ValueEnum};
use film::{FileFormat, Tone, ToneCurve};
use plan::{Diagnostic, Extra};
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub struct RenderArgs {
    /// Scene file (.toml), a picture (.exr) whose header has the scene that it was made from, or a point file; then
    /// camera, light and material are chosen; - is what comes through stdin
    #[arg(
        value_name = "SCENE",
        required = false,
        required_unless_present = "as_scene",
        default_value_if("as_scene", ArgPredicate::IsPresent, PIPE)
    )]
    pub scene: PathBuf,
    #[command(flatten)]
    pub source: SourceArgs,
    /// Picture to write: .exr, .png or .jpg; - writes it to stdout, as --format says; may be given several times
    #[arg(short, long = "output", value_name = "OUT", required = true)]
    pub outputs: Vec<PathBuf>,
    /// What `-o -` writes to stdout
    #[arg(long, value_name = "FORMAT", value_enum)]
    pub format: Option<PictureFormat>,
    #[command(flatten)]
    pub overrides: Overrides,
    /// What the picture may cost. Of a point file: draft, one ray a pixel and light from lights only; good [default],
    /// several samples with a soft key light and the light of the background; best, 256 samples with light from surface to
    /// surface. Of a scene, only image.samples: 1, 16 or 256 [default: what the scene says]
    #[arg(long, value_name = "QUALITY", value_enum)]
    pub quality: Option<Quality>,
    /// Let everything stand on a ground that catches its shadow
    #[arg(long)]
    pub ground: bool,
    /// Rays a pixel
    #[arg(long, value_name = "N", value_parser = parse_samples, allow_hyphen_values = true)]
    pub samples: Option<u32>,
    /// Render only a part of the picture: column and row of its upper left pixel, from 0, then its width and height in
    /// pixels. (Points in a box are chosen by --set objects.0.filter.box)
    #[arg(long, value_name = "X,Y,W,H", value_parser = parse_crop, allow_hyphen_values = true)]
    pub crop: Option<plan::Window>,
    /// Brighten PNG and JPEG files by so many stops, each a factor of two; auto: so that what is seen of the subject is
    /// mid-grey in the mean, 0.18. EXR files hold the numbers as they are [default: auto of a point file, what the header
    /// says of a picture, 0 of a scene]
    #[arg(long, value_name = "STOPS|auto", allow_negative_numbers = true, value_parser = parse_exposure)]
    pub exposure: Option<Exposure>,
    /// Curve from radiance to PNG and JPEG files, after the exposure
    #[arg(long, value_name = "CURVE", value_enum, default_value_t = Curve::Linear)]
    pub tone: Curve,
    /// Channels to add to EXR files, with commas between; may be given several times
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = channels_parser())]
    pub channels: Vec<Channels>,
    /// Write R, G, B, A and N of EXR files in 16 bits instead of 32; all other channels stay
    #[arg(long)]
    pub half: bool,
    /// Take warnings for errors: exit with 2, before rendering where they are known by then
    #[arg(long)]
    pub strict: bool,
    #[command(flatten)]
    pub view: ViewArgs,
    /// What the columns of a point file are, from the first on, with commas between: x,y,z,_,red,green,blue;
    /// _ passes a column over
    #[arg(long, value_name = "LIST", value_parser = points::Columns::in_order)]
    pub columns: Option<points::Columns>,
    /// What colours the points of a point file: points (their own), height, intensity, or an attribute by
    /// its name [default: their own; else, where they fill a volume, the first scalar; else intensity]
    #[arg(long, value_name = "WHAT", value_parser = ColorBy::parse)]
    pub color: Option<ColorBy>,
    #[command(flatten)]
    pub device: DeviceArgs,
    /// Write what the colours mean as a picture of its own: the colour map of each object that has one, with its range
    #[arg(long, value_name = "FILE.png")]
    pub legend: Option<PathBuf>,
    /// Write times and counts of this render as JSON
    #[arg(long, value_name = "FILE.json")]
    pub stats: Option<PathBuf>,
    #[command(flatten)]
    pub progress: ProgressArgs,
}

/// What a picture on stdout is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum PictureFormat {
    Exr,
    Png,
    Jpg,
}

/// What one name of `--channels` adds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Channels {
    /// One channel, of what the render did.
    Diagnostic(Diagnostic),
    /// One or several, of what is seen.
    Extra(Extra),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Curve {
    /// Cut at white
    Linear,
    /// c / (1 + c) in each channel
    Reinhard,
    /// A film-like curve: deeper darks, a soft shoulder
    Aces,
}

/// What `--quality` says.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Quality {
    Draft,
    Good,
    Best,
}

impl From<Quality> for scene::Quality {
    fn from(quality: Quality) -> Self {
        match quality {
            Quality::Draft => Self::Draft,
            Quality::Good => Self::Good,
            Quality::Best => Self::Best,
        }
    }
}

/// What `--exposure` says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Exposure {
    /// So that the subject is mid-grey.
    Auto,
    /// Factors of two.
    Stops(f64),
}

impl RenderArgs {
    /// What an output is written as: by its extension, or by `--format` where it is stdout.
    pub fn format_of(&self, output: &Path) -> Result<FileFormat, Failure> {
        if output != Path::new(PIPE) {
            return Ok(FileFormat::from_path(output)?);
        }
        match self.format {
            Some(PictureFormat::Exr) => Ok(FileFormat::Exr),
            Some(PictureFormat::Png) => Ok(FileFormat::Png),
            Some(PictureFormat::Jpg) => Ok(FileFormat::Jpeg),
            None => Err(Failure::usage(
                "-: stdout has no extension that says what picture is meant; add --format exr, png or jpg",
            )),
        }
    }

    /// How 8-bit files are made, brightened by so many stops.
    pub fn tone(&self, exposure: f64) -> Tone {
        let curve = match self.tone {
            Curve::Linear => ToneCurve::Linear,
            Curve::Reinhard => ToneCurve::Reinhard,
            Curve::Aces => ToneCurve::Aces,
        };
        Tone { exposure, curve }
    }

    /// Whether anything was typed of how 8-bit files are made.
    pub fn asks_for_tone(&self) -> bool {
        self.exposure.is_some_and(|exposure| exposure != Exposure::Stops(0.0))
            || self.tone != Curve::Linear
    }
}
