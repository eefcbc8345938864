//! The keys of `[objects.volume]` and of transfer functions.

use super::checks::{stop_shows_something, stops_ascend, volume_says_it_once};
use crate::keys::Absent::{Required, Value, Words};
use crate::keys::{Kind, LARGE, LENGTH, Numbers, RADIANCE, SHORT, Table, key, numbers};
use crate::{ColorMap, Scale};

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
            Kind::Either(&[Kind::Choice(&["auto", "adaptive"]), LENGTH]),
            Value("\"auto\""),
            "Reach of a point. With `adaptive`, each has its own, the mean over its 16 neighbours of the distance to \
             their 16th; `auto` takes that where it is uneven, and else one for all. With kernel `sph` a particle \
             reaches 2h, and nothing is to be given.",
        ),
        key(
            "smoothing",
            Kind::Either(&[
                Kind::Choice(&["auto"]),
                Kind::Number(numbers(SHORT, LARGE, "scene units squared")),
            ]),
            Value("\"auto\""),
            "ρ in the weight exp(−d²/2ρ); `auto` takes (radius/2)². A number does not go with `radius = \
             \"adaptive\"`.",
        ),
        key(
            "step",
            AUTO_LENGTH,
            Value("\"auto\""),
            "Distance of the samples along a ray; `auto` takes a quarter of the reach of the points around.",
        ),
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
            "Mode `emission` only: colours are emitted, or they are the share of light that is scattered, of up to four \
             lights that reach the points, past surfaces and volumes: as a surface across the scalar's gradient would, \
             or to all sides by `anisotropy`. With `render.integrator = \"path\"` both scatter as often as it takes, by \
             `anisotropy`.",
        ),
        key(
            "anisotropy",
            Kind::Number(numbers(-0.99, 0.99, "")),
            Value("0.0"),
            "Shading `scatter` only: the mean cosine of the angle that light is scattered by, g of the phase function of \
             Henyey and Greenstein: 0 evenly to all sides, towards 1 ahead, towards -1 back.",
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
            Kind::Choice(&ColorMap::NAMES),
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
            Kind::Choice(&Scale::NAMES),
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
