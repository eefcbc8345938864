//! `[render]`: how rays are followed.

use crate::keys::Absent::{Value, Words};
use crate::keys::{Kind, LARGE, SHORT, Table, count, key, numbers};
use crate::read::{Reader, to_number};
use std::fmt::{self, Write};

/// How rays are followed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RenderSettings {
    /// Surface interactions after the primary hit, 0 to 1024.
    pub max_bounces: u32,
    /// Where light comes from.
    pub integrator: Integrator,
    /// The most radiance that a sample of light takes from one place that is not seen at once, more than 0 to 1e15.
    pub clamp: Option<f64>,
    /// What glass does with a ray that it both reflects and refracts.
    pub fresnel: Fresnel,
    /// What glass does with light on its way to a surface.
    pub shadows: Shadows,
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

/// Where light comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Integrator {
    /// From the lights.
    Direct,
    /// From the lights, and at every diffuse hit from the background.
    Sky,
    /// From the lights, the background, and every surface and volume that these light.
    Path,
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

/// What glass does with light on its way to a surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shadows {
    /// Light goes straight on through glass, less what Fresnel's equations reflect and what media absorb.
    Tinted,
    /// Glass blocks light, but for surfaces between media of one index.
    Opaque,
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

pub(crate) static RENDER: Table = Table {
    header: "[render]",
    doc: "How rays are followed.",
    whole: None,
    keys: &[
        key(
            "max_bounces",
            count(0, 1024, "surface interactions"),
            Value("8"),
            "Interactions after the primary hit; a ray that has spent them takes the background. With `integrator = \
             \"path\"`, light that has come over more surfaces, or been scattered more often in volumes, does not count.",
        ),
        key(
            "integrator",
            Kind::Choice(&["direct", "sky", "path"]),
            Value("\"direct\""),
            "Where light comes from: `direct`, from the lights of the scene; `sky`, at every diffuse hit from the \
             background too, wherever nothing is in its way; `path`, also from surface to surface, through glass and \
             volumes, up to `max_bounces`. `sky` and `path` draw directions at random: they want `image.samples`.",
        ),
        key(
            "clamp",
            Kind::Number(numbers(SHORT, LARGE, "radiance")),
            Words("none", "10.0"),
            "With `integrator = \"path\"`: the most that one sample takes of light which has come over a diffuse \
             surface or a volume before the last. It removes bright specks, and some light.",
        ),
        key(
            "fresnel",
            Kind::Choice(&["transmit", "sample"]),
            Value("\"transmit\""),
            "What glass does with a ray: always refract it, or choose at random with the Fresnel \
             probability.",
        ),
        key(
            "shadows",
            Kind::Choice(&["tinted", "opaque"]),
            Value("\"tinted\""),
            "What glass does with light on its way to a surface: let it go straight on, dimmed by Fresnel's equations \
             and by what media absorb, in colour, or block it as in the paper, but for surfaces between media of one \
             index.",
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

impl RenderSettings {
    pub(crate) fn read(table: &Reader<'_>) -> Self {
        Self {
            max_bounces: table.count("max_bounces"),
            integrator: match table.text("integrator").as_str() {
                "sky" => Integrator::Sky,
                "path" => Integrator::Path,
                _ => Integrator::Direct,
            },
            clamp: table.written("clamp").map(|_| table.number("clamp")),
            fresnel: match table.text("fresnel").as_str() {
                "sample" => Fresnel::Sample,
                _ => Fresnel::Transmit,
            },
            shadows: match table.text("shadows").as_str() {
                "opaque" => Shadows::Opaque,
                _ => Shadows::Tinted,
            },
            cells_per_pass: table.count("cells_per_pass"),
            ray_loop: match table.text("loop").as_str() {
                "images" => RayLoop::Images,
                "queue" => RayLoop::Queue,
                _ => RayLoop::Auto,
            },
            seed: table.count("seed"),
            grid_resolution: match to_number(&table.value("grid_resolution")) {
                Some(_) => GridResolution::Cells(table.count("grid_resolution")),
                None => GridResolution::Paper,
            },
            primary: match table.text("primary").as_str() {
                "grid" => Primary::Grid,
                "discs" => Primary::Discs,
                "tree" => Primary::Tree,
                _ => Primary::Auto,
            },
            secondary: match table.text("secondary").as_str() {
                "grid" => Secondary::Grid,
                "tree" => Secondary::Tree,
                _ => Secondary::Auto,
            },
        }
    }
}

impl Default for RenderSettings {
    fn default() -> Self {
        Self::read(&Reader::defaults(&RENDER))
    }
}

pub(crate) fn write_render(out: &mut String, render: &RenderSettings) -> fmt::Result {
    let fresnel = match render.fresnel {
        Fresnel::Transmit => "transmit",
        Fresnel::Sample => "sample",
    };
    let shadows = match render.shadows {
        Shadows::Tinted => "tinted",
        Shadows::Opaque => "opaque",
    };
    writeln!(out, "[render]")?;
    let integrator = match render.integrator {
        Integrator::Direct => "direct",
        Integrator::Sky => "sky",
        Integrator::Path => "path",
    };
    writeln!(out, "max_bounces = {}", render.max_bounces)?;
    writeln!(out, "integrator = \"{integrator}\"")?;
    if let Some(clamp) = render.clamp {
        writeln!(out, "clamp = {clamp:?}")?;
    }
    writeln!(out, "fresnel = \"{fresnel}\"")?;
    writeln!(out, "shadows = \"{shadows}\"")?;
    writeln!(out, "seed = {}", render.seed)?;
    match render.grid_resolution {
        GridResolution::Cells(cells) => writeln!(out, "grid_resolution = {cells}\n"),
        GridResolution::Paper => writeln!(out, "grid_resolution = \"paper\"\n"),
    }
}
