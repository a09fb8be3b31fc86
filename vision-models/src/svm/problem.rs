//! The problem of one plane, and its dual.
//!
//! The problem is to minimise
//!
//! ½ wᵀw + ½ ρ b² + Σ C_i ξ_i^p, where
//!
//! - ξ_i = max(0, 1 − y_i (wᵀx_i + b)), and p = 1 or 2.
//! - ρ is 0 for a free bias.
//! - ρ is 1 / s² for a bias that is the weight of a feature s.
//!
//! The dual problem is to maximise
//!
//! Σ α_i − ½ |u|² − ½ v² / ρ − Σ α_i² / (4 C_i), where
//!
//! - The last sum exists for p = 2 only.
//! - u = Σ y_i α_i x_i and v = Σ y_i α_i.
//! - α ≥ 0, and α_i ≤ C_i for p = 1.
//! - v = 0 if ρ = 0.
//!
//! At the optimum w = u.

use ndarray::{Array1, ArrayView2};

use crate::svm::settings::{Bias, Loss};

/// The objective for one plane.
#[derive(Debug)]
pub(super) struct Problem<'a> {
    /// Samples × features, each row contiguous.
    pub(super) samples: ArrayView2<'a, f32>,
    /// y, which is 1 or −1.
    pub(super) sides: Vec<f64>,
    /// C of each sample.
    pub(super) costs: Vec<f64>,
    pub(super) loss: Loss,
    pub(super) bias: Bias,
}

/// A plane: w and b.
#[derive(Clone, Debug)]
pub(super) struct Plane {
    pub(super) weights: Array1<f64>,
    pub(super) bias: f64,
}

/// The sums over α, and the bound that it gives.
#[derive(Debug)]
pub(super) struct Forces {
    /// u = Σ y_i α_i x_i.
    pub(super) combination: Array1<f64>,
    /// v = Σ y_i α_i.
    pub(super) sum: f64,
    /// The dual objective of an admissible α made from this one. No plane's objective is below it.
    pub(super) bound: f64,
}

impl Problem<'_> {
    /// Returns ρ.
    pub(super) fn bias_cost(&self) -> f64 {
        match self.bias {
            Bias::Free => 0.0,
            Bias::Regularised { scaling } => 1.0 / (scaling * scaling),
        }
    }

    /// Returns wᵀx + b of each sample.
    pub(super) fn decisions(&self, plane: &Plane) -> Vec<f64> {
        let weights = plane.weights.as_slice().unwrap_or_default();
        self.rows().map(|row| dot(row, weights) + plane.bias).collect()
    }

    /// Returns the objective of a plane with these decisions.
    pub(super) fn objective(&self, plane: &Plane, decisions: &[f64]) -> f64 {
        let losses = decisions.iter().zip(&self.sides).zip(&self.costs);
        let losses = losses.map(|((decision, side), cost)| {
            let short = (1.0 - side * decision).max(0.0);
            cost * if self.loss == Loss::Hinge { short } else { short * short }
        });
        0.5 * plane.weights.dot(&plane.weights)
            + 0.5 * self.bias_cost() * plane.bias * plane.bias
            + losses.sum::<f64>()
    }

    /// Returns u, v and the bound of an α that is not negative and within its upper limits.
    pub(super) fn forces(&self, alphas: &[f64]) -> Forces {
        // Sums the two sides separately, so that one can be scaled down to the other's sum.
        let mut positive = Side::new(self.samples.ncols());
        let mut negative = Side::new(self.samples.ncols());
        for (((row, &side), &cost), &alpha) in
            self.rows().zip(&self.sides).zip(&self.costs).zip(alphas)
        {
            if alpha > 0.0 {
                let own = if side > 0.0 { &mut positive } else { &mut negative };
                own.add(row, alpha, cost);
            }
        }
        let combination = &positive.combination - &negative.combination;
        let sum = positive.sum - negative.sum;
        let (up, down) = match self.bias {
            Bias::Free if positive.sum > negative.sum => (negative.sum / positive.sum, 1.0),
            Bias::Free if negative.sum > positive.sum => (1.0, positive.sum / negative.sum),
            Bias::Free | Bias::Regularised { .. } => (1.0, 1.0),
        };
        let admissible = up * &positive.combination - down * &negative.combination;
        let of_bias = match self.bias {
            Bias::Free => 0.0,
            Bias::Regularised { scaling } => 0.5 * (scaling * sum).powi(2),
        };
        let squares = match self.loss {
            Loss::Hinge => 0.0,
            Loss::SquaredHinge => up * up * positive.squares + down * down * negative.squares,
        };
        let bound = up * positive.sum + down * negative.sum
            - 0.5 * admissible.dot(&admissible)
            - of_bias
            - squares;
        Forces { combination, sum, bound }
    }

    /// Returns the samples' features.
    pub(super) fn rows(&self) -> impl Iterator<Item = &[f32]> {
        self.samples.rows().into_iter().map(|row| row.to_slice().unwrap_or_default())
    }
}

/// The sums over the samples of one side.
struct Side {
    combination: Array1<f64>,
    sum: f64,
    /// Σ α² / (4 C).
    squares: f64,
}

impl Side {
    fn new(features: usize) -> Self {
        Self { combination: Array1::zeros(features), sum: 0.0, squares: 0.0 }
    }

    fn add(&mut self, row: &[f32], alpha: f64, cost: f64) {
        add_scaled(self.combination.as_slice_mut().unwrap_or_default(), alpha, row);
        self.sum += alpha;
        self.squares += alpha * alpha / (4.0 * cost);
    }
}

/// Returns the inner product, in several sums that the processor can compute in parallel.
pub(super) fn dot(row: &[f32], weights: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let (rows, weights) = (row.chunks_exact(8), weights.chunks_exact(8));
    let rest = rows.remainder().iter().zip(weights.remainder());
    let rest: f64 = rest.map(|(&value, weight)| f64::from(value) * weight).sum();
    for (row, weights) in rows.zip(weights) {
        for ((sum, &value), weight) in sums.iter_mut().zip(row).zip(weights) {
            *sum += f64::from(value) * weight;
        }
    }
    sums.iter().sum::<f64>() + rest
}

/// Adds a multiple of a row.
pub(super) fn add_scaled(target: &mut [f64], factor: f64, row: &[f32]) {
    for (target, &value) in target.iter_mut().zip(row) {
        *target += factor * f64::from(value);
    }
}
