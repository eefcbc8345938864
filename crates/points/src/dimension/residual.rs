//! What a quadratic polynomial leaves over of a neighbourhood.

/// Terms of the polynomial: 1, x, y, x², y², xy.
const TERMS: usize = 6;
/// Added to the diagonal of the normal equations, in parts of the sum of weights: neighbours on a line or a conic leave
/// terms open.
const RIDGE: f64 = 1e-6;
/// Sweeps of Jacobi rotations; three by three converges in four or five.
const SWEEPS: usize = 8;

/// The weighted root mean square of what a quadratic polynomial over the plane of least variance leaves over, in parts of
/// h. `offsets` are neighbours relative to their point, which is added; h is the distance of the farthest.
///
/// s² = Σθr²/Σθ · K/max(K − 6, 1) with θ = exp(−d²/h²) and K = (Σθ)²/Σθ², the number of equal weights that would vary as
/// much: the terms take a share of the noise with them.
pub(super) fn residual(offsets: &mut Vec<[f64; 3]>, h: f64) -> f64 {
    offsets.push([0.0; 3]);
    for offset in offsets.iter_mut() {
        *offset = offset.map(|x| x / h);
    }
    let weight = |p: &[f64; 3]| (-(p[0] * p[0] + p[1] * p[1] + p[2] * p[2])).exp();
    let weights: Vec<f64> = offsets.iter().map(weight).collect();
    let total: f64 = weights.iter().sum();
    let mut mean = [0.0; 3];
    for (p, w) in offsets.iter().zip(&weights) {
        (0..3).for_each(|a| mean[a] += w * p[a] / total);
    }
    let mut covariance = [[0.0; 3]; 3];
    for (p, w) in offsets.iter().zip(&weights) {
        let z = [0, 1, 2].map(|a| p[a] - mean[a]);
        (0..9).for_each(|i| covariance[i / 3][i % 3] += w * z[i / 3] * z[i % 3]);
    }
    let [n, v, u] = axes(covariance);
    let terms = |p: &[f64; 3]| {
        let [x, y] = [dot(p, &u), dot(p, &v)];
        [1.0, x, y, x * x, y * y, x * y]
    };
    let mut normal = [[0.0; TERMS]; TERMS];
    let mut right = [0.0; TERMS];
    for (p, w) in offsets.iter().zip(&weights) {
        let (t, f) = (terms(p), dot(p, &n));
        for row in 0..TERMS {
            (0..=row).for_each(|column| normal[row][column] += w * t[row] * t[column]);
            right[row] += w * t[row] * f;
        }
    }
    (0..TERMS).for_each(|i| normal[i][i] += RIDGE * total);
    let q = solved(normal, right);
    let left_over = |p: &[f64; 3]| {
        let fitted: f64 = terms(p).iter().zip(&q).map(|(t, q)| t * q).sum();
        dot(p, &n) - fitted
    };
    let squares: f64 = offsets.iter().zip(&weights).map(|(p, w)| w * left_over(p).powi(2)).sum();
    let count = total * total / weights.iter().map(|w| w * w).sum::<f64>();
    (squares / total * count / (count - TERMS as f64).max(1.0)).sqrt()
}

fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The axes of a symmetric matrix, that of the least eigenvalue first (Jacobi's rotations).
fn axes(mut a: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let mut rows = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for (p, q) in [(0, 1), (0, 2), (1, 2)].into_iter().cycle().take(3 * SWEEPS) {
        if a[p][q] == 0.0 {
            continue;
        }
        let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
        let t = theta.signum() / (theta.abs() + theta.hypot(1.0));
        let c = 1.0 / t.hypot(1.0);
        let s = t * c;
        for row in &mut a {
            let [x, y] = [row[p], row[q]];
            (row[p], row[q]) = (c * x - s * y, s * x + c * y);
        }
        for i in 0..3 {
            let [x, y] = [a[p][i], a[q][i]];
            (a[p][i], a[q][i]) = (c * x - s * y, s * x + c * y);
            let [x, y] = [rows[p][i], rows[q][i]];
            (rows[p][i], rows[q][i]) = (c * x - s * y, s * x + c * y);
        }
    }
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| a[i][i].total_cmp(&a[j][j]));
    order.map(|i| rows[i])
}

/// The solution of symmetric positive definite equations, of which the lower half is given (Cholesky).
fn solved(mut a: [[f64; TERMS]; TERMS], mut b: [f64; TERMS]) -> [f64; TERMS] {
    for i in 0..TERMS {
        for j in 0..=i {
            let sum = a[i][j] - (0..j).map(|k| a[i][k] * a[j][k]).sum::<f64>();
            a[i][j] = if i == j { sum.max(f64::MIN_POSITIVE).sqrt() } else { sum / a[j][j] };
        }
        b[i] = (b[i] - (0..i).map(|k| a[i][k] * b[k]).sum::<f64>()) / a[i][i];
    }
    for i in (0..TERMS).rev() {
        b[i] = (b[i] - (i + 1..TERMS).map(|k| a[k][i] * b[k]).sum::<f64>()) / a[i][i];
    }
    b
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A paraboloid turned in space is what the polynomial can be, but for the ridge.
    #[test]
    fn a_quadric_leaves_nothing_over() {
        let turned = |x: f64, y: f64, z: f64| [0.6 * x - 0.8 * z, y, 0.8 * x + 0.6 * z];
        let mut offsets: Vec<[f64; 3]> = (0..64)
            .map(|i| [f64::from(i % 8) - 3.5, f64::from(i / 8) - 3.5])
            .map(|[x, y]| turned(x, y, 0.02 * (x * x + 2.0 * y * y)))
            .collect();
        let s = residual(&mut offsets, 5.0);
        assert!(s < 1e-4, "{s}");
    }

    /// Of a ball with weights exp(−r²), a direction's variance is ∫r⁴e⁻ / 3∫r²e⁻ over 0..1, 0.1789, whose root is 0.423;
    /// the polynomial takes a little of it.
    #[test]
    fn a_filled_ball_leaves_over_what_it_has_across() {
        let steps = || (-9..=9).map(|i| f64::from(i) / 9.0);
        let mut offsets = Vec::new();
        for x in steps() {
            for y in steps() {
                offsets.extend(steps().map(|z| [x, y, z]).filter(|p| dot(p, p) <= 1.0));
            }
        }
        let s = residual(&mut offsets, 1.0);
        assert!((s - 0.423).abs() < 0.01, "{s}");
    }
}
