//! Where everything is: the room numbered 0, and others of its kind.

use crate::exact::sin_cos;
use crate::random::Random;
use crate::vector::{V3, add, cross, dot, frame, length, unit};

/// What [`Random`] is drawn for.
const PURPOSE: u64 = 1;

/// A perspective camera, upright along z.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// Where it is.
    pub eye: V3,
    /// What it looks at.
    pub target: V3,
    /// Degrees from the lower edge of the picture to the upper one.
    pub fov: f64,
}

impl View {
    /// The direction through a pixel's centre, of unit length; row 0 is at the top.
    #[must_use]
    pub fn through(&self, pixel: usize, size: [usize; 2]) -> V3 {
        let [width, height] = size.map(|side| side as f64);
        let [right, up, forward] = frame(add(self.target, self.eye, -1.0));
        let (sin, cos) = sin_cos(0.5 * self.fov.to_radians());
        let half = sin / cos / (0.5 * height);
        let x = ((pixel % size[0]) as f64 + 0.5 - 0.5 * width) * half;
        let y = (0.5 * height - (pixel / size[0]) as f64 - 0.5) * half;
        unit(add(add(forward, right, x), up, y))
    }

    /// Whether a place lies within a picture of this width over height, grown to all sides by a share of it.
    #[must_use]
    pub fn frames(&self, place: V3, aspect: f64, margin: f64) -> bool {
        let axes = frame(add(self.target, self.eye, -1.0));
        let [right, up, ahead] = axes.map(|axis| dot(add(place, self.eye, -1.0), axis));
        let (sin, cos) = sin_cos(0.5 * self.fov.to_radians());
        let high = (1.0 + margin) * sin / cos * ahead;
        ahead > 0.0 && up.abs() < high && right.abs() < aspect * high
    }
}

/// A rectangle: its middle, two directions of unit length across each other, and half its sides along them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Rectangle {
    pub middle: V3,
    pub along: [V3; 2],
    pub half: [f64; 2],
}

/// A box: its middle, the directions of its edges, and half their lengths.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Block {
    pub middle: V3,
    pub along: [V3; 3],
    pub half: V3,
}

/// An upright cylinder with a top.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Column {
    pub base: V3,
    pub radius: f64,
    pub height: f64,
}

/// The corner of a room, what stands in it, who scans it, and how it is shown.
#[derive(Debug, Clone, PartialEq)]
pub struct Room {
    /// Two walls, the floor, and the slanted one.
    pub(crate) rectangles: [Rectangle; 4],
    /// The box, and the plate that the depth camera sees edge-on.
    pub(crate) blocks: [Block; 2],
    /// Sunk into the floor.
    pub(crate) ball: (V3, f64),
    pub(crate) column: Column,
    /// The depth camera, and what it looks at.
    pub(crate) depth_camera: [V3; 2],
    pub(crate) lasers: [V3; 2],
    /// Places of which photogrammetry has nothing.
    pub(crate) blind: [V3; 6],
    /// The camera of pictures, which is no scanner's.
    pub view: View,
    /// The way the light of pictures travels, of unit length.
    pub light: V3,
}

impl Room {
    /// The room of a number. 0 is laid out by hand; of the others, sizes, places and turns of all that stands in it, of
    /// the scanners, the camera and the light are drawn by chance around that. Rooms of odd numbers are mirrored.
    #[must_use]
    pub fn new(number: u32) -> Self {
        let mut random = Random::new(u64::from(number), PURPOSE);
        // Half of the draws are clear; the first of them counts.
        let mut room = Self::varied(&mut random, if number == 0 { 0.0 } else { 1.0 });
        while !room.is_clear() {
            room = Self::varied(&mut random, 1.0);
        }
        if number % 2 == 1 { room.mirrored() } else { room }
    }

    /// By so much: 0, not at all.
    fn varied(random: &mut Random, amount: f64) -> Self {
        let mut within = |by: f64| amount * random.between(-by, by);
        let mut near = |place: V3, by: V3| [0, 1, 2].map(|i| place[i] + within(by[i]));
        let place = near([0.95, 1.65, 0.0], [0.12, 0.12, 0.0]);
        let half = near([0.35, 0.25, 0.3], [0.05, 0.05, 0.06]);
        let turn = near([25.0, 0.0, 0.0], [45.0, 0.0, 0.0])[0];
        let (sin, cos) = sin_cos(turn.to_radians());
        let cuboid = upright([cos, sin, 0.0], [place[0], place[1], half[2]], half);
        let depth_camera =
            [near([3.3, 3.0, 1.6], [0.25, 0.25, 0.15]), near([0.7, 0.8, 0.75], [0.1, 0.1, 0.1])];
        let place = near([1.75, 1.9, 0.0], [0.12, 0.12, 0.0]);
        let half = near([0.25, 0.01, 0.3], [0.04, 0.0, 0.05]);
        let way = add(depth_camera[0], place, -1.0);
        let plate = upright([way[0], way[1], 0.0], [place[0], place[1], half[2]], half);
        let radius = near([0.35, 0.0, 0.0], [0.06, 0.0, 0.0])[0];
        let place = near([1.75, 0.8, 0.0], [0.12, 0.12, 0.0]);
        let ball = ([place[0], place[1], 0.8 * radius], radius);
        let [radius, height, _] = near([0.16, 1.2, 0.0], [0.03, 0.15, 0.0]);
        let base = near([0.65, 0.6, 0.0], [0.1, 0.1, 0.0]);
        let middle = near([0.5, 2.75, 1.15], [0.08, 0.1, 0.05]);
        let first = unit(near([0.3, -0.9, 0.1], [0.1, 0.1, 0.1]));
        let second = unit(near([0.5, 0.25, 0.75], [0.1, 0.1, 0.1]));
        let second = unit(add(second, first, -dot(second, first)));
        let [width, length, _] = near([0.4, 0.35, 0.0], [0.05, 0.05, 0.0]);
        let flat = |middle, along, half| Rectangle { middle, along, half };
        let [x, y, z] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let blind = [
            near([0.0, 1.6, 0.9], [0.0, 0.3, 0.2]),
            near([1.6, 0.0, 1.4], [0.3, 0.0, 0.2]),
            near([1.2, 2.4, 0.0], [0.1, 0.1, 0.0]),
            near([2.3, 1.4, 0.0], [0.1, 0.1, 0.0]),
            add(cuboid.middle, [0.0, 0.25, 0.2], 1.0),
            add(ball.0, [0.0, 0.3, 0.17], 1.0),
        ];
        Self {
            rectangles: [
                flat([0.0, 2.0, 1.5], [y, z], [2.0, 1.5]),
                flat([2.0, 0.0, 1.5], [z, x], [1.5, 2.0]),
                flat([2.0, 2.0, 0.0], [x, y], [2.0, 2.0]),
                flat(middle, [first, second], [width, length]),
            ],
            blocks: [cuboid, plate],
            ball,
            column: Column { base, radius, height },
            depth_camera,
            lasers: [
                near([3.2, 3.4, 1.7], [0.25, 0.25, 0.15]),
                near([3.6, 1.0, 1.5], [0.2, 0.25, 0.15]),
            ],
            blind,
            view: View {
                eye: near([2.5, 3.7, 2.0], [0.2, 0.2, 0.15]),
                target: near([0.75, 0.85, 0.6], [0.1, 0.1, 0.1]),
                fov: 45.0,
            },
            light: unit(near([-0.55, -0.4, -0.75], [0.1, 0.1, 0.1])),
        }
    }

    /// Whether nothing stands in anything else, but in the floor.
    fn is_clear(&self) -> bool {
        let flat = |p: V3| [p[0], p[1], 0.0];
        let around = |block: &Block| length(flat(block.half));
        let slanted = self.rectangles[3];
        let circles = [
            (self.blocks[0].middle, around(&self.blocks[0])),
            (self.blocks[1].middle, around(&self.blocks[1])),
            self.ball,
            (self.column.base, self.column.radius),
        ];
        let apart = (0..circles.len()).all(|at| {
            let (p, a) = circles[at];
            let clear = |&(q, b): &(V3, f64)| length(flat(add(p, q, -1.0))) > a + b + 0.04;
            p[0].min(p[1]) > a + 0.05 && circles[..at].iter().all(clear)
        });
        let reach =
            |axis: usize| (0..2).map(move |k| slanted.half[k] * slanted.along[k][axis].abs());
        let lowest = [0, 1, 2].map(|axis| slanted.middle[axis] - reach(axis).sum::<f64>());
        let tops = 2.0 * self.blocks[0].half[2];
        apart && lowest[0] > 0.03 && lowest[2] > tops + 0.05
    }

    /// With x and y exchanged.
    fn mirrored(mut self) -> Self {
        let swap = |p: &mut V3| p.swap(0, 1);
        for rectangle in &mut self.rectangles {
            swap(&mut rectangle.middle);
            rectangle.along.iter_mut().for_each(swap);
        }
        for block in &mut self.blocks {
            swap(&mut block.middle);
            block.along.iter_mut().for_each(swap);
        }
        swap(&mut self.ball.0);
        swap(&mut self.column.base);
        self.depth_camera.iter_mut().chain(&mut self.lasers).for_each(swap);
        self.blind.iter_mut().for_each(swap);
        swap(&mut self.view.eye);
        swap(&mut self.view.target);
        swap(&mut self.light);
        self
    }

    /// A scene file that shows points in this room, of a picture of this size; `surface` has keys of
    /// `[objects.surface]`, or nothing.
    #[must_use]
    pub fn scene(&self, points: &str, size: [usize; 2], surface: &str) -> String {
        let View { eye, target, fov } = self.view;
        format!(
            "[camera]\neye = {eye:?}\ntarget = {target:?}\nup = [0.0, 0.0, 1.0]\n\
             vertical_fov = {fov:?}\n[image]\nsize = {size:?}\n[[lights]]\nkind = \"directional\"\n\
             direction = {:?}\nirradiance = [3.0, 3.0, 3.0]\n[[objects]]\npoints = \"{points}\"\n\
             material = {{ albedo = [0.8, 0.8, 0.8] }}\nsurface = {{ {surface} }}\n",
            self.light
        )
    }
}

/// A box whose first edge is along `way`, which is level.
fn upright(way: V3, middle: V3, half: V3) -> Block {
    let (first, up) = (unit(way), [0.0, 0.0, 1.0]);
    Block { middle, along: [first, cross(up, first), up], half }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rooms_are_clear_and_differ() {
        for number in 0..50 {
            let room = Room::new(number);
            assert!(room.is_clear(), "{number}");
            assert_eq!(room, Room::new(number));
            assert_ne!(room, Room::new(number + 1));
        }
    }

    /// The layout that figures elsewhere are of.
    #[test]
    fn room_0_is_laid_out_by_hand() {
        let room = Room::new(0);
        assert!(length(add(room.ball.0, [1.75, 0.8, 0.28], -1.0)) < 1e-15 && room.ball.1 == 0.35);
        assert_eq!(room.view.eye, [2.5, 3.7, 2.0]);
        let scene = room.scene("a.ply", [320, 240], "");
        assert!(scene.contains("target = [0.75, 0.85, 0.6]\n"), "{scene}");
    }
}
