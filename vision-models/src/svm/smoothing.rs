//! The smoothed penalty of one run of Newton's method.

use super::problem::Problem;
use crate::svm::settings::Loss;

/// Factor by which the hinge is steepened from one run to the next.
const STEEPER: f64 = 8.0;
/// Steepest hinge relative to the first. Rounding of a margin then changes α by 1e-10 of its range.
const STEEPEST: f64 = 1e6;

/// A penalty whose slope at the margin m = y f(x) is −α, with α = clip(λ + σ (1 − m), 0, C).
///
/// The squared hinge has λ = 0, σ = 2 C and no upper limit. If the penalty is the hinge, the
/// minimum of each run gives the next λ = α. This is the method of multipliers. α approaches the
/// dual's optimum for any σ, and faster for larger σ.
///
/// R. Rockafellar, "Augmented Lagrangians and applications of the proximal point algorithm in
/// convex programming", Mathematics of Operations Research 1, 1976.
#[derive(Debug)]
pub(super) enum Smoothing {
    /// The hinge, with σ and each λ.
    Hinge { steepness: f64, steepest: f64, centres: Vec<f64> },
    /// The squared hinge, unchanged.
    SquaredHinge,
}

impl Smoothing {
    /// Returns true if a run is near enough to its minimum. `promised` is the expected decrease of
    /// a step. It must be at most a share of the cost of the distance of α from λ (Rockafellar's
    /// criterion B).
    pub(super) fn is_minimised(&self, promised: f64, alphas: &[f64]) -> bool {
        match self {
            Self::SquaredHinge => false,
            Self::Hinge { steepness, centres, .. } => {
                let moved = alphas.iter().zip(centres).map(|(alpha, centre)| alpha - centre);
                let cost = moved.map(|moved| moved * moved).sum::<f64>() / (2.0 * steepness);
                promised <= 0.25 * cost
            }
        }
    }

    /// Changes to the next smoothing, whose minimum is nearer to the problem's. The squared hinge
    /// stays.
    pub(super) fn sharpen(&mut self, alphas: &[f64]) {
        if let Self::Hinge { steepness, steepest, centres } = self {
            centres.copy_from_slice(alphas);
            *steepness = (STEEPER * *steepness).min(*steepest);
        }
    }

    /// Creates the hinge around these α, for samples of this mean square.
    pub(super) fn of_hinge(centres: Vec<f64>, mean_square: f64) -> Self {
        let steepness = 1.0 / mean_square;
        Self::Hinge { steepness, steepest: STEEPEST * steepness, centres }
    }

    /// Returns σ. If it differs between samples, the first sample's is returned.
    pub(super) fn steepness(&self, problem: &Problem<'_>) -> f64 {
        match self {
            Self::Hinge { steepness, .. } => *steepness,
            Self::SquaredHinge => 2.0 * problem.costs[0],
        }
    }

    /// Returns α of a sample at a margin, and how much it falls with the margin.
    pub(super) fn alpha(&self, problem: &Problem<'_>, sample: usize, margin: f64) -> (f64, f64) {
        let cost = problem.costs[sample];
        let (centre, slope) = match self {
            Self::Hinge { steepness, centres, .. } => (centres[sample], *steepness),
            Self::SquaredHinge => (0.0, 2.0 * cost),
        };
        let alpha = centre + slope * (1.0 - margin);
        match problem.loss {
            _ if alpha <= 0.0 => (0.0, 0.0),
            Loss::Hinge if alpha >= cost => (cost, 0.0),
            Loss::Hinge | Loss::SquaredHinge => (alpha, slope),
        }
    }
}
