//! Numbers that look random and are the same everywhere.

pub use points::fill::random;

/// Smooth noise from 0 to 1 with features of size 1.
pub fn noise(x: f64, y: f64) -> f64 {
    let [i, j] = [x.floor(), y.floor()];
    let [s, t] = [x - i, y - j].map(|f| f * f * (3.0 - 2.0 * f));
    let row = |j: f64| random(i, j) + s * (random(i + 1.0, j) - random(i, j));
    row(j) + t * (row(j + 1.0) - row(j))
}
