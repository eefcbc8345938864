//! Loading, end to end. Names are claims.

use crate::keys::{Absent, Kind, SCENE, Table};
use crate::not_built::{NOT_BUILT, not_built};
use crate::*;
use std::path::{Path, PathBuf};

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
fresnel = "transmit"
cells_per_pass = 4
loop = "images"
seed = 4294967295
grid_resolution = 96
primary = "discs"
secondary = "tree"

[background]
color = [0.1, 0.2, 1e-7]

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
[objects.filter]
every = 3
box = { min = [-1, 0, 4.9e6], max = [1, 0.5, 4.9e6] }
range = { intensity = [100, 2000.5], "odd name" = [2, 2] }
classification = [2, 6]
voxel = 0.05
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

#[test]
fn every_built_key_is_read() {
    let scene = read(FULL).unwrap();
    let camera = Camera {
        eye: [0.0, 0.4, 3.0],
        target: [0.1, 0.2, -0.3],
        up: [0.0, 0.0, 2.0],
        projection: Projection::Perspective { vertical_fov: 50.0 },
        aperture: 0.02,
        focus: Some(2.5),
    };
    assert_eq!(scene.camera, Some(camera));
    let image = ImageSettings {
        size: [320, 200],
        samples: 16,
        filter: Filter::Triangle,
        filter_width: Some(1.5),
        transparent: true,
    };
    assert_eq!(scene.image, image);
    let render = RenderSettings {
        max_bounces: 3,
        fresnel: Fresnel::Transmit,
        cells_per_pass: 4,
        ray_loop: RayLoop::Images,
        seed: u32::MAX,
        grid_resolution: 96,
        primary: Primary::Discs,
        secondary: Secondary::Tree,
    };
    assert_eq!(scene.render, render);
    assert_eq!(scene.background, Background { color: [0.1, 0.2, 1e-7], environment: None });
    let lights = [
        Light::Directional {
            direction: [-0.4, -1.0, -0.3],
            irradiance: [3.0, 2.0, 1.0],
            angle: 0.53,
        },
        Light::Point { position: [1.0, 2.0, 0.0], intensity: [5.0, 6.0, 7.0], radius: 0.25 },
    ];
    assert_eq!(scene.lights, lights);
    let knot = Object {
        name: "the \"knot\" \\ ∂".into(),
        points: PathBuf::from("scenes/points/knot.ply"),
        points_as_written: "points/knot.ply".into(),
        filter: PointFilter {
            every: 3,
            bounds: Some([[-1.0, 0.0, 4.9e6], [1.0, 0.5, 4.9e6]]),
            ranges: vec![("intensity".into(), [100.0, 2000.5]), ("odd name".into(), [2.0, 2.0])],
            classes: Some(vec![2, 6]),
            voxel: Some(0.05),
        },
        transform: Transform {
            scale: 2.5,
            rotate: [10.0, 90.0, -5.5],
            translate: [0.1, 0.30000000000000004, -1e6],
        },
        surface: Surface {
            neighbors: 20,
            polynomial: Polynomial::Incomplete,
            feature_size: FeatureSize::Constant(0.25),
            trust: 0.75,
            normals: Normals::Polynomial,
            drop_isolated: 3.5,
            weight_width: 1.5,
            close_gaps: false,
            boundary_clip: false,
            refine: Refine::Project { tolerance: 2e-5, max_iterations: 12 },
        },
        material: Material { kind: MaterialKind::Diffuse, albedo: Albedo::Color([0.2, 0.4, 0.6]) },
        volume: None,
    };
    assert_eq!(scene.objects[0], knot);
    assert_eq!(scene.objects[1].material.albedo, Albedo::Points);
    let intensity = Albedo::Attribute {
        name: "intensity \"raw\"".into(),
        color_map: ColorMap::Turbo,
        range: Some([-1.0, 2.5]),
    };
    assert_eq!(scene.objects[2].material.albedo, intensity);
    let grass = Albedo::Texture { file: image_file("maps/grass.png"), axis: Some(TextureAxis::Uv) };
    assert_eq!(scene.objects[3].material.albedo, grass);
    let mirror = MaterialKind::Mirror { reflectance: [0.9, 0.8, 0.7] };
    assert_eq!(scene.objects[4].material.kind, mirror);
    let glass =
        MaterialKind::Glass { ior: [1.4, 1.5, 1.6], priority: -3, absorption: [0.0, 0.5, 2.0] };
    assert_eq!(scene.objects[5].material.kind, glass);
    let stop = |value, color, extinction| Stop { value, color, extinction };
    let volume = Volume {
        scalar: "density".into(),
        kernel: VolumeKernel::Sum,
        radius: Some(0.05),
        smoothing: Some(0.0006),
        step: Some(0.01),
        boundary: Boundary::Attribute("skin".into()),
        mode: VolumeMode::Emission,
        transfer: Some(Transfer::Stops(vec![
            stop(0.0, [0.0, 0.0, 1.0], 0.0),
            stop(1.0, [1.0, 0.3, 0.0], 8.0),
        ])),
        shading: VolumeShading::None,
    };
    assert_eq!(scene.objects[5].volume, Some(volume));
    let map = Transfer::Map {
        color_map: ColorMap::Magma,
        range: Some([0.25, 0.75]),
        extinction: [0.5, 4.0],
    };
    let volume_of = |i: usize| scene.objects[i].volume.as_ref();
    assert_eq!(volume_of(6).and_then(|volume| volume.transfer.as_ref()), Some(&map));
    let sph = VolumeKernel::Sph {
        smoothing_length: PerParticle::Attribute("h".into()),
        mass: Some(PerParticle::Number(0.125)),
        density: Some("rho".into()),
    };
    let found = scene.objects[7].volume.as_ref().map(|volume| (&volume.kernel, volume.mode));
    assert_eq!(found, Some((&sph, VolumeMode::Average)));
}

/// BK7: n_d = 1.5168, V = 64.17, and n_F − n_C = (n_d − 1)/V = 0.008054. Between its lines Cauchy's two terms
/// follow Schott's dispersion formula to 2e-4.
#[test]
fn an_abbe_number_gives_each_channel_its_index() {
    let text = format!("{SMALL}material = {{ kind = \"glass\", ior = 1.5168, abbe = 64.17 }}");
    let MaterialKind::Glass { ior, .. } = read(&text).unwrap().objects[0].material.kind else {
        panic!("no glass")
    };
    let schott = [1.515_86, 1.518_57, 1.524_08]; // at 611.4, 549.1 and 464.2 nm
    assert!((0..3).all(|i| (ior[i] - schott[i]).abs() < 2e-4), "{ior:?}");
    let several =
        format!("{SMALL}material = {{ kind = \"glass\", ior = [1.4, 1.5, 1.6], abbe = 64.17 }}");
    assert!(error(&several).contains("objects[0].material.abbe: found beside an ior of three"));
}

/// By hand: BK7 (1.5168, 64.17), n_F − n_C = 0.5168 / 64.17 = 0.0080536 and B = 0.0042173 µm²; dense flint
/// SF10 (1.72825, 28.41), 0.0256336 and 0.0134232. The indices of any two channels give A and B back.
#[test]
fn abbe_numbers_are_of_the_lines_d_f_and_c() {
    for (n_d, abbe, between, b) in
        [(1.5168, 64.17, 0.008_053_6, 0.004_217_3), (1.728_25, 28.41, 0.025_633_6, 0.013_423_2)]
    {
        let text =
            format!("{SMALL}material = {{ kind = \"glass\", ior = {n_d:?}, abbe = {abbe:?} }}");
        let MaterialKind::Glass { ior, .. } = read(&text).unwrap().objects[0].material.kind else {
            panic!("no glass")
        };
        let at = |wavelength: f64| 1.0 / (wavelength * wavelength);
        let channels = [0.6114, 0.5491, 0.4642];
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            let slope = (ior[j] - ior[i]) / (at(channels[j]) - at(channels[i]));
            let index = |wavelength: f64| ior[i] + slope * (at(wavelength) - at(channels[i]));
            assert!((slope - b).abs() < 1e-7, "B = {slope}, not {b}");
            assert!((index(0.587_56) - n_d).abs() < 1e-12, "n_d = {}", index(0.587_56));
            let found = index(0.486_13) - index(0.656_27);
            assert!((found - between).abs() < 1e-7, "n_F - n_C = {found}, not {between}");
        }
    }
}

#[test]
fn what_is_left_out_is_the_contracts_default() {
    let scene = read(SMALL).unwrap();
    assert_eq!(scene.camera, None);
    let image = ImageSettings {
        size: [640, 480],
        samples: 1,
        filter: Filter::Gaussian,
        filter_width: None,
        transparent: false,
    };
    assert_eq!(scene.image, image);
    assert_eq!((scene.render.max_bounces, scene.render.fresnel), (8, Fresnel::Transmit));
    assert_eq!((scene.render.cells_per_pass, scene.render.ray_loop), (0, RayLoop::Auto));
    assert_eq!((scene.render.seed, scene.render.grid_resolution), (0, 0));
    assert_eq!(scene.render.primary, Primary::Auto);
    assert_eq!(scene.render.secondary, Secondary::Auto);
    assert_eq!((scene.background.color, scene.lights.len()), ([0.0; 3], 0));
    let object = &scene.objects[0];
    assert_eq!((object.name.as_str(), object.transform), ("a", Transform::IDENTITY));
    let surface = Surface {
        neighbors: 16,
        polynomial: Polynomial::Full,
        feature_size: FeatureSize::Adaptive,
        trust: 0.6,
        normals: Normals::Blended,
        drop_isolated: 0.0,
        weight_width: 1.0,
        close_gaps: true,
        boundary_clip: true,
        refine: Refine::None,
    };
    assert_eq!((object.surface, &object.material.albedo), (surface, &Albedo::Default));
    assert_eq!(object.surface, Surface::default());
    assert_eq!(object.material, Material::default());
    assert_eq!(object.transform, Transform::default());
    assert_eq!((scene.image, scene.render), (ImageSettings::default(), RenderSettings::default()));
    let camera = "[camera]\neye = [0, 0, 1]\ntarget = [0, 0, 0]\n";
    let camera = read(&format!("{camera}{SMALL}")).unwrap().camera.unwrap();
    assert_eq!(camera.up, [0.0, 1.0, 0.0]);
    assert_eq!(camera.projection, Projection::Perspective { vertical_fov: 35.0 });
    assert_eq!((camera.aperture, camera.focus), (0.0, None));
}

/// The example of the contract uses everything that is planned.
#[test]
fn contract_example_loads() {
    let text = r#"
[camera]
eye = [0.0, 0.4, 3.0]
target = [0.0, 0.0, 0.0]
up = [0.0, 1.0, 0.0]
vertical_fov = 35.0            # degrees; square pixels; row 0 at the top
[image]
size = [640, 480]
samples = 1                    # a pixel; 1 = one ray through each pixel's centre, no jitter
[render]
max_bounces = 8                # surface interactions after the primary hit
fresnel = "transmit"           # or "sample"
cells_per_pass = 0
loop = "auto"
seed = 0
[background]
color = [0.6, 0.7, 0.9]        # or: environment = "sky.exr"
[[lights]]
kind = "directional"           # direction = the way the light travels
direction = [-0.4, -1.0, -0.3]
irradiance = [3.0, 3.0, 3.0]
[[lights]]
kind = "point"
position = [1.0, 2.0, 0.0]
intensity = [5.0, 5.0, 5.0]
[[objects]]
name = "knot"
points = "points/knot.ply"
[objects.transform]            # scale, then rotate (degrees about x, y, z in that order)
scale = 1.0
rotate = [0.0, 90.0, 0.0]
translate = [0.0, 0.0, 0.0]
[objects.surface]              # method.md §1 and §2
neighbors = 16
polynomial = "full"            # or "incomplete"
feature_size = "adaptive"      # or a length
trust = 0.6                    # b / h
refine = "none"                # or "project" (with tolerance, max_iterations)
close_gaps = true
[objects.material]
kind = "glass"                 # "diffuse", "mirror", "glass"
albedo = [0.8, 0.8, 0.8]
texture = "grass.png"
texture_axis = "y"
reflectance = [1.0, 1.0, 1.0]  # mirror
ior = [1.50, 1.52, 1.54]       # glass: one number, or one a channel
priority = 0                   # which of overlapping media counts (method.md §4)
absorption = [0.0, 0.1, 0.2]   # glass
[objects.volume]               # method.md §5; leave the table out for a pure surface
scalar = "density"             # name of the points' attribute
radius = 0.05                  # or "auto"
smoothing = 0.0006             # or "auto"
step = 0.01                    # or "auto"
boundary = "boundary"
transfer = [                   # stops, ascending in value
  { value = 0.0, color = [0.0, 0.0, 1.0], extinction = 0.0 },
  { value = 1.0, color = [1.0, 0.3, 0.0], extinction = 8.0 },
]
"#;
    let scene = read(text).unwrap();
    assert_eq!(
        scene.objects[0].volume.as_ref().map(|volume| stop_count(volume.transfer.as_ref())),
        Some(2)
    );
}

#[test]
fn a_volume_says_once_what_a_scalar_looks_like() {
    let with = |keys: &str| format!("{SMALL}[objects.volume]\nscalar = \"s\"\n{keys}");
    let stops = "transfer = [{ value = 0, color = [1, 1, 1], extinction = 1 }]\n";
    let cases = [
        (String::new(), "transfer: missing, and so is color_map"),
        (format!("{stops}color_map = \"gray\""), "color_map: found both transfer and color_map"),
        ("color_map = \"gray\"".into(), "extinction: missing, expected the extinction"),
        (format!("{stops}value_range = [0, 1]"), "value_range: belongs to color_map"),
        (format!("{stops}extinction = 1"), "extinction: belongs to color_map"),
        (format!("{stops}iso = 1"), "iso: belongs to mode \"isosurface\""),
        (format!("{stops}mass = 1"), "mass: belongs to kernel \"sph\""),
        (format!("{stops}mode = \"isosurface\""), "iso: missing"),
        ("mode = \"isosurface\"\niso = 1\nboundary = \"all\"".into(), "boundary: found \"all\""),
        (
            "mode = \"isosurface\"\niso = 0\nkernel = \"sum\"".into(),
            "iso: found 0, expected more than 0",
        ),
        (
            "mode = \"isosurface\"\niso = 1\nshading = \"scatter\"".into(),
            "shading: belongs to mode \"emission\"",
        ),
    ];
    for (keys, expected) in cases {
        let found = error(&with(&keys));
        assert!(found.contains(&format!("objects[0].volume.{expected}")), "{found}");
    }
    let constant = with("color_map = \"gray\"\nextinction = 2.5");
    let scene = read(&constant).unwrap();
    let map = Transfer::Map { color_map: ColorMap::Gray, range: None, extinction: [2.5, 2.5] };
    let volume = scene.objects[0].volume.as_ref();
    assert_eq!(volume.and_then(|volume| volume.transfer.as_ref()), Some(&map));
}

#[test]
fn a_transfer_function_comes_from_a_file_of_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("a.ply", "");
    write(
        "hot.toml",
        "transfer = [\n  { value = 1, color = [1, 0, 0], extinction = 2 },\n  { value = 3, color = [1, 1, 0], \
         extinction = 4 },\n]\n",
    );
    let text = format!("{SMALL}[objects.volume]\nscalar = \"s\"\ntransfer = \"hot.toml\"\n");
    write("s.toml", &text);
    let scene_file = folder.path().join("s.toml");
    let scene = Scene::load(&scene_file, &[]).unwrap();
    let stop = |value, color, extinction| Stop { value, color, extinction };
    let stops = vec![stop(1.0, [1.0, 0.0, 0.0], 2.0), stop(3.0, [1.0, 1.0, 0.0], 4.0)];
    let found = scene.objects[0].volume.as_ref().and_then(|volume| volume.transfer.clone());
    assert_eq!(found, Some(Transfer::Stops(stops)));
    // A picture's settings do not depend on the file.
    let settings = scene.settings_toml();
    assert!(settings.contains("value = 3.0") && !settings.contains("hot.toml"), "{settings}");

    let cases = [
        (
            "transfer = [\n  { value = 1, color = [1, 0, 0], extinction = -2 },\n]",
            "hot.toml:2:",
            "found -2, expected a number from 0",
        ),
        (
            "transfer = [{ value = 2, color = [1, 0, 0], extinction = 2 }, { value = 1, color = [1, 0, 0], \
          extinction = 2 }]",
            "hot.toml:1:",
            "expected stops that ascend",
        ),
        ("stops = []", "hot.toml:1:", "unknown key"),
        ("transfer = [", "hot.toml:1:", "not valid TOML"),
    ];
    for (text, place, expected) in cases {
        write("hot.toml", text);
        let found = Scene::load(&scene_file, &[]).unwrap_err().to_string();
        assert!(found.contains(place) && found.contains(expected), "{found}");
    }
    std::fs::remove_file(folder.path().join("hot.toml")).unwrap();
    let found = Scene::load(&scene_file, &[]).unwrap_err().to_string();
    assert!(found.contains("s.toml:5:") && found.contains("found no file at"), "{found}");
}

#[test]
fn filters_are_checked() {
    for (set, expected) in [
        ("every=0", "objects[0].filter.every: found 0, expected an integer from 1 to 4294967295"),
        ("every=1.5", "objects[0].filter.every: found 1.5, expected an integer"),
        ("evry=2", "objects[0].filter.evry: unknown key; did you mean 'every'?"),
        ("box={ min = [0, 0, 0] }", "objects[0].filter.box.max: missing, expected three numbers"),
        (
            "box={ min = [0, 0, 0], max = [1, -1, 1] }",
            "objects[0].filter.box.max: found -1 along y, expected at least min's, 0; raise it",
        ),
        ("box.min=[2, 0, 4.9e6]", "objects[0].filter.box.max: found 1 along x"),
        ("range=3", "objects[0].filter.range: found 3, expected a table of names, each with two"),
        ("range={ z = 3 }", "objects[0].filter.range.z: found 3, expected two numbers"),
        ("range={ z = [1, 2, 3] }", "filter.range.z: found a list of 3, expected two numbers"),
        ("range.z=[2, 1]", "filter.range.z: found a list of 2, expected two numbers"),
        ("range={ z = [0, inf] }", "objects[0].filter.range.z[1]: found inf, expected a number"),
        ("classification=2", "objects[0].filter.classification: found 2, expected a list of 1 to"),
        ("classification=[]", "objects[0].filter.classification: found a list of 0, expected"),
        ("classification=[256]", "classification[0]: found 256, expected an integer from 0 to 255"),
        ("voxel=0", "objects[0].filter.voxel: found 0, expected a number from 1e-12 to 1e15 units"),
        ("voxel=\"auto\"", "objects[0].filter.voxel: found the string \"auto\", expected a number"),
    ] {
        let error = error_with(FULL, &[&format!("objects.0.filter.{set}")]);
        assert!(error.contains(expected), "{error}\nlacks {expected}");
    }
    let set = ["objects.1.filter.every=10", "objects.1.filter.range.z=[0, 1]"];
    let filter = &read_with(FULL, &set).unwrap().objects[1].filter;
    assert_eq!((filter.every, filter.ranges.len(), filter.voxel), (10, 1, None));
}

#[test]
fn not_built_list_names_keys_that_exist() {
    for entry in NOT_BUILT {
        let mut table = &SCENE;
        for part in entry.path.split('.') {
            let key = table.key(part).unwrap_or_else(|| panic!("{} is no key", entry.path));
            if let Kind::Table(inner) | Kind::Tables { table: inner, .. } = key.kind {
                table = inner;
            }
        }
    }
}

#[test]
fn unknown_keys_name_the_place_and_the_nearest_key() {
    let found = error_where("neighbors = 20", "neighbours = 20");
    let expected = format!(
        "scenes/s.toml:{}:1: objects[0].surface.neighbours: unknown key; did you mean 'neighbors'?",
        line_of("neighbors = 20")
    );
    assert_eq!(found, expected);
    for (set, name) in [
        ("camera.fov=30", "vertical_fov"),
        ("camera.Eye=[0,0,0]", "eye"),
        ("background.colour=[0,0,0]", "color"),
        ("light=1", "lights"),
        ("render.bounces=1", "max_bounces"),
    ] {
        let error = error_with(FULL, &[set]);
        assert!(error.ends_with(&format!("unknown key; did you mean '{name}'?")), "{error}");
    }
}

#[test]
fn unknown_keys_far_from_any_list_the_known_and_name_another_tables() {
    let error_far = error_with(FULL, &["background.zzzzzz=1"]);
    assert!(error_far.ends_with("unknown key; [background] has color, environment"), "{error_far}");
    let error = error_with(FULL, &["render.size=[1, 1]"]);
    assert!(error.contains("it belongs to [image], while [render] has max_bounces"), "{error}");
    assert!(error_with(FULL, &["objects.0.scale=2"]).contains("it belongs to [objects.transform]"));
}

#[test]
fn error_says_where_what_expected_and_what_to_do() {
    let error = error_where("trust = 0.75", "  trust =   1.7 # b/h");
    let expected = format!(
        "scenes/s.toml:{}:13: objects[0].surface.trust: found 1.7, expected a number from 0.5 to 1; \
         lower it or leave it out (default 0.6)",
        line_of("trust = 0.75")
    );
    assert_eq!(error, expected);
}

#[test]
fn values_of_the_wrong_type_length_or_range_are_errors() {
    for (from, to, path, expected) in [
        ("trust = 0.75", "trust = \"a\"", "objects[0].surface.trust", "a number from 0.5 to 1"),
        ("trust = 0.75", "trust = nan", "objects[0].surface.trust", "write a finite number"),
        ("trust = 0.75", "trust = -inf", "objects[0].surface.trust", "write a finite number"),
        ("trust = 0.75", "trust = 1e999", "objects[0].surface.trust", "write a finite number"),
        ("trust = 0.75", "trust = 0.49", "objects[0].surface.trust", "raise it"),
        ("trust = 0.75", "trust = 1979-05-27", "objects[0].surface.trust", "found the date"),
        ("neighbors = 20", "neighbors = 2", "objects[0].surface.neighbors", "3 to 64 points"),
        ("neighbors = 20", "neighbors = 65", "objects[0].surface.neighbors", "lower it"),
        ("neighbors = 20", "neighbors = 16.0", "objects[0].surface.neighbors", "an integer"),
        ("seed = 4294967295", "seed = 4294967296", "render.seed", "0 to 4294967295"),
        ("seed = 4294967295", "seed = -1", "render.seed", "raise it"),
        ("grid_resolution = 96", "grid_resolution = 1025", "render.grid_resolution", "0 to 1024"),
        ("size = [320, 200]", "size = [320, 0]", "image.size[1]", "from 1 to 16384 pixels"),
        ("size = [320, 200]", "size = [16385, 1]", "image.size[0]", "lower it"),
        ("size = [320, 200]", "size = [320.0, 200]", "image.size[0]", "an integer"),
        ("size = [320, 200]", "size = [320]", "image.size", "found a list of 1"),
        ("size = [320, 200]", "size = \"320x200\"", "image.size", "two integers"),
        ("samples = 16", "samples = 0", "image.samples", "1 to 65536 rays a pixel"),
        ("transparent = true", "transparent = 1", "image.transparent", "true or false"),
        ("vertical_fov = 50", "vertical_fov = 180", "camera.vertical_fov", "179 degrees"),
        ("vertical_fov = 50", "vertical_fov = 0", "camera.vertical_fov", "0.001"),
        ("eye = [0.0, 0.4, 3]", "eye = [0.0, nan, 3]", "camera.eye[1]", "finite"),
        ("eye = [0.0, 0.4, 3]", "eye = [0.0, 3]", "camera.eye", "three numbers"),
        ("eye = [0.0, 0.4, 3]", "eye = [0, 0, 1e300]", "camera.eye[2]", "to 1e15 scene units"),
        ("up = [0.0, 0.0, 2.0]", "up = [0, 0, 0]", "camera.up", "not all zero"),
        ("color = [0.1, 0.2, 1e-7]", "color = [0, -1, 0]", "background.color[1]", "raise it"),
        ("irradiance = [3.0, 2.0, 1.0]", "irradiance = [0, 0, -1]", "lights[0].irradiance[2]", ""),
        ("intensity = [5.0, 6.0, 7.0]", "intensity = [-5, 0, 0]", "lights[1].intensity[0]", ""),
        ("direction = [-0.4, -1.0, -0.3]", "direction = [0, 0.0, -0.0]", "lights[0].direction", ""),
        ("direction = [-0.4, -1.0, -0.3]", "direction = [0, 0, 1e-200]", "lights[0].direction", ""),
        ("scale = 2.5", "scale = 0", "objects[0].transform.scale", "from 1e-12"),
        ("scale = 2.5", "scale = -1", "objects[0].transform.scale", "raise it"),
        ("feature_size = 0.25", "feature_size = 0", "objects[0].surface.feature_size", "or"),
        ("feature_size = 0.25", "feature_size = []", "objects[0].surface.feature_size", "or"),
        (
            "albedo = [0.2, 0.4, 0.6]",
            "albedo = [0.2, 0.4, 1.6]",
            "objects[0].material.albedo[2]",
            "",
        ),
        ("albedo = [0.2, 0.4, 0.6]", "albedo = \"\"", "objects[0].material.albedo", "\"points\""),
        ("points = \"points/knot.ply\"", "points = 3", "objects[0].points", "a point file"),
        ("points = \"points/knot.ply\"", "points = \" \"", "objects[0].points", "a point file"),
    ] {
        let error = error_where(from, to);
        assert!(error.starts_with("scenes/s.toml:"), "{error}");
        assert!(error.contains(&format!(": {path}: found ")), "{to}: {error}");
        assert!(error.contains(expected), "{to}: {error}");
        assert!(!error.contains('\n'), "{error}");
    }
}

#[test]
fn integers_beyond_64_bits_are_out_of_range_not_wrapped() {
    for digits in ["18446744073709551616", "-99999999999999999999999999999999999999999999999999"] {
        let error = error_where("max_bounces = 3", &format!("max_bounces = {digits}"));
        assert!(error.contains("render.max_bounces: found "), "{error}");
    }
}

#[test]
fn unknown_choices_suggest_the_nearest() {
    let error = error_where("kind = \"diffuse\"", "kind = \"glas\"");
    assert!(error.ends_with("did you mean \"glass\"?"), "{error}");
    let error = error_where("loop = \"images\"", "loop = \"xyz\"");
    assert!(error.contains("expected \"images\", \"queue\" or \"auto\"; write e.g. "), "{error}");
}

#[test]
fn tables_and_lists_are_told_apart() {
    let error_list = error(&format!("[[camera]]\n{SMALL}"));
    assert!(error_list.contains("camera: found a list of 1, expected a table; write [camera]"));
    let error_table = error("[objects]\npoints = \"a.ply\"\n");
    assert!(error_table.contains("objects: found a table, expected a list"), "{error_table}");
    assert!(error_table.ends_with("write [[objects]]"), "{error_table}");
}

#[test]
fn a_scene_needs_an_object_and_an_object_its_points() {
    for text in ["", "\u{feff}", "# nothing\n", "[image]\nsize = [1, 1]\n"] {
        let error = error(text);
        assert!(error.starts_with("scenes/s.toml:1:1: objects: missing"), "{error}");
        assert!(error.contains("[[objects]]"), "{error}");
    }
    assert!(error("objects = []").contains("1:11: objects: found a list of 0"));
    let error = error("[[objects]]\nname = \"a\"\n");
    assert!(error.starts_with("scenes/s.toml:1:1: objects[0].points: missing"), "{error}");
}

#[test]
fn light_keys_belong_to_their_kind() {
    let error_point = error_where("direction = [-0.4, -1.0, -0.3]", "position = [1, 1, 1]");
    assert!(error_point.contains("lights[0].direction: missing"), "{error_point}");
    assert!(error_point.contains("lights[0].position: belongs to kind \"point\""), "{error_point}");
    let error_kind = error_where("kind = \"point\"\n", "");
    assert!(error_kind.contains("lights[1].kind: missing"), "{error_kind}");
}

#[test]
fn a_camera_needs_a_view() {
    let error_same = error_where("target = [0.1, 0.2, -0.3]", "target = [0, 0.4, 3]");
    assert!(error_same.contains(":4:10: camera.target: found 0 scene units"), "{error_same}");
    let error_up = error_where("up = [0.0, 0.0, 2.0]", "up = [-1, 2, 33]");
    assert!(error_up.contains("camera.up: found a direction parallel"), "{error_up}");
    let error_up = error_with(SMALL, &["camera={ eye = [0, 5, 0], target = [0, 0, 0] }"]);
    assert!(error_up.contains("camera.up: found a direction parallel"), "{error_up}");
    let error_eye = error_where("eye = [0.0, 0.4, 3]\n", "");
    assert!(error_eye.contains(":2:1: camera.eye: missing"), "{error_eye}");
}

#[test]
fn each_projection_has_its_own_extent() {
    let scene = read(&orthographic()).unwrap();
    let camera = scene.camera.unwrap();
    assert_eq!(camera.projection, Projection::Orthographic { height: 1.5 });
    // What it writes, it reads.
    let again = Scene::from_toml(&scene.settings_toml(), Path::new("scenes/s.toml"), &[]).unwrap();
    assert_eq!(again.camera, Some(camera));
    let missing = error(&orthographic().replace("height = 1.5\n", ""));
    assert!(missing.contains("camera.height: missing, expected the height"), "{missing}");
    let foreign = error(&orthographic().replace("height = 1.5", "vertical_fov = 50"));
    assert!(foreign.contains("camera.vertical_fov: belongs to projection \"perspective\""));
    let foreign = error_where("vertical_fov = 50", "height = 1.5");
    assert!(foreign.contains("camera.height: belongs to projection \"orthographic\""), "{foreign}");
    assert!(error_with(FULL, &["camera.projection=fisheye"]).contains("camera.projection: found"));
}

#[test]
fn a_lens_is_not_much_wider_than_its_focus_is_far() {
    let wide = error_with(FULL, &["camera.aperture=2501"]);
    assert!(wide.contains("camera.aperture: found 2501 scene units with a focus at 2.5"), "{wide}");
    assert!(read_with(FULL, &["camera.aperture=2500"]).is_ok());
    let near = error_with(FULL, &["camera.focus=0"]);
    assert!(near.contains("camera.focus: found 0, expected a number from 1e-12"), "{near}");
}

#[test]
fn all_problems_are_reported_in_the_order_of_the_file() {
    let text = FULL.replace("trust = 0.75", "trust = 7").replace("seed = ", "sead = ");
    let error = read_with(&text, &["image.samples=0"]).unwrap_err();
    let keys = ["render.sead", "objects[0].surface.trust", "--set image.samples=0: image.samples"];
    assert_eq!(error.lines().len(), keys.len(), "{error}");
    for (line, key) in error.lines().iter().zip(keys) {
        assert!(line.contains(key), "{error}");
    }
    let many = format!("{SMALL}{}", (0..50).map(|i| format!("a{i} = 1\n")).collect::<String>());
    assert!(error_with(&many, &[]).ends_with("scenes/s.toml: and 30 more"));
}

#[test]
fn syntax_errors_have_line_and_column() {
    let error_syntax = error("[image]\n∂ = \"a\"\n");
    assert!(error_syntax.starts_with("scenes/s.toml:2:1: not valid TOML: "), "{error_syntax}");
    let error_open = error("[image]\nsize = [1, 2\n");
    assert!(error_open.starts_with("scenes/s.toml:"), "{error_open}");
    let error_twice = error("[image]\nsamples = 1\n  samples = 1\n");
    assert!(error_twice.starts_with("scenes/s.toml:3:3: "), "{error_twice}");
}

#[test]
fn columns_count_characters() {
    let error = error("objects = [{ name = \"∂∂\", point = \"a\" }]");
    assert!(error.contains("s.toml:1:27: objects[0].point: unknown key"), "{error}");
}

#[test]
fn deep_nesting_is_an_error_not_a_stack_overflow() {
    let deep = 200_000;
    for text in [
        format!("a = {}", "[".repeat(deep)),
        format!("a = {}1{}", "[".repeat(deep), "]".repeat(deep)),
        format!("a = {}", "{a=".repeat(deep)),
        format!("{}a = 1", "a.".repeat(deep)),
        format!("[{}a]", "a.".repeat(deep)),
    ] {
        assert!(read(&text).is_err());
        assert!(read_with(SMALL, &[&text]).is_err());
    }
}

#[test]
fn overrides_reach_every_kind_of_place() {
    let scene = read_with(
        SMALL,
        &[
            "objects.0.surface.trust=0.7",
            "objects.0.surface.polynomial=incomplete",
            "objects.0.surface.feature_size = 3",
            "objects.0.material.albedo=[0, 0.5, 1]",
            "objects.0.name=a b",
            "image.size.1=100",
            "camera={ eye = [0, 0, 3], target = [0, 0, 0] }",
            "camera.up.0=0.5",
            "lights=[{ kind = 'point', position = [0, 0, 0], intensity = [1, 1, 1] }]",
            "lights.0.intensity.2=9",
        ],
    );
    let scene = scene.unwrap();
    assert_eq!(scene.objects[0].surface.trust, 0.7);
    assert_eq!(scene.objects[0].surface.polynomial, Polynomial::Incomplete);
    assert_eq!(scene.objects[0].surface.feature_size, FeatureSize::Constant(3.0));
    assert_eq!(scene.objects[0].material.albedo, Albedo::Color([0.0, 0.5, 1.0]));
    assert_eq!(scene.objects[0].name, "a b");
    assert_eq!(scene.image.size, [640, 100], "the other element is the default");
    assert_eq!(scene.camera.unwrap().up, [0.5, 1.0, 0.0]);
    let light = Light::Point { position: [0.0; 3], intensity: [1.0, 1.0, 9.0], radius: 0.0 };
    assert_eq!(scene.lights, [light]);
}

#[test]
fn later_overrides_win() {
    let scene = read_with(FULL, &["render.seed=1", "render.seed=2"]).unwrap();
    assert_eq!(scene.render.seed, 2);
}

#[test]
fn errors_in_overrides_name_the_override() {
    let error = error_with(FULL, &["objects.0.surface.trust=1.7"]);
    let expected = "scenes/s.toml: --set objects.0.surface.trust=1.7: objects[0].surface.trust: \
                    found 1.7, expected a number from 0.5 to 1; \
                    lower it or leave it out (default 0.6)";
    assert_eq!(error, expected);
    for (set, expected) in [
        ("objects.8.name=a", "objects: found index '8', but the list has 8"),
        ("objects.-1.name=a", "use 0 to 7"),
        ("objects.name=a", "found index 'name'"),
        ("render.seed.x=1", "render.seed: found 4294967295, which has no 'x'"),
        ("image.size.2=1", "image.size: found index '2'"),
        ("image.size", "found no '=', expected PATH=VALUE"),
        ("=3", "empty part"),
        ("a..b=3", "empty part"),
        (".a=3", "empty part"),
        ("image.sixe=[1, 1]", "image.sixe: unknown key; did you mean 'size'?"),
        ("objects.0.points=", "objects[0].points: found the string \"\""),
        ("image.size=[1, 2", "image.size: found the string \"[1, 2\""),
    ] {
        let error = error_with(FULL, &[set]);
        assert!(error.starts_with(&format!("scenes/s.toml: --set {set}: ")), "{error}");
        assert!(error.contains(expected), "{set}: {error}");
    }
    assert!(error_with(SMALL, &["lights.0.kind=point"]).contains("lights: found index '0'"));
}

#[test]
fn settings_parse_to_the_same_scene_and_the_same_bytes() {
    let mut scene = read(FULL).unwrap();
    let settings = scene.settings_toml();
    let again = read(&settings).unwrap();
    (scene.render.cells_per_pass, scene.render.ray_loop) = (0, RayLoop::Auto);
    scene.render.primary = Primary::Auto;
    scene.render.secondary = Secondary::Auto;
    assert_eq!(again, scene);
    assert_eq!(again.settings_toml(), settings);
    let small = read(SMALL).unwrap();
    assert_eq!(read(&small.settings_toml()), Ok(small));
}

#[test]
fn settings_state_every_built_key() {
    fn names(table: &Table, path: &str, out: &mut Vec<(&'static str, String)>) {
        for key in table.keys {
            let path = check::joined(path, key.name);
            match key.kind {
                _ if not_built(&path).is_some() => {}
                Kind::Table(inner) | Kind::Tables { table: inner, .. } => names(inner, &path, out),
                _ => out.push((key.name, path)),
            }
        }
    }
    let mut keys = Vec::new();
    names(&SCENE, "", &mut keys);
    // No camera has the keys of both projections.
    let mut settings =
        read(FULL).unwrap().settings_toml() + &read(&orthographic()).unwrap().settings_toml();
    // Instead of the colour that FULL has.
    let sky = read(&format!("background.environment = \"sky.exr\"\n{SMALL}"));
    settings += &sky.unwrap().settings_toml();
    // Instead of a volume along the way.
    let iso = "[objects.volume]\nscalar = \"s\"\nmode = \"isosurface\"\niso = 0.5\n";
    settings += &read(&format!("{SMALL}{iso}")).unwrap().settings_toml();
    for (name, path) in keys {
        let stated = settings.lines().any(|line| line.starts_with(&format!("{name} = ")));
        // Four change no picture; the Abbe number is in the indices.
        let unseen = [
            "render.cells_per_pass",
            "render.loop",
            "render.primary",
            "render.secondary",
            "objects.material.abbe",
        ]
        .contains(&path.as_str());
        assert_eq!(stated, !unseen, "{path}");
    }
}

#[test]
fn settings_keep_every_bit_of_a_number() {
    let mut scene = read(FULL).unwrap();
    for value in [0.1 + 0.2, f64::MIN_POSITIVE, 5e-324, 1.0 / 3.0, 1e15, 123_456_789.123_456_79] {
        scene.background.color = [value, 0.0, 0.7];
        let again = read(&scene.settings_toml()).unwrap();
        assert_eq!(again.background.color.map(f64::to_bits), [value, 0.0, 0.7].map(f64::to_bits));
    }
}

#[test]
fn schema_states_every_key_and_allows_no_other() {
    fn compare(table: &Table, schema: &serde_json::Value) {
        assert_eq!(schema["additionalProperties"], false, "{}", table.header);
        let properties = schema["properties"].as_object().unwrap();
        assert_eq!(properties.len(), table.keys.len(), "{}", table.header);
        for key in table.keys {
            let property = &properties[key.name];
            assert!(property["description"].is_string(), "{}", key.name);
            match (&key.kind, key.absent) {
                (Kind::Table(inner), _) => compare(inner, property),
                (Kind::Tables { table: inner, in_file, .. }, _) => {
                    let list = if *in_file { &property["anyOf"][0] } else { property };
                    compare(inner, &list["items"]);
                }
                (_, Absent::Value(_)) => assert!(!property["default"].is_null(), "{}", key.name),
                _ => {}
            }
        }
    }
    let schema = json_schema();
    compare(&SCENE, &schema);
    let trust =
        &schema["properties"]["objects"]["items"]["properties"]["surface"]["properties"]["trust"];
    assert_eq!((&trust["minimum"], &trust["maximum"]), (&0.5.into(), &1.0.into()));
    assert_eq!(trust["default"], 0.6);
    let ray_loop = &schema["properties"]["render"]["properties"]["loop"];
    assert_eq!(ray_loop["enum"], serde_json::json!(["images", "queue", "auto"]));
}

#[test]
fn load_reads_a_file_and_finds_its_points_beside_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("s.toml");
    std::fs::write(&path, SMALL).unwrap();
    let error = Scene::load(&path, &[]).unwrap_err().to_string();
    let points = folder.path().join("a.ply");
    let place = format!("{}:2:10: objects[0].points: found no file at '", path.display());
    assert!(error.starts_with(&place) && error.contains(points.to_str().unwrap()), "{error}");
    std::fs::write(&points, "").unwrap();
    let scene = Scene::load(&path, &[]).unwrap();
    assert_eq!(scene.objects[0].points, points);
    let set = ["objects.0.points=b.ply".to_owned()];
    let error = Scene::load(&path, &set).unwrap_err().to_string();
    assert!(error.contains("--set objects.0.points=b.ply: objects[0].points: found no"), "{error}");
    let set = ["objects.0.points=\"a\\u0000\"".to_owned()];
    assert!(Scene::load(&path, &set).is_err(), "a NUL byte is no path");
    let set = ["objects.0.points=.".to_owned()];
    let error = Scene::load(&path, &set).unwrap_err().to_string();
    assert!(error.contains("found a folder"), "{error}");
}

#[test]
fn what_is_no_scene_file_is_a_clear_error() {
    let folder = tempfile::tempdir().unwrap();
    let load = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        Scene::load(&path, &[]).unwrap_err().to_string()
    };
    let error = load("latin.toml", b"[image]\n# caf\xe9\n");
    assert!(error.contains("latin.toml:2:6: found byte 0xe9, expected UTF-8"), "{error}");
    assert!(load("empty.toml", b"").contains("empty.toml:1:1: objects: missing"));
    let huge = load("huge.toml", &vec![b'#'; (16 << 20) + 1]);
    assert!(huge.contains("found more than 16777216 bytes"), "{huge}");
    let error = Scene::load(folder.path(), &[]).unwrap_err().to_string();
    assert!(error.contains("found a folder, expected a scene file"), "{error}");
    let error = Scene::load(&folder.path().join("none.toml"), &[]).unwrap_err().to_string();
    assert!(error.ends_with("none.toml: no such file; check the path"), "{error}");
}

#[test]
fn a_point_file_is_a_scene_of_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let points = folder.path().join("a \"b\" \\.ply");
    let error = Scene::for_point_file(&points, Up::Y, &[]).unwrap_err().to_string();
    assert!(error.contains("found no file at"), "{error}");
    std::fs::write(&points, "").unwrap();
    let set = ["objects.0.surface.polynomial=\"incomplete\"".to_owned()];
    let scene = Scene::for_point_file(&points, Up::Y, &set).unwrap();
    assert_eq!((scene.camera, scene.lights.len(), scene.objects.len()), (None, 2, 1));
    assert_eq!(scene.objects[0].points, points);
    assert_eq!(scene.objects[0].name, "a \"b\" \\");
    assert_eq!(scene.objects[0].surface.polynomial, Polynomial::Incomplete);
    assert_eq!(Scene::from_toml(&scene.settings_toml(), Path::new(""), &[]), Ok(scene));
    let set = ["image.sizes=3".to_owned()];
    let error = Scene::for_point_file(&points, Up::Y, &set).unwrap_err().to_string();
    assert!(error.contains("--set image.sizes=3: image.sizes: unknown key"), "{error}");
}

/// The light falls from above: against y, or against z.
#[test]
fn up_turns_the_lights_of_a_point_file() {
    let folder = tempfile::tempdir().unwrap();
    let points = folder.path().join("a.ply");
    std::fs::write(&points, "").unwrap();
    let directions = |up| -> Vec<[f64; 3]> {
        let lights = Scene::for_point_file(&points, up, &[]).unwrap().lights;
        let direction = |light: &Light| match *light {
            Light::Directional { direction, .. } => direction,
            Light::Point { .. } => panic!("a point light"),
        };
        lights.iter().map(direction).collect()
    };
    let turn = Transform { rotate: [90.0, 0.0, 0.0], ..Transform::IDENTITY };
    let turned: Vec<_> = directions(Up::Y).into_iter().map(|d| turn.rotate(d)).collect();
    assert_eq!(directions(Up::Z), turned);
    let over: Vec<_> = directions(Up::Y).into_iter().map(|[x, y, z]| [x, -y, -z]).collect();
    assert_eq!(directions(Up::MinusY), over);
    assert!(directions(Up::Y)[0][1] < 0.0);
}

#[cfg(unix)]
#[test]
fn a_point_files_name_need_not_be_utf8() {
    use std::os::unix::ffi::OsStrExt;
    let folder = tempfile::tempdir().unwrap();
    let points = folder.path().join(std::ffi::OsStr::from_bytes(b"a\xff.ply"));
    std::fs::write(&points, "").unwrap();
    assert_eq!(Scene::for_point_file(&points, Up::Y, &[]).unwrap().objects[0].points, points);
}

#[test]
fn no_prefix_of_a_scene_panics() {
    for end in 0..FULL.len() {
        if let Some(text) = FULL.get(..end) {
            let _ = read(text);
            let _ = read_with(SMALL, &[text]);
        }
    }
}

/// Every byte replaced by each of a few that mean something in TOML.
#[test]
fn no_corrupted_byte_panics() {
    for at in 0..FULL.len() {
        for byte in *b"\"'[]{}=.,#-0ex\n\\\0" {
            let mut bytes = FULL.as_bytes().to_vec();
            bytes[at] = byte;
            if let Ok(scene) = String::from_utf8(bytes).map(|text| read(&text)) {
                let message = scene.err().map(|error| error.to_string()).unwrap_or_default();
                assert!(message.lines().all(|line| line.starts_with("scenes/s.toml")), "{message}");
            }
        }
    }
}

#[test]
fn no_dropped_line_panics() {
    let lines: Vec<&str> = FULL.lines().collect();
    for skip in 0..lines.len() {
        let kept = lines.iter().enumerate().filter(|(index, _)| *index != skip);
        let _ = read(&kept.map(|(_, line)| format!("{line}\n")).collect::<String>());
    }
}

#[test]
fn environments_are_read_and_written_back() {
    let scene = read(&format!("background.environment = \"sky.exr\"\n{SMALL}")).unwrap();
    assert_eq!(scene.background.environment, Some(image_file("sky.exr")));
    let written = scene.settings_toml();
    assert!(
        written.contains("environment = \"sky.exr\"") && !written.contains("color ="),
        "{written}"
    );
    assert_eq!(read(&written).unwrap(), scene);
}

#[test]
fn attributes_have_a_map_and_their_own_range_if_none_is_given() {
    let scene = read_with(SMALL, &["objects.0.material.albedo=attribute:z"]).unwrap();
    let height = Albedo::Attribute { name: "z".into(), color_map: ColorMap::Viridis, range: None };
    assert_eq!(scene.objects[0].material.albedo, height);
    for (map, name) in ColorMap::ALL.into_iter().zip(ColorMap::NAMES) {
        assert_eq!(map.name(), name);
        assert_eq!(format!("{map:?}").to_lowercase(), name);
    }
}

#[test]
fn colors_that_exclude_each_other_are_errors() {
    let cases: [(&[&str], &str); 10] = [
        (
            &["objects.0.material.albedo=[1, 1, 1]", "objects.0.material.texture=a.png"],
            "objects[0].material.texture: found both albedo and texture",
        ),
        (
            &["background.color=[1, 1, 1]", "background.environment=a.exr"],
            "background.environment: found both color and environment",
        ),
        (&["objects.0.material.texture_axis=x"], "there is none; add texture, or remove it"),
        (
            &["objects.0.material.color_map=turbo"],
            "there is none; write albedo = \"attribute:NAME\"",
        ),
        (
            &["objects.0.material.albedo=points", "objects.0.material.value_range=[0, 1]"],
            "objects[0].material.value_range: belongs to the albedo of an attribute",
        ),
        (&["objects.0.material.value_range=[1, 1]"], "the second greater; raise the second"),
        (&["objects.0.material.value_range=[1]"], "expected two numbers"),
        (&["objects.0.material.albedo=attribute:"], "found the string \"attribute:\", expected"),
        (&["objects.0.material.albedo=attribut:z"], "\"attribute:\" and the name of an attribute"),
        (
            &["objects.0.material.albedo=attribute:z", "objects.0.material.color_map=virdis"],
            "did you mean \"viridis\"?",
        ),
    ];
    for (overrides, expected) in cases {
        let error = error_with(SMALL, overrides);
        assert!(error.contains(expected) && error.lines().count() == 1, "{overrides:?}: {error}");
    }
}

/// A missing image is found before points are read, at its line.
#[test]
fn images_that_are_missing_are_found_by_line() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("s.toml");
    std::fs::write(folder.path().join("a.ply"), "").unwrap();
    let text = "background.environment = \"no.exr\"\n[[objects]]\npoints = \"a.ply\"\n\
                material.texture = \"no.png\"\n";
    std::fs::write(&scene, text).unwrap();
    let error = Scene::load(&scene, &[]).unwrap_err().to_string();
    let lines: Vec<&str> = error.lines().collect();
    assert_eq!(lines.len(), 2, "{error}");
    assert!(lines[0].contains(":1:26: background.environment: found no file at"), "{error}");
    assert!(lines[1].contains(":4:20: objects[0].material.texture: found no file at"), "{error}");
}

/// The background of a point file rendered directly is nobody's wish, so an environment replaces it.
#[test]
fn a_point_file_takes_an_environment() {
    let folder = tempfile::tempdir().unwrap();
    let points = folder.path().join("a.ply");
    std::fs::write(&points, "").unwrap();
    let sky = folder.path().join("sky.hdr");
    std::fs::write(&sky, "").unwrap();
    let set = format!("background.environment={}", sky.display());
    let scene = Scene::for_point_file(&points, Up::Y, &[set]).unwrap();
    assert_eq!(scene.background.environment.map(|image| image.path), Some(sky));
}
