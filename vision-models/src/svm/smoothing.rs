//! What takes the place of the penalty in one run of Newton's method.

use super::problem::Problem;
use crate::svm::settings::Loss;

/// By how much the hinge is steepened from one run to the next.
const STEEPER: f64 = 8.0;
/// The steepest, relative to the first: rounding of a margin then moves α by 1e-10 of what it can move.
const STEEPEST: f64 = 1e6;

/// A penalty whose slope at the margin m = y f(x) is −α, with α = clip(λ + σ (1 − m), 0, C).
///
/// The squared hinge is this with λ = 0, σ = 2 C and no upper limit. For the hinge, each run's minimum gives
/// the next λ = α: the method of multipliers (R. Rockafellar, "Augmented Lagrangians and applications of the
/// proximal point algorithm in convex programming", Mathematics of Operations Research 1, 1976). α comes
/// nearer to the dual's optimum with any σ, and the faster the larger σ is.
#[derive(Debug)]
pub(super) enum Smoothing {
    /// The hinge, with σ and each λ.
    Hinge { steepness: f64, steepest: f64, centres: Vec<f64> },
    /// The squared hinge as it is.
    SquaredHinge,
}

impl Smoothing {
    /// Returns true if a run has come near enough to its minimum, when a step promises no more than `promised`:
    /// a part of what the distance of α from λ costs (Rockafellar's criterion B).
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

    /// Takes the next one, whose minimum is nearer to the problem's, if there is one.
    pub(super) fn sharpen(&mut self, alphas: &[f64]) {
        if let Self::Hinge { steepness, steepest, centres } = self {
            centres.copy_from_slice(alphas);
            *steepness = (STEEPER * *steepness).min(*steepest);
        }
    }

    /// The hinge about these α, for samples of this mean square.
    pub(super) fn of_hinge(centres: Vec<f64>, mean_square: f64) -> Self {
        let steepness = 1.0 / mean_square;
        Self::Hinge { steepness, steepest: STEEPEST * steepness, centres }
    }

    /// σ, of the first sample where they differ.
    pub(super) fn steepness(&self, problem: &Problem<'_>) -> f64 {
        match self {
            Self::Hinge { steepness, .. } => *steepness,
            Self::SquaredHinge => 2.0 * problem.costs[0],
        }
    }

    /// α of a sample at a margin, and by how much it falls with the margin.
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
