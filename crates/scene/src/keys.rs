//! Every key of a scene file: type, range, unit, default, meaning. The one place they are stated.
//!
//! The checker, the defaults of the public types, the JSON Schema and the tables of docs/scene.md
//! all come from [`SCENE`]. What is known here but not built is listed in `not_built.rs`.

use crate::camera_keys::ViewFrom;
use crate::read::Reader;
use crate::whole::{
    background_is_one, box_has_an_inside, camera_has_a_view, direction_has_a_length,
    material_has_one_color, stop_shows_something, stops_ascend, surface_has_no_key_in_vain,
    volume_says_it_once,
};

/// A key's name and what is wrong with its value.
pub(crate) type Fault = (&'static str, String);

/// A check that needs several keys of a table.
pub(crate) type WholeCheck = fn(&Reader<'_>) -> Result<(), Fault>;

/// A table of the file.
pub(crate) struct Table {
    /// As a file writes it: `[camera]`, `[[lights]]`.
    pub(crate) header: &'static str,
    pub(crate) doc: &'static str,
    pub(crate) keys: &'static [Key],
    /// What no key can say alone. Runs when each key is right by itself; names the key at fault.
    pub(crate) whole: Option<WholeCheck>,
}

impl Table {
    pub(crate) fn key(&self, name: &str) -> Option<&'static Key> {
        self.keys.iter().find(|key| key.name == name)
    }
}

/// A key of a table.
pub(crate) struct Key {
    pub(crate) name: &'static str,
    pub(crate) kind: Kind,
    pub(crate) absent: Absent,
    pub(crate) doc: &'static str,
    /// The value of `kind` beside it that the key belongs to, if only to one.
    pub(crate) only: Option<&'static str>,
}

/// What a key that is left out means. Values are TOML.
#[derive(Clone, Copy)]
pub(crate) enum Absent {
    /// It may not be left out; an example of a value.
    Required(&'static str),
    /// This value.
    Value(&'static str),
    /// What these words say; an example of a value.
    Words(&'static str, &'static str),
    /// The defaults of the table's own keys, or an empty list.
    Table,
}

/// What a value has to be.
pub(crate) enum Kind {
    Bool,
    Integer {
        min: i64,
        max: i64,
        unit: &'static str,
    },
    Number(Numbers),
    /// Three numbers.
    Vector(Numbers),
    /// Three numbers that are not all zero.
    Direction,
    /// Width and height.
    Size {
        max: i64,
    },
    /// Two numbers, the first under the second.
    Range(Numbers),
    Choice(&'static [&'static str]),
    /// This word and what it goes before, which is what the second says.
    Prefixed(&'static str, &'static str),
    Text(&'static str),
    /// One of several, told apart by TOML type.
    Either(&'static [Kind]),
    Table(&'static Table),
    /// Two numbers.
    Pair(Numbers),
    Tables {
        table: &'static Table,
        min: usize,
        max: usize,
        /// The path of a file that has them under the same key will do.
        in_file: bool,
    },
    /// One value or more that are no tables.
    List {
        of: &'static Kind,
        max: usize,
    },
    /// A table of any names, each with two numbers, the second no less than the first.
    Ranges(Numbers),
    /// A table of any names, each with a column's name or number; `_` with a list of numbers.
    Columns,
    /// One name, or a list of names, which may be empty; what has them.
    Names(&'static str),
}

/// A closed range and its unit, which may be empty.
#[derive(Clone, Copy)]
pub(crate) struct Numbers {
    pub(crate) min: f64,
    pub(crate) max: f64,
    pub(crate) unit: &'static str,
}

/// Largest magnitude of a coordinate or radiometric value: its square is still far inside f32.
pub(crate) const LARGE: f64 = 1e15;
/// Shortest length that counts as one.
pub(crate) const SHORT: f64 = 1e-12;

pub(crate) const fn numbers(min: f64, max: f64, unit: &'static str) -> Numbers {
    Numbers { min, max, unit }
}

/// The vertical angle of a camera whose eye and target are given, in degrees.
pub(crate) const DEFAULT_FOV: f64 = 35.0;
/// The key of `[objects.columns]` that lists columns which are passed over.
pub(crate) const LEFT_OUT: &str = "_";
/// Greatest number of a column.
pub(crate) const MOST_COLUMNS: u32 = 1_000_000;

const POSITION: Kind = Kind::Vector(numbers(-LARGE, LARGE, "scene units"));
const FILE_POSITION: Kind = Kind::Vector(numbers(-LARGE, LARGE, "units of the file"));
const RADIANCE: Kind = Kind::Vector(numbers(0.0, LARGE, "W sr⁻¹ m⁻², linear RGB"));
const SHARE: Kind = Kind::Vector(numbers(0.0, 1.0, "in linear RGB"));
const LENGTH: Kind = Kind::Number(numbers(SHORT, LARGE, "scene units"));

pub(crate) const fn key(name: &'static str, kind: Kind, absent: Absent, doc: &'static str) -> Key {
    Key { name, kind, absent, doc, only: None }
}

const fn key_of(
    only: &'static str,
    name: &'static str,
    kind: Kind,
    absent: Absent,
    doc: &'static str,
) -> Key {
    Key { name, kind, absent, doc, only: Some(only) }
}

pub(crate) const fn count(min: i64, max: i64, unit: &'static str) -> Kind {
    Kind::Integer { min, max, unit }
}

use Absent::{Required, Value, Words};

/// The whole file.
pub(crate) static SCENE: Table = Table {
    header: "the scene",
    doc: "",
    whole: None,
    keys: &[
        key("camera", Kind::Table(&CAMERA), Absent::Table, CAMERA.doc),
        key("image", Kind::Table(&IMAGE), Absent::Table, IMAGE.doc),
        key("render", Kind::Table(&RENDER), Absent::Table, RENDER.doc),
        key("background", Kind::Table(&BACKGROUND), Absent::Table, BACKGROUND.doc),
        key(
            "lights",
            Kind::Tables { table: &LIGHTS, min: 0, max: 1024, in_file: false },
            Absent::Table,
            LIGHTS.doc,
        ),
        key(
            "objects",
            Kind::Tables { table: &OBJECTS, min: 1, max: 65_536, in_file: false },
            Required("[{ points = \"points/knot.ply\" }]"),
            OBJECTS.doc,
        ),
    ],
};

pub(crate) static CAMERA: Table = Table {
    header: "[camera]",
    doc: "A camera with square pixels, row 0 at the top. Whatever is left out is chosen so that the objects are in the \
          picture: see [below](#the-automatic-camera).",
    whole: Some(camera_has_a_view),
    keys: &[
        key(
            "eye",
            POSITION,
            Words("as far away as the objects need", "[0.0, 0.4, 3.0]"),
            "Where the camera is, in the world.",
        ),
        key(
            "target",
            POSITION,
            Words("in the middle of the objects", "[0.0, 0.0, 0.0]"),
            "The point in the picture's middle.",
        ),
        key(
            "view",
            Kind::Either(&[Kind::Choice(&ViewFrom::NAMES), Kind::Direction]),
            Words("from the front, a little from the right and from above", "\"front\""),
            "Where the camera looks from, or the way that it looks, as three numbers; only where eye or target is left out.",
        ),
        key(
            "up",
            Kind::Direction,
            Value("[0.0, 1.0, 0.0]"),
            "The direction that is upwards in the picture; not parallel to the line of sight. `--up` goes before the \
             default.",
        ),
        key(
            "vertical_fov",
            Kind::Number(numbers(0.001, 179.0, "degrees")),
            Words(
                "35; 40 where eye is left out; what holds the objects, at most 90, where only target is",
                "35.0",
            ),
            "Perspective only: angle between the lower and the upper edge of the picture.",
        ),
        key(
            "projection",
            Kind::Choice(&["perspective", "orthographic"]),
            Value("\"perspective\""),
            "Rays from the eye, or parallel ones from the plane through the eye across the line of \
             sight.",
        ),
        key(
            "height",
            LENGTH,
            Words("what holds the objects", "2.0"),
            "Orthographic only: height of what the picture shows.",
        ),
        key(
            "aperture",
            Kind::Number(numbers(0.0, LARGE, "scene units")),
            Value("0.0"),
            "Diameter of the lens; what is out of focus is blurred, with `image.samples` over 1. 0 is a \
             pinhole: everything is sharp. At most 1000 times the distance in focus.",
        ),
        key(
            "focus",
            LENGTH,
            Words("the distance from eye to target", "3.0"),
            "Distance of the plane in focus from the eye, along the line of sight.",
        ),
        key(
            "inside",
            Kind::Names("an object of glass"),
            Words("found by normals, else by counting surfaces around the eye", "\"bottle\""),
            "The glass that the eye is inside: an object's name, a list of names, or [] for none. Spheres \
             count where they hold the eye.",
        ),
    ],
};

pub(crate) static IMAGE: Table = Table {
    header: "[image]",
    doc: "Size and sampling of the picture.",
    whole: None,
    keys: &[
        key("size", Kind::Size { max: 16_384 }, Value("[640, 480]"), "Width and height."),
        key(
            "samples",
            count(1, 65_536, "rays a pixel"),
            Value("1"),
            "1 is one ray through each pixel's centre, without jitter. With more, the colours and `A` \
             are means over rays about the centre, which smooths edges; `Z`, `P`, `N`, `object` and \
             diagnostics are those of one more ray, through the centre.",
        ),
        key(
            "filter",
            Kind::Choice(&["gaussian", "triangle", "box"]),
            Value("\"gaussian\""),
            "How the rays of a pixel lie about its centre along each axis, where it has several: \
             normally distributed and cut at three standard deviations, thinning out evenly, or \
             evenly.",
        ),
        key(
            "filter_width",
            Kind::Number(numbers(0.1, 16.0, "pixels")),
            Words(
                "3 for gaussian (half a pixel a standard deviation), 2 for triangle, 1 for box",
                "3.0",
            ),
            "Side of the square about the pixel's centre that its rays lie in.",
        ),
        key(
            "transparent",
            Kind::Bool,
            Value("false"),
            "Leave the background out and premultiply the colours by coverage. Behind coloured glass too, whose \
             coverage is one a channel: AR, AG, AB.",
        ),
    ],
};

pub(crate) static RENDER: Table = Table {
    header: "[render]",
    doc: "How rays are followed.",
    whole: None,
    keys: &[
        key(
            "max_bounces",
            count(0, 1024, "surface interactions"),
            Value("8"),
            "Interactions after the primary hit; a ray that has spent them takes the background.",
        ),
        key(
            "fresnel",
            Kind::Choice(&["transmit", "sample"]),
            Value("\"transmit\""),
            "What glass does with a ray: always refract it, or choose at random with the Fresnel \
             probability.",
        ),
        key(
            "cells_per_pass",
            count(0, u32::MAX as i64, "cells"),
            Value("0"),
            "Cells with points that a ray may cross in one dispatch. 0 lets the device decide, 1 is the paper's \
             loop. Changes no pixel.",
        ),
        key(
            "loop",
            Kind::Choice(&["images", "queue", "auto"]),
            Value("\"auto\""),
            "Where the ray state lives: four images that are read and four that are written, as in the paper, or a \
             queue in a buffer, in place, which \"auto\" takes. A device whose texel buffers are too short for a \
             queue takes images. Changes no pixel.",
        ),
        key("seed", count(0, u32::MAX as i64, ""), Value("0"), "Seed of all that is random."),
        key(
            "grid_resolution",
            Kind::Either(&[Kind::Choice(&["paper"]), count(0, 1024, "cells")]),
            Value("0"),
            "Cells along the longest axis of one grid. 0 chooses grids from the points; `\"paper\"` takes about as \
             many as the paper, 20·∛(N/35 000) for N points. Changes no pixel.",
        ),
        key(
            "primary",
            Kind::Choice(&["grid", "discs", "tree", "auto"]),
            Value("\"auto\""),
            "How camera rays find their first hit: cell after cell of the grid, each tile of pixels among the \
             points whose discs cover it, or through a tree of boxes around the points. `auto` takes discs or the \
             tree, whichever is expected to be faster; several samples a pixel and orthographic views never take \
             discs. Where cells are limited or counted, or the ray state lives in images, the grid replaces the \
             tree. Changes no pixel.",
        ),
        key(
            "secondary",
            Kind::Choice(&["grid", "tree", "auto"]),
            Value("\"auto\""),
            "How shadow rays and those from mirrors and glass find their hits: cell after cell of the grid, or \
             through the tree, which `auto` takes. Where cells are limited or counted, or the ray state lives in \
             images, the grid replaces the tree. Changes no pixel.",
        ),
        key(
            "preset",
            Kind::Choice(&["paper"]),
            Words("none", "\"paper\""),
            "Other defaults for several keys, beneath whatever the scene and `--set` say. `paper` renders as the \
             paper does: see docs/method.md, The paper's own method.",
        ),
    ],
};

pub(crate) static BACKGROUND: Table = Table {
    header: "[background]",
    doc: "What rays that hit nothing see. It lights nothing else.",
    whole: Some(background_is_one),
    keys: &[
        key("color", RADIANCE, Value("[0.0, 0.0, 0.0]"), "One radiance in every direction."),
        key(
            "environment",
            Kind::Text("the path of an image"),
            Words("none", "\"sky.exr\""),
            "An equirectangular image (EXR or HDR; PNG and JPEG are decoded from sRGB) instead of \
             `color`. Its top is the camera's `up` where that is an axis, so that the horizon is level; a \
             direction (x, y, z) is looked up as (x, y, z) for +y, (x, -y, -z) for -y, (x, z, -y) for +z, \
             (x, -z, y) for -z, (-y, x, z) for +x, (y, -x, z) for -x, and as for +y where `up` is no axis. In \
             what is looked up +y is the top row, -z the middle, +x right of that.",
        ),
        key(
            "rotate",
            Kind::Vector(numbers(-1e6, 1e6, "degrees")),
            Value("[0.0, 0.0, 0.0]"),
            "Turns the environment about the world's fixed axes x, then y, then z, right-handed, as \
             `transform.rotate` turns an object; an error without one.",
        ),
    ],
};

pub(crate) static LIGHTS: Table = Table {
    header: "[[lights]]",
    doc: "A light. A scene without lights is black wherever it is diffuse.",
    whole: Some(direction_has_a_length),
    keys: &[
        key(
            "kind",
            Kind::Choice(&["directional", "point", "headlight"]),
            Required("\"directional\""),
            "Light from infinitely far away, from a point, or from the camera's eye (along its line of sight \
             where rays are parallel), where no shadow is seen.",
        ),
        key_of(
            "directional",
            "direction",
            Kind::Direction,
            Required("[-0.4, -1.0, -0.3]"),
            "The way the light travels; any length.",
        ),
        key_of(
            "directional",
            "irradiance",
            Kind::Vector(numbers(0.0, LARGE, "W m⁻², linear RGB")),
            Required("[3.0, 3.0, 3.0]"),
            "On a surface that faces the light.",
        ),
        key_of(
            "directional",
            "angle",
            Kind::Number(numbers(0.0, 179.9, "degrees")),
            Value("0.0"),
            "Angle that the light's disc on the sky is wide; the sun's is 0.53. More than 0 makes \
             soft shadows, with `image.samples` over 1.",
        ),
        key_of("point", "position", POSITION, Required("[1.0, 2.0, 0.0]"), "In the world."),
        key_of(
            "point",
            "intensity",
            Kind::Vector(numbers(0.0, LARGE, "W sr⁻¹, linear RGB")),
            Required("[5.0, 5.0, 5.0]"),
            "Radiant intensity I; the irradiance at distance r is I/r².",
        ),
        key_of(
            "point",
            "radius",
            Kind::Number(numbers(0.0, LARGE, "scene units")),
            Value("0.0"),
            "Radius of the sphere that shines. More than 0 makes soft shadows, with `image.samples` \
             over 1. Nothing sees the sphere itself.",
        ),
        key_of(
            "headlight",
            "at_target",
            Kind::Vector(numbers(0.0, LARGE, "W m⁻², linear RGB")),
            Required("[1.0, 1.0, 1.0]"),
            "Irradiance on a surface that faces the light, as far away as the camera's target; at r times \
             that distance it is 1/r² of it.",
        ),
    ],
};

pub(crate) static OBJECTS: Table = Table {
    header: "[[objects]]",
    doc: "A point set with its place, surface and material. A scene has at least one. Its place \
          in the file, counted from 0, is its index in the picture's `object` channel.",
    whole: None,
    keys: &[
        key(
            "name",
            Kind::Text("a name"),
            Words("the point file's name without folder and extension", "\"knot\""),
            "Name in messages and statistics.",
        ),
        key(
            "points",
            Kind::Text("the path of a point file"),
            Required("\"points/knot.ply\""),
            "The point file, relative to the scene file's folder.",
        ),
        key(
            "units",
            Kind::Choice(&["auto", "degrees", "scene"]),
            Value("\"auto\""),
            "What x and y of the file are. `\"degrees\"`: longitude and latitude, which are projected to \
             metres east and north of a centre that all such objects of the scene share, before the \
             transform; z stays. `\"scene\"`: lengths, which stay as they are. `\"auto\"`: degrees where \
             the file says so, by the names of its columns or by its coordinate reference system.",
        ),
        key("transform", Kind::Table(&TRANSFORM), Absent::Table, TRANSFORM.doc),
        key("surface", Kind::Table(&SURFACE), Absent::Table, SURFACE.doc),
        key("material", Kind::Table(&MATERIAL), Absent::Table, MATERIAL.doc),
        key("volume", Kind::Table(&VOLUME), Words("a pure surface", "{}"), VOLUME.doc),
        key("filter", Kind::Table(&FILTER), Absent::Table, FILTER.doc),
        key(
            "columns",
            Kind::Columns,
            Words(
                "what the file calls them, or is taken to mean",
                "{ x = \"E\", y = \"N\", z = 3 }",
            ),
            "Which column of the file is what: `x`, `y`, `z`, `red`, `green`, `blue`, `nx`, `ny`, `nz`, \
             `intensity`, `classification`, or any other name for an attribute, each with the column's \
             name in the file or its number from 1. `_` lists the numbers of columns that are passed \
             over. See docs/point-files.md, Choosing columns.",
        ),
    ],
};

pub(crate) static FILTER: Table = Table {
    header: "[objects.filter]",
    doc: "Which points of the file are taken. The conditions apply in this order while the file is \
          read; what is left out takes no memory. Coordinates and lengths are the file's. How many \
          points were kept, of how many, is said on the terminal, by `info` and in `--stats`.",
    whole: None,
    keys: &[
        key(
            "every",
            count(1, u32::MAX as i64, "points"),
            Value("1"),
            "The first point of the file and every n-th after it, whatever the other \
             conditions leave out.",
        ),
        key("box", Kind::Table(&FILTER_BOX), Words("everywhere", "{}"), FILTER_BOX.doc),
        key(
            "range",
            Kind::Ranges(numbers(-LARGE, LARGE, "")),
            Words("any", "{ intensity = [100, 2000], z = [0, 50] }"),
            "Least and greatest value of attributes, or of x, y and z; both are taken. `info` lists \
             the attributes of a file. What is no number is left out.",
        ),
        key(
            "classification",
            Kind::List { of: &Kind::Integer { min: 0, max: 255, unit: "" }, max: 256 },
            Words("any", "[2, 6]"),
            "Values of the attribute `classification` that are taken: of LAS, 2 is ground, 6 \
             buildings.",
        ),
        key(
            "voxel",
            Kind::Either(&[
                Kind::Choice(&["auto"]),
                Kind::Number(numbers(SHORT, LARGE, "units of the file")),
            ]),
            Words("none", "0.1"),
            "Edge of cubes, counted from the origin of the file's coordinates, in each of which the points \
             that meet all other conditions become one, their mean; a larger one leaves fewer points. `auto` \
             takes twice the median distance of points to the nearest other one, which thins what is denser \
             than the middle.",
        ),
    ],
};

pub(crate) static FILTER_BOX: Table = Table {
    header: "[objects.filter.box]",
    doc: "A box along the axes of the file's coordinates; its faces belong to it.",
    whole: Some(box_has_an_inside),
    keys: &[
        key("min", FILE_POSITION, Required("[0.0, 0.0, 0.0]"), "The lowest corner."),
        key("max", FILE_POSITION, Required("[10.0, 10.0, 5.0]"), "The highest corner."),
    ],
};

pub(crate) static TRANSFORM: Table = Table {
    header: "[objects.transform]",
    doc: "From the file's coordinates (of degrees, from metres) to the world's: scale, then rotate, then translate.",
    whole: None,
    keys: &[
        key("scale", Kind::Number(numbers(1e-12, 1e12, "")), Value("1.0"), "One positive factor."),
        key(
            "rotate",
            Kind::Vector(numbers(-1e6, 1e6, "degrees")),
            Value("[0.0, 0.0, 0.0]"),
            "About the fixed axes x, then y, then z, right-handed.",
        ),
        key("translate", POSITION, Value("[0.0, 0.0, 0.0]"), "Added last."),
    ],
};

pub(crate) static SURFACE: Table = Table {
    header: "[objects.surface]",
    doc: "How the surface is fitted. Lengths are scene units, after the transform.",
    whole: Some(surface_has_no_key_in_vain),
    keys: &[
        key(
            "kind",
            Kind::Choice(&["points", "spheres", "discs"]),
            Value("\"points\""),
            "What is drawn: the smooth surface through the points, a sphere at each point, or a flat disc at \
             each point, across the file's normals or, without these, the plane through its 16 nearest \
             others. Of the other keys, spheres and discs use `radius`, `radius_scale` and `drop_isolated`.",
        ),
        key(
            "radius",
            Kind::Either(&[
                Kind::Choice(&["auto", "local"]),
                Kind::Prefixed("attribute:", "the name of an attribute of the points"),
                LENGTH,
            ]),
            Value("\"auto\""),
            "Kinds `spheres` and `discs` only: the radius of all, in scene units; `\"attribute:NAME\"`, an \
             attribute in the file's units, which is scaled with the object; `auto`, half the median \
             distance between nearest points, for all; or `local`, half the mean distance of each point's \
             four nearest others, for sets of uneven density.",
        ),
        key(
            "radius_scale",
            Kind::Number(numbers(1e-6, 1e6, "")),
            Value("1.0"),
            "Kinds `spheres` and `discs` only: a factor on `radius`. With `auto`, 1 lets spheres on a \
             lattice touch, and discs close a surface from 1.5 or 2 on.",
        ),
        key(
            "scatter",
            Kind::Choice(&["discs", "spheres", "drop"]),
            Value("\"discs\""),
            "Neighbors `auto` only, where points have noise: how those are drawn that lie on no surface: as \
             small discs, small spheres, or not at all. Of glass, which has an inside, discs are spheres.",
        ),
        key(
            "neighbors",
            Kind::Either(&[Kind::Choice(&["auto"]), count(3, 256, "points")]),
            Value("\"auto\""),
            "Nearest other points of a fit. `auto` is 16, and where points have noise, they are first moved \
             onto the surface that they are samples of; a number, or one of `feature_size`, \
             `weight_width` and `refine` being given, takes them as they are.",
        ),
        key(
            "accuracy",
            Kind::Number(numbers(0.1, 30.0, "degrees")),
            Value("2.5"),
            "Neighbors `auto` only: the error of normals up to which noise is smoothed. Smaller is smoother.",
        ),
        key(
            "polynomial",
            Kind::Choice(&["full", "incomplete"]),
            Value("\"full\""),
            "With the linear terms, or without them as in the paper.",
        ),
        key(
            "feature_size",
            Kind::Either(&[Kind::Choice(&["adaptive", "smoothed"]), LENGTH]),
            Value("\"adaptive\""),
            "The length h that weights and trust radii are measured by: each point's distance to \
             its farthest neighbour, the mean of that over a point and its neighbours (for sets of \
             very uneven density), or one length.",
        ),
        key(
            "trust",
            Kind::Number(numbers(0.5, 1.0, "")),
            Value("0.6"),
            "Trust radius over feature size, b/h.",
        ),
        key(
            "refine",
            Kind::Choice(&["none", "project"]),
            Value("\"none\""),
            "Take the nearest hit with a stored polynomial, or project it onto the exact surface.",
        ),
        key(
            "tolerance",
            Kind::Number(numbers(1e-9, 1.0, "feature sizes")),
            Value("1e-4"),
            "Distance of a hit to its projection at which `project` stops.",
        ),
        key(
            "max_iterations",
            count(1, 100, "iterations"),
            Value("8"),
            "Projections of one hit at most, for `project`; the last one then stands.",
        ),
        key(
            "close_gaps",
            Kind::Bool,
            Value("true"),
            "Raise single trust radii, at most to the feature size, where neighbours leave a gap.",
        ),
        key(
            "weight_width",
            Kind::Number(numbers(0.25, 4.0, "")),
            Value("1.0"),
            "Width w of the weights exp(-d²/(w h)²): wider smooths noise, narrower keeps detail.",
        ),
        key(
            "drop_isolated",
            Kind::Number(numbers(0.0, 100.0, "standard deviations")),
            Value("0.0"),
            "Drop points whose mean distance to their neighbours is over the mean of all points' by \
             more than this, and at least twice that mean; 0 drops none. How many is said.",
        ),
        key(
            "boundary_clip",
            Kind::Bool,
            Value("true"),
            "End the surface of an open set near its last points, about half their spacing beyond, not \
             a trust radius. Even closed sets are not changed.",
        ),
        key(
            "normals",
            Kind::Choice(&["polynomial", "blended"]),
            Value("\"blended\""),
            "Normal of a hit: the hit polynomial's, as in the paper, or blended over all polynomials \
             around it, which leaves no seams between them. Refined hits have none to blend.",
        ),
    ],
};

pub(crate) static MATERIAL: Table = Table {
    header: "[objects.material]",
    doc: "How the surface scatters light. Keys of another kind than the material's have no effect.",
    whole: Some(material_has_one_color),
    keys: &[
        key(
            "kind",
            Kind::Choice(&["diffuse", "mirror", "glass"]),
            Value("\"diffuse\""),
            "Lambert on both sides, perfect mirror, or smooth glass.",
        ),
        key(
            "albedo",
            Kind::Either(&[
                Kind::Choice(&["points"]),
                Kind::Prefixed("attribute:", "the name of an attribute of the points"),
                SHARE,
            ]),
            Words("the points' own colours where they have them, else 0.8", "[0.8, 0.8, 0.8]"),
            "Diffuse: the share of light scattered back; `\"points\"` takes the points' own \
             colours, `\"attribute:NAME\"` shows an attribute (or x, y, z of the file) through \
             `color_map`.",
        ),
        key(
            "color_map",
            Kind::Choice(&crate::scene::ColorMap::NAMES),
            Value("\"viridis\""),
            "Colours of an attribute, from the lower end of `value_range` to the upper one.",
        ),
        key(
            "value_range",
            Kind::Pair(numbers(-1e300, 1e300, "in the attribute's unit")),
            Words("the attribute's own range", "[0.0, 1.0]"),
            "Values of an attribute at the two ends of `color_map`, also the greater one first; what lies beyond \
             has their colours.",
        ),
        key(
            "scale",
            Kind::Choice(&crate::scene::Scale::NAMES),
            Value("\"linear\""),
            "How values of an attribute lie between the ends of `value_range`: `log`, by their logarithms, for what \
             spans decades. Values of 0 or less have the colour of the lower end, and the attribute's own range \
             begins at its smallest positive value then.",
        ),
        key(
            "texture",
            Kind::Text("the path of an image"),
            Words("none", "\"grass.png\""),
            "Diffuse, instead of `albedo`: an image (PNG, JPEG, EXR, HDR) over the object; see \
             `texture_axis`.",
        ),
        key(
            "texture_axis",
            Kind::Choice(&["x", "y", "z", "uv"]),
            Words("`\"uv\"` where the points have u and v, else `\"y\"`", "\"y\""),
            "Projects `texture` along an axis over the bounding box of the points, in the file's \
             coordinates, before the transform. Seen from the positive axis: `\"y\"` has x to the right and z \
             downwards, `\"z\"` has x to the right and y upwards, `\"x\"` has -z to the right and y \
             upwards. `\"uv\"` takes the points' attributes u and v (or s and t, texture_u and \
             texture_v); v counts upwards from the bottom row.",
        ),
        key("reflectance", SHARE, Value("[1.0, 1.0, 1.0]"), "Mirror: the share reflected."),
        key(
            "ior",
            Kind::Either(&[
                Kind::Number(numbers(0.1, 10.0, "")),
                Kind::Vector(numbers(0.1, 10.0, "")),
            ]),
            Value("1.5"),
            "Glass: refractive index, one number or one for each of red, green and blue. Where it is that of the \
             medium around, 1 for air, the surface is not seen and light passes it; any other throws a black \
             shadow.",
        ),
        key(
            "abbe",
            Kind::Number(numbers(1.0, 1000.0, "")),
            Words("no dispersion", "64.2"),
            "Glass: Abbe number; `ior` is then the index n_d at 587.6 nm, and those of the channels are \
             Cauchy's n = A + B/λ² at 611, 549 and 464 nm.",
        ),
        key(
            "priority",
            count(-1_000_000, 1_000_000, ""),
            Value("0"),
            "Glass: the highest counts where media overlap; ties go to the last in the scene.",
        ),
        key(
            "absorption",
            Kind::Vector(numbers(0.0, LARGE, "per scene unit, linear RGB")),
            Value("[0.0, 0.0, 0.0]"),
            "Glass: σ in exp(−σℓ) over the length ℓ inside.",
        ),
    ],
};

const AUTO_LENGTH: Kind = Kind::Either(&[Kind::Choice(&["auto"]), LENGTH]);

pub(crate) static VOLUME: Table = Table {
    header: "[objects.volume]",
    doc: "A volume made of the points. Left out, the object is a pure surface.",
    whole: Some(volume_says_it_once),
    keys: &[
        key(
            "scalar",
            Kind::Text("the name of an attribute"),
            Required("\"density\""),
            "The points' attribute that is shown.",
        ),
        key(
            "kernel",
            Kind::Choice(&["shepard", "sum", "sph"]),
            Value("\"shepard\""),
            "How points are blended: by the weighted mean of those in reach, as in the paper, by the \
             weighted sum, or as particles of smoothed particle hydrodynamics: Σ (m/ρ) A W(d, h) with the \
             cubic spline W, which ends at 2h.",
        ),
        key(
            "smoothing_length",
            Kind::Either(&[LENGTH, Kind::Text("the name of an attribute")]),
            Words("none; required where the kernel is sph", "\"h\""),
            "Kernel `sph` only: h of every particle, or the attribute that has it, which is scaled with the \
             object.",
        ),
        key(
            "mass",
            Kind::Either(&[
                Kind::Number(numbers(0.0, LARGE, "")),
                Kind::Text("the name of an attribute, or \"auto\""),
            ]),
            Value("\"auto\""),
            "Kernel `sph` only: m of every particle, or the attribute that has it; `auto` takes each \
             particle's volume m/ρ to be (h/1.2)³.",
        ),
        key(
            "density",
            Kind::Text("the name of an attribute"),
            Words("that of `scalar`: the density Σ m W itself is shown", "\"rho\""),
            "Kernel `sph` with `mass` only: the attribute that has the particles' density ρ.",
        ),
        key(
            "radius",
            AUTO_LENGTH,
            Value("\"auto\""),
            "Reach of a point; with kernel `sph`, the largest 2h, and not to be given.",
        ),
        key(
            "smoothing",
            Kind::Either(&[
                Kind::Choice(&["auto"]),
                Kind::Number(numbers(SHORT, LARGE, "scene units squared")),
            ]),
            Value("\"auto\""),
            "ρ in the weight exp(−d²/2ρ).",
        ),
        key("step", AUTO_LENGTH, Value("\"auto\""), "Distance of the samples along a ray."),
        key(
            "mode",
            Kind::Choice(&["emission", "maximum", "average", "integral", "isosurface"]),
            Value("\"emission\""),
            "What a ray shows: emission and extinction along its way; the greatest scalar on it, as a layer \
             of one `radius`; the mean scalar, all along the way; the integral of the scalar over the length \
             of the way (the column density, where the scalar is a density), once; or the surface where the \
             scalar is `iso`, with the object's material, lit like any other. `maximum`, `average` and \
             `integral` need the scene's only volume, and are the channel `value` of an EXR \
             (`--channels value`).",
        ),
        key(
            "iso",
            Kind::Number(numbers(-LARGE, LARGE, "in the attribute's unit")),
            Words("none; required where the mode is isosurface", "0.5"),
            "Mode `isosurface` only: the scalar on the surface. Of glass, the inside is where it is greater.",
        ),
        key(
            "shading",
            Kind::Choice(&["none", "gradient", "scatter"]),
            Value("\"none\""),
            "Mode `emission` only: colours are emitted, or they scatter the light of up to four lights that \
             reaches the points, past surfaces and volumes: as a surface across the scalar's gradient would, \
             or evenly to all sides.",
        ),
        key(
            "boundary",
            Kind::Text("the name of an attribute, or \"all\", \"none\", \"auto\""),
            Value("\"none\""),
            "Which points carry the object's surface: those whose attribute of this name is not zero, \
             `all`, `none`, or, with `auto`, those with no neighbour on one side. The volume then counts \
             only inside that surface, where `material.kind` is `glass`.",
        ),
        key(
            "transfer",
            STOPS,
            Words(
                "`color_map`; one of the two is required",
                "[{ value = 0.0, color = [0.0, 0.0, 1.0], extinction = 0.0 }]",
            ),
            TRANSFER.doc,
        ),
        key(
            "color_map",
            Kind::Choice(&crate::scene::ColorMap::NAMES),
            Words("`transfer`; one of the two is required", "\"viridis\""),
            "Instead of `transfer`: colours from the lower end of `value_range` to the upper one.",
        ),
        key(
            "value_range",
            Kind::Either(&[
                Kind::Choice(&["auto"]),
                Kind::Range(numbers(-LARGE, LARGE, "in the attribute's unit")),
            ]),
            Words("\"auto\"; required where the mode is integral", "[0.0, 1.0]"),
            "With `color_map`: scalars at its two ends; what lies beyond has their colours. `auto` is the \
             attribute's own range; with mode `integral`, whose values are the attribute's times a length, from \
             0 to the greatest scalar times the diagonal of the box around the volume, which no ray exceeds.",
        ),
        key(
            "scale",
            Kind::Choice(&crate::scene::Scale::NAMES),
            Value("\"linear\""),
            "With `color_map`: how scalars lie between the ends of `value_range`: `log`, by their logarithms, for what \
             spans decades, extinctions too. Scalars of 0 or less are as the lower end, and the attribute's own range \
             begins at its smallest positive value then.",
        ),
        key(
            "extinction",
            Kind::Either(&[
                Kind::Choice(&["auto"]),
                Kind::Number(EXTINCTION),
                Kind::Pair(EXTINCTION),
            ]),
            Words(
                "1 with `transfer`; required beside `color_map`, but with mode `integral`, which is then opaque",
                "[0.0, 5.0]",
            ),
            "With `color_map`: σ everywhere, or at the two ends of `value_range` and linear along the map between. With \
             `transfer`: a factor on the extinctions of its stops. With mode `integral` it is the optical depth of a \
             pixel with that value. `auto`, in mode `emission`: the σ, or the factor, that makes the optical depth \
             across the median chord of the object's bulk 2.",
        ),
    ],
};

const EXTINCTION: Numbers = numbers(0.0, LARGE, "per scene unit");
const STOPS: Kind = Kind::Tables { table: &TRANSFER, min: 1, max: 4096, in_file: true };

/// A file that scenes share a transfer function by.
pub(crate) static TRANSFER_FILE: Table = Table {
    header: "a file of a transfer function",
    doc: "",
    whole: Some(stops_ascend),
    keys: &[key(
        "transfer",
        Kind::Tables { table: &TRANSFER, min: 1, max: 4096, in_file: false },
        Required("[{ value = 0.0, color = [0.0, 0.0, 1.0], extinction = 0.0 }]"),
        TRANSFER.doc,
    )],
};

pub(crate) static TRANSFER: Table = Table {
    header: "[[objects.volume.transfer]]",
    doc: "The stops of the transfer function, ascending in value; or the path of a TOML file that has them as \
          its `transfer`, relative to the scene file's folder. A stop has a colour and an extinction, an emission, or \
          all three; what lies between two stops is linear.",
    whole: Some(stop_shows_something),
    keys: &[
        key(
            "value",
            Kind::Number(numbers(-LARGE, LARGE, "in the attribute's unit")),
            Required("0.0"),
            "The scalar at this stop.",
        ),
        key(
            "color",
            RADIANCE,
            Words("black; required where there is no `emission`", "[0.0, 0.0, 1.0]"),
            "Colour of what the extinction stops: a way with the coverage α = 1 − exp(−σℓ) sends α times \
             this.",
        ),
        key(
            "extinction",
            Kind::Number(EXTINCTION),
            Words("0; required where there is no `emission`", "0.0"),
            "σ in α = 1 − exp(−σℓ); larger values are denser.",
        ),
        key(
            "emission",
            Kind::Vector(numbers(0.0, LARGE, "per scene unit, linear RGB")),
            Value("[0.0, 0.0, 0.0]"),
            "Radiance per length, beside what colour and extinction send, and whatever light reaches the \
             volume: without extinction it adds to what is beyond and covers nothing.",
        ),
    ],
};

impl Kind {
    /// What a value has to be, in words.
    pub(crate) fn expected(&self) -> String {
        match self {
            Kind::Bool => "true or false".into(),
            Kind::Integer { min, max, unit } => {
                format!("an integer from {min} to {max}{}", spaced(unit))
            }
            Kind::Number(n) => format!("a number {n}"),
            Kind::Vector(n) => format!("three numbers {n}"),
            Kind::Direction => {
                format!(
                    "a direction of three numbers from {} to {}, not all zero",
                    plain(-LARGE),
                    plain(LARGE)
                )
            }
            Kind::Size { max } => format!("width and height, two integers from 1 to {max} pixels"),
            Kind::Range(n) => format!("two numbers {n}, the second greater"),
            Kind::Choice(names) => choice(names),
            Kind::Prefixed(before, what) => format!("\"{before}\" and {what}"),
            Kind::Text(what) => format!("{what}, a string"),
            Kind::Either(kinds) => {
                kinds.iter().map(Kind::expected).collect::<Vec<_>>().join(", or ")
            }
            Kind::Table(_) => "a table".into(),
            Kind::Pair(n) => format!("two numbers {n}"),
            Kind::Tables { min, max, in_file: true, .. } => {
                format!("a list of {min} to {max} tables, or the path of a file that has it")
            }
            Kind::Tables { min: 0, max, .. } => format!("a list of up to {max} tables"),
            Kind::Tables { min, max, .. } => format!("a list of {min} to {max} tables"),
            Kind::List { of, max } => format!("a list of 1 to {max}, each {}", of.expected()),
            Kind::Ranges(n) => {
                format!("a table of names, each with two numbers {n}, the second no less")
            }
            Kind::Columns => {
                "a table of names, each with a column's name or its number from 1".into()
            }
            Kind::Names(of) => format!("the name of {of}, or a list of such names"),
        }
    }
}

/// The component range of a direction.
pub(crate) const DIRECTION: Numbers = numbers(-LARGE, LARGE, "");

impl std::fmt::Display for Numbers {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "from {} to {}{}", plain(self.min), plain(self.max), spaced(self.unit))
    }
}

impl Key {
    /// A value to imitate, as TOML.
    pub(crate) fn example(&self) -> &'static str {
        match self.absent {
            Required(example) | Value(example) | Words(_, example) => example,
            Absent::Table => "{}",
        }
    }
}

fn spaced(unit: &str) -> String {
    if unit.is_empty() { String::new() } else { format!(" {unit}") }
}

/// `"a"`, `"a" or "b"`, or `"a", "b" or "c"`.
fn choice(names: &[&str]) -> String {
    let quoted: Vec<String> = names.iter().map(|name| format!("\"{name}\"")).collect();
    match quoted.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, rest)) => format!("{} or {last}", rest.join(", ")),
        None => String::new(),
    }
}

/// A number as a person would write it.
pub(crate) fn plain(x: f64) -> String {
    if x != 0.0 && !(1e-4..1e6).contains(&x.abs()) { format!("{x:e}") } else { format!("{x}") }
}
