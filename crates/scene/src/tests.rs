//! Loading, end to end. Names are claims.

mod cameras;
mod colors;
mod damage;
mod errors;
mod files;
mod overrides;
mod reading;
mod settings;
mod volumes;

use crate::*;
use std::path::Path;

/// Everything that is built, with values that are not the defaults.
const FULL: &str = r#"# full
[camera]
eye = [0.0, 0.4, 3]
target = [0.1, 0.2, -0.3]
up = [0.0, 0.0, 2.0]
projection = "perspective"
vertical_fov = 50
aperture = 0.02
focus = 2.5

[image]
size = [320, 200]
samples = 16
filter = "triangle"
filter_width = 1.5
transparent = true

[render]
max_bounces = 3
integrator = "path"
clamp = 12.5
fresnel = "transmit"
shadows = "opaque"
cells_per_pass = 4
loop = "images"
seed = 4294967295
grid_resolution = 96
primary = "discs"
secondary = "tree"

[background]
color = [0.1, 0.2, 1e-7]
lights = false

[[lights]]
kind = "directional"
direction = [-0.4, -1.0, -0.3]
irradiance = [3.0, 2.0, 1.0]
angle = 0.53

[[lights]]
kind = "point"
position = [1.0, 2.0, 0.0]
intensity = [5.0, 6.0, 7.0]
radius = 0.25

[[objects]]
name = "the \"knot\" \\ ∂"
points = "points/knot.ply"
units = "degrees"
[objects.filter]
every = 3
box = { min = [-1, 0, 4.9e6], max = [1, 0.5, 4.9e6] }
range = { intensity = [100, 2000.5], "odd name" = [2, 2] }
classification = [2, 6]
voxel = 0.05
[objects.columns]
x = "E [m]"
y = 2
"odd name" = 7
_ = [4, 5]
[objects.transform]
scale = 2.5
rotate = [10.0, 90.0, -5.5]
translate = [0.1, 0.30000000000000004, -1e6]
[objects.surface]
neighbors = 20
polynomial = "incomplete"
feature_size = 0.25
trust = 0.75
refine = "project"
tolerance = 2e-5
max_iterations = 12
normals = "polynomial"
drop_isolated = 3.5
weight_width = 1.5
close_gaps = false
boundary_clip = false
[objects.material]
kind = "diffuse"
albedo = [0.2, 0.4, 0.6]

[[objects]]
points = "b.ply"
material.albedo = "points"

[[objects]]
points = "c.ply"
[objects.surface]
kind = "spheres"
radius = "attribute:diameter"
radius_scale = 0.5
[objects.material]
albedo = "attribute:intensity \"raw\""
color_map = "turbo"
value_range = [-1, 2.5]

[[objects]]
points = "d.ply"
material.texture = "maps/grass.png"
material.texture_axis = "uv"

[[objects]]
points = "e.ply"
material = { kind = "mirror", reflectance = [0.9, 0.8, 0.7] }

[[objects]]
points = "f.ply"
[objects.material]
kind = "glass"
ior = [1.4, 1.5, 1.6]
priority = -3
absorption = [0.0, 0.5, 2.0]
[objects.volume]
scalar = "density"
kernel = "sum"
radius = 0.05
smoothing = 0.0006
step = 0.01
boundary = "skin"
shading = "scatter"
anisotropy = 0.5
transfer = [
  { value = 0.0, color = [0.0, 0.0, 1.0], extinction = 0.0 },
  { value = 1.0, color = [1.0, 0.3, 0.0], extinction = 8.0 },
]

[[objects]]
points = "g.ply"
[objects.volume]
scalar = "u"
color_map = "magma"
value_range = [0.25, 0.75]
extinction = [0.5, 4]
mode = "maximum"

[[objects]]
points = "h.ply"
[objects.volume]
scalar = "u"
kernel = "sph"
smoothing_length = "h"
mass = 0.125
density = "rho"
mode = "average"
color_map = "gray"
extinction = 2
"#;

const SMALL: &str = "[[objects]]\npoints = \"a.ply\"\n";

fn read_with(text: &str, overrides: &[&str]) -> Result<Scene, SceneError> {
    let overrides: Vec<String> = overrides.iter().map(|&text| text.into()).collect();
    Scene::from_toml(text, Path::new("scenes/s.toml"), &overrides)
}

fn image_file(as_written: &str) -> ImageFile {
    ImageFile { path: Path::new("scenes").join(as_written), as_written: as_written.into() }
}

fn stop_count(transfer: Option<&Transfer>) -> usize {
    match transfer {
        Some(Transfer::Stops(stops)) => stops.len(),
        _ => 0,
    }
}

fn read(text: &str) -> Result<Scene, SceneError> {
    read_with(text, &[])
}

#[track_caller]
fn error_with(text: &str, overrides: &[&str]) -> String {
    match read_with(text, overrides) {
        Ok(_) => panic!("loaded, with {overrides:?}:\n{text}"),
        Err(error) => error.to_string(),
    }
}

/// The one error of a scene.
#[track_caller]
fn error(text: &str) -> String {
    error_with(text, &[])
}

/// FULL with the other projection.
fn orthographic() -> String {
    FULL.replace("\"perspective\"", "\"orthographic\"").replace("vertical_fov = 50", "height = 1.5")
}

/// Where in FULL a line stands, from 1.
fn line_of(line: &str) -> usize {
    1 + FULL.lines().position(|other| other == line).unwrap()
}

/// The one error of FULL after a replacement.
#[track_caller]
fn error_where(from: &str, to: &str) -> String {
    assert_eq!(FULL.matches(from).count(), 1, "'{from}' is not in FULL once");
    error(&FULL.replace(from, to))
}
