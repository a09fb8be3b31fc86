//! The start of the training with the hinge loss.

use ndarray::Array1;
use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};

use super::problem::{Plane, Problem, add_scaled, dot};
use crate::random::shuffle;
use crate::svm::settings::Bias;

/// Number of passes through all samples.
const EPOCHS: usize = 20;

/// A plane with its α, and the mean square of the samples including the bias's feature.
#[derive(Debug)]
pub(super) struct Start {
    pub(super) plane: Plane,
    pub(super) alphas: Vec<f64>,
    pub(super) mean_square: f64,
}

/// Coordinate ascent on the dual problem, one α after the other in random order.
///
/// It quickly finds the samples that are at a limit. A free bias is treated as the weight of a
/// feature as large as the samples. C.-J. Hsieh, K.-W. Chang, C.-J. Lin, S. Keerthi and S.
/// Sundararajan, "A dual coordinate descent method for large-scale linear SVM", ICML 2008,
/// algorithm 1.
pub(super) fn ascend(problem: &Problem<'_>) -> Start {
    let squares: Vec<f64> =
        problem.rows().map(|row| row.iter().map(|&value| f64::from(value).powi(2)).sum()).collect();
    let mean = squares.iter().sum::<f64>() / squares.len().max(1) as f64;
    let feature = match problem.bias {
        Bias::Free if mean > 0.0 => mean,
        Bias::Free => 1.0,
        Bias::Regularised { scaling } => scaling * scaling,
    };
    let mut plane = Plane { weights: Array1::zeros(problem.samples.ncols()), bias: 0.0 };
    let mut alphas = vec![0.0; squares.len()];
    let mut order: Vec<usize> = (0..squares.len()).collect();
    let mut random = ChaCha8Rng::seed_from_u64(0);
    for _ in 0..EPOCHS {
        shuffle(&mut order, &mut random);
        for &sample in &order {
            let row = problem.samples.row(sample);
            let row = row.as_slice().unwrap_or_default();
            let weights = plane.weights.as_slice_mut().unwrap_or_default();
            let side = problem.sides[sample];
            let slope = 1.0 - side * (dot(row, weights) + plane.bias);
            let moved = alphas[sample] + slope / (squares[sample] + feature);
            let moved = moved.clamp(0.0, problem.costs[sample]);
            let step = side * (moved - alphas[sample]);
            if step != 0.0 {
                alphas[sample] = moved;
                add_scaled(weights, step, row);
                plane.bias += step * feature;
            }
        }
    }
    Start { plane, alphas, mean_square: mean + feature }
}
