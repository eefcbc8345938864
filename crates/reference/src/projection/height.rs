//! The polynomial over the reference plane: Equation 2.

use super::conjugate_gradient::solve_symmetric;
use super::{PolynomialKind, theta};
use crate::real::V3;

const MOST_TERMS: usize = 15;
/// The method's limit: a pivot of LDLᵀ under this part of its diagonal entry is singular.
const SINGULAR_PIVOT: f64 = 1e-4;

/// Exponents of x and y of each term. The first six are the order A B C E F D of the method.
const TERMS: [[i32; 2]; MOST_TERMS] = [
    [2, 0],
    [0, 2],
    [1, 1],
    [1, 0],
    [0, 1],
    [0, 0],
    [3, 0],
    [2, 1],
    [1, 2],
    [0, 3],
    [4, 0],
    [3, 1],
    [2, 2],
    [1, 3],
    [0, 4],
];
const SLOPE_X: usize = 3;
const SLOPE_Y: usize = 4;
const CONSTANT: usize = 5;

/// Places in [`TERMS`] of a kind's terms.
fn terms(kind: PolynomialKind) -> &'static [usize] {
    const ALL: [usize; MOST_TERMS] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14];
    match kind {
        PolynomialKind::Plane => &ALL[CONSTANT..=CONSTANT],
        PolynomialKind::Incomplete => &[0, 1, 2, CONSTANT],
        PolynomialKind::Full => &ALL[..6],
        PolynomialKind::Cubic => &ALL[..10],
        PolynomialKind::Quartic => &ALL,
    }
}

/// g at (0, 0), in units of h.
#[derive(Debug, Clone, Copy)]
pub(super) struct Height {
    /// g(0, 0)
    pub(super) offset: f64,
    /// ∇g(0, 0)
    pub(super) slope: [f64; 2],
    /// Which kind could be told from the points.
    pub(super) kind: PolynomialKind,
}

/// Normal equations of the terms of one kind.
struct Equations {
    matrix: [[f64; MOST_TERMS]; MOST_TERMS],
    right: [f64; MOST_TERMS],
    unknowns: usize,
}

impl Equations {
    /// Samples are (x, y, f, weight).
    fn new(samples: &[[f64; 4]], terms: &[usize]) -> Self {
        let mut equations = Self {
            matrix: [[0.0; MOST_TERMS]; MOST_TERMS],
            right: [0.0; MOST_TERMS],
            unknowns: terms.len(),
        };
        for &[x, y, f, weight] in samples {
            let mut basis = [0.0; MOST_TERMS];
            for (value, &term) in basis.iter_mut().zip(terms) {
                *value = x.powi(TERMS[term][0]) * y.powi(TERMS[term][1]);
            }
            for i in 0..terms.len() {
                let wi = weight * basis[i];
                for (entry, bj) in equations.matrix[i].iter_mut().zip(basis) {
                    *entry += wi * bj;
                }
                equations.right[i] += wi * f;
            }
        }
        equations
    }

    /// Whether all pivots of LDLᵀ are clear of zero. Conjugate gradient alone would not say: normal
    /// equations have solutions even where they have many, and it finds the shortest.
    fn is_regular(&self) -> bool {
        let mut rest = self.matrix;
        for j in 0..self.unknowns {
            let pivot = rest[j][j];
            let clear = pivot > SINGULAR_PIVOT * self.matrix[j][j];
            if !clear {
                return false;
            }
            let row = rest[j];
            for below in &mut rest[j + 1..self.unknowns] {
                let factor = below[j] / pivot;
                for (entry, above) in below.iter_mut().zip(row) {
                    *entry -= factor * above;
                }
            }
        }
        true
    }

    fn solve(&self) -> Option<[f64; MOST_TERMS]> {
        if !self.is_regular() {
            return None;
        }
        solve_symmetric(&self.matrix, &self.right, self.unknowns)
    }
}

/// The polynomial that minimises Equation 2 over the plane through q with normal n; `about_q` are
/// the offsets (pᵢ − q)/h. Where the points cannot tell the kind, the next simpler one.
pub(super) fn fit_height(
    about_q: &[V3<f64>],
    [u, v, n]: [V3<f64>; 3],
    wanted: PolynomialKind,
) -> Option<Height> {
    let samples: Vec<[f64; 4]> =
        about_q.iter().map(|&y| [y.dot(u), y.dot(v), y.dot(n), theta(y.dot(y))]).collect();
    PolynomialKind::SIMPLER.into_iter().filter(|&kind| kind <= wanted).find_map(|kind| {
        let terms = terms(kind);
        let solution = Equations::new(&samples, terms).solve()?;
        let coefficient = |term: usize| {
            terms.iter().position(|&t| t == term).map_or(0.0, |place| solution[place])
        };
        Some(Height {
            offset: coefficient(CONSTANT),
            slope: [coefficient(SLOPE_X), coefficient(SLOPE_Y)],
            kind,
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::least_squares::NormalEquations;
    use kernels::layout::{FIT_FULL, FIT_INCOMPLETE};

    /// A cap of a wavy surface, unevenly sampled, within 3h.
    fn samples() -> Vec<[f64; 4]> {
        (0..150)
            .map(|i| {
                let (r, phi) = (3.0 * (f64::from(i) / 150.0).sqrt(), 2.4 * f64::from(i));
                let (x, y) = (r * phi.cos() + 0.1, r * phi.sin() - 0.05);
                let f = 0.1 + 0.3 * x * y - 0.2 * y * y + 0.05 * (3.0 * x).sin();
                [x, y, f, theta(x * x + y * y + f * f)]
            })
            .collect()
    }

    /// Conditions here are below 1e3, so 1e-12 leaves a digit to both solvers.
    #[test]
    fn conjugate_gradient_equals_the_direct_solution_of_the_same_equations() {
        let mut direct = NormalEquations::<f64>::default();
        for [x, y, f, weight] in samples() {
            direct.add_sample(x, y, f, weight);
        }
        for (kind, code) in
            [(PolynomialKind::Full, FIT_FULL), (PolynomialKind::Incomplete, FIT_INCOMPLETE)]
        {
            let solution = Equations::new(&samples(), terms(kind)).solve().expect("regular");
            let (regular, expected) = direct.solve(code);
            assert!(regular);
            for (found, &term) in solution.iter().zip(terms(kind)) {
                assert!((found - expected[term]).abs() < 1e-12, "{kind:?} term {term}");
            }
        }
    }

    /// Gauss's elimination of the same equations, of up to 15 unknowns and a condition of 1e6.
    #[test]
    fn higher_degrees_equal_their_direct_solution() {
        for kind in [PolynomialKind::Cubic, PolynomialKind::Quartic] {
            let equations = Equations::new(&samples(), terms(kind));
            let solution = equations.solve().expect("regular");
            let n = terms(kind).len();
            let (mut rest, mut right) = (equations.matrix, equations.right);
            for j in 0..n {
                let row = rest[j];
                for i in j + 1..n {
                    let factor = rest[i][j] / row[j];
                    for (entry, above) in rest[i].iter_mut().zip(row) {
                        *entry -= factor * above;
                    }
                    right[i] -= factor * right[j];
                }
            }
            for i in (0..n).rev() {
                let known: f64 = (i + 1..n).map(|k| rest[i][k] * right[k]).sum();
                right[i] = (right[i] - known) / rest[i][i];
                assert!((solution[i] - right[i]).abs() < 1e-10, "{kind:?} unknown {i}");
            }
        }
    }

    #[test]
    fn polynomials_of_their_own_degree_are_recovered() {
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(V3);
        for (kind, power) in
            [(PolynomialKind::Full, 2), (PolynomialKind::Cubic, 3), (PolynomialKind::Quartic, 4)]
        {
            let cap: Vec<V3<f64>> = samples()
                .iter()
                .map(|&[x, y, ..]| {
                    V3([x, y, 0.125 + 0.25 * x - 0.5 * y + 0.1 * (x - 0.5 * y).powi(power)])
                })
                .collect();
            let height = fit_height(&cap, axes, kind).expect("a polynomial");
            assert_eq!(height.kind, kind);
            // The condition, up to 1e6, times ε.
            assert!((height.offset - 0.125).abs() < 1e-10, "{height:?}");
            assert!((height.slope[0] - 0.25).abs() < 1e-10, "{height:?}");
            assert!((height.slope[1] + 0.5).abs() < 1e-10, "{height:?}");
        }
    }

    #[test]
    fn points_that_cannot_tell_a_kind_get_a_simpler_one() {
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(V3);
        let ring = |count: i32| -> Vec<V3<f64>> {
            (0..count)
                .map(|i| {
                    let phi = std::f64::consts::TAU * f64::from(i) / f64::from(count);
                    V3([0.5 * phi.cos() + 0.1, 0.3 * phi.sin(), 0.0])
                })
                .collect()
        };
        let kind = |points: &[V3<f64>]| {
            fit_height(points, axes, PolynomialKind::Quartic).expect("a polynomial").kind
        };
        // On a conic x², y², xy, x, y and 1 are dependent, however many the points.
        assert_eq!(kind(&ring(40)), PolynomialKind::Incomplete);
        assert_eq!(kind(&ring(3)), PolynomialKind::Plane);
    }
}
