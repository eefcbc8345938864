//! What of its point file an object makes use of, so that nothing else is held.

use crate::colors::UV;
use points::{Column, Columns, Filter, ReadOptions, Voxel, Wanted};
use scene::{
    Albedo, Boundary, Object, PerParticle, PointColumn, PointColumns, PointFilter, RadiusOf,
    SurfaceKind, TextureAxis, VolumeKernel, VolumeMode, VoxelEdge,
};

/// How an object's file is to be read for a render.
#[must_use]
pub fn read_options(object: &Object) -> ReadOptions {
    let mut names: Vec<&str> = Vec::new();
    let has_albedo = object.material.kind.has_albedo();
    let mut colors = false;
    match &object.material.albedo {
        Albedo::Default | Albedo::Points => colors = has_albedo,
        Albedo::Attribute { name, .. } => names.push(name),
        Albedo::Texture { axis: None | Some(TextureAxis::Uv), .. } => {
            names.extend(UV.iter().flatten());
        }
        Albedo::Texture { .. } | Albedo::Color(_) => {}
    }
    let mut discs = false;
    if let SurfaceKind::Spheres(radius) | SurfaceKind::Discs(radius) = &object.surface.kind {
        discs = matches!(object.surface.kind, SurfaceKind::Discs(_));
        if let RadiusOf::Attribute(name) = &radius.of {
            names.push(name);
        }
    }
    if let Some(volume) = &object.volume {
        names.push(&volume.scalar);
        if let Boundary::Attribute(name) = &volume.boundary {
            names.push(name);
        }
        if let VolumeKernel::Sph { smoothing_length, mass, density } = &volume.kernel {
            let particles = [Some(smoothing_length), mass.as_ref()];
            names.extend(particles.into_iter().flatten().filter_map(|of| match of {
                PerParticle::Attribute(name) => Some(name.as_str()),
                PerParticle::Number(_) => None,
            }));
            names.extend(density.as_deref());
        }
        // Its colour comes from the transfer function.
        colors &= !matches!(volume.mode, VolumeMode::Isosurface(_));
    }
    let wanted = Wanted::Some {
        colors,
        normals: discs || object.material.kind.has_inside(),
        attributes: names.into_iter().map(str::to_owned).collect(),
    };
    ReadOptions {
        wanted,
        filter: filter(&object.filter),
        columns: columns(&object.columns),
        ..ReadOptions::default()
    }
}

/// A scene's filter as readers take it.
#[must_use]
pub fn filter(filter: &PointFilter) -> Filter {
    Filter {
        every: filter.every,
        bounds: filter.bounds,
        ranges: filter.ranges.clone(),
        classes: filter.classes.clone(),
        voxel: filter.voxel.map(|voxel| match voxel {
            VoxelEdge::Auto => Voxel::Auto,
            VoxelEdge::Length(edge) => Voxel::Edge(edge),
        }),
    }
}

/// What a scene says of columns, as readers take it.
#[must_use]
pub fn columns(columns: &PointColumns) -> Columns {
    let column = |column: &PointColumn| match column {
        PointColumn::Name(name) => Column::Name(name.clone()),
        PointColumn::Number(number) => Column::Number(*number),
    };
    Columns {
        named: columns.named.iter().map(|(name, of)| (name.clone(), column(of))).collect(),
        left_out: columns.left_out.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::Scene;
    use std::path::Path;

    fn options(object: &str) -> ReadOptions {
        let text = format!("[[objects]]\npoints = \"a.las\"\n{object}");
        let scene = Scene::from_toml(&text, Path::new("s.toml"), &[]).expect("a scene");
        read_options(&scene.objects[0])
    }

    fn wanted(object: &str) -> (bool, bool, Vec<String>) {
        match options(object).wanted {
            Wanted::All => panic!("all is wanted"),
            Wanted::Some { colors, normals, attributes } => (colors, normals, attributes),
        }
    }

    #[test]
    fn what_the_scene_names_is_wanted() {
        assert_eq!(wanted(""), (true, false, vec![]));
        assert_eq!(wanted("material.kind = \"glass\""), (false, true, vec![]));
        assert_eq!(wanted("material.albedo = [1, 1, 1]"), (false, false, vec![]));
        let discs = "surface = { kind = \"discs\", radius = \"attribute:size\" }";
        assert_eq!(wanted(discs), (true, true, vec!["size".to_owned()]));
        let of_attribute = wanted("material.albedo = \"attribute:intensity\"");
        assert_eq!(of_attribute, (false, false, vec!["intensity".to_owned()]));
        let (_, _, places) = wanted("material.texture = \"a.png\"");
        assert!(["u", "v", "s", "t"].iter().all(|name| places.iter().any(|place| place == name)));
        let (_, _, particles) = wanted(
            "volume = { scalar = \"rho\", kernel = \"sph\", smoothing_length = \"h\", mass = \"m\", \
             density = \"d\", boundary = \"skin\", color_map = \"gray\", extinction = 1 }",
        );
        assert_eq!(particles, ["rho", "skin", "h", "m", "d"]);
    }

    #[test]
    fn columns_are_handed_on() {
        assert!(options("").columns.is_empty());
        let columns = options("columns = { x = \"E\", red = 4, _ = [2] }").columns;
        assert_eq!(columns.to_string(), "x = 'E', red = column 4, _ = column 2");
    }

    #[test]
    fn filters_are_handed_on() {
        assert!(options("").filter.keeps_all());
        let all = "every = 2\nrange = { z = [0, 1] }\nclassification = [2]\nvoxel = 3\n\
                   box = { min = [0, 0, 0], max = [1, 2, 3] }";
        assert_eq!(
            options(&format!("[objects.filter]\n{all}")).filter.to_string(),
            "every = 2, box = { min = [0.0, 0.0, 0.0], max = [1.0, 2.0, 3.0] }, range = { z = [0, \
             1] }, classification = [2], voxel = 3"
        );
        let auto = options("filter.voxel = \"auto\"").filter;
        assert_eq!((auto.keeps_all(), auto.to_string().as_str()), (false, "voxel = \"auto\""));
    }
}
