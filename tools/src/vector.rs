//! The few operations on vectors that the generators need.

/// A position or direction.
pub type Vector = [f64; 3];

/// a + s b.
pub fn add_scaled(a: Vector, s: f64, b: Vector) -> Vector {
    [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]]
}

/// a · b.
pub fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// a × b.
pub fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// s a.
pub fn scale(s: f64, a: Vector) -> Vector {
    a.map(|x| s * x)
}

/// |a|.
pub fn length(a: Vector) -> f64 {
    dot(a, a).sqrt()
}

/// a / |a|; a is not zero.
pub fn unit(a: Vector) -> Vector {
    scale(1.0 / length(a), a)
}
