//! What kernels take of each object: parameters of its fit, its material ([`crate::materials`]), what its points carry.

use crate::chosen::Findings;
use crate::images::{ImageList, Use};
use crate::materials::info_of;
use crate::missing::{Lacking, Missing, count_marked};
use crate::{PlanError, SceneImages, Volumes, colors};
use kernels::layout::{FIT_FULL, FIT_INCOMPLETE, FitParams, NONE, ObjectInfo};
use points::{Cloud, PointSet, SlotRange};
use scene::{
    Albedo, FeatureSize, Normals, Object, Polynomial, Refine, Scene, TextureAxis, VolumeMode,
};
use std::sync::Arc;

fn kind_of(polynomial: Polynomial) -> u32 {
    match polynomial {
        Polynomial::Full => FIT_FULL,
        Polynomial::Incomplete => FIT_INCOMPLETE,
    }
}

/// Distance from the centroid of k neighbours at which the surface ends, over their reach: half a spacing
/// beyond a straight rim. The spacing is less of the reach where there are more.
fn rim_limit(neighbors: u32) -> f32 {
    (0.37 + 0.4 / f64::from(neighbors).sqrt()) as f32
}

/// `slots` are those that carry the object's surface.
pub(crate) fn fit_params(object: &Object, index: u32, slots: SlotRange) -> FitParams {
    let neighbors = object.surface.neighbors.count().min(slots.count.saturating_sub(1)).max(1);
    FitParams {
        first_slot: slots.first_slot,
        point_count: slots.count,
        neighbors,
        polynomial: kind_of(object.surface.polynomial),
        feature_size: match object.surface.feature_size {
            FeatureSize::Adaptive => 0.0,
            FeatureSize::Smoothed => -1.0,
            FeatureSize::Constant(h) => h as f32,
        },
        trust: object.surface.trust as f32,
        object: index,
        first_listed: slots.first_slot,
        weight_scale: (1.0 / object.surface.weight_width) as f32,
        close_gaps: u32::from(object.surface.close_gaps),
        rim_limit: if object.surface.boundary_clip { rim_limit(neighbors) } else { 0.0 },
        bound_from: 0,
    }
}

/// `surfaces` are the slots of each object that carry its surface.
pub(crate) fn object_infos(
    scene: &Scene,
    sets: &[Arc<PointSet>],
    (cloud, surfaces): (&Cloud, &[SlotRange]),
    images: &SceneImages,
    (list, found): (&mut ImageList, &mut Findings),
) -> Result<(Vec<ObjectInfo>, Vec<f32>), PlanError> {
    let mut colors: Vec<f32> = Vec::new();
    let mut infos = Vec::new();
    for (index, (object, set)) in scene.objects.iter().zip(sets).enumerate() {
        let values = point_values((index, object), set, |place| cloud.counts(index, place), found)?;
        let (mut texture, mut rows) = (NONE, [[0.0; 4]; 2]);
        if let (true, Albedo::Texture { file, axis }) =
            (object.material.kind.has_albedo(), &object.material.albedo)
        {
            let image = images.textures.get(index).and_then(Option::as_ref);
            texture = add_image(list, image, file, Use::Texture)?;
            let axis = axis.unwrap_or(TextureAxis::Y);
            rows = colors::projection(axis, set, &object.transform, cloud.origin);
        }
        infos.push(ObjectInfo {
            first_color: match values {
                PointValues::None => NONE,
                _ => colors.len() as u32,
            },
            first_slot: cloud.objects[index].first_slot,
            polynomial: kind_of(object.surface.polynomial),
            max_iterations: match object.surface.refine {
                _ if surfaces[index].count == 0 => 0,
                Refine::None => 0,
                Refine::Project { max_iterations, .. } => max_iterations,
            },
            tolerance: match object.surface.refine {
                Refine::None => 0.0,
                Refine::Project { tolerance, .. } => tolerance as f32,
            },
            slot_count: surfaces[index].count,
            weight_scale: (1.0 / object.surface.weight_width) as f32,
            blends: u32::from(
                object.surface.normals == Normals::Blended && surfaces[index].count > 0,
            ),
            texture,
            texture_u: rows[0],
            texture_v: rows[1],
            ..info_of(&object.material, scene.render.integrator)
        });
        match values {
            PointValues::None => {}
            PointValues::Colors(values) => {
                let points = count_marked(&values);
                if points > 0 {
                    let what = match &object.material.albedo {
                        Albedo::Attribute { name, .. } => Lacking::Attribute(name.clone()),
                        _ => Lacking::Color,
                    };
                    let (object, of) = (object.name.clone(), values.len() as u64);
                    found.missing.push(Missing { object, what, points, of });
                }
                colors.extend(cloud.by_slot(index, &values).iter().flatten());
            }
            PointValues::Places(values) => {
                colors.extend(cloud.by_slot(index, &values).iter().flatten());
            }
        }
        if colors.len() > 3_000_000_000 {
            return Err(PlanError::TooManyColors(colors.len() / 3));
        }
    }
    Ok((infos, colors))
}

fn is_isosurface(object: &Object) -> bool {
    object.volume.as_ref().is_some_and(|volume| matches!(volume.mode, VolumeMode::Isosurface(_)))
}

/// Gives isosurfaces whose material has no albedo the colour that their transfer function says.
pub(crate) fn color_isosurfaces(scene: &Scene, volumes: &Volumes, infos: &mut [ObjectInfo]) {
    for volume in &volumes.infos {
        let object = &scene.objects[volume.object as usize];
        let has_transfer = object.volume.as_ref().is_some_and(|volume| volume.transfer.is_some());
        let has_albedo = matches!(object.material.albedo, Albedo::Color(_));
        let takes_albedo = object.material.kind.has_albedo();
        if is_isosurface(object) && has_transfer && takes_albedo && !has_albedo {
            let color = volumes.color_of(volume, volume.iso);
            infos[volume.object as usize].albedo = color.map(|channel| channel.clamp(0.0, 1.0));
        }
    }
}

/// What the points of an object have that its albedo takes.
enum PointValues {
    None,
    Colors(Vec<[f32; 3]>),
    /// In the object's texture.
    Places(Vec<[f32; 2]>),
}

fn point_values(
    (index, object): (usize, &Object),
    set: &PointSet,
    counts: impl Fn(usize) -> bool,
    found: &mut Findings,
) -> Result<PointValues, PlanError> {
    if !object.material.kind.has_albedo() {
        return Ok(PointValues::None);
    }
    if is_isosurface(object) {
        return match object.material.albedo {
            Albedo::Color(_) | Albedo::Default => Ok(PointValues::None),
            _ => Err(PlanError::IsosurfaceAlbedo { name: object.name.clone() }),
        };
    }
    let (name, file) = (&object.name, || object.points.display().to_string());
    Ok(match (&object.material.albedo, &set.colors) {
        (Albedo::Color(_), _) | (Albedo::Default, None) => PointValues::None,
        (Albedo::Default | Albedo::Points, Some(own)) => {
            PointValues::Colors(colors::own_colors(set, own))
        }
        (Albedo::Points, None) => {
            return Err(PlanError::NoColors { name: name.clone(), file: file() });
        }
        (Albedo::Attribute { name, color_map, range, scale }, _) => {
            let shown = (name.as_str(), *color_map, *range, *scale);
            let (colors, taken) = colors::attribute_colors(object, set, shown, counts)?;
            if range.is_none() {
                found.range(index, "material.value_range", taken);
            }
            PointValues::Colors(colors)
        }
        (Albedo::Texture { axis, .. }, _) => match (axis, colors::places(set)) {
            (None | Some(TextureAxis::Uv), Some(places)) => PointValues::Places(places),
            (Some(TextureAxis::Uv), None) => {
                return Err(PlanError::NoPlaces { name: name.clone(), file: file() });
            }
            _ => PointValues::None,
        },
    })
}

pub(crate) fn add_image(
    list: &mut ImageList,
    image: Option<&Arc<film::Image>>,
    file: &scene::ImageFile,
    used: Use,
) -> Result<u32, PlanError> {
    let Some(image) = image else { unreachable!("the image '{}' is not given", file.as_written) };
    list.add(image, &file.as_written, used)
        .ok_or_else(|| PlanError::TooManyTexels(file.as_written.clone()))
}
