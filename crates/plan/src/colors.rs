//! What the points of an object bring to its albedo: colours of their own, an attribute in colours of a
//! map, or places in a texture; and how a texture is projected.

use crate::PlanError;
use crate::materials::DEFAULT_ALBEDO;
use crate::missing::{NO_VALUE, marked};
use film::linear_from_srgb;
use points::{ColorEncoding, PointSet};
use scene::{ColorMap, Object, Scale, TextureAxis, Transform};

/// Names that exporters give to the two places of a point in a texture.
pub(crate) const UV: [[&str; 2]; 3] = [["u", "v"], ["s", "t"], ["texture_u", "texture_v"]];
/// Places beyond are as good as infinite, which no arithmetic likes.
const FAR: f64 = 1e6;
/// Under this, a bounding box is flat.
const FLAT: f64 = 1e-30;

/// Decimals that writers give fractions of 1 have at least four, so that they are this near to the bytes that
/// they were.
const NEAR_A_BYTE: f64 = 6e-5;

/// Colours as files have them. Where all of them are floats that were bytes, they are those of the bytes, so
/// that a cloud has one picture in every encoding. One that is not a number is as if the object had none.
pub(crate) fn own_colors(set: &PointSet, colors: &[[f32; 3]]) -> Vec<[f32; 3]> {
    let floats = [ColorEncoding::Fraction, ColorEncoding::Fraction255];
    let mut own = match set.color_encoding {
        Some(encoding) if floats.contains(&encoding) => {
            bytes_of(colors).unwrap_or_else(|| colors.to_vec())
        }
        _ => colors.to_vec(),
    };
    for color in &mut own {
        // What no picture can show comes from no reader, but a set may have it.
        *color = match color.iter().any(|c| c.is_nan()) {
            true => marked(DEFAULT_ALBEDO),
            false => color.map(|c| c.clamp(0.0, 1e15)),
        };
    }
    own
}

/// The colours of the bytes that these were, if all were.
fn bytes_of(colors: &[[f32; 3]]) -> Option<Vec<[f32; 3]>> {
    let linear = |part: f64| linear_from_srgb(part.clamp(0.0, 1.0)) as f32;
    // Of each byte, what is too near to be anything else, and what the reader makes of it.
    let bytes: Vec<[f32; 3]> = (0..=255u8)
        .map(|byte| {
            let part = f64::from(byte) / 255.0;
            [linear(part - NEAR_A_BYTE), linear(part), linear(part + NEAR_A_BYTE)]
        })
        .collect();
    let byte_of = |c: f32| {
        let [low, own, _] = *bytes.get(bytes.partition_point(|[.., high]| *high < c))?;
        (low <= c).then_some(own)
    };
    let color_of = |color: &[f32; 3]| {
        // What is no number is none of a byte either.
        let [r, g, b] = color.map(|c| if c.is_nan() { Some(c) } else { byte_of(c) });
        Some([r?, g?, b?])
    };
    colors.iter().map(color_of).collect()
}

/// The values of the attribute that a name means, or of a coordinate where no attribute is called x, y or z.
/// Otherwise the names that would do.
pub(crate) fn attribute_values(set: &PointSet, name: &str) -> Result<Vec<f64>, String> {
    let axes = ["x", "y", "z"];
    let axis = axes.iter().position(|axis| axis.eq_ignore_ascii_case(name));
    match (set.attribute(name), axis, set.attribute_meant(name)) {
        (Some(values), ..) | (None, None, Some(values)) => Ok(values.iter().collect()),
        (None, Some(axis), _) => Ok(set.positions.iter().map(|p| p[axis]).collect()),
        (None, None, None) => {
            let known = set.attributes.iter().map(|attribute| attribute.name.as_str());
            let left_out = set.left_out.iter().map(String::as_str);
            Err(known.chain(left_out).chain(axes).collect::<Vec<_>>().join(", "))
        }
    }
}

/// The colours of an attribute of the object's points, linear. What is no number is marked. Where the scene gives no
/// range, it is that of the points that count. Also returns the range.
pub(crate) fn attribute_colors(
    object: &Object,
    set: &PointSet,
    (name, map, range, scale): (&str, ColorMap, Option<[f64; 2]>, Scale),
    counts: impl Fn(usize) -> bool,
) -> Result<(Vec<[f32; 3]>, [f64; 2]), PlanError> {
    let values = attribute_values(set, name).map_err(|known| PlanError::NoAttribute {
        name: object.name.clone(),
        attribute: name.to_owned(),
        file: object.points.display().to_string(),
        known,
    })?;
    let own_range = || {
        let counted = values.iter().copied().enumerate().filter(|&(place, _)| counts(place));
        let finite = counted.map(|(_, value)| value).filter(|value| counts_in_range(*value, scale));
        finite.fold(None, |range: Option<[f64; 2]>, value| {
            Some(range.map_or([value; 2], |[low, high]| [low.min(value), high.max(value)]))
        })
    };
    let any = values.iter().any(|value| !value.is_nan());
    if any && scale == Scale::Log && range.is_none() && own_range().is_none() {
        return Err(PlanError::NothingPositive {
            name: object.name.clone(),
            attribute: name.to_owned(),
            file: object.points.display().to_string(),
        });
    }
    let Some([low, high]) = range.or_else(own_range).filter(|_| any) else {
        return Err(PlanError::NoValues {
            name: object.name.clone(),
            attribute: name.to_owned(),
            file: object.points.display().to_string(),
        });
    };
    let color = |value: f64| {
        if value.is_nan() {
            return marked(NO_VALUE);
        }
        mapped(map, part_of(value, [low, high], scale))
    };
    Ok((values.into_iter().map(color).collect(), [low, high]))
}

/// Whether a value takes part in the range of an attribute.
pub(crate) fn counts_in_range(value: f64, scale: Scale) -> bool {
    value.is_finite() && (scale == Scale::Linear || value > 0.0)
}

/// How far a value lies from the lower end of a range to the upper one, 0 to 1; the middle of a range of one value.
pub(crate) fn part_of(value: f64, [low, high]: [f64; 2], scale: Scale) -> f64 {
    if low == high {
        return 0.5;
    }
    let part = match scale {
        // Halves, so that no difference of two numbers overflows.
        Scale::Linear => (0.5 * value - 0.5 * low) / (0.5 * high - 0.5 * low),
        // What is not positive lies before any end, whichever is the lower one.
        Scale::Log if value <= 0.0 => return if low < high { 0.0 } else { 1.0 },
        Scale::Log => (value.ln() - low.ln()) / (high.ln() - low.ln()),
    };
    part.clamp(0.0, 1.0)
}

/// The colour of a map at 0..=1, linear.
pub(crate) fn mapped(map: ColorMap, part: f64) -> [f32; 3] {
    let gradient = match map {
        ColorMap::Viridis => colorous::VIRIDIS,
        ColorMap::Turbo => colorous::TURBO,
        ColorMap::Magma => colorous::MAGMA,
        ColorMap::Inferno => colorous::INFERNO,
        ColorMap::Plasma => colorous::PLASMA,
        ColorMap::Cividis => colorous::CIVIDIS,
        ColorMap::Gray => return [linear_from_srgb(part) as f32; 3],
    };
    let colorous::Color { r, g, b } = gradient.eval_continuous(part);
    [r, g, b].map(|byte| linear_from_srgb(f64::from(byte) / 255.0) as f32)
}

/// Column over width and row over height of each point in its object's texture, if the points have them.
pub(crate) fn places(set: &PointSet) -> Option<Vec<[f32; 2]>> {
    let [u, v] = UV.into_iter().find_map(|[u, v]| Some([set.attribute(u)?, set.attribute(v)?]))?;
    let place = |value: f64| if value.is_nan() { 0.0 } else { value.clamp(-FAR, FAR) as f32 };
    // v counts from the bottom row upwards.
    Some(u.iter().zip(v.iter()).map(|(u, v)| [place(u), place(1.0 - v)]).collect())
}

/// Rows of the map from the centred scene to column over width and row over height of a texture that is
/// projected over the bounding box of the points, in their file's coordinates.
pub(crate) fn projection(
    axis: TextureAxis,
    set: &PointSet,
    transform: &Transform,
    origin: [f64; 3],
) -> [[f32; 4]; 2] {
    let (min, max) = set.bounds().unwrap_or_default();
    let rotation = transform.rotation();
    // The file's coordinate over the box, from its lower end or from its upper one.
    let row = |axis: usize, from_above: bool| {
        let extent = max[axis] - min[axis];
        let column = [0, 1, 2].map(|i| rotation[i][axis] / transform.scale);
        let at_origin: f64 = (0..3).map(|i| column[i] * (origin[i] - transform.translate[i])).sum();
        if !(extent * transform.scale > FLAT && extent.is_finite()) {
            return [0.0, 0.0, 0.0, 0.5];
        }
        let (sign, begin) = if from_above { (-1.0, max[axis]) } else { (1.0, min[axis]) };
        let [x, y, z] = column.map(|c| (sign * c / extent) as f32);
        [x, y, z, (sign * (at_origin - begin) / extent) as f32]
    };
    match axis {
        TextureAxis::X => [row(2, true), row(1, true)],
        TextureAxis::Y | TextureAxis::Uv => [row(0, false), row(2, false)],
        TextureAxis::Z => [row(0, false), row(1, true)],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The ends and the middle of the maps, as matplotlib and Google publish them.
    #[test]
    fn maps_begin_and_end_as_published() {
        let byte = |map, part| mapped(map, part).map(film::srgb_byte);
        assert_eq!(byte(ColorMap::Viridis, 0.0), [68, 1, 84]);
        assert_eq!(byte(ColorMap::Viridis, 1.0), [253, 231, 37]);
        assert_eq!(byte(ColorMap::Magma, 0.0), [0, 0, 4]);
        assert_eq!(byte(ColorMap::Gray, 0.5), [128; 3]);
        for map in ColorMap::ALL {
            for i in 0..=100 {
                assert!(mapped(map, f64::from(i) / 100.0).iter().all(|c| (0.0..=1.0).contains(c)));
            }
        }
    }

    fn set_of(positions: usize, encoding: ColorEncoding) -> PointSet {
        PointSet {
            positions: vec![[0.0; 3]; positions],
            color_encoding: Some(encoding),
            ..PointSet::default()
        }
    }

    /// To four decimals, as floats of 32 bits, and as the float nearest to a byte: one colour.
    #[test]
    fn floats_that_were_bytes_are_bytes_again() {
        let encoding = ColorEncoding::Fraction;
        let set = set_of(1, encoding);
        for byte in 0..=255u8 {
            let exact = ColorEncoding::Srgb8.decode(byte.into());
            let part = f64::from(byte) / 255.0;
            for stored in [part, f64::from(part as f32), (part * 1e4).round() / 1e4] {
                let colors = [[encoding.decode(stored); 3]];
                assert_eq!(own_colors(&set, &colors), [[exact; 3]], "{byte}, {stored}");
            }
        }
        // One that is between two bytes says that none were bytes.
        let colors = [[encoding.decode(0.7843); 3], [encoding.decode(0.7863); 3]];
        assert_eq!(own_colors(&set, &colors), colors);
        // Whole numbers are what they are.
        let colors = [[ColorEncoding::Srgb16.decode(51_401.0); 3]];
        assert_eq!(own_colors(&set_of(1, ColorEncoding::Srgb16), &colors), colors);
    }

    #[test]
    fn a_color_that_is_no_number_is_as_if_there_were_none() {
        for encoding in [ColorEncoding::Fraction, ColorEncoding::Srgb8] {
            let byte = ColorEncoding::Srgb8.decode(40.0);
            let colors = [[byte; 3], [byte, f32::NAN, byte]];
            assert_eq!(own_colors(&set_of(2, encoding), &colors), [[byte; 3], [-0.8, 0.8, 0.8]]);
        }
    }

    /// Corners of the box, turned, scaled and moved with the object.
    #[test]
    fn projections_stick_to_the_object() {
        let positions = vec![[1.0, 2.0, 3.0], [5.0, 4.0, 13.0]];
        let set = PointSet { file_index: vec![0, 1], positions, ..PointSet::default() };
        let transform =
            Transform { scale: 2.5, rotate: [20.0, -70.0, 130.0], translate: [1e5, -2.0, 30.0] };
        let origin = [99_990.0, 3.0, 20.0];
        // Where the file's corner lies in the picture: from the left, from the top.
        let cases = [
            (TextureAxis::Y, [1.0, 2.0, 3.0], [0.0, 0.0]),
            (TextureAxis::Y, [5.0, 2.0, 8.0], [1.0, 0.5]),
            (TextureAxis::Z, [1.0, 4.0, 3.0], [0.0, 0.0]),
            (TextureAxis::Z, [2.0, 2.0, 9.0], [0.25, 1.0]),
            (TextureAxis::X, [3.0, 4.0, 13.0], [0.0, 0.0]),
            (TextureAxis::X, [3.0, 3.5, 3.0], [1.0, 0.25]),
        ];
        for (axis, corner, expected) in cases {
            let world = transform.apply(corner);
            let x = [0, 1, 2].map(|i| world[i] - origin[i]);
            let rows = projection(axis, &set, &transform, origin);
            for (row, expected) in rows.into_iter().zip(expected) {
                let at = (0..3).map(|i| f64::from(row[i]) * x[i]).sum::<f64>() + f64::from(row[3]);
                // Terms reach about 5, so f32 leaves 3e-7 each.
                assert!((at - expected).abs() < 2e-6, "{axis:?} {corner:?}: {at}, not {expected}");
            }
        }
    }

    #[test]
    fn a_flat_box_has_its_picture_in_the_middle() {
        let positions = vec![[1.0, 2.0, 3.0], [5.0, 2.0, 13.0]];
        let set = PointSet { file_index: vec![0, 1], positions, ..PointSet::default() };
        let [_, row] = projection(TextureAxis::Z, &set, &Transform::IDENTITY, [0.0; 3]);
        assert_eq!(row, [0.0, 0.0, 0.0, 0.5]);
    }
}
