//! A scene as canonical TOML, for the header of the pictures it makes.

use crate::{
    Albedo, Boundary, ExtinctionFactor, FeatureSize, Filter, Fresnel, GridResolution, Light,
    Material, MaterialKind, Neighbors, Normals, Object, PerParticle, PointColumn, PointColumns,
    PointFilter, Polynomial, RadiusOf, Refine, RenderSettings, Scatter, Scene, Surface,
    SurfaceKind, TextureAxis, Transfer, Units, Volume, VolumeKernel, VolumeMode, VolumeShading,
    VoxelEdge,
};
use std::fmt::{self, Write};

impl Scene {
    /// Canonical TOML of everything that changes a picture, defaults included: all but
    /// `cells_per_pass`, `loop`, `primary` and `secondary`. Loading it as the same file gives the same scene up
    /// to those four, and the same bytes again.
    pub fn settings_toml(&self) -> String {
        let mut out = String::new();
        // Writing to a string cannot fail.
        let _ = self.write_settings(&mut out);
        out
    }

    fn write_settings(&self, out: &mut String) -> fmt::Result {
        self.camera.write(self.inside.as_deref(), out)?;
        writeln!(out, "[image]")?;
        writeln!(out, "size = {:?}", self.image.size)?;
        writeln!(out, "samples = {}", self.image.samples)?;
        let filter = match self.image.filter {
            Filter::Gaussian => "gaussian",
            Filter::Triangle => "triangle",
            Filter::Box => "box",
        };
        writeln!(out, "filter = \"{filter}\"")?;
        if let Some(width) = self.image.filter_width {
            writeln!(out, "filter_width = {width:?}")?;
        }
        writeln!(out, "transparent = {}\n", self.image.transparent)?;
        write_render(out, &self.render)?;
        writeln!(out, "[background]")?;
        match &self.background.environment {
            Some(image) => {
                writeln!(out, "environment = {}", quoted(&image.as_written))?;
                writeln!(out, "rotate = {:?}", self.background.rotate)?;
            }
            None => writeln!(out, "color = {:?}", self.background.color)?,
        }
        for light in &self.lights {
            write_light(out, light)?;
        }
        for object in &self.objects {
            write_object(out, object)?;
        }
        Ok(())
    }
}

fn write_render(out: &mut String, render: &RenderSettings) -> fmt::Result {
    let fresnel = match render.fresnel {
        Fresnel::Transmit => "transmit",
        Fresnel::Sample => "sample",
    };
    writeln!(out, "[render]")?;
    writeln!(out, "max_bounces = {}", render.max_bounces)?;
    writeln!(out, "fresnel = \"{fresnel}\"")?;
    writeln!(out, "seed = {}", render.seed)?;
    match render.grid_resolution {
        GridResolution::Cells(cells) => writeln!(out, "grid_resolution = {cells}\n"),
        GridResolution::Paper => writeln!(out, "grid_resolution = \"paper\"\n"),
    }
}

fn write_light(out: &mut String, light: &Light) -> fmt::Result {
    writeln!(out, "\n[[lights]]")?;
    match light {
        Light::Directional { direction, irradiance, angle } => {
            writeln!(out, "kind = \"directional\"")?;
            writeln!(out, "direction = {direction:?}")?;
            writeln!(out, "irradiance = {irradiance:?}")?;
            writeln!(out, "angle = {angle:?}")
        }
        Light::Point { position, intensity, radius } => {
            writeln!(out, "kind = \"point\"")?;
            writeln!(out, "position = {position:?}")?;
            writeln!(out, "intensity = {intensity:?}")?;
            writeln!(out, "radius = {radius:?}")
        }
        Light::Headlight { at_target } => {
            writeln!(out, "kind = \"headlight\"")?;
            writeln!(out, "at_target = {at_target:?}")
        }
    }
}

fn write_object(out: &mut String, object: &Object) -> fmt::Result {
    writeln!(out, "\n[[objects]]")?;
    writeln!(out, "name = {}", quoted(&object.name))?;
    writeln!(out, "points = {}", quoted(&object.points_as_written))?;
    let units = match object.units {
        Units::Auto => "auto",
        Units::Degrees => "degrees",
        Units::Scene => "scene",
    };
    writeln!(out, "units = \"{units}\"")?;
    write_filter(out, &object.filter)?;
    write_columns(out, &object.columns)?;
    writeln!(out, "\n[objects.transform]")?;
    writeln!(out, "scale = {:?}", object.transform.scale)?;
    writeln!(out, "rotate = {:?}", object.transform.rotate)?;
    writeln!(out, "translate = {:?}", object.transform.translate)?;
    write_surface(out, &object.surface)?;
    write_material(out, &object.material)?;
    match &object.volume {
        Some(volume) => write_volume(out, volume),
        None => Ok(()),
    }
}

fn write_columns(out: &mut String, columns: &PointColumns) -> fmt::Result {
    if *columns == PointColumns::default() {
        return Ok(());
    }
    writeln!(out, "\n[objects.columns]")?;
    for (name, column) in &columns.named {
        match column {
            PointColumn::Name(column) => writeln!(out, "{} = {}", quoted(name), quoted(column))?,
            PointColumn::Number(number) => writeln!(out, "{} = {number}", quoted(name))?,
        }
    }
    if columns.left_out.is_empty() { Ok(()) } else { writeln!(out, "_ = {:?}", columns.left_out) }
}

fn write_filter(out: &mut String, filter: &PointFilter) -> fmt::Result {
    writeln!(out, "\n[objects.filter]")?;
    writeln!(out, "every = {}", filter.every)?;
    if !filter.ranges.is_empty() {
        let range = |(name, range): &(String, [f64; 2])| format!("{} = {range:?}", quoted(name));
        let ranges: Vec<String> = filter.ranges.iter().map(range).collect();
        writeln!(out, "range = {{ {} }}", ranges.join(", "))?;
    }
    if let Some(classes) = &filter.classes {
        writeln!(out, "classification = {classes:?}")?;
    }
    match filter.voxel {
        Some(VoxelEdge::Length(edge)) => writeln!(out, "voxel = {edge:?}")?,
        Some(VoxelEdge::Auto) => writeln!(out, "voxel = \"auto\"")?,
        None => {}
    }
    if let Some([min, max]) = filter.bounds {
        writeln!(out, "\n[objects.filter.box]\nmin = {min:?}\nmax = {max:?}")?;
    }
    Ok(())
}

fn write_volume(out: &mut String, volume: &Volume) -> fmt::Result {
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
        writeln!(out, "radius = {}", auto(volume.radius))?;
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
            VolumeShading::Scatter => "scatter",
        };
        writeln!(out, "shading = \"{shading}\"")?;
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

fn write_material(out: &mut String, material: &Material) -> fmt::Result {
    writeln!(out, "\n[objects.material]")?;
    match material.kind {
        MaterialKind::Diffuse => writeln!(out, "kind = \"diffuse\"")?,
        MaterialKind::Mirror { reflectance } => {
            writeln!(out, "kind = \"mirror\"")?;
            writeln!(out, "reflectance = {reflectance:?}")?;
        }
        MaterialKind::Glass { ior, priority, absorption } => {
            writeln!(out, "kind = \"glass\"")?;
            writeln!(out, "ior = {ior:?}")?;
            writeln!(out, "priority = {priority}")?;
            writeln!(out, "absorption = {absorption:?}")?;
        }
    }
    match &material.albedo {
        // The default depends on the points, so it has no value to write.
        Albedo::Default => Ok(()),
        Albedo::Points => writeln!(out, "albedo = \"points\""),
        Albedo::Color(color) => writeln!(out, "albedo = {color:?}"),
        Albedo::Attribute { name, color_map, range, scale } => {
            writeln!(out, "albedo = {}", quoted(&format!("attribute:{name}")))?;
            writeln!(out, "color_map = \"{}\"", color_map.name())?;
            writeln!(out, "scale = \"{}\"", scale.name())?;
            match range {
                Some(range) => writeln!(out, "value_range = {range:?}"),
                None => Ok(()),
            }
        }
        Albedo::Texture { file, axis } => {
            writeln!(out, "texture = {}", quoted(&file.as_written))?;
            let axis = match axis {
                // The default depends on the points.
                None => return Ok(()),
                Some(TextureAxis::X) => "x",
                Some(TextureAxis::Y) => "y",
                Some(TextureAxis::Z) => "z",
                Some(TextureAxis::Uv) => "uv",
            };
            writeln!(out, "texture_axis = \"{axis}\"")
        }
    }
}

fn write_surface(out: &mut String, surface: &Surface) -> fmt::Result {
    let polynomial = match surface.polynomial {
        Polynomial::Full => "full",
        Polynomial::Incomplete => "incomplete",
    };
    writeln!(out, "\n[objects.surface]")?;
    write_kind(out, &surface.kind)?;
    writeln!(out, "polynomial = \"{polynomial}\"")?;
    match surface.neighbors {
        // With one of the others it would be a number.
        Neighbors::Auto { accuracy } => {
            writeln!(out, "neighbors = \"auto\"")?;
            writeln!(out, "accuracy = {accuracy:?}")?;
            let scatter = match surface.scatter {
                Scatter::Discs => "discs",
                Scatter::Spheres => "spheres",
                Scatter::Drop => "drop",
            };
            if surface.kind == SurfaceKind::Points {
                writeln!(out, "scatter = \"{scatter}\"")?;
            }
        }
        Neighbors::Count(count) => {
            writeln!(out, "neighbors = {count}")?;
            write_fit(out, surface)?;
        }
    }
    writeln!(out, "trust = {:?}", surface.trust)?;
    let normals = match surface.normals {
        Normals::Polynomial => "polynomial",
        Normals::Blended => "blended",
    };
    writeln!(out, "normals = \"{normals}\"")?;
    writeln!(out, "drop_isolated = {:?}", surface.drop_isolated)?;
    writeln!(out, "close_gaps = {}", surface.close_gaps)?;
    writeln!(out, "boundary_clip = {}", surface.boundary_clip)
}

/// How the surface is fitted to the points where they lie.
fn write_fit(out: &mut String, surface: &Surface) -> fmt::Result {
    match surface.feature_size {
        FeatureSize::Adaptive => writeln!(out, "feature_size = \"adaptive\"")?,
        FeatureSize::Smoothed => writeln!(out, "feature_size = \"smoothed\"")?,
        FeatureSize::Constant(length) => writeln!(out, "feature_size = {length:?}")?,
    }
    match surface.refine {
        Refine::None => writeln!(out, "refine = \"none\"")?,
        Refine::Project { tolerance, max_iterations } => {
            writeln!(out, "refine = \"project\"")?;
            writeln!(out, "tolerance = {tolerance:?}")?;
            writeln!(out, "max_iterations = {max_iterations}")?;
        }
    }
    writeln!(out, "weight_width = {:?}", surface.weight_width)
}

fn write_kind(out: &mut String, kind: &SurfaceKind) -> fmt::Result {
    let (kind, radius) = match kind {
        SurfaceKind::Points => return writeln!(out, "kind = \"points\""),
        SurfaceKind::Spheres(radius) => ("spheres", radius),
        SurfaceKind::Discs(radius) => ("discs", radius),
    };
    writeln!(out, "kind = \"{kind}\"")?;
    match &radius.of {
        RadiusOf::Spacing => writeln!(out, "radius = \"auto\"")?,
        RadiusOf::LocalSpacing => writeln!(out, "radius = \"local\"")?,
        RadiusOf::Length(length) => writeln!(out, "radius = {length:?}")?,
        RadiusOf::Attribute(name) => {
            writeln!(out, "radius = {}", quoted(&format!("attribute:{name}")))?;
        }
    }
    writeln!(out, "radius_scale = {:?}", radius.scale)
}

/// A TOML basic string.
pub(crate) fn quoted(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            c if c.is_control() => out.push_str(&format!("\\u{:04X}", u32::from(c))),
            c => out.push(c),
        }
    }
    out.push('"');
    out
}
