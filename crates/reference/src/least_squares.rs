//! Twin of `glsl/shared/least_squares.glsl`: the weighted fit of
//! g(x, y) = A x² + B y² + C xy + E x + F y + D, unknowns in the order A B C E F D.

use crate::real::Real;
use kernels::layout::{FIT_FULL, FIT_INCOMPLETE};

pub(crate) const UNKNOWNS: usize = 6;
const SINGULAR_PIVOT: f64 = 1e-4;

/// Normal equations: lower triangle row by row, and the right side.
#[derive(Debug, Clone)]
pub struct NormalEquations<R> {
    matrix: [R; 21],
    right: [R; 6],
}

impl<R: Real> Default for NormalEquations<R> {
    fn default() -> Self {
        Self { matrix: [R::of(0.0); 21], right: [R::of(0.0); 6] }
    }
}

fn has_coefficient(kind: u32, i: usize) -> bool {
    kind == FIT_FULL || i == 5 || (kind == FIT_INCOMPLETE && i < 3)
}

impl<R: Real> NormalEquations<R> {
    /// Adds one sample of the height f at (x, y).
    pub fn add_sample(&mut self, x: R, y: R, f: R, weight: R) {
        let basis = [x * x, y * y, x * y, x, y, R::of(1.0)];
        let mut at = 0;
        for i in 0..UNKNOWNS {
            let wi = weight * basis[i];
            for &bj in &basis[..=i] {
                self.matrix[at] = self.matrix[at] + wi * bj;
                at += 1;
            }
            self.right[i] = self.right[i] + wi * f;
        }
    }

    /// Coefficients of one kind of polynomial by LDLᵀ without pivoting; the flag is false where a
    /// pivot is singular.
    #[must_use]
    pub fn solve(&self, kind: u32) -> (bool, [R; 6]) {
        let (zero, one) = (R::of(0.0), R::of(1.0));
        let mut lower = [zero; 21];
        let mut pivot = [one; 6];
        let mut regular = true;
        for j in 0..UNKNOWNS {
            let row_j = j * (j + 1) / 2;
            let used = has_coefficient(kind, j);
            let diagonal = self.matrix[row_j + j];
            let mut d = diagonal;
            for k in 0..j {
                d = d - lower[row_j + k] * lower[row_j + k] * pivot[k];
            }
            let good = d > R::of(SINGULAR_PIVOT) * diagonal;
            regular = regular && (good || !used);
            pivot[j] = if used && good { d } else { one };
            for i in j + 1..UNKNOWNS {
                let row_i = i * (i + 1) / 2;
                let mut a = self.matrix[row_i + j];
                for k in 0..j {
                    a = a - lower[row_i + k] * lower[row_j + k] * pivot[k];
                }
                lower[row_i + j] =
                    if used && has_coefficient(kind, i) { a / pivot[j] } else { zero };
            }
        }
        let mut solution = [zero; 6];
        for i in 0..UNKNOWNS {
            let row_i = i * (i + 1) / 2;
            let mut z = if has_coefficient(kind, i) { self.right[i] } else { zero };
            for k in 0..i {
                z = z - lower[row_i + k] * solution[k];
            }
            solution[i] = z;
        }
        for i in 0..UNKNOWNS {
            solution[i] = solution[i] / pivot[i];
        }
        for i in (0..UNKNOWNS).rev() {
            let mut z = solution[i];
            for k in i + 1..UNKNOWNS {
                z = z - lower[k * (k + 1) / 2 + i] * solution[k];
            }
            solution[i] = z;
        }
        (regular, solution)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kernels::layout::FIT_PLANE;

    fn grid_of(f: impl Fn(f64, f64) -> f64) -> NormalEquations<f64> {
        let mut equations = NormalEquations::default();
        for i in -3..=3 {
            for j in -3..=3 {
                let (x, y) = (f64::from(i) * 0.3, f64::from(j) * 0.25 + 0.05);
                equations.add_sample(x, y, f(x, y), (-(x * x + y * y)).exp());
            }
        }
        equations
    }

    #[test]
    fn a_quadric_is_recovered_exactly() {
        let truth = [0.3, -0.2, 0.5, 0.1, -0.4, 0.05];
        let [a, b, c, e, f, d] = truth;
        let equations = grid_of(|x, y| a * x * x + b * y * y + c * x * y + e * x + f * y + d);
        let (regular, solution) = equations.solve(FIT_FULL);
        assert!(regular);
        for (found, expected) in solution.iter().zip(truth) {
            assert!((found - expected).abs() < 1e-13, "{solution:?}");
        }
    }

    #[test]
    fn coefficients_that_a_kind_lacks_are_zero() {
        let equations = grid_of(|x, y| 0.3 * x * x + 0.1 * x + 0.2 * y + 0.05);
        assert_eq!(equations.solve(FIT_INCOMPLETE).1[3..5], [0.0, 0.0]);
        assert_eq!(equations.solve(FIT_PLANE).1[..5], [0.0; 5]);
    }

    /// All samples on the line y = 0: y², xy and y cannot be told.
    #[test]
    fn a_line_of_samples_is_singular_but_a_constant_fits_it() {
        let mut equations = NormalEquations::<f32>::default();
        for i in -8..=8 {
            equations.add_sample(i as f32 * 0.1, 0.0, 0.25, 1.0);
        }
        assert!(!equations.solve(FIT_FULL).0 && !equations.solve(FIT_INCOMPLETE).0);
        assert_eq!(equations.solve(FIT_PLANE), (true, [0.0, 0.0, 0.0, 0.0, 0.0, 0.25]));
    }
}
