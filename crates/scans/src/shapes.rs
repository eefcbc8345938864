//! What rays meet in a room, and where its edges are.

use crate::room::{Block, Column, Rectangle, Room};
use crate::vector::{V3, add, cross, dot, length};

/// Rays begin beyond what they start on.
const LEAST: f64 = 1e-6;

/// Where a ray meets a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Along the ray.
    pub t: f64,
    /// Of unit length, facing the ray.
    pub normal: V3,
    /// Walls, floor and slanted rectangle 0 to 3, box 4, plate 5, ball 6, column 7.
    pub object: usize,
}

impl Rectangle {
    fn hit(&self, o: V3, d: V3) -> Option<(f64, V3)> {
        let normal = cross(self.along[0], self.along[1]);
        let from = add(self.middle, o, -1.0);
        let t = dot(from, normal) / dot(d, normal);
        let place = add(d.map(|x| t * x), from, -1.0);
        let inside = (0..2).all(|k| dot(place, self.along[k]).abs() <= self.half[k]);
        inside.then_some((t, normal))
    }
}

impl Block {
    /// Where a ray enters.
    fn hit(&self, o: V3, d: V3) -> Option<(f64, V3)> {
        let from = add(o, self.middle, -1.0);
        let (mut enters, mut leaves, mut normal) =
            (f64::NEG_INFINITY, f64::INFINITY, self.along[0]);
        for (along, half) in self.along.into_iter().zip(self.half) {
            let (o, d) = (dot(from, along), dot(d, along));
            let ([a, b], inside) = ([(-half - o) / d, (half - o) / d], o.abs() <= half);
            // Along a face, 0 / 0: inside the slab or not.
            let [low, high] = match a.is_nan() || b.is_nan() || d == 0.0 {
                true if inside => [f64::NEG_INFINITY, f64::INFINITY],
                true => return None,
                false => [a.min(b), a.max(b)],
            };
            if low > enters {
                (enters, normal) = (low, along);
            }
            leaves = leaves.min(high);
        }
        (enters <= leaves).then_some((enters, normal))
    }

    /// The place from the middle along the three edges.
    pub(crate) fn inside(&self, p: V3) -> V3 {
        self.along.map(|along| dot(add(p, self.middle, -1.0), along))
    }

    fn edges(&self) -> impl Iterator<Item = [V3; 2]> + '_ {
        (0..12).map(|edge| {
            let (k, sides) =
                (edge / 4, [edge & 1, edge >> 1 & 1].map(|bit| f64::from(2 * bit as i32 - 1)));
            let [a, b] = [(k + 1) % 3, (k + 2) % 3];
            let middle = add(self.middle, self.along[a], sides[0] * self.half[a]);
            let middle = add(middle, self.along[b], sides[1] * self.half[b]);
            [-1.0, 1.0].map(|end| add(middle, self.along[k], end * self.half[k]))
        })
    }
}

impl Column {
    fn hit(&self, o: V3, d: V3) -> Option<(f64, V3)> {
        let q = add(o, self.base, -1.0);
        let level = d[0] * d[0] + d[1] * d[1];
        let b = q[0] * d[0] + q[1] * d[1];
        let under = b * b - level * (q[0] * q[0] + q[1] * q[1] - self.radius * self.radius);
        let side = (-b - under.sqrt()) / level;
        let p = add(q, d, side);
        let meets_side = under > 0.0 && (0.0..=self.height).contains(&p[2]) && side > LEAST;
        let side = meets_side.then_some((side, [p[0] / self.radius, p[1] / self.radius, 0.0]));
        let top = (self.height - q[2]) / d[2];
        let p = add(q, d, top);
        let meets_top = p[0] * p[0] + p[1] * p[1] <= self.radius * self.radius && top > LEAST;
        let top = meets_top.then_some((top, [0.0, 0.0, 1.0]));
        [side, top].into_iter().flatten().min_by(|a, b| a.0.total_cmp(&b.0))
    }
}

fn ball_hit((middle, radius): (V3, f64), o: V3, d: V3) -> Option<(f64, V3)> {
    let q = add(o, middle, -1.0);
    let b = dot(q, d);
    let under = b * b - dot(q, q) + radius * radius;
    let t = -b - under.sqrt();
    (under > 0.0).then(|| (t, add(q, d, t).map(|x| x / radius)))
}

impl Room {
    /// What a ray meets first; `d` has unit length.
    #[must_use]
    pub fn trace(&self, o: V3, d: V3) -> Option<Hit> {
        let flat = self.rectangles.iter().map(|rectangle| rectangle.hit(o, d));
        let blocks = self.blocks.iter().map(|block| block.hit(o, d));
        let others = [ball_hit(self.ball, o, d), self.column.hit(o, d)];
        let mut nearest: Option<Hit> = None;
        for (object, met) in flat.chain(blocks).chain(others).enumerate() {
            let Some((t, normal)) = met.filter(|met| met.0 > LEAST) else { continue };
            if nearest.is_none_or(|hit| t < hit.t) {
                nearest = Some(Hit { t, normal, object });
            }
        }
        nearest.map(|hit| match dot(hit.normal, d) > 0.0 {
            true => Hit { normal: hit.normal.map(|x| -x), ..hit },
            false => hit,
        })
    }

    /// How far the nearest sharp edge, crease or rim is from a place.
    #[must_use]
    pub fn edge_distance(&self, p: V3) -> f64 {
        let (x, y, z) = ([4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 3.0]);
        let mut edges = Vec::with_capacity(48);
        let corner = [4.0, 4.0, 0.0];
        edges.extend([[[0.0; 3], x], [[0.0; 3], y], [[0.0; 3], z], [x, corner], [y, corner]]);
        edges.extend([x, y].map(|end| [end, add(end, z, 1.0)]));
        edges.extend([x, y].map(|end| [z, add(end, z, 1.0)]));
        edges.extend(self.blocks.iter().flat_map(Block::edges));
        let Rectangle { middle, along, half } = self.rectangles[3];
        for k in 0..2 {
            let across = add([0.0; 3], along[1 - k], half[1 - k]);
            for side in [-1.0, 1.0] {
                let middle = add(middle, along[k], side * half[k]);
                edges.push([add(middle, across, -1.0), add(middle, across, 1.0)]);
            }
        }
        let to_edge = |[a, b]: [V3; 2]| {
            let (from, way) = (add(p, a, -1.0), add(b, a, -1.0));
            let along = (dot(from, way) / dot(way, way)).clamp(0.0, 1.0);
            length(add(from, way, -along))
        };
        let (middle, radius) = self.ball;
        let column = self.column;
        let circles = [
            (column.base, column.radius),
            (add(column.base, [0.0, 0.0, column.height], 1.0), column.radius),
            ([middle[0], middle[1], 0.0], (radius * radius - middle[2] * middle[2]).sqrt()),
        ];
        let to_circle = |(middle, radius): (V3, f64)| {
            let [x, y, z] = add(p, middle, -1.0);
            length([length([x, y, 0.0]) - radius, z, 0.0])
        };
        let edges = edges.into_iter().map(to_edge);
        edges.chain(circles.map(to_circle)).fold(f64::INFINITY, f64::min)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vector::unit;

    /// Each object where a ray aims at it, at the distance and with the normal of its closed form.
    #[test]
    fn rays_meet_each_object_where_it_is() {
        let room = Room::new(0);
        let down = |x, y| room.trace([x, y, 2.9], [0.0, 0.0, -1.0]).unwrap();
        let up = [0.0, 0.0, 1.0];
        let near = |a: f64, b: f64| (a - b).abs() < 1e-12;
        for (x, y, height, object) in [
            (3.0, 3.5, 0.0, 2),
            (0.95, 1.65, 0.6, 4),
            (1.75, 1.9, 0.6, 5),
            (1.75, 0.8, 0.63, 6),
            (0.65, 0.6, 1.2, 7),
        ] {
            let hit = down(x, y);
            assert_eq!(hit.object, object);
            assert!(near(hit.t, 2.9 - height) && near(length(add(hit.normal, up, -1.0)), 0.0));
        }
        assert_eq!(down(0.5, 2.75).object, 3);
        let side = room.trace([3.0, 0.6, 0.9], [-1.0, 0.0, 0.0]).unwrap();
        assert!(side.object == 7 && near(side.t, 3.0 - 0.65 - 0.16), "{side:?}");
        let wall = room.trace([3.0, 3.5, 2.0], unit([-1.0, 0.1, 0.0])).unwrap();
        assert!(wall.object == 0 && wall.normal == [1.0, 0.0, 0.0], "{wall:?}");
        assert_eq!(room.trace([3.0, 3.0, 1.0], unit([1.0, 1.0, 0.1])), None);
    }

    /// From inside, and along a face: boxes are met where rays enter them.
    #[test]
    fn rays_along_a_box_miss_it_or_meet_it_and_are_no_nan() {
        let room = Room::new(0);
        let block =
            Block { along: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], ..room.blocks[0] };
        let [x, y, z] = block.middle;
        assert!(block.hit([x + 2.0, y, z], [-1.0, 0.0, 0.0]).is_some());
        assert!(block.hit([x + 2.0, y + 1.0, z], [-1.0, 0.0, 0.0]).is_none());
        let on_top = block.hit([x + 2.0, y, z + block.half[2]], [-1.0, 0.0, 0.0]);
        assert!(on_top.is_none_or(|hit| hit.0.is_finite()));
        assert!(block.hit([x, y, z], [-1.0, 0.0, 0.0]).is_some_and(|hit| hit.0 < 0.0));
    }

    #[test]
    fn edges_are_at_distance_zero_and_faces_half_a_side_away() {
        let room = Room::new(0);
        let block = room.blocks[0];
        let corner = (0..3).fold(block.middle, |p, k| add(p, block.along[k], block.half[k]));
        assert!(room.edge_distance(corner) < 1e-12);
        let top = add(block.middle, block.along[2], block.half[2]);
        assert!((room.edge_distance(top) - 0.25).abs() < 1e-12);
        assert!(room.edge_distance([1.9, 0.0, 0.0]) < 1e-12);
        assert!((room.edge_distance([3.0, 0.0, 2.5]) - 0.5).abs() < 1e-12);
    }
}
