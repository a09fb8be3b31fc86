//! The Newton direction.

use ndarray::{Array1, Array2, Axis, s};

use super::{
    cholesky::{Cholesky, add_lower_products_of_columns, lower_products},
    problem::{Plane, Problem, add_scaled, dot},
};

/// Smallest pivot, and smallest relative curvature along the bias that is more than rounding. The
/// line search corrects the errors of both limits.
const LEAST: f64 = 1e-10;
/// Number of rows that are converted to f64 at a time.
const ROWS: usize = 512;

/// The gradient and the curvature of the objective.
#[derive(Debug)]
pub(super) struct Slope<'a> {
    /// Gradient with respect to w.
    pub(super) weights: Array1<f64>,
    /// Gradient with respect to b.
    pub(super) bias: f64,
    /// The samples that contribute curvature, and how much.
    pub(super) curved: &'a [(usize, f64)],
    /// Curvature of one sample. It replaces the curvature along the bias if that is zero.
    pub(super) of_one: f64,
}

/// The Newton direction Δ, which solves H Δ = −g with H = [I + XᵀSX, XᵀS1; 1ᵀSX, ρ + 1ᵀS1].
///
/// X are the samples that contribute curvature, and S their contributions. The smaller of two
/// systems is solved: it has as many rows as features, or as such samples. The latter uses the
/// Woodbury identity with M = S⁻¹ + X Xᵀ.
#[derive(Debug, Default)]
pub(super) struct Newton {
    /// Inner products of all samples, computed when needed. They are in f64, because the
    /// differences of large and nearly parallel samples are smaller than the rounding of f32.
    products: Option<Array2<f64>>,
}

impl Newton {
    pub(super) fn direction(&mut self, problem: &Problem<'_>, slope: &Slope<'_>) -> Plane {
        let features = problem.samples.ncols();
        if slope.curved.len() < features {
            self.by_samples(problem, slope)
        } else {
            Self::by_features(problem, slope)
        }
    }

    fn by_features(problem: &Problem<'_>, slope: &Slope<'_>) -> Plane {
        let features = problem.samples.ncols();
        let mut curvature = Array2::eye(features);
        let mut mixed = Array1::<f64>::zeros(features);
        let mut of_bias = problem.bias_cost();
        for part in slope.curved.chunks(ROWS) {
            let mut rows = rows_of(problem, part);
            for (mut row, (_, weight)) in rows.outer_iter_mut().zip(part) {
                mixed.scaled_add(*weight, &row);
                of_bias += weight;
                row *= weight.sqrt();
            }
            add_lower_products_of_columns(rows.view(), &mut curvature);
        }
        let factor = Cholesky::factor(curvature, LEAST);
        let along = factor.solve(-&slope.weights);
        let per_bias = factor.solve(mixed.clone());
        let curvature = of_bias - mixed.dot(&per_bias);
        let bias = (-slope.bias - mixed.dot(&along)) / curvature.max(LEAST * of_bias);
        Plane { weights: along - bias * per_bias, bias }
    }

    fn by_samples(&mut self, problem: &Problem<'_>, slope: &Slope<'_>) -> Plane {
        let row = |sample: usize| problem.samples.row(sample).to_slice().unwrap_or_default();
        let mut system = self.products_of(problem, slope.curved);
        for (place, (_, weight)) in slope.curved.iter().enumerate() {
            system[[place, place]] += 1.0 / weight;
        }
        let factor = Cholesky::factor(system, f64::MIN_POSITIVE);
        let gradient = slope.weights.as_slice().unwrap_or_default();
        let right = slope.curved.iter().map(|(sample, _)| -dot(row(*sample), gradient));
        let along = factor.solve(right.collect());
        let per_bias = factor.solve(Array1::ones(slope.curved.len()));
        let curvature = per_bias.sum() + problem.bias_cost();
        let curvature = if curvature > 0.0 { curvature } else { slope.of_one };
        let bias = (-slope.bias - along.sum()) / curvature;
        let mut weights = -&slope.weights;
        let target = weights.as_slice_mut().unwrap_or_default();
        for (pull, (sample, _)) in (along + bias * per_bias).iter().zip(slope.curved) {
            add_scaled(target, -pull, row(*sample));
        }
        Plane { weights, bias }
    }

    /// Returns the lower triangle of the inner products of some samples. The products of all
    /// samples are computed once and reused, unless the samples are few, or more numerous than the
    /// features.
    fn products_of(&mut self, problem: &Problem<'_>, curved: &[(usize, f64)]) -> Array2<f64> {
        let (samples, features) = problem.samples.dim();
        if samples > features || (self.products.is_none() && 4 * curved.len() < samples) {
            return lower_products(rows_of(problem, curved).view());
        }
        let all = self
            .products
            .get_or_insert_with(|| lower_products(problem.samples.mapv(f64::from).view()));
        let mut products = Array2::zeros((curved.len(), curved.len()));
        for (place, (sample, _)) in curved.iter().enumerate() {
            // Samples are in order, so the lower triangle of all samples contains the needed
            // elements.
            let from = all.row(*sample);
            let mut row = products.slice_mut(s![place, ..=place]);
            for (product, (other, _)) in row.iter_mut().zip(curved) {
                *product = from[*other];
            }
        }
        products
    }
}

/// Returns the rows of some samples in f64.
fn rows_of(problem: &Problem<'_>, some: &[(usize, f64)]) -> Array2<f64> {
    let mut rows = Array2::zeros((some.len(), problem.samples.ncols()));
    for (mut row, (sample, _)) in rows.outer_iter_mut().zip(some) {
        row.zip_mut_with(&problem.samples.index_axis(Axis(0), *sample), |to, from| {
            *to = f64::from(*from);
        });
    }
    rows
}
