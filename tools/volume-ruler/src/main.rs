//! The ruler of the march through volumes: the same mean of points (Eq. 3) at the same places along the same camera rays, with
//! the same transfer function, in plain code for the CPU: points sorted by cell, side by side, eight at a time (AVX2).
//!
//! volume-ruler SCENE [--set KEY=VALUE]... [--threads N] [--runs N] [--cells N] [--packet N] [--every N] [--plain] [--picture FILE.exr]
#![allow(clippy::print_stdout, reason = "its results")]

mod cells;
mod direct;
mod frame;
mod gather;
mod transfer;
mod way;

use frame::{Field, How};
use kernels::layout::{VOLUME_EMISSION, VOLUME_EMITS, VOLUME_SHEPARD};
use plan::{Plan, SceneImages};
use scene::{Scene, Up};
use std::error::Error;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;
use way::Light;

const USAGE: &str = "volume-ruler SCENE [--set KEY=VALUE]... [--threads N] [--runs N] [--cells N] [--packet N] [--every N] [--plain] \
                     [--picture FILE.exr]
SCENE has only volumes that emit, of kind \"shepard\", without a boundary, before a background of one colour.
  --threads N  default 2
  --runs N     frames that are timed; the median counts; default 3
  --cells N    cells of the ruler's grid a reach; default 1
  --packet N   columns and rows of pixels for which points are sought together, a power of two; default: up to 8, within a reach
  --every N    of every N-th column and row, the error against f64; 0: of none; default 4
  --plain      without AVX2
  --picture    what pointillist rendered of the same scene, whose error is printed as well
volume-ruler --write-cube COUNT FILE.ply writes the points of the cubes of `pointillist bench volume`";

struct Args {
    scene: PathBuf,
    set: Vec<String>,
    threads: usize,
    runs: usize,
    cells: f64,
    packet: Option<u32>,
    every: u32,
    how: How,
    picture: Option<PathBuf>,
}

impl Args {
    fn read() -> Result<Self, Box<dyn Error>> {
        let mut args = Self {
            scene: PathBuf::new(),
            set: vec![],
            threads: 2,
            runs: 3,
            cells: 1.0,
            packet: None,
            every: 4,
            how: How::Fast,
            picture: None,
        };
        let mut words = std::env::args().skip(1);
        while let Some(word) = words.next() {
            let mut value = || words.next().ok_or(format!("{word} needs a value\n{USAGE}"));
            match word.as_str() {
                "--set" => args.set.push(value()?),
                "--threads" => args.threads = value()?.parse::<usize>()?.max(1),
                "--runs" => args.runs = value()?.parse::<usize>()?.max(1),
                "--cells" => args.cells = value()?.parse()?,
                "--packet" => {
                    args.packet = Some(value()?.parse::<u32>()?.clamp(1, 16).next_power_of_two())
                }
                "--every" => args.every = value()?.parse()?,
                "--picture" => args.picture = Some(value()?.into()),
                "--plain" => args.how = How::Plain,
                _ if word.starts_with('-') => {
                    return Err(format!("{word}: unknown\n{USAGE}").into());
                }
                _ => args.scene = word.into(),
            }
        }
        if args.scene.as_os_str().is_empty() { Err(USAGE.into()) } else { Ok(args) }
    }
}

fn main() -> ExitCode {
    let done = match std::env::args().skip(1).collect::<Vec<_>>().as_slice() {
        [word, count, file] if word == "--write-cube" => write_cube(count, Path::new(file)),
        _ => Args::read().and_then(|args| run(&args)),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            #[allow(clippy::print_stderr, reason = "its failure")]
            {
                eprintln!("error: {error}");
            }
            ExitCode::FAILURE
        }
    }
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    let scene = Scene::load(&args.scene, &args.set)?;
    let plan = plan_of(&scene)?;
    let field = Field::of(&plan, args.cells, args.packet);
    let (mut seconds, mut of_processors) = (Vec::new(), Vec::new());
    let mut picture = Vec::new();
    for _ in 0..args.runs {
        let begun = Instant::now();
        let (lights, _, time) = field.render(args.how, args.threads, 1);
        picture = lights;
        seconds.push(begun.elapsed().as_secs_f64());
        of_processors.push(time);
    }
    seconds.sort_by(f64::total_cmp);
    of_processors.sort_by(f64::total_cmp);
    let counted = if args.how == How::Plain { How::Plain } else { How::Counted };
    let counts = field.render(counted, args.threads, 1).1;
    let samples = counts.samples.max(1) as f64;
    let points: usize = field.cells.iter().map(|cells| cells.scalar.len() - 8).sum();
    let bytes: usize = field.cells.iter().map(cells::Cells::bytes).sum();
    println!(
        "seconds {:.3} (least {:.3}, most {:.3}, threads {}), of processors {:.3} (least {:.3}), samples {}, a sample: sought {:.1}, read {:.1}, near {:.1}, weighed {:.1}; \
         points {points}, bytes a point {:.1}",
        seconds[seconds.len() / 2],
        seconds[0],
        seconds[seconds.len() - 1],
        args.threads,
        of_processors[of_processors.len() / 2],
        of_processors[0],
        counts.samples,
        counts.sought as f64 / samples,
        counts.read as f64 / samples,
        counts.near as f64 / samples,
        counts.weighed as f64 / samples,
        bytes as f64 / points.max(1) as f64,
    );
    if args.every == 0 {
        return Ok(());
    }
    let background = scene.background.color.map(f64::from);
    let colored = |lights: &[Light]| -> Vec<[f64; 3]> {
        let through = |l: &Light| if l.is_over() { 0.0 } else { l.through };
        lights.iter().map(|l| [0, 1, 2].map(|i| l.color[i] + through(l) * background[i])).collect()
    };
    let exact = colored(&field.render(How::Direct, args.threads, args.every).0);
    let [width, height] = scene.image.size;
    let report = |name: &str, all: &[[f64; 3]]| {
        let rows = (0..height).step_by(args.every as usize);
        let places = rows.flat_map(|y| {
            (0..width).step_by(args.every as usize).map(move |x| (y * width + x) as usize)
        });
        let mut off: Vec<f64> = places
            .zip(&exact)
            .filter(|(_, exact)| exact.iter().zip(&background).any(|(a, b)| (a - b).abs() > 1e-6))
            .map(|(at, exact)| (0..3).map(|i| (all[at][i] - exact[i]).abs()).fold(0.0, f64::max))
            .collect();
        off.sort_by(f64::total_cmp);
        if let Some(most) = off.last() {
            let at = |share: f64| off[((off.len() - 1) as f64 * share) as usize];
            println!(
                "{name} against f64: median {:.2e}, 95th percentile {:.2e}, maximum {most:.2e}, of {} pixels",
                at(0.5),
                at(0.95),
                off.len()
            );
        }
    };
    report("ruler", &colored(&picture));
    if let Some(path) = &args.picture {
        report("picture", &picture_of(path, [width, height])?);
    }
    Ok(())
}

/// The points that `pointillist bench volume` makes for its cubes.
fn write_cube(count: &str, file: &Path) -> Result<(), Box<dyn Error>> {
    let count: u64 = count.parse()?;
    let mut file = BufWriter::new(File::create(file)?);
    write!(file, "ply\nformat binary_little_endian 1.0\nelement vertex {count}\n")?;
    for property in ["x", "y", "z", "density"] {
        writeln!(file, "property float {property}")?;
    }
    writeln!(file, "end_header")?;
    // From 0 to 1 (splitmix64, Steele et al. 2014).
    let random = |number: u64| {
        let mut z = (number + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    };
    for index in 0..count {
        let [x, y, z] = [0, 1, 2].map(|axis| 2.0 * random(3 * index + axis) - 1.0);
        let density = 0.5 + 0.25 * (3.0 * x + y).sin() + 0.25 * (2.0 * y - 4.0 * z).cos();
        for number in [x, y, z, density] {
            file.write_all(&(number as f32).to_le_bytes())?;
        }
    }
    Ok(file.flush()?)
}

fn plan_of(scene: &Scene) -> Result<Plan, Box<dyn Error>> {
    let read = |object: &scene::Object| {
        points::read_with(&object.points, &plan::read_options(object), &mut |_, _| {}).map(Arc::new)
    };
    let sets = scene.objects.iter().map(read).collect::<Result<Vec<_>, _>>()?;
    if scene.background.environment.is_some() || scene.background.sky.is_some() {
        return Err("background: an image or a sky; give it one colour".into());
    }
    if let Some(object) = scene.objects.iter().find(|object| object.volume.is_none()) {
        return Err(format!("{}: a surface; leave it out", object.name).into());
    }
    if scene.image.samples != 1 {
        return Err("image.samples: several; set it to 1".into());
    }
    let images = SceneImages { textures: vec![None; sets.len()], ..SceneImages::default() };
    let plan = Plan::new(scene, &sets, &images, None, Up::Y)?;
    for info in &plan.volumes.infos {
        let name = &scene.objects[info.object as usize].name;
        let lacks = |what: &str| Err(format!("{name}: the ruler does without {what}").into());
        if info.kernel != VOLUME_SHEPARD {
            return lacks("kernels but \"shepard\"");
        }
        if info.mode != VOLUME_EMISSION || info.shading != VOLUME_EMITS {
            return lacks("modes but \"emission\" and without shading");
        }
        if info.bounded != 0 {
            return lacks("a boundary; set volume.boundary to \"none\"");
        }
    }
    if plan.volumes.any_steep() {
        return Err(
            "a steep transfer function, whose steps are divided: the ruler does without".into()
        );
    }
    Ok(plan)
}

fn picture_of(path: &Path, size: [u32; 2]) -> Result<Vec<[f64; 3]>, Box<dyn Error>> {
    let picture = film::read_exr(path)?;
    if picture.data_size != size {
        return Err(
            format!("{}: {:?} pixels, not {size:?}", path.display(), picture.data_size).into()
        );
    }
    let channel = |name: &str| {
        picture.channels.get(name).ok_or(format!("{}: lacks channel {name}", path.display()))
    };
    let [r, g, b] = [channel("R")?, channel("G")?, channel("B")?];
    Ok((0..r.len()).map(|i| [r[i], g[i], b[i]].map(f64::from)).collect())
}
