//! Twin of `glsl/shared/eigen.glsl`: cyclic Jacobi rotations of a symmetric 3 × 3 matrix. It makes all sweeps, also
//! those that turn nothing, which the kernel leaves out: the same result.

use crate::real::{Real, V3};

const JACOBI_SWEEPS: usize = 8;

/// Eigenvalues in ascending order, and two of the eigenvectors.
#[derive(Debug, Clone, Copy)]
pub struct Eigen<R> {
    /// Ascending; ties keep the order x, y, z.
    pub values: V3<R>,
    /// Of the smallest value.
    pub smallest: V3<R>,
    /// Of the largest value.
    pub largest: V3<R>,
}

/// Matrix entries and eigenvectors under rotation: `diagonal[p]`, `off[r]` = entry (p, q) of the
/// axes other than r.
struct State<R> {
    diagonal: [R; 3],
    off: [R; 3],
    vectors: [V3<R>; 3],
}

impl<R: Real> State<R> {
    /// One rotation that zeroes entry (p, q); r is the third axis.
    fn rotate(&mut self, p: usize, q: usize, r: usize) {
        let (app, aqq, apq) = (self.diagonal[p], self.diagonal[q], self.off[r]);
        let (apr, aqr) = (self.off[q], self.off[p]);
        let turn = apq.abs() > R::of(1e-12) * (app.abs() + aqq.abs());
        let theta = (aqq - app) / (R::of(2.0) * if turn { apq } else { R::of(1.0) });
        let magnitude = R::of(1.0) / (theta.abs() + (theta * theta + R::of(1.0)).sqrt());
        let t = match turn {
            true if theta < R::of(0.0) => -magnitude,
            true => magnitude,
            false => R::of(0.0),
        };
        let c = R::of(1.0) / (t * t + R::of(1.0)).sqrt();
        let s = t * c;
        self.diagonal[p] = app - t * apq;
        self.diagonal[q] = aqq + t * apq;
        self.off[r] = if turn { R::of(0.0) } else { apq };
        self.off[q] = c * apr - s * aqr;
        self.off[p] = s * apr + c * aqr;
        let (vp, vq) = (self.vectors[p], self.vectors[q]);
        self.vectors[p] = vp.times(c) - vq.times(s);
        self.vectors[q] = vp.times(s) + vq.times(c);
    }
}

/// The matrix is given by its diagonal and by (xy, xz, yz).
pub fn eigen_symmetric<R: Real>(diagonal: V3<R>, off: V3<R>) -> Eigen<R> {
    let (zero, one) = (R::of(0.0), R::of(1.0));
    let mut m = State {
        diagonal: diagonal.0,
        off: [off.z(), off.y(), off.x()],
        vectors: [V3([one, zero, zero]), V3([zero, one, zero]), V3([zero, zero, one])],
    };
    for _ in 0..JACOBI_SWEEPS {
        m.rotate(0, 1, 2);
        m.rotate(0, 2, 1);
        m.rotate(1, 2, 0);
    }
    let [xx, yy, zz] = m.diagonal;
    let [vx, vy, vz] = m.vectors;
    let (low, high, v_low, v_high) = if yy < xx { (yy, xx, vy, vx) } else { (xx, yy, vx, vy) };
    let (z_lowest, z_highest) = (zz < low, zz >= high);
    Eigen {
        values: V3([
            if z_lowest { zz } else { low },
            if z_lowest {
                low
            } else if z_highest {
                high
            } else {
                zz
            },
            if z_highest { zz } else { high },
        ]),
        smallest: if z_lowest { vz } else { v_low },
        largest: if z_highest { vz } else { v_high },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Q diag(1, 2, 5) Qᵀ with Q a rotation about (1, 1, 1) by 120°, which permutes the axes, and
    /// then about z by the 3-4-5 triangle.
    #[test]
    fn eigenvectors_of_a_rotated_diagonal_are_found() {
        let columns = [[0.6, 0.8, 0.0], [-0.8, 0.6, 0.0], [0.0, 0.0, 1.0]].map(V3::<f64>);
        let values = [5.0, 1.0, 2.0];
        let entry = |i: usize, j: usize| {
            (0..3).map(|k| values[k] * columns[k].0[i] * columns[k].0[j]).sum::<f64>()
        };
        let eigen = eigen_symmetric(
            V3([entry(0, 0), entry(1, 1), entry(2, 2)]),
            V3([entry(0, 1), entry(0, 2), entry(1, 2)]),
        );
        for (found, expected) in eigen.values.0.iter().zip([1.0, 2.0, 5.0]) {
            assert!((found - expected).abs() < 1e-14);
        }
        assert!((eigen.smallest.dot(columns[1]).abs() - 1.0).abs() < 1e-14);
        assert!((eigen.largest.dot(columns[0]).abs() - 1.0).abs() < 1e-14);
    }

    #[test]
    fn zero_matrix_has_axes_and_no_nan() {
        let eigen = eigen_symmetric(V3::splat(0.0f32), V3::splat(0.0));
        assert_eq!(eigen.values, V3::splat(0.0));
        assert_eq!(eigen.smallest, V3([1.0, 0.0, 0.0]));
        assert_eq!(eigen.largest, V3([0.0, 0.0, 1.0]));
    }
}
