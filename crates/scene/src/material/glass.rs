//! Smooth glass.

use super::{Described, MaterialKind};
use crate::document;
use crate::keys::Absent::{Value, Words};
use crate::keys::{Fault, Kind, LARGE, count, key, numbers};
use crate::read::{Reader, to_number};
use std::fmt::Write;

pub(super) const GLASS: Described = Described {
    name: "glass",
    noun: "glass",
    has_albedo: false,
    has_inside: true,
    keys: &[
        key(
            "ior",
            Kind::Either(&[
                Kind::Number(numbers(0.1, 10.0, "")),
                Kind::Vector(numbers(0.1, 10.0, "")),
            ]),
            Value("1.5"),
            "Glass: refractive index, one number or one for each of red, green and blue. Where it is that of the \
             medium around, 1 for air, the surface is not seen and all light passes it; what other glass does with \
             light is up to render.shadows.",
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
    read: |table| MaterialKind::Glass {
        ior: ior_of_channels(table),
        // Within the range of the key, which is far inside i32.
        priority: to_number(&table.value("priority")).map_or(0, |priority| priority as i32),
        absorption: table.vector("absorption"),
    },
    check: dispersion_is_stated_once,
    write: |kind, out| match kind {
        MaterialKind::Glass { ior, priority, absorption } => {
            writeln!(out, "ior = {ior:?}")?;
            writeln!(out, "priority = {priority}")?;
            writeln!(out, "absorption = {absorption:?}")
        }
        _ => Ok(()),
    },
};

/// Squares of reciprocal wavelengths in µm⁻²: of the dominant wavelengths of Rec. 709's primaries, and of the
/// spectral lines d, F and C that Abbe numbers are defined by.
const CHANNELS: [f64; 3] =
    [1.0 / (0.6114 * 0.6114), 1.0 / (0.5491 * 0.5491), 1.0 / (0.4642 * 0.4642)];
const LINE_D: f64 = 1.0 / (0.587_56 * 0.587_56);
const LINE_F: f64 = 1.0 / (0.486_13 * 0.486_13);
const LINE_C: f64 = 1.0 / (0.656_27 * 0.656_27);

/// The refractive index of each channel; from n_d and an Abbe number V by Cauchy's formula n = A + B/λ²,
/// where V = (n_d − 1) / (n_F − n_C).
fn ior_of_channels(table: &Reader<'_>) -> [f64; 3] {
    let ior = table.value("ior");
    let Some(index) = to_number(&ior) else { return table.vector("ior") };
    let Some(abbe) = table.written("abbe").and_then(|node| to_number(&node.value)) else {
        return [index; 3];
    };
    let b = (index - 1.0) / (abbe * (LINE_F - LINE_C));
    CHANNELS.map(|channel| index + b * (channel - LINE_D))
}

/// An Abbe number goes with one index, not with one a channel.
fn dispersion_is_stated_once(material: &Reader<'_>) -> Result<(), Fault> {
    let several =
        material.written("ior").is_some_and(|ior| matches!(ior.value, document::Value::List(_)));
    if material.written("abbe").is_some() && several {
        let message = "found beside an ior of three numbers, expected one number there; remove \
                       this or give one ior";
        return Err(("abbe", message.into()));
    }
    Ok(())
}
