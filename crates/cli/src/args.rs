//! What may be typed. Values are checked for their form here, for their range by the scene.

mod parse;
mod render;

pub use render::{Channels, Exposure, RenderArgs};

use crate::errors::Failure;
use crate::source;
use clap::builder::{ArgPredicate, PossibleValuesParser};
use clap::{Args, Parser, Subcommand, ValueEnum};
use parse::{
    parse_flip, parse_limit, parse_percent, parse_reach, parse_size, parse_threads, view_parser,
};
use scene::ViewFrom;
use std::path::{Path, PathBuf};

/// The whole command line.
#[derive(Debug, Parser)]
#[command(name = "pointillist", version, about, max_term_width = 100)]
#[command(after_help = "Exit codes: 0 done, 1 compare found a difference over a limit, 2 usage, \
    scene or input at fault, 3 the Vulkan device that was asked for is not usable, 4 the device or the machine ran out, \
    130 interrupted.")]
pub struct Arguments {
    #[command(subcommand)]
    pub command: Command,
    /// Threads that compute at once, those of Mesa's software drivers too [default: one a core]
    #[arg(long, value_name = "N", global = true, value_parser = parse_threads, allow_negative_numbers = true)]
    pub threads: Option<usize>,
    /// What stands on stderr: lines of text, or one JSON object a line
    #[arg(long, value_name = "FORMAT", global = true, value_enum, default_value_t = LogFormat::Text)]
    pub log: LogFormat,
}

/// What lines on stderr look like.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum LogFormat {
    /// As people read it
    Text,
    /// An object with time, level, event and message, see docs/running.md
    Json,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Render a scene file, or a point file as it is
    Render(Box<RenderArgs>),
    /// Measure how long suites or scenes take to render, and what changed since
    Bench(BenchArgs),
    /// Say what is in a point file, a scene file, or a picture
    Info(InfoArgs),
    /// Validate a scene without rendering it
    Check(CheckArgs),
    /// Print the JSON Schema of scene files, of suites, or of what `bench` writes
    Schema(SchemaArgs),
    /// Fill a surface with points that carry scalars, for volumes
    Fill(FillArgs),
    /// List the Vulkan devices, and say which is the default and why
    Devices,
    /// Say how far two pictures are apart, and whether that is too far
    Compare(CompareArgs),
}

#[derive(Debug, Args)]
#[command(
    after_help = "Suites are TOML files below scenes/bench/, part of the program too: --list names them. \
    Rows whose models are missing, or that do not fit into memory, are skipped and said to be. Times are \
    medians of --runs frames after one to warm up, with the least and the largest. --compare calls a time \
    faster or slower where the two ranges from least to largest do not meet; one that was measured once \
    is taken to vary by a quarter. Exit codes: 0 done, 1 --compare found a changed picture, or a frame or \
    a build that got slower beyond its spread, 2 usage or input at fault, 4 the device or the machine ran \
    out, 130 interrupted."
)]
pub struct BenchArgs {
    /// Suites, suite files, scene files or point files [default: smoke]
    #[arg(value_name = "SUITE|SCENE")]
    pub scenes: Vec<PathBuf>,
    /// List the suites and what they measure, or the rows of those that are named
    #[arg(long)]
    pub list: bool,
    /// Frames to time, after one to warm up
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=100_000), allow_negative_numbers = true)]
    pub runs: u32,
    /// Beside each build, time the neighbours and fits of the same points on the CPU with a k-d tree
    #[arg(long)]
    pub cpu_preparation: bool,
    /// Leave out rows of more generated points
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub max_points: Option<u32>,
    /// Write the results as JSON
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Write the results as Markdown tables
    #[arg(long, value_name = "FILE")]
    pub markdown: Option<PathBuf>,
    /// Draw build and trace times over the number of points
    #[arg(long, value_name = "FILE.svg")]
    pub plot: Option<PathBuf>,
    /// Say what changed since an earlier run, whose --json this is
    #[arg(long, value_name = "OLD.json")]
    pub compare: Option<PathBuf>,
    /// What a time may change by without being called a change, in percent of it
    #[arg(long, value_name = "PERCENT", default_value_t = 5.0, value_parser = parse_percent, requires = "compare", allow_negative_numbers = true)]
    pub tolerance: f64,
    #[command(flatten)]
    pub overrides: Overrides,
    #[command(flatten)]
    pub device: DeviceArgs,
    #[command(flatten)]
    pub progress: ProgressArgs,
}

#[derive(Debug, Args)]
pub struct SchemaArgs {
    /// Of what `bench --json` writes instead
    #[arg(long, conflicts_with = "suite")]
    pub bench: bool,
    /// Of suites of benchmarks instead
    #[arg(long)]
    pub suite: bool,
}

#[derive(Debug, Args)]
pub struct InfoArgs {
    /// Point file, scene file, or picture (EXR, PNG, JPEG, Radiance HDR); - is what comes through stdin
    pub file: PathBuf,
    /// What comes through stdin, if its contents leave that open: scene, or the extension that a file would have
    #[arg(long, value_name = "FORMAT", value_parser = PossibleValuesParser::new(source::FORMATS), hide_possible_values = true)]
    pub input_format: Option<String>,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
    /// Print the scene that an EXR holds in its header, as a scene file
    #[arg(long, conflicts_with = "json")]
    pub scene: bool,
    /// Folder that the scene's files are in now: paths are looked for below it, as written or by their last parts
    #[arg(long, value_name = "FOLDER")]
    pub root: Option<PathBuf>,
    /// What the columns of a point file are, from the first on, with commas between: x,y,z,_,red,green,blue;
    /// _ passes a column over
    #[arg(long, value_name = "LIST", value_parser = points::Columns::in_order)]
    pub columns: Option<points::Columns>,
    #[command(flatten)]
    pub progress: ProgressArgs,
}

#[derive(Debug, Args)]
#[command(
    after_help = "Colours of EXR and Radiance HDR files are compared as they are, linear; two PNG or \
    JPEG files by what they store, sRGB from 0 to 1; one against the other in linear light. Pixels that \
    only one file's data window has are left out. Equal infinities, and NaN on both sides, differ by 0; \
    NaN against a number is over any limit. Exit codes: 0 within the limits or none given, 1 over a \
    limit, 2 files that cannot be compared."
)]
pub struct CompareArgs {
    /// Picture to compare with, the reference of FLIP: EXR, PNG, JPEG or Radiance HDR
    pub a: PathBuf,
    /// Picture to compare, of the same size
    pub b: PathBuf,
    /// Channels or layers to compare, e.g. RGB,N,Z, with commas between; may be given several times
    /// [default: all that both files have]
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub channels: Vec<String>,
    /// Largest |a - b| that any pixel of any of these channels may have, in the channel's unit
    #[arg(long, value_name = "X", value_parser = parse_limit, allow_negative_numbers = true)]
    pub max_abs: Option<f64>,
    /// Largest root mean square of a - b that any of these channels may have, in the channel's unit
    #[arg(long, value_name = "X", value_parser = parse_limit, allow_negative_numbers = true)]
    pub rmse: Option<f64>,
    /// Compute FLIP of R, G and B of pictures of any size: HDR-FLIP, or LDR-FLIP where one is PNG or JPEG; with X, the
    /// largest mean that it may have, 0 to 1. Without this option, FLIP is computed of pictures of up to 2 megapixels
    /// (2^21 pixels), and of equal ones, where it is 0
    #[arg(long, value_name = "X", num_args = 0..=1, value_parser = parse_flip, allow_negative_numbers = true)]
    pub flip: Option<Option<f64>>,
    /// List the attributes that differ in the headers of two EXR files; one that differs is over a
    /// limit
    #[arg(long)]
    pub headers: bool,
    /// Picture of the differences to write: .png, the largest of R, G and B (of all channels where
    /// these are not compared) in false colours, from black for 0 to pale yellow for --max-abs or
    /// else the largest there is; .exr, b - a of each channel and FLIP; may be given several times
    #[arg(long = "diff", value_name = "OUT")]
    pub diffs: Vec<PathBuf>,
    /// Leave FLIP out, whatever the size
    #[arg(long, conflicts_with = "flip")]
    pub no_flip: bool,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
#[command(
    after_help = "The points of the surface come first, as they are, then those inside. `boundary` is 1 on the \
    surface and 0 inside, `depth` 0 on the surface and 1 at the deepest point, `density` whirls from 0 to 1. The same \
    file gives the same points on every machine. Coordinates are 32-bit floats, or 64-bit where these would move \
    points by a millionth of their extent. Exit codes: 0 done, 2 no usable input or nothing inside, 4 the machine ran \
    out, 130 interrupted."
)]
pub struct FillArgs {
    /// Point file of a surface, in any format that is read; - is what comes through stdin
    pub input: PathBuf,
    /// PLY file to write
    #[arg(short, long, value_name = "OUT.ply")]
    pub output: PathBuf,
    /// Points inside
    #[arg(long, value_name = "N", default_value_t = 40_000, value_parser = clap::value_parser!(u32).range(1..=10_000_000), allow_negative_numbers = true)]
    pub count: u32,
    /// Half the width of the widest hole that is closed, over the longest side of the points' box
    #[arg(long, value_name = "PART", default_value_t = 0.06, value_parser = parse_reach, allow_negative_numbers = true)]
    pub reach: f64,
    /// What the columns of a point file are, from the first on, with commas between: x,y,z,_,red,green,blue;
    /// _ passes a column over
    #[arg(long, value_name = "LIST", value_parser = points::Columns::in_order)]
    pub columns: Option<points::Columns>,
    #[command(flatten)]
    pub progress: ProgressArgs,
}

/// What the input is.
#[derive(Debug, Args)]
pub struct SourceArgs {
    /// Scene, whatever its file is called; - is one that comes through stdin, whose paths start from the working folder
    #[arg(long = "scene", id = "as_scene", value_name = "FILE", conflicts_with = "scene")]
    pub as_scene: Option<PathBuf>,
    /// What comes through stdin, if its contents leave that open: scene, or the extension that a file would have
    #[arg(long, value_name = "FORMAT", value_parser = PossibleValuesParser::new(source::FORMATS), hide_possible_values = true)]
    pub input_format: Option<String>,
}

impl SourceArgs {
    /// The path to go on with.
    pub fn resolve(&self, path: &Path) -> Result<PathBuf, Failure> {
        source::resolve(path, self.as_scene.as_deref(), self.input_format.as_deref())
    }
}

#[derive(Debug, Args)]
pub struct CheckArgs {
    /// Scene file, a picture (.exr) with the scene that it was made from, or a point file; - is what comes through stdin
    #[arg(
        value_name = "SCENE",
        required = false,
        required_unless_present = "as_scene",
        default_value_if("as_scene", ArgPredicate::IsPresent, source::PIPE)
    )]
    pub scene: PathBuf,
    #[command(flatten)]
    pub source: SourceArgs,
    /// Override one value of the scene, e.g. objects.0.surface.trust=0.7
    #[arg(long = "set", value_name = "PATH=VALUE")]
    pub set: Vec<String>,
    /// Other defaults beneath what the scene says: paper renders by the paper's own method
    #[arg(long, value_name = "NAME")]
    pub preset: Option<String>,
    /// Folder that the scene's files are in now: paths are looked for below it, as written or by their last parts
    #[arg(long, value_name = "FOLDER")]
    pub root: Option<PathBuf>,
    /// Take warnings for errors: exit with 2
    #[arg(long)]
    pub strict: bool,
    #[command(flatten)]
    pub view: ViewArgs,
    #[command(flatten)]
    pub progress: ProgressArgs,
}

/// How a scene or a point file is looked at.
#[derive(Debug, Default, Args)]
pub struct ViewArgs {
    /// Which axis of a point file points upwards [default: z of LAS, LAZ and E57 files, -y of organised PCD
    /// files, which depth cameras write, else y]
    #[arg(long, value_name = "AXIS", allow_hyphen_values = true)]
    pub up: Option<UpAxis>,
    /// Look from this side, with everything in the picture: front, back, left, right, top, bottom or iso, the
    /// corner between front, right and top
    #[arg(long, value_name = "SIDE", value_parser = view_parser())]
    pub view: Option<ViewFrom>,
    /// Show parallel lines as such, with everything in the picture
    #[arg(long)]
    pub ortho: bool,
    /// Take the camera from the header of another picture, of this program or any other
    #[arg(long, value_name = "FILE.exr", conflicts_with_all = ["up", "view", "ortho"])]
    pub camera_from: Option<PathBuf>,
}

/// Options that stand for values of the scene.
#[derive(Debug, Clone, Args)]
pub struct Overrides {
    /// Width and height of the picture in pixels
    #[arg(long, value_name = "WxH", value_parser = parse_size, allow_hyphen_values = true)]
    pub size: Option<Size>,
    /// Override one value of the scene, e.g. objects.0.surface.trust=0.7; may be given several times
    #[arg(long = "set", value_name = "PATH=VALUE")]
    pub set: Vec<String>,
    /// Cells a ray may cross in one pass: 0 lets the device decide, 1 is the paper's loop
    #[arg(long, value_name = "K", allow_negative_numbers = true)]
    pub cells_per_pass: Option<u32>,
    /// Other defaults beneath what the scene says: paper renders by the paper's own method
    #[arg(long, value_name = "NAME")]
    pub preset: Option<String>,
    /// Folder that the scene's files are in now: paths are looked for below it, as written or by their last parts
    #[arg(long, value_name = "FOLDER")]
    pub root: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub struct DeviceArgs {
    /// Device by a part of its name or by its index, see `pointillist devices`; `vulkan` is the first of these,
    /// `reference` renders on the CPU without Vulkan, `reference-f64` so in double precision [default: vulkan
    /// where there is a usable device, else reference]
    #[arg(long, value_name = "NAME|INDEX")]
    pub device: Option<String>,
}

#[derive(Debug, Args)]
pub struct ProgressArgs {
    /// Say nothing on stderr but errors
    #[arg(long)]
    pub quiet: bool,
    /// Say on stderr what was chosen where the scene leaves it to the program: lengths that are "auto", and the
    /// ranges that colour maps took
    #[arg(long, conflicts_with = "quiet")]
    pub verbose: bool,
    /// When to show progress on stderr; auto: on a terminal
    #[arg(long, value_name = "WHEN", value_enum, default_value_t = ProgressWhen::Auto)]
    pub progress: ProgressWhen,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ProgressWhen {
    Auto,
    Always,
    Never,
}

impl BenchArgs {
    /// What is to be timed.
    pub fn asked(&self) -> Vec<PathBuf> {
        if self.scenes.is_empty() { vec!["smoke".into()] } else { self.scenes.clone() }
    }
}

impl CompareArgs {
    /// The largest mean FLIP, where `--flip` gives one.
    pub fn flip_limit(&self) -> Option<f64> {
        self.flip.flatten()
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum UpAxis {
    Y,
    Z,
    #[value(name = "-y")]
    MinusY,
}

impl From<UpAxis> for scene::Up {
    fn from(axis: UpAxis) -> Self {
        match axis {
            UpAxis::Y => Self::Y,
            UpAxis::Z => Self::Z,
            UpAxis::MinusY => Self::MinusY,
        }
    }
}

/// Width and height.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Size(pub u32, pub u32);

/// What was typed, or clap's answer to it.
pub fn parse() -> Result<Arguments, clap::Error> {
    Arguments::try_parse()
}
