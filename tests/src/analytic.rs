//! Spheres and level planes traced in closed form, in double precision: what pictures of light are measured
//! against.
//!
//! Nothing here is the renderer's: not its vectors, its optics, its media nor its images. In particular,
//! what a ray is inside of is read off the middle of each way, not counted along the path, so that a
//! renderer that counts wrongly is found out.

use film::{Image, Texels};

/// Three coordinates or channels.
pub type V3 = [f64; 3];

/// The scalar product.
#[must_use]
pub fn dot(a: V3, b: V3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The vector product.
#[must_use]
pub fn cross(a: V3, b: V3) -> V3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// a + factor b
#[must_use]
pub fn add(a: V3, b: V3, factor: f64) -> V3 {
    [0, 1, 2].map(|i| a[i] + factor * b[i])
}

/// Euclid's length.
#[must_use]
pub fn length(a: V3) -> f64 {
    dot(a, a).sqrt()
}

/// The vector over its length.
#[must_use]
pub fn unit(a: V3) -> V3 {
    a.map(|x| x / length(a))
}

/// A perspective camera, upright along +y, from a scene's own words.
#[derive(Debug, Clone, Copy)]
pub struct View {
    /// Where it is.
    pub eye: V3,
    /// What it looks at.
    pub target: V3,
    /// Degrees from the lower edge of the picture to the upper one.
    pub fov: f64,
    /// Columns and rows.
    pub size: [usize; 2],
}

impl View {
    /// The tables `[camera]` and `[image]` of a scene.
    #[must_use]
    pub fn text(&self) -> String {
        let Self { eye, target, fov, size } = self;
        format!(
            "[camera]\neye = {eye:?}\ntarget = {target:?}\nvertical_fov = {fov:?}\n\
             [image]\nsize = {size:?}\n"
        )
    }

    /// Direction through a pixel's centre.
    #[must_use]
    pub fn through(&self, pixel: usize) -> V3 {
        let [width, height] = self.size;
        let forward = unit(add(self.target, self.eye, -1.0));
        let right = unit(cross(forward, [0.0, 1.0, 0.0]));
        let up = cross(right, forward);
        let half = (0.5 * self.fov.to_radians()).tan() / (0.5 * height as f64);
        let x = ((pixel % width) as f64 + 0.5 - 0.5 * width as f64) * half;
        let y = (0.5 * height as f64 - (pixel / width) as f64 - 0.5) * half;
        unit(add(add(forward, right, x), up, y))
    }

    /// How far the line of sight through a pixel passes from a place.
    #[must_use]
    pub fn distance(&self, pixel: usize, place: V3) -> f64 {
        length(cross(add(place, self.eye, -1.0), self.through(pixel)))
    }
}

/// The form of a body.
#[derive(Debug, Clone, Copy)]
pub enum Shape {
    /// Middle and radius.
    Sphere(V3, f64),
    /// The level y below which, endlessly, the body is.
    Below(f64),
}

/// What a body does to rays.
#[derive(Debug, Clone, Copy)]
pub enum Matter {
    /// Of this reflectance.
    Mirror(V3),
    /// Index and absorption.
    Glass(f64, f64),
}

/// One body; of those that overlap, the later one counts.
#[derive(Debug, Clone, Copy)]
pub struct Body {
    /// Where it is.
    pub shape: Shape,
    /// What it is made of.
    pub matter: Matter,
}

impl Shape {
    /// Nearest t > 0 where o + t d crosses the surface. A ray that starts on it leaves it first.
    #[must_use]
    pub fn crossing(&self, o: V3, d: V3) -> Option<f64> {
        const LEAST: f64 = 1e-9; // a root of an origin on the surface
        match *self {
            Self::Sphere(middle, radius) => {
                let from = add(o, middle, -1.0);
                let along = -dot(from, d);
                let foot = add(from, d, along);
                let square = radius * radius - dot(foot, foot);
                let half = (square > 0.0).then(|| square.sqrt())?;
                [along - half, along + half].into_iter().find(|&t| t > LEAST)
            }
            Self::Below(level) => Some((level - o[1]) / d[1]).filter(|&t| t > LEAST && t < 1e9),
        }
    }

    fn holds(&self, x: V3) -> bool {
        match *self {
            Self::Sphere(middle, radius) => length(add(x, middle, -1.0)) < radius,
            Self::Below(level) => x[1] < level,
        }
    }

    fn normal(&self, x: V3) -> V3 {
        match *self {
            Self::Sphere(middle, _) => unit(add(x, middle, -1.0)),
            Self::Below(_) => [0.0, 1.0, 0.0],
        }
    }
}

/// Where a ray meets a surface, and what is on either side.
struct Meeting {
    t: f64,
    x: V3,
    body: usize,
    /// Facing the ray.
    normal: V3,
    /// Index and absorption on the ray's way, and beyond the surface; equal bodies change nothing.
    before: (f64, f64),
    beyond: (f64, f64),
    changes: bool,
}

fn meet(bodies: &[Body], o: V3, d: V3) -> Option<Meeting> {
    let crossings =
        bodies.iter().enumerate().filter_map(|(i, b)| Some((b.shape.crossing(o, d)?, i)));
    let (t, body) = crossings.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let inside = |at: f64| bodies.iter().rposition(|b| b.shape.holds(add(o, d, at)));
    let glass = |body: Option<usize>| match body.map(|body| bodies[body].matter) {
        Some(Matter::Glass(index, absorption)) => (index, absorption),
        _ => (1.0, 0.0),
    };
    let (before, beyond) = (inside(0.5 * t), inside(t + 1e-7));
    let x = add(o, d, t);
    let outward = bodies[body].shape.normal(x);
    let normal = if dot(outward, d) < 0.0 { outward } else { outward.map(|c| -c) };
    let changes = before != beyond;
    Some(Meeting { t, x, body, normal, before: glass(before), beyond: glass(beyond), changes })
}

/// The way of one ray that is never divided: glass refracts it, or reflects it totally.
#[derive(Debug, Clone)]
pub struct Way {
    /// Its last direction, into the background.
    pub direction: V3,
    /// What of the background's light is left.
    pub throughput: V3,
    /// Surfaces where the medium changed or the ray was mirrored: body, and where.
    pub hits: Vec<(usize, V3)>,
    /// Whether it was reflected totally.
    pub total: bool,
}

/// Follows a ray.
///
/// # Panics
/// Where it finds no end in 1000 surfaces.
#[must_use]
pub fn follow(bodies: &[Body], mut o: V3, d: V3) -> Way {
    let mut way = Way { direction: d, throughput: [1.0; 3], hits: Vec::new(), total: false };
    for _ in 0..1000 {
        let d = way.direction;
        let Some(met) = meet(bodies, o, d) else { return way };
        let (index, absorption) = met.before;
        way.throughput = way.throughput.map(|share| share * (-absorption * met.t).exp());
        match bodies[met.body].matter {
            Matter::Mirror(reflectance) => {
                way.throughput = [0, 1, 2].map(|i| way.throughput[i] * reflectance[i]);
                way.direction = mirrored(d, met.normal);
                way.hits.push((met.body, met.x));
            }
            Matter::Glass(..) if met.changes => {
                let bent = refracted(d, met.normal, index / met.beyond.0);
                way.total |= bent.is_none();
                way.direction = bent.unwrap_or_else(|| mirrored(d, met.normal));
                way.hits.push((met.body, met.x));
            }
            Matter::Glass(..) => {}
        }
        o = met.x;
    }
    panic!("a ray from {o:?} along {:?} finds no end", way.direction);
}

/// All ways of a ray through glass that absorbs nothing, which Fresnel's equations divide: the last direction of
/// each and its share. Those under `least` are left out.
#[must_use]
pub fn divided(bodies: &[Body], o: V3, d: V3, least: f64) -> Vec<(V3, f64)> {
    let (mut ends, mut open) = (Vec::new(), vec![(o, d, 1.0)]);
    while let Some((o, d, share)) = open.pop() {
        let Some(met) = meet(bodies, o, d) else {
            ends.push((d, share));
            continue;
        };
        let (n1, n2) = (met.before.0, met.beyond.0);
        let reflected = match refracted(d, met.normal, n1 / n2) {
            _ if !met.changes => 0.0,
            None => 1.0,
            Some(_) => fresnel(-dot(d, met.normal), n1, n2),
        };
        let bent = if met.changes { refracted(d, met.normal, n1 / n2) } else { Some(d) };
        let ways = [
            (mirrored(d, met.normal), share * reflected),
            (bent.unwrap_or(d), share * (1.0 - reflected)),
        ];
        open.extend(
            ways.into_iter().filter(|way| way.1 > least).map(|(d, share)| (met.x, d, share)),
        );
    }
    ends
}

/// What of unpolarised light is reflected from index n1 to n2, by the angles alone; not for total reflection.
#[must_use]
pub fn fresnel(cosine: f64, n1: f64, n2: f64) -> f64 {
    let a = cosine.clamp(0.0, 1.0).acos();
    let b = (n1 / n2 * a.sin()).asin();
    if a < 1e-5 {
        return ((n1 - n2) / (n1 + n2)).powi(2);
    }
    let across = (a - b).sin() / (a + b).sin();
    let along = (a - b).tan() / (a + b).tan();
    0.5 * (across * across + along * along)
}

fn mirrored(d: V3, n: V3) -> V3 {
    unit(add(d, n, -2.0 * dot(n, d)))
}

/// Snell's law by the part of the direction along the surface; nothing where all is reflected.
fn refracted(d: V3, n: V3, ratio: f64) -> Option<V3> {
    let level = add(d, n, -dot(n, d)).map(|c| ratio * c);
    let square = 1.0 - dot(level, level);
    (square > 0.0).then(|| unit(add(level, n, -square.sqrt())))
}

/// The colour of an environment image of linear texels in a direction: bilinear, +y is the top row, −z
/// the middle, +x right of it.
///
/// # Panics
/// For an image of bytes.
#[must_use]
pub fn environment_at(image: &Image, d: V3) -> V3 {
    let Texels::Linear(texels) = &image.texels else { panic!("an image of bytes") };
    let d = unit(d);
    let (width, height) = (f64::from(image.width), f64::from(image.height));
    let turn = d[0].atan2(-d[2]) / std::f64::consts::TAU;
    let x = (0.5 + turn) * width - 0.5;
    let y = (d[1].clamp(-1.0, 1.0).acos() / std::f64::consts::PI * height - 0.5)
        .clamp(0.0, height - 1.0);
    let texel = |column: f64, row: f64| {
        let column = column.rem_euclid(width) as usize;
        texels[row.min(height - 1.0) as usize * image.width as usize + column].map(f64::from)
    };
    let (left, top) = (x.floor(), y.floor());
    let mix = |a: V3, b: V3, part: f64| [0, 1, 2].map(|i| (1.0 - part) * a[i] + part * b[i]);
    let row = |at: f64| mix(texel(left, at), texel(left + 1.0, at), x - left);
    mix(row(top), row(top + 1.0), y - top)
}

/// What docs/scene.md says is looked up for a direction.
#[must_use]
pub fn looked_up(up: V3, [x, y, z]: V3) -> V3 {
    match up.map(|along| if along == 0.0 { 0 } else { along.signum() as i32 }) {
        [0, -1, 0] => [x, -y, -z],
        [0, 0, 1] => [x, z, -y],
        [0, 0, -1] => [x, -z, y],
        [1, 0, 0] => [-y, x, z],
        [-1, 0, 0] => [y, -x, z],
        _ => [x, y, z],
    }
}

/// A direction turned back by Rz·Ry·Rx: about z, then y, then x, each the other way round.
#[must_use]
pub fn turned_back(rotate: V3, d: V3) -> V3 {
    let [(sx, cx), (sy, cy), (sz, cz)] = rotate.map(|angle| angle.to_radians().sin_cos());
    let [x, y, z] = d;
    let [x, y, z] = [cz * x + sz * y, cz * y - sz * x, z];
    let [x, y, z] = [cy * x - sy * z, y, cy * z + sy * x];
    [x, cx * y + sx * z, cx * z - sx * y]
}

/// An environment image of a smooth function of the direction.
#[must_use]
pub fn environment_of(height: u32, radiance: impl Fn(V3) -> V3) -> Image {
    let width = 2 * height;
    let texel = |i: u32| {
        let turn = (f64::from(i % width) + 0.5) / f64::from(width) - 0.5;
        let (across, ahead) = (turn * std::f64::consts::TAU).sin_cos();
        let (level, up) =
            ((f64::from(i / width) + 0.5) / f64::from(height) * std::f64::consts::PI).sin_cos();
        radiance([level * across, up, -level * ahead]).map(|c| c as f32)
    };
    let texels = Texels::Linear((0..width * height).map(texel).collect());
    Image { width, height, texels }
}

/// The value that this share of all values does not exceed.
#[must_use]
pub fn percentile(mut values: Vec<f64>, share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    values[((values.len() - 1) as f64 * share) as usize]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ball images what is far away at n / (2 (n − 1)) of its radius from its middle.
    #[test]
    fn a_ball_of_glass_has_the_focal_length_of_a_ball_lens() {
        let ball = Body { shape: Shape::Sphere([0.0; 3], 1.0), matter: Matter::Glass(1.5, 0.0) };
        let way = follow(&[ball], [1e-4, 0.0, 5.0], [0.0, 0.0, -1.0]);
        let (_, x) = way.hits[1];
        let focus = x[2] + x[0] / way.direction[0] * -way.direction[2];
        assert!((focus + 1.5).abs() < 1e-6, "{focus}");
        assert_eq!(way.hits.len(), 2);
    }

    /// Half as large as the ball and empty, the bubble reflects totally what passes from 1/2 to 3/4.
    #[test]
    fn a_bubble_reflects_beyond_the_critical_angle() {
        let glass = |radius, index| Body {
            shape: Shape::Sphere([0.0; 3], radius),
            matter: Matter::Glass(index, 0.0),
        };
        let bodies = [glass(1.0, 1.5), glass(0.5, 1.0)];
        for (x, total, hits) in
            [(0.49, false, 4), (0.51, true, 3), (0.74, true, 3), (0.76, false, 2)]
        {
            let way = follow(&bodies, [x, 0.0, 5.0], [0.0, 0.0, -1.0]);
            assert_eq!((way.total, way.hits.len()), (total, hits), "{x}");
        }
    }

    /// Bilinear errors are the curvature's: a 3 by 3 times step squared over 8.
    #[test]
    fn an_environment_image_is_the_function_that_it_was_made_of() {
        let image = environment_of(256, |d| [0.5 + 0.3 * d[0], 0.5 + 0.3 * d[1], 0.5 + 0.3 * d[2]]);
        for d in [[1.0, 0.0, 0.0], [-0.3, 0.8, 0.5], [0.01, -0.2, 1.0], [-0.01, -0.2, 1.0]] {
            let (found, d) = (environment_at(&image, d), unit(d));
            for i in 0..3 {
                assert!((found[i] - 0.5 - 0.3 * d[i]).abs() < 3e-5, "{d:?}: {found:?}");
            }
        }
    }
}
