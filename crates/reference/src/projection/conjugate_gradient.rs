//! Conjugate gradient, twice: over unit vectors for Equation 1, and for the normal equations of
//! Equation 2.

use super::minimise::minimise;
use crate::real::V3;
use std::f64::consts::FRAC_PI_2;

/// On a surface of two dimensions two steps end a quadratic; the rest is for what is not one.
const MAX_TURNS: usize = 64;
/// Rounds of the linear iteration for each unknown: exact arithmetic needs one.
const ROUNDS_PER_UNKNOWN: usize = 8;
/// Where the residual is rounding, relative to the right side.
const RESIDUAL: f64 = 1e-16;

/// The part of a vector that is tangent to the unit sphere at n.
pub(super) fn tangent(v: V3<f64>, n: V3<f64>) -> V3<f64> {
    v - n.times(v.dot(n))
}

/// The unit vector next to `start` at which a function is least, to a `tolerance` in radians.
/// The function gives its value and its gradient, of which the part along n is ignored.
///
/// Polak and Ribière's directions, in the tangent plane of the sphere and carried along by
/// projection; each line is the great circle n cos φ + d sin φ, searched over 0 ≤ φ ≤ π/2: the
/// functions of Equation 1 are even in n but for t, so the farthest plane is π/2 away.
pub(super) fn minimise_direction(
    f: impl Fn(V3<f64>) -> (f64, V3<f64>),
    start: V3<f64>,
    tolerance: f64,
) -> V3<f64> {
    let mut n = start;
    let mut before: Option<(V3<f64>, V3<f64>)> = None;
    for _ in 0..MAX_TURNS {
        let gradient = tangent(f(n).1, n);
        let steepest = -gradient;
        let conjugate = before.and_then(|(gradient_before, direction_before)| {
            let change = gradient - tangent(gradient_before, n);
            let beta = gradient.dot(change) / gradient_before.dot(gradient_before);
            let direction = steepest + tangent(direction_before, n).times(beta);
            (beta > 0.0 && direction.dot(gradient) < 0.0).then_some(direction)
        });
        let direction = conjugate.unwrap_or(steepest);
        let length = direction.dot(direction).sqrt();
        if !(length > 0.0 && length.is_finite()) {
            break;
        }
        let d = direction.over(length);
        let along = |phi: f64| (n.times(phi.cos()) + d.times(phi.sin())).normalize();
        let line = |phi: f64| {
            let (value, gradient) = f(along(phi));
            (value, gradient.dot(d.times(phi.cos()) - n.times(phi.sin())))
        };
        let phi = minimise(line, [0.0, FRAC_PI_2], 0.0, 0.01 * tolerance).at;
        n = along(phi);
        if phi <= tolerance {
            if conjugate.is_none() {
                break;
            }
            before = None;
        } else {
            before = Some((gradient, direction));
        }
    }
    n
}

/// Solves A c = b for a symmetric positive definite A by conjugate gradient; `None` where A is not,
/// or where the iteration does not end.
///
/// A is first scaled to a unit diagonal, which is Jacobi's preconditioner. A second round solves
/// for the residual that rounding left in the first.
pub(super) fn solve_symmetric<const N: usize>(
    matrix: &[[f64; N]; N],
    right: &[f64; N],
    unknowns: usize,
) -> Option<[f64; N]> {
    let used = 0..unknowns;
    let mut scale = [0.0; N];
    for i in used.clone() {
        let positive = matrix[i][i] > 0.0;
        if !positive {
            return None;
        }
        scale[i] = 1.0 / matrix[i][i].sqrt();
    }
    let scaled: [[f64; N]; N] =
        std::array::from_fn(|i| std::array::from_fn(|j| matrix[i][j] * scale[i] * scale[j]));
    let target: [f64; N] = std::array::from_fn(|i| right[i] * scale[i]);
    let first = iterate(&scaled, &target, unknowns)?;
    let product = apply(&scaled, &first);
    let residual: [f64; N] = std::array::from_fn(|i| target[i] - product[i]);
    let second = iterate(&scaled, &residual, unknowns)?;
    Some(std::array::from_fn(|i| (first[i] + second[i]) * scale[i]))
}

fn iterate<const N: usize>(
    matrix: &[[f64; N]; N],
    right: &[f64; N],
    unknowns: usize,
) -> Option<[f64; N]> {
    let mut solution = [0.0; N];
    let mut residual = *right;
    let mut direction = residual;
    let mut square = dot(&residual, &residual);
    let enough = RESIDUAL * RESIDUAL * square;
    for _ in 0..ROUNDS_PER_UNKNOWN * unknowns {
        if square <= enough {
            return Some(solution);
        }
        let product = apply(matrix, &direction);
        let curvature = dot(&direction, &product);
        let definite = curvature > 0.0;
        if !definite {
            return None;
        }
        let alpha = square / curvature;
        for i in 0..N {
            solution[i] += alpha * direction[i];
            residual[i] -= alpha * product[i];
        }
        let square_before = square;
        square = dot(&residual, &residual);
        let beta = square / square_before;
        for i in 0..N {
            direction[i] = residual[i] + beta * direction[i];
        }
    }
    (square <= enough).then_some(solution)
}

fn dot<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

fn apply<const N: usize>(matrix: &[[f64; N]; N], vector: &[f64; N]) -> [f64; N] {
    std::array::from_fn(|i| dot(&matrix[i], vector))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// nᵀ C n is least along the eigenvector of C's smallest eigenvalue, whatever the start.
    #[test]
    fn the_least_direction_of_a_quadratic_form_is_its_smallest_eigenvector() {
        let axes = [[0.6, 0.8, 0.0], [-0.8, 0.6, 0.0], [0.0, 0.0, 1.0]].map(V3::<f64>);
        let form = |values: [f64; 3]| {
            move |n: V3<f64>| {
                let parts = [0, 1, 2].map(|k| axes[k].times(values[k] * n.dot(axes[k])));
                let gradient = (parts[0] + parts[1] + parts[2]).times(2.0);
                (0.5 * gradient.dot(n), gradient)
            }
        };
        for values in [[1.0, 1e-3, 2.0], [0.3, 0.1, 0.3], [1.0, 0.0, 1e-2]] {
            for start in [[1.0, 0.1, 0.0], [0.0, 1.0, 0.0], [0.3, 0.2, 0.9], [-0.5, 0.5, 0.1]] {
                let n = minimise_direction(form(values), V3(start).normalize(), 1e-11);
                let off = tangent(n, axes[1]);
                assert!(off.dot(off).sqrt() < 1e-10, "{values:?} from {start:?}: {n:?}");
            }
        }
    }

    /// Hilbert's matrix of five unknowns: its condition, 4.8e5, costs that many digits.
    #[test]
    fn an_ill_conditioned_system_is_solved() {
        let matrix: [[f64; 5]; 5] =
            std::array::from_fn(|i| std::array::from_fn(|j| 1.0 / (i + j + 1) as f64));
        let truth = [1.0, -2.0, 3.0, -4.0, 5.0];
        let solution =
            solve_symmetric(&matrix, &apply(&matrix, &truth), 5).expect("a definite matrix");
        for (found, expected) in solution.iter().zip(truth) {
            assert!((found - expected).abs() < 5e5 * 1e-15, "{solution:?}");
        }
    }

    #[test]
    fn unknowns_that_are_unused_stay_zero_and_indefinite_systems_are_refused() {
        let matrix = [[2.0, 1.0, 0.0], [1.0, 2.0, 0.0], [0.0, 0.0, 0.0]];
        assert_eq!(solve_symmetric(&matrix, &[0.0; 3], 2), Some([0.0; 3]), "no right side");
        let solution = solve_symmetric(&matrix, &[3.0, 3.0, 0.0], 2).expect("definite");
        assert!((solution[0] - 1.0).abs() < 1e-15 && solution[2] == 0.0, "{solution:?}");
        assert_eq!(solve_symmetric(&matrix, &[3.0, 3.0, 0.0], 3), None);
        assert_eq!(solve_symmetric(&[[1.0, 2.0], [2.0, 1.0]], &[1.0, -1.0], 2), None);
    }
}
