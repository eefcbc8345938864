//! Warnings where numbers of 32 bits are too coarse for the points: those of the file, or those that the kernels
//! compute with.

use points::{PointSet, coarse, coarse_rounding, single_axes, single_step};
use scene::Scene;
use std::sync::Arc;

/// Metres a degree of latitude, and of longitude at the equator, about.
const DEGREE: f64 = 111_300.0;

/// One sentence for each object whose points are closer to each other than a hundred steps of f32. `files` are the
/// sets as read, `sets` the same in metres where they were degrees.
pub(crate) fn warnings(
    scene: &Scene,
    files: &[Arc<PointSet>],
    sets: &[Arc<PointSet>],
    origin: [f64; 3],
) -> Vec<String> {
    let mut warnings = Vec::new();
    for ((object, file), set) in scene.objects.iter().zip(files).zip(sets) {
        let name = &object.name;
        if let Some(warning) = of_file(file, &set.positions) {
            warnings.push(format!("object '{name}': {}: {warning}", object.points_as_written));
        }
        let scale = object.transform.scale;
        let local = |i: usize| {
            let p = object.transform.apply(set.positions[i]);
            [0, 1, 2].map(|axis| p[axis] - origin[axis])
        };
        if let Some(found) = coarse_rounding(&set.positions, scale, local) {
            warnings.push(format!(
                "object '{name}': so far from the middle of the scene, positions are computed in steps of {:.1e}, \
                 while its points are {:.1e} apart, so that its surface shows terraces; bring the objects \
                 nearer together, leave far points out by objects.filter, or render it in a scene of its own",
                found.step, found.spacing
            ));
        }
    }
    warnings
}

/// What of a file's own numbers is too coarse for its points. `positions` are its points, in metres where the
/// file has degrees.
fn of_file(file: &PointSet, positions: &[[f64; 3]]) -> Option<String> {
    if !file.single_positions {
        return None;
    }
    let axes = single_axes(&file.positions);
    let in_degrees = file.positions.first() != positions.first();
    let step_at = |i: usize| {
        let p = file.positions[i];
        let units = match in_degrees {
            true => [DEGREE * p[1].to_radians().cos().abs(), DEGREE, 1.0],
            false => [1.0; 3],
        };
        let steps =
            [0, 1, 2].map(|axis| if axes[axis] { units[axis] * single_step(p[axis]) } else { 0.0 });
        steps.into_iter().fold(0.0, f64::max)
    };
    let found = coarse(positions, step_at)?;
    Some(format!(
        "its positions are stored in 32 bits, in steps of {:.1e}, while points are {:.1e} apart: terraces in the \
         picture are in the file; export it with 64-bit numbers (double), or with an offset subtracted",
        found.step, found.spacing
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Even points of a unit sphere, about 0.02 apart.
    fn ball(center: [f64; 3]) -> Vec<[f64; 3]> {
        let lattice = |i: u32| {
            let z = 1.0 - (2.0 * f64::from(i) + 1.0) / 20_000.0;
            let (sin, cos) = (2.399_963_229_728_653 * f64::from(i)).sin_cos();
            let r = (1.0 - z * z).sqrt();
            [center[0] + r * cos, center[1] + r * sin, center[2] + z]
        };
        (0..20_000).map(lattice).collect()
    }

    fn set(positions: Vec<[f64; 3]>, single_positions: bool) -> Arc<PointSet> {
        let file_index = (0..positions.len() as u32).collect();
        Arc::new(PointSet { positions, file_index, single_positions, ..PointSet::default() })
    }

    fn scene(transform: &str) -> Scene {
        let text = format!("[[objects]]\npoints = \"a.ply\"\ntransform = {{ {transform} }}\n");
        Scene::from_toml(&text, "s.toml".as_ref(), &[]).expect("a scene")
    }

    fn warned(transform: &str, set: &Arc<PointSet>, origin: [f64; 3]) -> Vec<String> {
        let sets = [Arc::clone(set)];
        warnings(&scene(transform), &sets, &sets, origin)
    }

    #[test]
    fn an_object_far_from_the_origin_is_named() {
        let near = set(ball([5e5, 4.6e6, 200.0]), false);
        assert_eq!(warned("", &near, [5e5, 4.6e6, 200.0]), Vec::<String>::new());
        let found = warned("", &near, [0.0; 3]);
        assert!(found.len() == 1 && found[0].contains("object 'a'"), "{found:?}");
        assert!(found[0].contains("in steps of 5.0e-1"), "{found:?}");
        // What the transform does counts.
        let scaled = warned("scale = 1000.0", &set(ball([0.0; 3]), false), [0.0; 3]);
        assert_eq!(scaled, Vec::<String>::new());
        let moved = warned("translate = [1e6, 0, 0]", &set(ball([0.0; 3]), false), [0.0; 3]);
        assert_eq!(moved.len(), 1, "{moved:?}");
    }

    #[test]
    fn a_file_of_rounded_numbers_is_at_fault_itself() {
        let round = |positions: Vec<[f64; 3]>| -> Vec<[f64; 3]> {
            positions.iter().map(|p| p.map(|x| f64::from(x as f32))).collect()
        };
        let center = [5e5, 4.6e6, 200.0];
        let found = warned("", &set(round(ball(center)), true), center);
        assert!(
            found.len() == 1 && found[0].contains("a.ply: its positions are stored in 32 bits"),
            "{found:?}"
        );
        assert!(found[0].contains("steps of 5.0e-1"), "{found:?}");
        let fine = warned("", &set(round(ball([1.0, 2.0, 3.0])), true), [0.0; 3]);
        assert_eq!(fine, Vec::<String>::new());
        // The same numbers in 64 bits may be a lattice.
        assert_eq!(warned("", &set(round(ball(center)), false), center), Vec::<String>::new());
    }

    /// Degrees in f32: steps of 7.6e-6 at 86° west, 0.65 m at 40° north.
    #[test]
    fn steps_of_degrees_are_measured_in_metres() {
        let metres = ball([0.0; 3]).iter().map(|p| p.map(|x| 20.0 * x)).collect::<Vec<_>>();
        let degrees = metres.iter().map(|p| {
            let east = f64::from((-86.5 + p[0] / 85_300.0) as f32);
            [east, f64::from((40.1 + p[1] / 111_000.0) as f32), p[2]]
        });
        let file = set(degrees.collect(), true);
        let warning = of_file(&file, &metres).expect("coarse");
        assert!(warning.contains("steps of 6.5e-1"), "{warning}");
    }
}
