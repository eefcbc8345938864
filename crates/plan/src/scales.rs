//! What the colours of a picture mean: the maps of colours that its objects took, with their ranges.

use crate::colors::{mapped, part_of};
use crate::{Choice, Chosen, Volumes};
use scene::{Albedo, Boundary, ColorMap, Object, Scale, Scene, Transfer, VolumeMode};

/// Colours of a scale.
const COLORS: u32 = 256;

/// The colours that an object's values have.
#[derive(Debug, Clone, PartialEq)]
pub struct ColorScale {
    /// Index of the object in the scene.
    pub object: usize,
    /// The attribute that is shown, and what of it.
    pub attribute: String,
    /// Linear colours, evenly from the lower value to the upper one.
    pub colors: Vec<[f32; 3]>,
    /// The values at both ends, ascending.
    pub range: [f64; 2],
    /// Whether values lie by their logarithms.
    pub is_log: bool,
}

/// The scales of all objects, in their order; `chosen` has the ranges that the scene does not say.
pub(crate) fn of_scene(scene: &Scene, volumes: &Volumes, chosen: &[Chosen]) -> Vec<ColorScale> {
    let mut scales = Vec::new();
    for (index, object) in scene.objects.iter().enumerate() {
        let range = |given: Option<[f64; 2]>, key: &str| {
            given.or_else(|| {
                let of = |chosen: &&Chosen| chosen.object == index && chosen.key == key;
                match chosen.iter().find(of)?.value {
                    Choice::Range(range) => Some(range),
                    Choice::Number(_) | Choice::Word(_) => None,
                }
            })
        };
        scales.extend(of_surface(index, object, &range));
        scales.extend(of_volume(index, object, volumes, &range));
    }
    scales
}

type RangeOf<'a> = &'a dyn Fn(Option<[f64; 2]>, &str) -> Option<[f64; 2]>;

fn of_surface(index: usize, object: &Object, range_of: RangeOf<'_>) -> Option<ColorScale> {
    let is_drawn = object.volume.as_ref().is_none_or(|volume| {
        volume.boundary != Boundary::None && !matches!(volume.mode, VolumeMode::Isosurface(_))
    });
    let Albedo::Attribute { name, color_map, range, scale } = &object.material.albedo else {
        return None;
    };
    let is_shown = is_drawn && object.material.kind.has_albedo();
    let range = range_of(*range, "material.value_range").filter(|_| is_shown)?;
    Some(of_map(index, name, *color_map, range, *scale))
}

fn of_volume(
    index: usize,
    object: &Object,
    volumes: &Volumes,
    range_of: RangeOf<'_>,
) -> Option<ColorScale> {
    let volume = object.volume.as_ref()?;
    if matches!(volume.mode, VolumeMode::Isosurface(_)) {
        return None; // of one colour
    }
    let attribute = match volume.mode {
        VolumeMode::Maximum => format!("maximum of {}", volume.scalar),
        VolumeMode::Average => format!("mean of {}", volume.scalar),
        VolumeMode::Integral => format!("integral of {}", volume.scalar),
        VolumeMode::Emission | VolumeMode::Isosurface(_) => volume.scalar.clone(),
    };
    match volume.transfer.as_ref()? {
        Transfer::Map { color_map, range, .. } => {
            let range = range_of(*range, "volume.value_range")?;
            Some(of_map(index, &attribute, *color_map, range, volume.scale))
        }
        Transfer::Stops(stops) => {
            let range = [stops.first()?.value, stops.last()?.value];
            let info = volumes.infos.iter().find(|info| info.object as usize == index)?;
            let at = |i: u32| {
                let part = f64::from(i) / f64::from(COLORS - 1);
                volumes.light_of(info, (range[0] + part * (range[1] - range[0])) as f32)
            };
            let covers = stops.iter().any(|stop| stop.extinction > 0.0 && stop.color != [0.0; 3]);
            let colors = shown((0..COLORS).map(at).collect(), covers);
            Some(ColorScale { object: index, attribute, colors, range, is_log: false })
        }
    }
}

/// The colours of what covers; of what only glows, its emission, scaled so that the greatest of its channels is 1.
fn shown(lights: Vec<[[f32; 3]; 2]>, covers: bool) -> Vec<[f32; 3]> {
    let greatest = lights.iter().flat_map(|light| light[1]).fold(0.0, f32::max);
    let of = |[color, emission]: [[f32; 3]; 2]| match !covers && greatest > 0.0 {
        true => emission.map(|x| x / greatest),
        false => color,
    };
    lights.into_iter().map(of).collect()
}

/// A range may begin with its greater end; a scale does not.
fn of_map(
    object: usize,
    attribute: &str,
    map: ColorMap,
    range: [f64; 2],
    scale: Scale,
) -> ColorScale {
    let [a, b] = range;
    let ends = [a.min(b), a.max(b)];
    let last = f64::from(COLORS - 1);
    let is_turned = part_of(ends[0], range, scale) > 0.5;
    let colors = (0..COLORS).map(|i| f64::from(i) / last).map(|part| match is_turned {
        _ if a == b => mapped(map, part_of(a, range, scale)),
        true => mapped(map, 1.0 - part),
        false => mapped(map, part),
    });
    ColorScale {
        object,
        attribute: attribute.to_owned(),
        colors: colors.collect(),
        range: ends,
        is_log: scale == Scale::Log,
    }
}
