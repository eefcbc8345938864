//! The checked scene, as the renderer takes it.
//!
//! Ranges stated here hold for every value that came from a file: `keys.rs` is where they are set.

use crate::{CameraKeys, Transform};
use std::path::PathBuf;

/// What to render. Lengths are scene units, colours linear RGB with Rec. 709 primaries.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Scene {
    /// Names of the objects of glass that the eye is inside (`camera.inside`); `None`: the renderer finds out.
    pub inside: Option<Vec<String>>,
    /// What is given of the view; the renderer frames the objects with the rest.
    pub camera: CameraKeys,
    /// Size and sampling of the picture.
    pub image: ImageSettings,
    /// How rays are followed.
    pub render: RenderSettings,
    /// What rays that hit nothing see.
    pub background: Background,
    /// The lights, 0 to 1024.
    pub lights: Vec<Light>,
    /// The directional light whose direction follows the camera, by its place among the lights: the key light of a point
    /// file rendered directly, unless its direction is given. Scene files have none.
    pub key_light: Option<usize>,
    /// The objects, 1 to 65536; an object's place here is its index in the picture.
    pub objects: Vec<Object>,
}

/// A camera. `eye` and `target` differ, and `up` is not parallel to the line of sight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// World position, each -1e15 to 1e15.
    pub eye: [f64; 3],
    /// World position in the middle of the picture, each -1e15 to 1e15.
    pub target: [f64; 3],
    /// World direction that is upwards in the picture, any length from 1e-12.
    pub up: [f64; 3],
    /// How the scene comes onto the picture.
    pub projection: Projection,
    /// Diameter of the lens, 0 to 1e15 and at most 1000 times the distance in focus; 0: a pinhole.
    pub aperture: f64,
    /// Distance along the viewing axis of the plane in focus, 1e-12 to 1e15; `None`: the target's.
    pub focus: Option<f64>,
}

/// How the scene comes onto the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Projection {
    /// Towards the eye.
    Perspective {
        /// Angle between the lower and the upper edge in degrees, 0.001 to 179.
        vertical_fov: f64,
    },
    /// By parallels to the viewing axis.
    Orthographic {
        /// Distance of the lower edge from the upper, 1e-12 to 1e15.
        height: f64,
    },
}

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

/// How rays are followed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RenderSettings {
    /// Surface interactions after the primary hit, 0 to 1024.
    pub max_bounces: u32,
    /// What glass does with a ray that it both reflects and refracts.
    pub fresnel: Fresnel,
    /// Cells a ray may cross in one pass; 0 lets the device decide. Changes no pixel.
    pub cells_per_pass: u32,
    /// Where the ray state lives. Changes no pixel.
    pub ray_loop: RayLoop,
    /// Seed of everything that is random.
    pub seed: u32,
    /// How many cells a grid has.
    pub grid_resolution: GridResolution,
    /// How camera rays find their first hit. Changes no pixel.
    pub primary: Primary,
    /// How all other rays find theirs. Changes no pixel.
    pub secondary: Secondary,
}

/// How many cells a grid has along its longest axis. Changes no pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GridResolution {
    /// So many, 1 to 1024; 0 chooses grids from the points.
    Cells(u32),
    /// As many as the paper has: about 20³ for 35 000 points.
    Paper,
}

impl GridResolution {
    /// Cells along the longest axis of a scene of so many points; 0 leaves it to the size of trust balls.
    #[must_use]
    pub fn cells(self, points: u64) -> u32 {
        match self {
            Self::Cells(cells) => cells,
            // The share of points a cell stays: twice as many points have twice as many cells.
            Self::Paper => {
                (20.0 * (points as f64 / 35_000.0).cbrt()).round().clamp(1.0, 1024.0) as u32
            }
        }
    }
}

/// What glass does with a ray that it both reflects and refracts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fresnel {
    /// Follow the refracted ray only.
    Transmit,
    /// Choose one of the two at random with the Fresnel probability.
    Sample,
}

/// Where the ray state lives between passes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RayLoop {
    /// Four ping-pong storage images.
    Images,
    /// Live rays compacted, in buffers.
    Queue,
    /// Whichever the device runs faster.
    Auto,
}

/// How camera rays find their first hit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Primary {
    /// Cell after cell of the grid.
    Grid,
    /// Among the points whose discs cover the tile of pixels.
    Discs,
    /// Through the tree.
    Tree,
    /// Whichever is expected to be faster.
    Auto,
}

/// How rays that do not come from the camera find their hits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Secondary {
    /// Cell after cell of the grid.
    Grid,
    /// Through the tree.
    Tree,
    /// Through the tree, unless the grid is to be seen at work.
    Auto,
}

/// What rays that hit nothing see. It lights nothing else.
#[derive(Debug, Clone, PartialEq)]
pub struct Background {
    /// Radiance, each 0 to 1e15.
    pub color: [f64; 3],
    /// An equirectangular image instead.
    pub environment: Option<ImageFile>,
    /// How the environment is turned about the fixed x, y, z axes in that order, in degrees, each -1e6 to 1e6.
    pub rotate: [f64; 3],
}

/// An image that the scene names.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ImageFile {
    /// Resolved against the scene file's folder.
    pub path: PathBuf,
    /// As the scene file names it, for headers: it says nothing about the machine.
    pub as_written: String,
}

/// A light. Every surface blocks it fully, but for those between media of one index.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Light {
    /// Light from infinitely far away.
    Directional {
        /// The way the light travels, any length from 1e-12; not normalised.
        direction: [f64; 3],
        /// On a surface that faces the light, W m⁻², each 0 to 1e15.
        irradiance: [f64; 3],
        /// Angle between opposite places of its rim in degrees, 0 to 179.9; 0 casts hard shadows.
        angle: f64,
    },
    /// Light from a point, equal in all directions.
    Point {
        /// World position, each -1e15 to 1e15.
        position: [f64; 3],
        /// Radiant intensity I, W sr⁻¹, each 0 to 1e15: irradiance is I/r².
        intensity: [f64; 3],
        /// Of the sphere that it is, 0 to 1e15; 0 casts hard shadows.
        radius: f64,
    },
    /// A point light in the camera's eye; where rays are parallel, light along the line of sight.
    Headlight {
        /// Irradiance on a surface that faces it at the distance of the target, W m⁻², each 0 to 1e15.
        at_target: [f64; 3],
    },
}

/// One point set with its place, surface and material.
#[derive(Debug, Clone, PartialEq)]
pub struct Object {
    /// Name in messages and statistics; the stem of the point file unless the scene gives one.
    pub name: String,
    /// The point file, resolved against the scene file's folder.
    pub points: PathBuf,
    /// The point file as the scene file names it, for headers: it says nothing about the machine.
    pub points_as_written: String,
    /// Which points of the file are taken.
    pub filter: PointFilter,
    /// Which column of the file is what, over what the file says.
    pub columns: PointColumns,
    /// What x and y of the file are.
    pub units: Units,
    /// From the file's coordinates, of degrees from metres, to the world's.
    pub transform: Transform,
    /// How the surface is fitted.
    pub surface: Surface,
    /// How the surface scatters light.
    pub material: Material,
    /// A volume made of the points; `None`: the object is a pure surface.
    pub volume: Option<Volume>,
}

/// Which column of a point file is what.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct PointColumns {
    /// `x`, `y`, `z`, `red`, …, or any name of an attribute, and the column.
    pub named: Vec<(String, PointColumn)>,
    /// Columns that are passed over, counted from 1.
    pub left_out: Vec<u32>,
}

/// A column of a point file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum PointColumn {
    /// The one that the file calls so.
    Name(String),
    /// The one in this place, counted from 1.
    Number(u32),
}

/// What x and y of a point file are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Units {
    /// What the file says; lengths where it says nothing.
    #[default]
    Auto,
    /// Longitude and latitude in degrees.
    Degrees,
    /// Lengths, like z.
    Scene,
}

/// Which points of a file are taken. Conditions apply in the order of the fields. Coordinates and
/// lengths are the file's.
#[derive(Debug, Clone, PartialEq)]
pub struct PointFilter {
    /// The first point of the file and every n-th after it, from 1.
    pub every: u32,
    /// Lowest and highest corner of a box, each coordinate -1e15 to 1e15.
    pub bounds: Option<[[f64; 3]; 2]>,
    /// Attributes, or `x`, `y`, `z`, with their least and greatest values, -1e15 to 1e15.
    pub ranges: Vec<(String, [f64; 2])>,
    /// Values of `classification`, 0 to 255.
    pub classes: Option<Vec<u32>>,
    /// Cubes whose points become one.
    pub voxel: Option<VoxelEdge>,
}

/// The edge of the cubes that a filter makes points of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum VoxelEdge {
    /// Twice the median distance of points to the nearest other one.
    Auto,
    /// 1e-12 to 1e15.
    Length(f64),
}

/// A volume made of an object's points (docs/method.md, section 7). Lengths are scene units.
#[derive(Debug, Clone, PartialEq)]
pub struct Volume {
    /// The points' attribute that is shown.
    pub scalar: String,
    /// How points are blended.
    pub kernel: VolumeKernel,
    /// Reach of a point, 1e-12 to 1e15; `None`: from the points' spacing.
    pub radius: Option<f64>,
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

/// What the light of the scene does in a volume.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VolumeShading {
    /// Nothing: colours are emitted.
    None,
    /// It is scattered by Lambert's law, as by a surface across the scalar's gradient.
    Gradient,
    /// It is scattered evenly to all sides.
    Scatter,
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

/// How the surface is fitted (docs/method.md, section 1).
#[derive(Debug, Clone, PartialEq)]
pub struct Surface {
    /// What is drawn of the points.
    pub kind: SurfaceKind,
    /// How points are drawn that lie on no surface.
    pub scatter: Scatter,
    /// Nearest other points of a fit.
    pub neighbors: Neighbors,
    /// Which terms the polynomial has.
    pub polynomial: Polynomial,
    /// The length h that weights and trust radii are measured by.
    pub feature_size: FeatureSize,
    /// Trust radius over feature size, b/h, 0.5 to 1.
    pub trust: f64,
    /// Points are dropped whose mean distance to their neighbours is over the mean of all points' by more
    /// than so many standard deviations, 0 to 100; 0 drops none.
    pub drop_isolated: f64,
    /// Width of the Gaussian weights over feature size, 0.25 to 4.
    pub weight_width: f64,
    /// Whether single trust radii grow, at most to the feature size, where neighbours leave a gap.
    pub close_gaps: bool,
    /// Whether the surface of an open set ends near its last points.
    pub boundary_clip: bool,
    /// Whose normal a hit has; refined hits have that of the surface they are on.
    pub normals: Normals,
    /// What becomes of a hit with a stored polynomial.
    pub refine: Refine,
}

/// Nearest other points of a fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Neighbors {
    /// [`FEW`](Self::FEW), after points with noise were moved onto their surface (docs/method.md, section 1).
    Auto {
        /// The error of normals up to which noise is smoothed, 0.1 to 30 degrees.
        accuracy: f64,
    },
    /// So many, 3 to 256, of the points where they lie.
    Count(u32),
}

impl Neighbors {
    /// Those of points without noise.
    pub const FEW: u32 = 16;

    /// How many.
    #[must_use]
    pub fn count(self) -> u32 {
        match self {
            Self::Auto { .. } => Self::FEW,
            Self::Count(count) => count,
        }
    }
}

/// What is drawn of an object's points (docs/method.md, section 1).
#[derive(Debug, Clone, PartialEq)]
pub enum SurfaceKind {
    /// The surface through them.
    Points,
    /// A sphere at each.
    Spheres(ShapeRadius),
    /// A flat disc at each.
    Discs(ShapeRadius),
}

/// How large spheres and discs are.
#[derive(Debug, Clone, PartialEq)]
pub struct ShapeRadius {
    /// What the radius is taken from.
    pub of: RadiusOf,
    /// A factor on that, 1e-6 to 1e6.
    pub scale: f64,
}

/// What the radius of spheres and discs is taken from.
#[derive(Debug, Clone, PartialEq)]
pub enum RadiusOf {
    /// Half the median distance from a point to its nearest other: one radius for the object.
    Spacing,
    /// Half the mean distance from each point to its four nearest others.
    LocalSpacing,
    /// One radius in scene units, 1e-12 to 1e15.
    Length(f64),
    /// Each point's value of the attribute of this name, in the file's units.
    Attribute(String),
}

/// How points are drawn that lie on no surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scatter {
    /// As discs; of glass, which has an inside, as spheres.
    Discs,
    /// As spheres.
    Spheres,
    /// Not at all.
    Drop,
}

/// Whose normal a hit has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Normals {
    /// That of the polynomial that was hit, as in the paper.
    Polynomial,
    /// The weighted mean over the polynomials whose trust balls hold the hit.
    Blended,
}

/// What becomes of a hit with a stored polynomial (docs/method.md, section 2).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Refine {
    /// It stands.
    None,
    /// It is projected onto the point set surface.
    Project {
        /// Distance of a hit to its projection that is near enough, over h, 1e-7 to 1.
        tolerance: f64,
        /// Projections of one stored hit, 1 to 100.
        max_iterations: u32,
    },
}

/// Which terms a point's polynomial has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Polynomial {
    /// A x² + B y² + C xy + D + E x + F y.
    Full,
    /// A x² + B y² + C xy + D, as in the paper.
    Incomplete,
}

/// The length h that weights and trust radii are measured by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FeatureSize {
    /// Each point's distance to its farthest neighbour of the fit.
    Adaptive,
    /// The mean of the adaptive one over a point and its neighbours.
    Smoothed,
    /// One length for the object in scene units, 1e-12 to 1e15.
    Constant(f64),
}

/// How a surface scatters light. Diffuse (Lambert) is what is built.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// What becomes of a ray.
    pub kind: MaterialKind,
    /// The share of light that a diffuse surface scatters back.
    pub albedo: Albedo,
}

/// What becomes of a ray at a surface (docs/method.md, section 4).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MaterialKind {
    /// Lambert's law on both sides.
    Diffuse,
    /// A perfect mirror.
    Mirror {
        /// The share reflected, linear RGB, each 0 to 1.
        reflectance: [f64; 3],
    },
    /// Smooth glass.
    Glass {
        /// Refractive index of red, green and blue, each 0.1 to 10.
        ior: [f64; 3],
        /// The highest counts where media overlap, -1000000 to 1000000; ties go to the last object.
        priority: i32,
        /// σ in exp(−σℓ) over the length ℓ inside, per scene unit, each 0 to 1e15.
        absorption: [f64; 3],
    },
}

/// Where a diffuse surface takes its albedo from.
#[derive(Debug, Clone, PartialEq)]
pub enum Albedo {
    /// The points' own colours where they have them, else 0.8.
    Default,
    /// The points' own colours; a point set without is an error of the renderer's.
    Points,
    /// One colour, each 0 to 1.
    Color([f64; 3]),
    /// An attribute of the points, or `x`, `y` or `z` where they have none of that name.
    Attribute {
        /// Its name; a point set without it is an error of the renderer's.
        name: String,
        /// The colours that it is shown in.
        color_map: ColorMap,
        /// Values at the two ends of the map; the attribute's own where `None`.
        range: Option<[f64; 2]>,
        /// How values lie between these.
        scale: Scale,
    },
    /// An image.
    Texture {
        /// Which.
        file: ImageFile,
        /// How it lies; where `None`, by u and v if the points have them, else along y.
        axis: Option<TextureAxis>,
    },
}

/// Colours for values, from low to high.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ColorMap {
    /// Of matplotlib: dark blue, green, yellow.
    Viridis,
    /// Of Google: a rainbow of even brightness.
    Turbo,
    /// Of matplotlib: black, purple, cream.
    Magma,
    /// Of matplotlib: black, red, pale yellow.
    Inferno,
    /// Of matplotlib: blue, red, yellow.
    Plasma,
    /// Blue, grey, yellow; the same to colour-blind eyes.
    Cividis,
    /// Black to white in even steps of sRGB.
    Gray,
}

impl ColorMap {
    /// All, in the order of their names.
    pub const ALL: [Self; 7] = [
        Self::Viridis,
        Self::Turbo,
        Self::Magma,
        Self::Inferno,
        Self::Plasma,
        Self::Cividis,
        Self::Gray,
    ];
    /// Their names in scene files.
    pub const NAMES: [&str; 7] =
        ["viridis", "turbo", "magma", "inferno", "plasma", "cividis", "gray"];

    /// Its name in scene files.
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize]
    }
}

/// How values lie between the ends of a colour map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Scale {
    /// Evenly.
    #[default]
    Linear,
    /// Their logarithms do. Values that are not positive have the colour of the lower end.
    Log,
}

impl Scale {
    /// Their names in scene files.
    pub const NAMES: [&str; 2] = ["linear", "log"];

    /// Its name in scene files.
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize]
    }
}

/// What all extinctions of a volume are multiplied by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ExtinctionFactor {
    /// This, 0 to 1e15.
    Given(f64),
    /// What makes the optical depth across the median chord 2.
    Auto,
}

/// How a texture lies on an object.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TextureAxis {
    /// Projected along x over the bounding box of the points, in the file's coordinates.
    X,
    /// Along y.
    Y,
    /// Along z.
    Z,
    /// By the points' own u and v.
    Uv,
}

/// Which axis of a point file points upwards.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Up {
    /// +y, as in most models.
    #[default]
    Y,
    /// +z, as in most surveys.
    Z,
    /// -y, as in what a depth camera sees: x to the right, y down, z forward.
    MinusY,
}
