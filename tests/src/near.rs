//! What two renders may differ by on devices that are not exact: their arithmetic contracts, reorders or flushes,
//! which moves a surface by some last bits, and lets a ray in a hundred or two take another way at an outline, a
//! seam between polynomials, or inside of glass.

use crate::{Rendered, said};
use film::Film;
use kernels::layout::Polynomial;

/// The share of points whose polynomials may be others: at a threshold, a trust radius or a kind flips.
const OTHER_POLYNOMIALS: f64 = 0.01;
/// The share of pixels that may show something else.
const OTHER_PIXELS: f64 = 0.02;
/// What counts as else: this much of a value, or of 1.
const FAR: f32 = 1e-3;

/// Fails unless both are the same but for what rounding may do.
pub(crate) fn assert_near(name: &str, a: &Rendered, b: &Rendered) {
    assert_eq!(a.polynomials.len(), b.polynomials.len(), "{name}: polynomials");
    let pairs = a.polynomials.iter().zip(&b.polynomials);
    let other = pairs.filter(|(p, q)| !same_surface(p, q)).count();
    assert_share(name, "polynomials", other, a.polynomials.len(), OTHER_POLYNOMIALS);
    assert_near_films(name, &a.film, &b.film);
}

/// The same of two films.
pub(crate) fn assert_near_films(name: &str, a: &Film, b: &Film) {
    let pixels = a.color.len();
    let other = |differ: &dyn Fn(usize) -> bool| (0..pixels).filter(|&at| differ(at)).count();
    assert_eq!(a.channel_alpha.is_some(), b.channel_alpha.is_some(), "{name}: AR AG AB");
    let alphas = a.channel_alpha.as_ref().zip(b.channel_alpha.as_ref());
    let planes: [(&str, &dyn Fn(usize) -> bool); 6] = [
        ("object", &|at| a.object[at] != b.object[at]),
        ("RGBA", &|at| far(&a.color[at], &b.color[at])),
        ("Z", &|at| far(&[a.depth[at]], &[b.depth[at]])),
        ("P", &|at| far(&a.position[at], &b.position[at])),
        ("N", &|at| far(&a.normal[at], &b.normal[at])),
        ("AR AG AB", &|at| alphas.is_some_and(|(a, b)| far(&a[at], &b[at]))),
    ];
    for (plane, differ) in planes {
        assert_share(name, plane, other(differ), pixels, OTHER_PIXELS);
    }
}

/// Says the share, where it is any: what a driver's tolerances should be is read from there.
fn assert_share(name: &str, what: &str, other: usize, all: usize, most: f64) {
    if other > 0 {
        let percent = 100.0 * other as f64 / all as f64;
        said(&format!("NEAR: {name}: {what}: {other} of {all} ({percent:.2} %) are others"));
    }
    // A few in a small picture are no share.
    let allowed = (most * all as f64).ceil().max(4.0);
    assert!(
        other as f64 <= allowed,
        "{name}: {what}: {other} of {all} differ by more than rounding"
    );
}

/// Points without a surface may hold anything beside.
fn same_surface(p: &Polynomial, q: &Polynomial) -> bool {
    let trust = [p, q].map(|polynomial| polynomial.center_trust[3]);
    trust == [0.0; 2]
        || (!far(&p.center_trust, &q.center_trust) && !far(&p.gradient_offset, &q.gradient_offset))
}

fn far(a: &[f32], b: &[f32]) -> bool {
    let near =
        |(a, b): (&f32, &f32)| a == b || (a - b).abs() <= FAR * a.abs().max(b.abs()).max(1.0);
    !a.iter().zip(b).all(near) // so that NaN is far from everything
}
