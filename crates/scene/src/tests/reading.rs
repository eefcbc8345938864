//! What is read, from every key to the contract's example.

use super::{FULL, SMALL, error, error_with, image_file, read, read_with, stop_count};
use crate::keys::{Kind, SCENE};
use crate::not_built::NOT_BUILT;
use crate::*;
use std::path::{Path, PathBuf};

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
    assert_eq!(scene.camera.whole(), Some(camera));
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
        integrator: Integrator::Path,
        clamp: Some(12.5),
        fresnel: Fresnel::Transmit,
        shadows: Shadows::Opaque,
        cells_per_pass: 4,
        ray_loop: RayLoop::Images,
        seed: u32::MAX,
        grid_resolution: GridResolution::Cells(96),
        primary: Primary::Discs,
        secondary: Secondary::Tree,
    };
    assert_eq!(scene.render, render);
    assert_eq!(
        scene.background,
        Background {
            color: [0.1, 0.2, 1e-7],
            environment: None,
            rotate: [0.0; 3],
            sky: None,
            gradient: None,
            lights: Some(false)
        }
    );
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
        columns: PointColumns {
            named: vec![
                ("x".to_owned(), PointColumn::Name("E [m]".to_owned())),
                ("y".to_owned(), PointColumn::Number(2)),
                ("odd name".to_owned(), PointColumn::Number(7)),
            ],
            left_out: vec![4, 5],
        },
        filter: PointFilter {
            every: 3,
            bounds: Some([[-1.0, 0.0, 4.9e6], [1.0, 0.5, 4.9e6]]),
            ranges: vec![("intensity".into(), [100.0, 2000.5]), ("odd name".into(), [2.0, 2.0])],
            classes: Some(vec![2, 6]),
            voxel: Some(VoxelEdge::Length(0.05)),
        },
        units: Units::Degrees,
        transform: Transform {
            scale: 2.5,
            rotate: [10.0, 90.0, -5.5],
            translate: [0.1, 0.30000000000000004, -1e6],
        },
        surface: Surface {
            kind: SurfaceKind::Points,
            scatter: Scatter::Discs,
            neighbors: Neighbors::Count(20),
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
        scale: Scale::Linear,
    };
    assert_eq!(scene.objects[2].material.albedo, intensity);
    let of = RadiusOf::Attribute("diameter".into());
    let spheres = SurfaceKind::Spheres(ShapeRadius { of, scale: 0.5 });
    assert_eq!(scene.objects[2].surface.kind, spheres);
    let kind = |surface: &str| {
        read(&format!("{SMALL}surface = {{ {surface} }}")).unwrap().objects.remove(0).surface.kind
    };
    let (of, scale) = (RadiusOf::Spacing, 1.0);
    assert_eq!(kind("kind = \"discs\""), SurfaceKind::Discs(ShapeRadius { of, scale }));
    let of = RadiusOf::LocalSpacing;
    assert_eq!(
        kind("kind = \"spheres\", radius = \"local\""),
        SurfaceKind::Spheres(ShapeRadius { of, scale })
    );
    let of = RadiusOf::Length(0.25);
    assert_eq!(
        kind("kind = \"discs\", radius = 0.25"),
        SurfaceKind::Discs(ShapeRadius { of, scale })
    );
    let grass = Albedo::Texture { file: image_file("maps/grass.png"), axis: Some(TextureAxis::Uv) };
    assert_eq!(scene.objects[3].material.albedo, grass);
    let mirror = MaterialKind::Mirror { reflectance: [0.9, 0.8, 0.7] };
    assert_eq!(scene.objects[4].material.kind, mirror);
    let glass =
        MaterialKind::Glass { ior: [1.4, 1.5, 1.6], priority: -3, absorption: [0.0, 0.5, 2.0] };
    assert_eq!(scene.objects[5].material.kind, glass);
    let stop = |value, color, extinction| Stop { value, color, extinction, emission: [0.0; 3] };
    let volume = Volume {
        scalar: "density".into(),
        kernel: VolumeKernel::Sum,
        radius: VolumeRadius::Length(0.05),
        smoothing: Some(0.0006),
        step: Some(0.01),
        boundary: Boundary::Attribute("skin".into()),
        mode: VolumeMode::Emission,
        transfer: Some(Transfer::Stops(vec![
            stop(0.0, [0.0, 0.0, 1.0], 0.0),
            stop(1.0, [1.0, 0.3, 0.0], 8.0),
        ])),
        scale: Scale::Linear,
        extinction: ExtinctionFactor::Given(1.0),
        shading: VolumeShading::Scatter { anisotropy: 0.5 },
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
    assert_eq!(scene.camera, CameraKeys::default());
    let image = ImageSettings {
        size: [640, 480],
        samples: 1,
        filter: Filter::Gaussian,
        filter_width: None,
        transparent: false,
    };
    assert_eq!(scene.image, image);
    assert_eq!((scene.render.max_bounces, scene.render.fresnel), (8, Fresnel::Transmit));
    assert_eq!(scene.render.shadows, Shadows::Tinted);
    assert_eq!((scene.render.cells_per_pass, scene.render.ray_loop), (0, RayLoop::Auto));
    assert_eq!((scene.render.seed, scene.render.grid_resolution), (0, GridResolution::Cells(0)));
    assert_eq!(scene.render.primary, Primary::Auto);
    assert_eq!(scene.render.secondary, Secondary::Auto);
    assert_eq!((scene.background.color, scene.lights.len()), ([0.0; 3], 0));
    let object = &scene.objects[0];
    assert_eq!((object.name.as_str(), object.transform), ("a", Transform::IDENTITY));
    let surface = Surface {
        kind: SurfaceKind::Points,
        scatter: Scatter::Discs,
        neighbors: Neighbors::Auto { accuracy: 2.5 },
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
    assert_eq!((&object.surface, &object.material.albedo), (&surface, &Albedo::Default));
    assert_eq!(object.surface, Surface::default());
    assert_eq!(object.material, Material::default());
    assert_eq!(object.transform, Transform::default());
    assert_eq!((scene.image, scene.render), (ImageSettings::default(), RenderSettings::default()));
    let camera = "[camera]\neye = [0, 0, 1]\ntarget = [0, 0, 0]\n";
    let camera = read(&format!("{camera}{SMALL}")).unwrap().camera.whole().unwrap();
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
fn columns_are_checked() {
    for (set, expected) in [
        (
            "columns=3",
            "objects[0].columns: found 3, expected a table of names, each with a column's",
        ),
        (
            "columns.x=0",
            "objects[0].columns.x: found 0, expected a column's name or its number from 1",
        ),
        ("columns.x=1.5", "objects[0].columns.x: found 1.5, expected a column's name"),
        ("columns.x=[1]", "objects[0].columns.x: found a list of 1, expected a column's name"),
        ("columns.x=\"\"", "objects[0].columns.x: found the string \"\", expected a column's name"),
        ("columns._=4", "objects[0].columns._: found 4, expected a list of columns' numbers"),
        ("columns={ \"\" = 4 }", "found 4, expected a name before it"),
    ] {
        let error = error_with(FULL, &[&format!("objects.0.{set}")]);
        assert!(error.contains(expected), "{error}\nlacks {expected}");
    }
    let set = ["objects.1.columns.x=E", "objects.1.columns.red=5"];
    assert_eq!(read_with(FULL, &set).unwrap().objects[1].columns.named.len(), 2);
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
        ("voxel=0", "objects[0].filter.voxel: found 0, expected \"auto\", or a number from"),
        (
            "voxel=\"first\"",
            "objects[0].filter.voxel: found the string \"first\", expected \"auto\", or",
        ),
    ] {
        let error = error_with(FULL, &[&format!("objects.0.filter.{set}")]);
        assert!(error.contains(expected), "{error}\nlacks {expected}");
    }
    let set = ["objects.1.filter.every=10", "objects.1.filter.range.z=[0, 1]"];
    let filter = &read_with(FULL, &set).unwrap().objects[1].filter;
    assert_eq!((filter.every, filter.ranges.len(), filter.voxel), (10, 1, None));
    let of_auto = read_with(FULL, &["objects.1.filter.voxel=auto"]).unwrap();
    assert_eq!(of_auto.objects[1].filter.voxel, Some(VoxelEdge::Auto));
    let again = Scene::from_toml(&of_auto.settings_toml(), Path::new("again.toml"), &[]).unwrap();
    assert_eq!(again.objects[1].filter.voxel, Some(VoxelEdge::Auto));
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

/// The sun from the right, behind whoever looks along the middle of the panorama; grey ground in three equal channels.
#[test]
fn a_sky_has_defaults_and_a_grey_ground_is_one_number() {
    let sky = |set: &str| read_with(SMALL, &[set]).unwrap().background.sky.unwrap();
    let expected = Sky {
        sun: SunPlace::Angles { elevation: 45.0, azimuth: 135.0 },
        sun_angle: 0.53,
        turbidity: 3.0,
        ground: [0.2; 3],
    };
    assert_eq!((sky("background.sky={}"), Sky::default()), (expected, expected));
    assert_eq!(sky("background.sky.ground=0.5").ground, [0.5; 3]);
    assert_eq!(sky("background.sky.ground=[0, 0.5, 1]").ground, [0.0, 0.5, 1.0]);
    assert_eq!(sky("background.sky.sun=[0, 2, 0]").sun, SunPlace::Towards([0.0, 2.0, 0.0]));
}
