//! Three coordinates.

/// A place or a direction.
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
    let length = length(a);
    a.map(|x| x / length)
}

/// Right, up and forward of somebody who looks along `forward`, upright along z.
pub(crate) fn frame(forward: V3) -> [V3; 3] {
    let forward = unit(forward);
    let right = unit(cross(forward, [0.0, 0.0, 1.0]));
    [right, cross(right, forward), forward]
}
