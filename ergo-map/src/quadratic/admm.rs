//! The convex fit: weighted least squares over the quadratics with H ⪰ εI.

use nalgebra::{Cholesky, Matrix3, SMatrix, SVector, SymmetricEigen, Vector3};

use super::ErgonomicsQuadratic;
use super::scored_point::ScoredPoint;
use crate::error::{Error, Result};

/// Number of coefficients of a quadratic in three variables.
const N: usize = 10;
/// Largest number of iterations. Some hundred are sufficient.
const ITERATIONS: usize = 20_000;
/// Change of the Hessian at which the iteration ends, relative to its largest entry.
const CONVERGED: f64 = 1e-12;

type Coefficients = SVector<f64, N>;

/// The fit, and whether the bound on the Hessian is active.
pub(super) struct ConvexFit {
    pub(super) quadratic: ErgonomicsQuadratic,
    pub(super) bound_active: bool,
}

/// minimise Σ w (½ xᵀHx + gᵀx + c - e)² subject to H ⪰ εI.
///
/// The points, scores e and weights w are given. In the coordinates y = (x - μ)/σ the bound is
/// `H_y` ⪰ ε σσᵀ (diagonal). The problem is a linear system if the bound is inactive. If its
/// solution violates the bound, ADMM splits the problem into the linear system for the coefficients
/// and an eigenvalue clip for the Hessian.
pub(super) fn convex_fit(
    points: &[ScoredPoint],
    weights: &[f64],
    min_curvature: f64,
) -> Result<ConvexFit> {
    let scaling = Scaling::of(points, weights)?;
    let (normal, right) = normal_equations(points, weights, &scaling);
    let plain = Cholesky::new(normal).ok_or(Error::DegenerateSamples)?.solve(&right);
    let smallest = normal.symmetric_eigenvalues().min();
    if smallest.is_nan() || smallest < 1e-9 {
        return Err(Error::DegenerateSamples);
    }
    let floor =
        Matrix3::from_diagonal(&scaling.sigma.component_mul(&scaling.sigma)) * min_curvature;
    let clip = |h: Matrix3<f64>| above(h - floor, 0.0) + floor;
    let unbound = hessian(&plain);
    let bound_active = (unbound - floor).symmetric_eigenvalues().min() < 0.0;
    let coefficients = if bound_active { split(&normal, &right, &plain, clip)? } else { plain };
    Ok(ConvexFit { quadratic: scaling.undo(&coefficients, min_curvature), bound_active })
}

/// Runs the alternating direction method of multipliers on the Hessian's copy Z.
fn split(
    normal: &SMatrix<f64, N, N>,
    right: &Coefficients,
    start: &Coefficients,
    clip: impl Fn(Matrix3<f64>) -> Matrix3<f64>,
) -> Result<Coefficients> {
    // Off-diagonal entries represent two entries of H.
    let metric =
        Coefficients::from_column_slice(&[1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 0.0, 0.0, 0.0, 0.0]);
    let penalty = (0..6).map(|i| normal[(i, i)]).sum::<f64>() / 6.0;
    let weight = metric * penalty;
    let factor =
        Cholesky::new(normal + SMatrix::from_diagonal(&weight)).ok_or(Error::DegenerateSamples)?;
    let mut z = clip(hessian(start));
    let mut dual = Matrix3::zeros();
    for _ in 0..ITERATIONS {
        let pulled = right + weight.component_mul(&coefficients_of(&(z - dual)));
        let h = hessian(&factor.solve(&pulled));
        let next = clip(h + dual);
        dual += h - next;
        let change = (next - z).amax().max((h - next).amax());
        z = next;
        if change < CONVERGED * z.amax().max(1e-6) {
            break;
        }
    }
    // The Hessian is Z, which satisfies the bound exactly. Slope and constant are the best ones for
    // it.
    let mut solution = coefficients_of(&z);
    let rest = right - normal * solution;
    let corner = normal.fixed_view::<4, 4>(6, 6).into_owned();
    let linear = Cholesky::new(corner)
        .ok_or(Error::DegenerateSamples)?
        .solve(&rest.fixed_rows::<4>(6).into_owned());
    solution.fixed_rows_mut::<4>(6).copy_from(&linear);
    Ok(solution)
}

/// Mean and spread of the points.
struct Scaling {
    mean: Vector3<f64>,
    sigma: Vector3<f64>,
}

impl Scaling {
    fn of(points: &[ScoredPoint], weights: &[f64]) -> Result<Self> {
        let total: f64 = weights.iter().sum();
        let pairs = || points.iter().zip(weights);
        let mean = pairs().map(|(p, w)| p.position * *w).sum::<Vector3<f64>>() / total;
        let variance =
            pairs().map(|(p, w)| (p.position - mean).map(|d| d * d) * *w).sum::<Vector3<f64>>()
                / total;
        let sigma = variance.map(f64::sqrt);
        if sigma.iter().any(|s| s.is_nan() || *s < 1e-9) {
            return Err(Error::DegenerateSamples);
        }
        Ok(Self { mean, sigma })
    }

    fn basis(&self, x: &Vector3<f64>) -> Coefficients {
        let y = (x - self.mean).component_div(&self.sigma);
        Coefficients::from_column_slice(&[
            0.5 * y.x * y.x,
            0.5 * y.y * y.y,
            0.5 * y.z * y.z,
            y.x * y.y,
            y.x * y.z,
            y.y * y.z,
            y.x,
            y.y,
            y.z,
            1.0,
        ])
    }

    /// Converts back to metres, and keeps the bound in spite of rounding.
    fn undo(&self, coefficients: &Coefficients, min_curvature: f64) -> ErgonomicsQuadratic {
        let inverse = Matrix3::from_diagonal(&self.sigma.map(f64::recip));
        let scaled = symmetric(inverse * hessian(coefficients) * inverse);
        let margin = 1e-12 * scaled.amax();
        let hessian = if scaled.symmetric_eigenvalues().min() < min_curvature + margin {
            above(scaled, min_curvature + 2.0 * margin)
        } else {
            scaled
        };
        let slope = inverse * coefficients.fixed_rows::<3>(6);
        let gradient = slope - hessian * self.mean;
        let constant =
            coefficients[9] - slope.dot(&self.mean) + 0.5 * self.mean.dot(&(hessian * self.mean));
        ErgonomicsQuadratic { hessian, gradient, constant }
    }
}

fn normal_equations(
    points: &[ScoredPoint],
    weights: &[f64],
    scaling: &Scaling,
) -> (SMatrix<f64, N, N>, Coefficients) {
    let (mut normal, mut right) = (SMatrix::zeros(), Coefficients::zeros());
    let total: f64 = weights.iter().sum();
    for (point, weight) in points.iter().zip(weights) {
        let basis = scaling.basis(&point.position);
        let share = weight / total;
        normal += basis * basis.transpose() * share;
        right += basis * (share * point.score);
    }
    (normal, right)
}

/// Returns the Hessian of the first six coefficients.
fn hessian(c: &Coefficients) -> Matrix3<f64> {
    Matrix3::new(c[0], c[3], c[4], c[3], c[1], c[5], c[4], c[5], c[2])
}

/// Computes the inverse of [`hessian`], with zero slope and constant.
fn coefficients_of(h: &Matrix3<f64>) -> Coefficients {
    let mut c = Coefficients::zeros();
    for (i, value) in [h.m11, h.m22, h.m33, h.m12, h.m13, h.m23].into_iter().enumerate() {
        c[i] = value;
    }
    c
}

/// Returns the nearest symmetric matrix (Frobenius) without eigenvalues below `floor`.
fn above(matrix: Matrix3<f64>, floor: f64) -> Matrix3<f64> {
    let mut eigen = SymmetricEigen::new(symmetric(matrix));
    eigen.eigenvalues.apply(|value| *value = value.max(floor));
    symmetric(eigen.recompose())
}

/// Returns the matrix without asymmetry from rounding.
fn symmetric(matrix: Matrix3<f64>) -> Matrix3<f64> {
    (matrix + matrix.transpose()) * 0.5
}
