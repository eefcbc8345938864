//! How far a picture of a simulated scan is from the room that was scanned.

use film::Film;
use scans::{Hit, Observed, Room, Scan, V3, add, cross, dot, length};
use std::fmt;

/// Of [`Room::scene`]'s points and light.
const ALBEDO: f64 = 0.8;
const IRRADIANCE: f64 = 3.0;
/// Hits so many deviations and so many spacings before the truth are of no surface.
const PHANTOM: [f64; 2] = [5.0, 2.0];
/// Degrees.
const WRONG: f64 = 30.0;
/// Pixels so near the outline of a shadow are not judged by their light.
const OUTLINE: usize = 2;
/// Cosine of the light from which on surfaces count as lit.
const LIT: f64 = 0.2;
/// What is nearer to an edge than so many spacings is not smooth; nor where depths around jump by so much.
const EDGE: f64 = 4.0;
const JUMP: f64 = 0.05;

/// What a picture of a room should show.
pub struct Truth {
    size: [usize; 2],
    eye: V3,
    pixels: Vec<Pixel>,
}

struct Pixel {
    way: V3,
    hit: Option<Hit>,
    /// Of the scan, where something was hit.
    scan: Option<Observed>,
    /// Cosine of the light.
    cosine: f64,
    is_lit: bool,
    is_smooth: bool,
}

/// Shares in percent, angles in degrees.
#[derive(Debug, Clone, Copy)]
pub struct Verdict {
    /// Of pixels whose place was scanned: those with a hit. All else is of these.
    pub coverage: f64,
    /// Errors of the normals, either way: the median, and what nine of ten do not exceed.
    pub normal: [f64; 2],
    /// Normals more than 30° off.
    pub wrong: f64,
    /// Hits far before the truth.
    pub phantoms: f64,
    /// Of those that should be lit: less than half as bright as they should be.
    pub speckle: f64,
    /// The normals' errors away from edges.
    pub smooth: [f64; 2],
}

impl Truth {
    /// Of a scan's room, for pictures of its camera of this size.
    #[must_use]
    pub fn new(room: &Room, scan: &Scan, size: [usize; 2]) -> Self {
        let eye = room.view.eye;
        let towards = room.light.map(|x| -x);
        let mut is_free = Vec::new();
        let mut places = Vec::new();
        let mut pixels = Vec::new();
        for pixel in 0..size[0] * size[1] {
            let way = room.view.through(pixel, size);
            let hit = room.trace(eye, way);
            let place = hit.map(|hit| (add(eye, way, hit.t), hit.normal));
            let cosine = hit.map_or(0.0, |hit| dot(hit.normal, towards));
            let shadowed = |(p, n): (V3, V3)| room.trace(add(p, n, 1e-5), towards).is_some();
            is_free.push(cosine > 0.0 && !place.is_some_and(shadowed));
            places.push(place);
            let scan = place.map(|(p, n)| scan.at(p, n));
            pixels.push(Pixel { way, hit, scan, cosine, is_lit: false, is_smooth: false });
        }
        for at in 0..pixels.len() {
            let free = around(at, size, OUTLINE).all(|other| is_free[other]);
            pixels[at].is_lit = free && pixels[at].cosine > LIT;
            let depth = |at: usize| pixels[at].hit.map_or(1e9, |hit| hit.t);
            let near = around(at, size, 1).map(depth).fold(f64::INFINITY, f64::min);
            let far = around(at, size, 1).map(depth).fold(0.0, f64::max);
            let spacing = pixels[at].scan.map_or(0.0, |scan| scan.spacing);
            let at_edge = places[at].is_some_and(|(p, _)| room.edge_distance(p) < EDGE * spacing);
            pixels[at].is_smooth = !at_edge && (far - near) / near <= JUMP;
        }
        Self { size, eye, pixels }
    }

    /// What a picture is like.
    ///
    /// # Panics
    /// For one of another size.
    #[must_use]
    pub fn judge(&self, film: &Film) -> Verdict {
        let size = [film.window.width, film.window.height].map(|side| side as usize);
        assert_eq!(size, self.size, "the picture's size");
        let (mut observed, mut hits) = (0.0, 0.0);
        let (mut angles, mut smooth) = (Vec::new(), Vec::new());
        let (mut wrong, mut phantoms, mut lit, mut dark) = (0.0, 0.0, 0.0, 0.0);
        for (at, pixel) in self.pixels.iter().enumerate() {
            let (Some(hit), Some(scan)) = (pixel.hit, pixel.scan.filter(|scan| scan.is_seen))
            else {
                continue;
            };
            observed += 1.0;
            if film.object[at] < 0.0 || film.color[at][3] <= 0.5 {
                continue;
            }
            hits += 1.0;
            let angle = angle(film.normal[at].map(f64::from), hit.normal);
            angles.push(angle);
            if pixel.is_smooth {
                smooth.push(angle);
            }
            wrong += f64::from(u8::from(angle > WRONG));
            let t = dot(add(film.position[at].map(f64::from), self.eye, -1.0), pixel.way);
            let before = PHANTOM[0] * scan.sigma + PHANTOM[1] * scan.spacing;
            phantoms += f64::from(u8::from(t < hit.t - before));
            if pixel.is_lit {
                let expected = ALBEDO / std::f64::consts::PI * IRRADIANCE * pixel.cosine;
                lit += 1.0;
                dark += f64::from(u8::from(f64::from(film.color[at][1]) < 0.5 * expected));
            }
        }
        let both = |angles: Vec<f64>| [0.5, 0.9].map(|share| interpolated(&angles, share));
        Verdict {
            coverage: 100.0 * hits / observed,
            normal: both(sorted(angles)),
            wrong: 100.0 * wrong / hits,
            phantoms: 100.0 * phantoms / hits,
            speckle: 100.0 * dark / lit,
            smooth: both(sorted(smooth)),
        }
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { coverage, normal, wrong, phantoms, speckle, smooth } = self;
        write!(
            f,
            "coverage {coverage:.1}, normals {:.1} {:.1} (smooth {:.1} {:.1}), over 30° {wrong:.1}, phantoms \
             {phantoms:.1}, speckle {speckle:.1}",
            normal[0], normal[1], smooth[0], smooth[1]
        )
    }
}

/// A pixel and those around it, to a distance, as far as the picture goes.
fn around(at: usize, [width, height]: [usize; 2], by: usize) -> impl Iterator<Item = usize> {
    let (x, y) = (at % width, at / width);
    let columns = x.saturating_sub(by)..width.min(x + by + 1);
    let rows = y.saturating_sub(by)..height.min(y + by + 1);
    rows.flat_map(move |y| columns.clone().map(move |x| y * width + x))
}

/// Degrees between two directions, either way; 90 where one is none.
fn angle(a: V3, b: V3) -> f64 {
    let across = length(cross(a, b));
    let degrees = across.atan2(dot(a, b).abs()).to_degrees();
    if dot(a, a) > 0.0 && degrees.is_finite() { degrees } else { 90.0 }
}

fn sorted(mut values: Vec<f64>) -> Vec<f64> {
    values.sort_by(f64::total_cmp);
    values
}

/// Between the two nearest of sorted values.
fn interpolated(sorted: &[f64], share: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    let place = last as f64 * share;
    let low = place as usize;
    let high = last.min(low + 1);
    sorted[low] + (sorted[high] - sorted[low]) * (place - low as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use film::Window;
    use scans::{Scanner, unit};

    const SIZE: [usize; 2] = [80, 60];

    /// The truth as a picture, of which every tenth pixel is changed.
    fn picture(truth: &Truth, change: impl Fn(&mut Film, usize, &Hit, V3)) -> Verdict {
        let size = SIZE.map(|side| side as u32);
        let mut film = Film::empty(size, Window::whole(size), false);
        for (at, pixel) in truth.pixels.iter().enumerate() {
            let Some(hit) = pixel.hit else { continue };
            film.object[at] = 0.0;
            film.position[at] = add(truth.eye, pixel.way, hit.t).map(|x| x as f32);
            film.normal[at] = hit.normal.map(|x| x as f32);
            let light = if pixel.is_lit {
                ALBEDO / std::f64::consts::PI * IRRADIANCE * pixel.cosine
            } else {
                0.0
            };
            film.color[at] = [light as f32, light as f32, light as f32, 1.0];
            if at % 10 == 0 {
                change(&mut film, at, &hit, pixel.way);
            }
        }
        truth.judge(&film)
    }

    /// Each fault is found in the tenth of the pixels that have it, and in no other figure.
    #[test]
    fn each_fault_has_its_figure() {
        let room = Room::new(0);
        let truth = Truth::new(&room, &Scan::new(Scanner::Laser1, &room, 1, 0.5), SIZE);
        let good = picture(&truth, |_, _, _, _| {});
        assert!(good.coverage == 100.0 && good.normal[1] < 1e-3, "{good}");
        assert!(good.wrong == 0.0 && good.phantoms == 0.0 && good.speckle == 0.0, "{good}");
        // By chance a tenth of the observed is 9 to 11 %, of the lit too.
        let tenth = |share: f64| (share - 10.0).abs() < 1.0;
        let holes = picture(&truth, |film, at, _, _| film.object[at] = -1.0);
        assert!(tenth(100.0 - holes.coverage) && holes.wrong == 0.0, "{holes}");
        let turned = picture(&truth, |film, at, hit, way| {
            let across = unit(cross(hit.normal, way));
            let (sin, cos) = 40f64.to_radians().sin_cos();
            let tilted = add(hit.normal.map(|x| cos * x), across, sin);
            film.normal[at] = tilted.map(|x| -x as f32);
        });
        assert!(
            tenth(turned.wrong) && turned.normal[0] < 1e-3 && turned.phantoms == 0.0,
            "{turned}"
        );
        let near = picture(&truth, |film, at, hit, way| {
            film.position[at] = add(truth.eye, way, hit.t - 0.3).map(|x| x as f32);
        });
        assert!(tenth(near.phantoms) && near.wrong == 0.0 && near.speckle == 0.0, "{near}");
        let black = picture(&truth, |film, at, _, _| film.color[at] = [0.0, 0.0, 0.0, 1.0]);
        assert!(tenth(black.speckle) && black.coverage == 100.0, "{black}");
    }

    #[test]
    fn percentiles_lie_between_the_nearest_two() {
        assert_eq!(interpolated(&[1.0, 2.0, 4.0], 0.75), 3.0);
        assert_eq!(interpolated(&[5.0], 0.9), 5.0);
        assert!(interpolated(&[], 0.5).is_nan());
    }
}
