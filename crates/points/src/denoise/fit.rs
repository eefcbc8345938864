//! The weighted quadratic fit to a neighbourhood, with what its residual says.

use super::lanes::{LANES, Lanes, exp_down, sum, wide};

/// Coefficients of the polynomial.
const COEFFICIENTS: usize = 6;
/// Added to the diagonal of the normal equations, of the weights' sum: points of one line give some polynomial.
const RIDGE: f64 = 1e-6;
/// A polynomial that is steeper over its plane is none: the plane is taken.
const STEEPEST: f32 = 1.0;

/// A fit to the points within h of a point.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Fit {
    /// Of unit length, to either side.
    pub normal: [f32; 3],
    /// From the point to its foot on the surface.
    pub foot: [f32; 3],
    /// Residual: the noise's standard deviation along the normal.
    pub s: f32,
    pub h: f32,
    /// The expected error of the normal, in radians.
    pub error: f32,
}

/// 2.6: what makes it the median error on planes with noise (docs/method.md).
const ERROR: f32 = 2.6;

/// Offsets of the neighbours from the point in units of h, the point itself among them; filled up to whole lanes.
#[derive(Default)]
pub(super) struct Neighborhood {
    y: [Vec<Lanes>; 3],
    weight: Vec<Lanes>,
    /// In the frame of the plane: along it, across it, above it.
    local: [Vec<Lanes>; 3],
    count: usize,
}

impl Neighborhood {
    pub fn clear(&mut self) {
        self.count = 0;
        self.y.iter_mut().for_each(Vec::clear);
        self.weight.clear();
    }

    pub fn push(&mut self, offset: [f32; 3]) {
        let lane = self.count % LANES;
        if lane == 0 {
            self.y.iter_mut().for_each(|y| y.push([0.0; LANES]));
            self.weight.push([0.0; LANES]);
        }
        let last = self.weight.len() - 1;
        for (list, offset) in self.y.iter_mut().zip(offset) {
            list[last][lane] = offset;
        }
        self.weight[last][lane] = 1.0;
        self.count += 1;
    }

    #[inline(always)]
    fn weigh(&mut self) {
        let [xs, ys, zs] = &self.y;
        for (((weight, x), y), z) in self.weight.iter_mut().zip(xs).zip(ys).zip(zs) {
            for i in 0..LANES {
                let square = (x[i] * x[i] + y[i] * y[i]) + z[i] * z[i];
                weight[i] *= exp_down(square.min(1.0));
            }
        }
    }

    /// Weights' sum, that of their squares, and the weighted mean.
    #[inline(always)]
    fn mean(&self) -> (f32, f32, [f32; 3]) {
        let mut sums = [[0.0; LANES]; 5];
        let [xs, ys, zs] = &self.y;
        for (((w, x), y), z) in self.weight.iter().zip(xs).zip(ys).zip(zs) {
            for i in 0..LANES {
                sums[0][i] += w[i];
                sums[1][i] += w[i] * w[i];
                sums[2][i] += w[i] * x[i];
                sums[3][i] += w[i] * y[i];
                sums[4][i] += w[i] * z[i];
            }
        }
        let [total, squares, x, y, z] = sums.map(|lanes| sum(&lanes));
        (total, squares, [x / total, y / total, z / total])
    }

    /// xx, yy, zz, xy, xz, yz about the mean.
    #[inline(always)]
    fn covariance(&self, mean: [f32; 3]) -> [f32; 6] {
        let mut sums = [[0.0; LANES]; 6];
        let [xs, ys, zs] = &self.y;
        for (((w, x), y), z) in self.weight.iter().zip(xs).zip(ys).zip(zs) {
            for i in 0..LANES {
                let (dx, dy, dz) = (x[i] - mean[0], y[i] - mean[1], z[i] - mean[2]);
                let (wx, wy) = (w[i] * dx, w[i] * dy);
                sums[0][i] += wx * dx;
                sums[1][i] += wy * dy;
                sums[2][i] += w[i] * dz * dz;
                sums[3][i] += wx * dy;
                sums[4][i] += wx * dz;
                sums[5][i] += wy * dz;
            }
        }
        sums.map(|lanes| sum(&lanes))
    }

    /// Into a frame of these axes.
    #[inline(always)]
    fn turn(&mut self, [u, v, n]: [[f32; 3]; 3]) {
        let [xs, ys, zs] = &self.y;
        for (axis, list) in [u, v, n].into_iter().zip(&mut self.local) {
            list.clear();
            list.extend(xs.iter().zip(ys).zip(zs).map(|((x, y), z)| {
                let mut along = [0.0; LANES];
                for i in 0..LANES {
                    along[i] = (x[i] * axis[0] + y[i] * axis[1]) + z[i] * axis[2];
                }
                along
            }));
        }
    }

    /// Sums of weights times x^i y^j for i + j up to 4, and times f for i + j up to 2.
    #[inline(always)]
    fn moments(&self) -> ([f32; 15], [f32; 6]) {
        let (mut m, mut b) = ([[0.0; LANES]; 15], [[0.0; LANES]; 6]);
        let [xs, ys, fs] = &self.local;
        for (((w, x), y), f) in self.weight.iter().zip(xs).zip(ys).zip(fs) {
            for i in 0..LANES {
                let (w, x, y, f) = (w[i], x[i], y[i], f[i]);
                let (wx, wy) = (w * x, w * y);
                let (xx, xy, yy) = (x * x, x * y, y * y);
                let (wxx, wxy, wyy) = (w * xx, w * xy, w * yy);
                m[0][i] += w;
                m[1][i] += wx;
                m[2][i] += wy;
                m[3][i] += wxx;
                m[4][i] += wxy;
                m[5][i] += wyy;
                m[6][i] += wxx * x;
                m[7][i] += wxx * y;
                m[8][i] += wyy * x;
                m[9][i] += wyy * y;
                m[10][i] += wxx * xx;
                m[11][i] += wxx * xy;
                m[12][i] += wxx * yy;
                m[13][i] += wyy * xy;
                m[14][i] += wyy * yy;
                b[0][i] += w * f;
                b[1][i] += wx * f;
                b[2][i] += wy * f;
                b[3][i] += wxx * f;
                b[4][i] += wyy * f;
                b[5][i] += wxy * f;
            }
        }
        (m.map(|lanes| sum(&lanes)), b.map(|lanes| sum(&lanes)))
    }

    /// The sum of weighted squares of what the polynomial leaves.
    #[inline(always)]
    fn residual(&self, c: [f32; COEFFICIENTS]) -> f32 {
        let mut squares = [0.0; LANES];
        let [xs, ys, fs] = &self.local;
        for (((w, x), y), f) in self.weight.iter().zip(xs).zip(ys).zip(fs) {
            for i in 0..LANES {
                let (x, y) = (x[i], y[i]);
                let linear = (c[0] + c[1] * x) + c[2] * y;
                let left = f[i] - (linear + ((c[3] * x + c[5] * y) * x + c[4] * y * y));
                squares[i] += w[i] * left * left;
            }
        }
        sum(&squares)
    }

    /// Fits 1, x, y, x², y², xy over the plane through the weighted mean.
    pub fn fit(&mut self, h: f32) -> Fit {
        wide(|| self.fit_inlined(h))
    }

    #[inline(always)]
    fn fit_inlined(&mut self, h: f32) -> Fit {
        self.weigh();
        let (total, squares, mean) = self.mean();
        let [u, v, n] = frame(self.covariance(mean));
        self.turn([u, v, n]);
        let (m, b) = self.moments();
        // Rows of 1, x, y, xx, yy, xy; entries of m.
        const ROWS: [[usize; COEFFICIENTS]; COEFFICIENTS] = [
            [0, 1, 2, 3, 5, 4],
            [1, 3, 4, 6, 8, 7],
            [2, 4, 5, 7, 9, 8],
            [3, 6, 7, 10, 12, 11],
            [5, 8, 9, 12, 14, 13],
            [4, 7, 8, 11, 13, 12],
        ];
        let matrix = ROWS.map(|row| row.map(|entry| f64::from(m[entry])));
        let c = solve(matrix, b.map(f64::from), RIDGE * f64::from(total)).map(|c| c as f32);
        let effective = total * total / squares;
        let freedom = (effective - COEFFICIENTS as f32).max(1.0);
        let s = (self.residual(c) / total * (effective / freedom)).sqrt() * h;
        let along = |v: [f32; 3], x: f32| v.map(|component| component * x);
        let add = |a: [f32; 3], b: [f32; 3]| [0, 1, 2].map(|axis| a[axis] + b[axis]);
        let (normal, foot) = if c[1] * c[1] + c[2] * c[2] > STEEPEST * STEEPEST {
            let height = (mean[0] * n[0] + mean[1] * n[1]) + mean[2] * n[2];
            (n, along(n, height * h))
        } else {
            // A Newton step along the gradient.
            let gradient = add(n, add(along(u, -c[1]), along(v, -c[2])));
            let square = 1.0 + c[1] * c[1] + c[2] * c[2];
            (along(gradient, 1.0 / square.sqrt()), along(gradient, c[0] * h / square))
        };
        Fit { normal, foot, s, h, error: ERROR * s / (h * effective.sqrt()) }
    }
}

/// The eigenvectors of a covariance, of the largest eigenvalue first: cyclic Jacobi rotations.
fn frame(c: [f32; 6]) -> [[f32; 3]; 3] {
    let [xx, yy, zz, xy, xz, yz] = c.map(f64::from);
    let mut a = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
    let mut v = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]; // rows
    for _ in 0..8 {
        let mut turned = false;
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            let off = a[p][q];
            if off.abs() <= 1e-14 * (a[p][p].abs() + a[q][q].abs()) {
                continue;
            }
            turned = true;
            let theta = (a[q][q] - a[p][p]) / (2.0 * off);
            let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
            let cosine = 1.0 / (t * t + 1.0).sqrt();
            let sine = t * cosine;
            let r = 3 - p - q;
            a[p][p] -= t * off;
            a[q][q] += t * off;
            (a[p][q], a[q][p]) = (0.0, 0.0);
            let (pr, qr) = (a[p][r], a[q][r]);
            (a[p][r], a[q][r]) = (cosine * pr - sine * qr, sine * pr + cosine * qr);
            (a[r][p], a[r][q]) = (a[p][r], a[q][r]);
            let (at_p, at_q) = (v[p], v[q]);
            v[p] = std::array::from_fn(|i| cosine * at_p[i] - sine * at_q[i]);
            v[q] = std::array::from_fn(|i| sine * at_p[i] + cosine * at_q[i]);
        }
        if !turned {
            break;
        }
    }
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| a[j][j].total_cmp(&a[i][i]));
    order.map(|i| v[i].map(|x| x as f32))
}

/// Solves by Cholesky's decomposition, with `ridge` on the diagonal; zeros where that is not positive.
fn solve(
    mut a: [[f64; COEFFICIENTS]; COEFFICIENTS],
    mut b: [f64; COEFFICIENTS],
    ridge: f64,
) -> [f64; COEFFICIENTS] {
    let before = |a: &[[f64; COEFFICIENTS]; COEFFICIENTS], i: usize, j: usize| {
        (0..j).map(|k| a[i][k] * a[j][k]).sum::<f64>()
    };
    for j in 0..COEFFICIENTS {
        let d = a[j][j] + ridge - before(&a, j, j);
        if d <= 0.0 {
            return [0.0; COEFFICIENTS];
        }
        a[j][j] = d.sqrt();
        for i in j + 1..COEFFICIENTS {
            a[i][j] = (a[i][j] - before(&a, i, j)) / a[j][j];
        }
    }
    for i in 0..COEFFICIENTS {
        let known: f64 = (0..i).map(|k| a[i][k] * b[k]).sum();
        b[i] = (b[i] - known) / a[i][i];
    }
    for i in (0..COEFFICIENTS).rev() {
        let known: f64 = (i + 1..COEFFICIENTS).map(|k| a[k][i] * b[k]).sum();
        b[i] = (b[i] - known) / a[i][i];
    }
    b
}
