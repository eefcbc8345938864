//! `[objects.volume]`: a volume made of an object's points. Its keys are in [`keys`], what several of them say together
//! is checked in [`checks`].

pub(crate) mod keys;

mod checks;

use crate::document::Value;
use crate::read::{Reader, to_number};
use crate::settings::quoted;
use crate::{ColorMap, Scale};
use keys::TRANSFER;
use std::fmt::{self, Write};

/// A volume made of an object's points (docs/method.md, section 7). Lengths are scene units.
#[derive(Debug, Clone, PartialEq)]
pub struct Volume {
    /// The points' attribute that is shown.
    pub scalar: String,
    /// How points are blended.
    pub kernel: VolumeKernel,
    /// How far a point reaches.
    pub radius: VolumeRadius,
    /// ρ of the weights exp(−d²/2ρ), a length squared; `None`: (radius/2)².
    pub smoothing: Option<f64>,
    /// Distance of the samples along a ray; `None`: radius/4.
    pub step: Option<f64>,
    /// Which points carry the object's surface.
    pub boundary: Boundary,
    /// What a ray shows.
    pub mode: VolumeMode,
    /// What each scalar looks like; of an isosurface whose material has no albedo, the colour at its
    /// scalar.
    pub transfer: Option<Transfer>,
    /// How scalars lie between the ends of a colour map's range.
    pub scale: Scale,
    /// What all extinctions of the transfer function are multiplied by.
    pub extinction: ExtinctionFactor,
    /// What the light of the scene does in it.
    pub shading: VolumeShading,
}

/// How far the points of a volume reach.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum VolumeRadius {
    /// As far as their spacing asks for: all alike where it is even, each by its own where it is not.
    Auto,
    /// Each as far as its own spacing asks for.
    Adaptive,
    /// All as far as this, 1e-12 to 1e15.
    Length(f64),
}

/// What the light of the scene does in a volume.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum VolumeShading {
    /// Nothing: colours are emitted.
    None,
    /// It is scattered by Lambert's law, as by a surface across the scalar's gradient.
    Gradient,
    /// It is scattered to all sides.
    Scatter {
        /// g of the phase function of Henyey and Greenstein, -0.99 to 0.99.
        anisotropy: f64,
    },
}

/// What a ray through a volume shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum VolumeMode {
    /// Emission and extinction along its way (\[T\] §6).
    Emission,
    /// The greatest scalar on its way, as a layer of one radius.
    Maximum,
    /// The mean scalar, all along its way.
    Average,
    /// The integral of the scalar along its way.
    Integral,
    /// The first place where the scalar is this.
    Isosurface(f64),
}

/// Colour and extinction of a scalar.
#[derive(Debug, Clone, PartialEq)]
pub enum Transfer {
    /// Linear between stops, of which there is at least one, ascending in value.
    Stops(Vec<Stop>),
    /// The colours of a map.
    Map {
        /// Which.
        color_map: ColorMap,
        /// Scalars at its ends, the second greater; the attribute's own where `None`, and of an integral, up to a bound
        /// from the data.
        range: Option<[f64; 2]>,
        /// σ at its ends, per scene unit; of an integral, the optical depth of a pixel.
        extinction: [f64; 2],
    },
}

/// What particles have, all the same or each its own.
#[derive(Debug, Clone, PartialEq)]
pub enum PerParticle {
    /// All this.
    Number(f64),
    /// Each what the attribute of this name says.
    Attribute(String),
}

/// How a volume's points are blended.
#[derive(Debug, Clone, PartialEq)]
pub enum VolumeKernel {
    /// The weighted mean (Eq. 3 of the paper).
    Shepard,
    /// The weighted sum.
    Sum,
    /// Σ (m/ρ) A W(d, h) with Monaghan's cubic spline, which ends at 2h.
    Sph {
        /// h: a number in scene units, an attribute in the file's.
        smoothing_length: PerParticle,
        /// m; `None`: m/ρ is (h/1.2)³.
        mass: Option<PerParticle>,
        /// The attribute that has ρ; `None`: Σ m W itself is shown.
        density: Option<String>,
    },
}

/// Which points of a volume carry its surface.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Boundary {
    /// None: the volume counts wherever points are in reach.
    None,
    /// All of them.
    All,
    /// Those with no neighbour on one side.
    Auto,
    /// Those whose attribute of this name is not zero.
    Attribute(String),
}

/// A stop of a transfer function.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stop {
    /// The scalar.
    pub value: f64,
    /// Emitted colour, linear RGB.
    pub color: [f64; 3],
    /// σ, per scene unit.
    pub extinction: f64,
    /// Radiance per scene unit, linear RGB, beside what `color` and `extinction` send.
    pub emission: [f64; 3],
}

/// What all extinctions of a volume are multiplied by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ExtinctionFactor {
    /// This, 0 to 1e15.
    Given(f64),
    /// What makes the optical depth across the median chord 2.
    Auto,
}

/// An optical depth through which nothing is seen.
const OPAQUE: f64 = 1e3;

impl Volume {
    pub(crate) fn read(table: &Reader<'_>) -> Self {
        let length = |name: &str| to_number(&table.value(name));
        let stops = table.tables("transfer", &TRANSFER);
        let per_particle = |name: &str| match table.value(name) {
            Value::Text(text) if text == "auto" => None,
            Value::Text(text) => Some(PerParticle::Attribute(text)),
            number => to_number(&number).map(PerParticle::Number),
        };
        Self {
            scalar: table.text("scalar"),
            kernel: match table.text("kernel").as_str() {
                "sum" => VolumeKernel::Sum,
                "sph" => VolumeKernel::Sph {
                    smoothing_length: per_particle("smoothing_length")
                        .unwrap_or_else(|| PerParticle::Attribute("auto".into())),
                    mass: per_particle("mass"),
                    density: table.written("density").map(|_| table.text("density")),
                },
                _ => VolumeKernel::Shepard,
            },
            radius: match table.value("radius") {
                Value::Text(text) if text == "adaptive" => VolumeRadius::Adaptive,
                Value::Text(_) => VolumeRadius::Auto,
                number => to_number(&number).map_or(VolumeRadius::Auto, VolumeRadius::Length),
            },
            smoothing: length("smoothing"),
            step: length("step"),
            boundary: match table.text("boundary").as_str() {
                "none" => Boundary::None,
                "all" => Boundary::All,
                "auto" => Boundary::Auto,
                name => Boundary::Attribute(name.to_owned()),
            },
            mode: match table.text("mode").as_str() {
                "maximum" => VolumeMode::Maximum,
                "average" => VolumeMode::Average,
                "integral" => VolumeMode::Integral,
                "isosurface" => VolumeMode::Isosurface(table.number("iso")),
                _ => VolumeMode::Emission,
            },
            transfer: match table.written("color_map") {
                Some(_) => Some(Transfer::Map {
                    color_map: ColorMap::read(&table.text("color_map")),
                    range: match table.written("value_range").map(|node| &node.value) {
                        Some(Value::Text(_)) | None => None,
                        Some(_) => table.written_range("value_range"),
                    },
                    // None is asked for, and none is needed, by an isosurface; an integral is opaque.
                    extinction: match table.written("extinction").map(|node| &node.value) {
                        Some(Value::Text(_)) => [1.0; 2],
                        Some(_) => table.pair("extinction"),
                        None if table.text("mode") == "integral" => [OPAQUE; 2],
                        None => [0.0; 2],
                    },
                }),
                None if stops.is_empty() => None,
                None => Some(Transfer::Stops(stops.iter().map(Stop::read).collect())),
            },
            scale: Scale::read(&table.text("scale")),
            extinction: match table.written("extinction").map(|node| &node.value) {
                Some(Value::Text(_)) => ExtinctionFactor::Auto,
                Some(number) if !stops.is_empty() => {
                    ExtinctionFactor::Given(to_number(number).unwrap_or(1.0))
                }
                _ => ExtinctionFactor::Given(1.0),
            },
            shading: match table.text("shading").as_str() {
                "gradient" => VolumeShading::Gradient,
                "scatter" => VolumeShading::Scatter { anisotropy: table.number("anisotropy") },
                _ => VolumeShading::None,
            },
        }
    }
}

impl Stop {
    pub(crate) fn read(table: &Reader<'_>) -> Self {
        Self {
            value: table.number("value"),
            color: table.written("color").map_or([0.0; 3], |_| table.vector("color")),
            extinction: table.written("extinction").map_or(0.0, |_| table.number("extinction")),
            emission: table.vector("emission"),
        }
    }
}

pub(crate) fn write_volume(out: &mut String, volume: &Volume) -> fmt::Result {
    let auto = |length: Option<f64>| length.map_or("\"auto\"".into(), |x| format!("{x:?}"));
    let kernel = match volume.kernel {
        VolumeKernel::Shepard => "shepard",
        VolumeKernel::Sum => "sum",
        VolumeKernel::Sph { .. } => "sph",
    };
    let boundary = match &volume.boundary {
        Boundary::None => "none",
        Boundary::All => "all",
        Boundary::Auto => "auto",
        Boundary::Attribute(name) => name,
    };
    writeln!(out, "\n[objects.volume]")?;
    writeln!(out, "scalar = {}", quoted(&volume.scalar))?;
    writeln!(out, "kernel = \"{kernel}\"")?;
    if let VolumeKernel::Sph { smoothing_length, mass, density } = &volume.kernel {
        let written = |what: &PerParticle| match what {
            PerParticle::Number(number) => format!("{number:?}"),
            PerParticle::Attribute(name) => quoted(name),
        };
        writeln!(out, "smoothing_length = {}", written(smoothing_length))?;
        let mass = mass.as_ref().map_or("\"auto\"".into(), written);
        writeln!(out, "mass = {mass}")?;
        if let Some(name) = density {
            writeln!(out, "density = {}", quoted(name))?;
        }
    } else {
        let radius = match volume.radius {
            VolumeRadius::Auto => "\"auto\"".into(),
            VolumeRadius::Adaptive => "\"adaptive\"".into(),
            VolumeRadius::Length(length) => format!("{length:?}"),
        };
        writeln!(out, "radius = {radius}")?;
        writeln!(out, "smoothing = {}", auto(volume.smoothing))?;
    }
    writeln!(out, "step = {}", auto(volume.step))?;
    match volume.mode {
        VolumeMode::Emission => writeln!(out, "mode = \"emission\"")?,
        VolumeMode::Maximum => writeln!(out, "mode = \"maximum\"")?,
        VolumeMode::Average => writeln!(out, "mode = \"average\"")?,
        VolumeMode::Integral => writeln!(out, "mode = \"integral\"")?,
        VolumeMode::Isosurface(iso) => {
            writeln!(out, "mode = \"isosurface\"")?;
            writeln!(out, "iso = {iso:?}")?;
        }
    }
    if volume.mode == VolumeMode::Emission {
        let shading = match volume.shading {
            VolumeShading::None => "none",
            VolumeShading::Gradient => "gradient",
            VolumeShading::Scatter { .. } => "scatter",
        };
        writeln!(out, "shading = \"{shading}\"")?;
        if let VolumeShading::Scatter { anisotropy } = volume.shading {
            writeln!(out, "anisotropy = {anisotropy:?}")?;
        }
    }
    writeln!(out, "boundary = {}", quoted(boundary))?;
    let stops = match &volume.transfer {
        None => return Ok(()),
        Some(Transfer::Stops(stops)) => stops,
        Some(Transfer::Map { color_map, range, extinction }) => {
            writeln!(out, "color_map = \"{}\"", color_map.name())?;
            if let Some(range) = range {
                writeln!(out, "value_range = {range:?}")?;
            } else if volume.mode == VolumeMode::Integral {
                writeln!(out, "value_range = \"auto\"")?;
            }
            writeln!(out, "scale = \"{}\"", volume.scale.name())?;
            return match volume.extinction {
                ExtinctionFactor::Auto => writeln!(out, "extinction = \"auto\""),
                ExtinctionFactor::Given(_) => writeln!(out, "extinction = {extinction:?}"),
            };
        }
    };
    match volume.extinction {
        ExtinctionFactor::Auto => writeln!(out, "extinction = \"auto\"")?,
        ExtinctionFactor::Given(1.0) => {}
        ExtinctionFactor::Given(factor) => writeln!(out, "extinction = {factor:?}")?,
    }
    for stop in stops {
        writeln!(out, "\n[[objects.volume.transfer]]")?;
        writeln!(out, "value = {:?}", stop.value)?;
        writeln!(out, "color = {:?}", stop.color)?;
        writeln!(out, "extinction = {:?}", stop.extinction)?;
        writeln!(out, "emission = {:?}", stop.emission)?;
    }
    Ok(())
}
