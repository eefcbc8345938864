//! Points that lie apart from all others: stray returns of a scanner, birds over a terrain.
//!
//! Statistical removal after Rusu et al., Towards 3D Point Cloud Based Object Maps for Household
//! Environments (2008), section 4: a point is dropped whose mean distance to its neighbours is over the
//! mean of all points' by more than so many standard deviations, and at least twice that mean: on even
//! points deviations are so small that corners would go.

use points::{Cloud, CloudError, NeighborSearch, ObjectPoints, PointSet};

/// The set without its isolated points, and how many those are; `None` where there are none.
///
/// Once points are gone, others may have lost the neighbours that kept them: rounds follow each other,
/// with the limit of the first, until all that is left is near.
///
/// # Errors
/// Points that f32 cannot bear.
pub(crate) fn without_isolated(
    set: &PointSet,
    neighbors: u32,
    deviations: f64,
) -> Result<Option<(PointSet, u64)>, CloudError> {
    let distances = mean_distances(set, neighbors)?;
    let mean = distances.iter().sum::<f64>() / distances.len() as f64;
    let squares = distances.iter().map(|d| (d - mean).powi(2)).sum::<f64>();
    let deviation = (squares / distances.len() as f64).sqrt();
    let limit = (mean + deviations * deviation).max(2.0 * mean);
    let mut kept = without_far(set, &distances, limit);
    while let Some(set) = &kept {
        match without_far(set, &mean_distances(set, neighbors)?, limit) {
            Some(fewer) => kept = Some(fewer),
            None => break,
        }
    }
    Ok(kept.map(|kept| {
        let dropped = (set.len() - kept.len()) as u64;
        (kept, dropped)
    }))
}

/// Mean distance of each point to its neighbours, in the order of the set.
fn mean_distances(set: &PointSet, neighbors: u32) -> Result<Vec<f64>, CloudError> {
    let object = ObjectPoints::new(&set.positions, &set.file_index);
    let cloud = Cloud::new(&[object])?;
    let count = cloud.points.len();
    let k = (neighbors as usize).min(count.saturating_sub(1)).max(1);
    let lists = NeighborSearch::new(&cloud.points, 0).nearest(0..count, k);
    let mean_distance = |&slot: &u32| {
        let at = cloud.points[slot as usize].position;
        let others: Vec<f64> = lists[slot as usize * k..(slot as usize + 1) * k]
            .iter()
            .filter_map(|&other| cloud.points.get(other as usize))
            .map(|other| distance(at, other.position))
            .collect();
        others.iter().sum::<f64>() / (others.len() as f64).max(1.0)
    };
    Ok(cloud.order.iter().map(mean_distance).collect())
}

/// The set without points whose distance is over the limit; `None` where none is, or nothing would be
/// left.
fn without_far(set: &PointSet, distances: &[f64], limit: f64) -> Option<PointSet> {
    let near = || distances.iter().map(|&d| d <= limit);
    let left = near().filter(|&near| near).count();
    (left > 0 && left < set.len()).then(|| set.filtered(|i| distances[i] <= limit))
}

fn distance(a: [f32; 3], b: [f32; 3]) -> f64 {
    [0, 1, 2].map(|i| f64::from(b[i] - a[i]).powi(2)).iter().sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use points::{Attribute, Values};

    fn grid_and(strays: &[[f64; 3]]) -> PointSet {
        let mut positions: Vec<[f64; 3]> =
            (0..400).map(|i| [f64::from(i % 20), f64::from(i / 20), 0.0]).collect();
        positions.splice(100..100, strays.iter().copied());
        let file_index = (0..positions.len() as u32).collect();
        let colors = Some(positions.iter().map(|p| [p[2] as f32, 0.0, 0.0]).collect());
        let heights = positions.iter().map(|p| p[2]).collect();
        let height = Attribute { name: "height".to_owned(), values: Values::F64(heights) };
        PointSet { positions, file_index, colors, attributes: vec![height], ..PointSet::default() }
    }

    #[test]
    fn strays_go_with_their_colors_and_the_rest_keeps_its_indices() {
        let set = grid_and(&[[3.0, 3.0, 50.0], [100.0, 0.0, 7.0]]);
        let (kept, dropped) = without_isolated(&set, 16, 4.0).expect("bearable").expect("strays");
        assert_eq!((kept.len(), dropped), (400, 2));
        assert_eq!(kept.file_index[99..102], [99, 102, 103]);
        assert!(kept.attribute("height").expect("heights").iter().all(|height| height == 0.0));
        assert!(kept.colors.expect("colours").iter().all(|color| color[0] == 0.0));
    }

    #[test]
    fn even_points_and_coinciding_ones_all_stay() {
        assert!(without_isolated(&grid_and(&[]), 16, 4.0).expect("bearable").is_none());
        let same = PointSet {
            positions: vec![[1.0; 3]; 50],
            file_index: (0..50).collect(),
            ..PointSet::default()
        };
        assert!(without_isolated(&same, 16, 4.0).expect("bearable").is_none());
        let one =
            PointSet { positions: vec![[1.0; 3]], file_index: vec![0], ..PointSet::default() };
        assert!(without_isolated(&one, 16, 4.0).expect("bearable").is_none());
    }
}
