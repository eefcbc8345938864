//! `[objects.surface]`: how the surface is fitted.

use crate::document;
use crate::keys::Absent::Value;
use crate::keys::{Fault, Kind, LENGTH, Table, count, key, numbers};
use crate::read::{Reader, to_number};
use crate::settings::quoted;
use std::fmt::{self, Write};

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

/// The key, if any, by which a surface says that it is fitted to the points where they lie.
fn key_of_points_as_they_are(surface: &Reader<'_>) -> Option<&'static str> {
    let number = to_number(&surface.value("neighbors")).map(|_| "neighbors");
    let given = |name: &&str| surface.written(name).is_some();
    number.or_else(|| ["feature_size", "weight_width", "refine"].into_iter().find(given))
}

impl Surface {
    pub(crate) fn read(table: &Reader<'_>) -> Self {
        let radius = || ShapeRadius {
            of: match table.value("radius") {
                document::Value::Text(text) => match text.strip_prefix("attribute:") {
                    Some(name) => RadiusOf::Attribute(name.trim().to_owned()),
                    None if text == "local" => RadiusOf::LocalSpacing,
                    None => RadiusOf::Spacing,
                },
                number => to_number(&number).map_or(RadiusOf::Spacing, RadiusOf::Length),
            },
            scale: table.number("radius_scale"),
        };
        Self {
            kind: match table.text("kind").as_str() {
                "spheres" => SurfaceKind::Spheres(radius()),
                "discs" => SurfaceKind::Discs(radius()),
                _ => SurfaceKind::Points,
            },
            scatter: match table.text("scatter").as_str() {
                "spheres" => Scatter::Spheres,
                "drop" => Scatter::Drop,
                _ => Scatter::Discs,
            },
            neighbors: match to_number(&table.value("neighbors")) {
                Some(_) => Neighbors::Count(table.count("neighbors")),
                None if key_of_points_as_they_are(table).is_some() => {
                    Neighbors::Count(Neighbors::FEW)
                }
                None => Neighbors::Auto { accuracy: table.number("accuracy") },
            },
            polynomial: match table.text("polynomial").as_str() {
                "incomplete" => Polynomial::Incomplete,
                _ => Polynomial::Full,
            },
            feature_size: match to_number(&table.value("feature_size")) {
                Some(length) => FeatureSize::Constant(length),
                None if table.text("feature_size") == "smoothed" => FeatureSize::Smoothed,
                None => FeatureSize::Adaptive,
            },
            trust: table.number("trust"),
            drop_isolated: table.number("drop_isolated"),
            weight_width: table.number("weight_width"),
            close_gaps: table.flag("close_gaps"),
            boundary_clip: table.flag("boundary_clip"),
            normals: match table.text("normals").as_str() {
                "blended" => Normals::Blended,
                _ => Normals::Polynomial,
            },
            refine: match table.text("refine").as_str() {
                "project" => Refine::Project {
                    tolerance: table.number("tolerance"),
                    max_iterations: table.count("max_iterations"),
                },
                _ => Refine::None,
            },
        }
    }
}

impl Default for Surface {
    fn default() -> Self {
        Self::read(&Reader::defaults(&SURFACE))
    }
}

pub(crate) fn write_surface(out: &mut String, surface: &Surface) -> fmt::Result {
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

/// Only spheres and discs have a radius, only a surface leaves points over, and only noise is smoothed.
fn surface_has_no_key_in_vain(surface: &Reader<'_>) -> Result<(), Fault> {
    let kind = surface.text("kind");
    let of_shapes = kind != "points";
    let owned = [
        ("radius", of_shapes, "kind \"spheres\" or \"discs\""),
        ("radius_scale", of_shapes, "kind \"spheres\" or \"discs\""),
        ("scatter", !of_shapes, "kind \"points\""),
    ];
    for (name, fits, owner) in owned {
        if surface.written(name).is_some() && !fits {
            let message = format!("belongs to {owner}, but kind is \"{kind}\"; remove one");
            return Err((name, message));
        }
    }
    if let (Some(_), Some(key)) = (surface.written("accuracy"), key_of_points_as_they_are(surface))
    {
        let found = if key == "neighbors" { "is a number" } else { "is given" };
        let message = format!(
            "belongs to neighbors \"auto\", but {key} {found}, by which points are taken as they are; remove one"
        );
        return Err(("accuracy", message));
    }
    Ok(())
}
