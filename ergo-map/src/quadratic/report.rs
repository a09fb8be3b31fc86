//! Quality of a fit.

use nalgebra::Vector3;

use super::ErgonomicsQuadratic;
use super::scored_point::ScoredPoint;
use crate::region::Region;

/// Difference between the quadratic's choice and the map's best, in units of the score.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Regret {
    /// The map's score at the quadratic's optimum within the region, minus the map's minimum there.
    pub at_optimum: f64,
    /// Mean of the same difference within random boxes (shared workspaces).
    pub boxes_mean: f64,
    /// 95th percentile of the difference within random boxes.
    pub boxes_p95: f64,
    /// Maximum of the difference within random boxes.
    pub boxes_max: f64,
    /// Number of random boxes.
    pub boxes: usize,
}

/// Quality of a quadratic as an approximation of the score.
#[derive(Debug, Clone, PartialEq)]
pub struct FitReport {
    /// Number of points in the fit.
    pub samples: usize,
    /// Smallest box around the points of the fit \[m\].
    pub domain: Region,
    /// Coefficient of determination with equal weights.
    pub r_squared: f64,
    /// Coefficient of determination with the fit's weights.
    pub weighted_r_squared: f64,
    /// Root mean square error with equal weights.
    pub rmse: f64,
    /// Largest error.
    pub max_error: f64,
    /// Spearman's rank correlation between quadratic and score.
    pub spearman: f64,
    /// Eigenvalues of H, ascending \[1/m²\].
    pub eigenvalues: Vector3<f64>,
    /// True if the bound H ⪰ εI changed the fit.
    pub bound_active: bool,
    /// The quadratic's minimiser within the domain \[m\].
    pub optimum: Vector3<f64>,
    /// Cost of following the quadratic instead of the map. `None` for bare samples.
    pub regret: Option<Regret>,
}

impl FitReport {
    pub(super) fn new(
        quadratic: &ErgonomicsQuadratic,
        bound_active: bool,
        points: &[ScoredPoint],
        weights: &[f64],
    ) -> Self {
        let fitted: Vec<f64> = points.iter().map(|p| quadratic.value(&p.position)).collect();
        let scores: Vec<f64> = points.iter().map(|p| p.score).collect();
        let equal = vec![1.0; points.len()];
        let (r_squared, rmse) = determination(&scores, &fitted, &equal);
        let (weighted_r_squared, _) = determination(&scores, &fitted, weights);
        let errors = scores.iter().zip(&fitted).map(|(s, f)| (s - f).abs());
        let mut eigenvalues: [f64; 3] = quadratic.hessian().symmetric_eigenvalues().into();
        eigenvalues.sort_by(f64::total_cmp);
        let domain = Region::around(points.iter().map(|p| p.position));
        Self {
            samples: points.len(),
            domain,
            r_squared,
            weighted_r_squared,
            rmse,
            max_error: errors.fold(0.0, f64::max),
            spearman: correlation(&ranks(&scores), &ranks(&fitted)),
            eigenvalues: eigenvalues.into(),
            bound_active,
            optimum: quadratic.minimiser_in(&domain),
            regret: None,
        }
    }
}

/// Returns weighted R² and root mean square error.
fn determination(scores: &[f64], fitted: &[f64], weights: &[f64]) -> (f64, f64) {
    let total: f64 = weights.iter().sum();
    let mean = scores.iter().zip(weights).map(|(s, w)| s * w).sum::<f64>() / total;
    let spread = |other: &dyn Fn(usize) -> f64| -> f64 {
        let terms = scores.iter().zip(weights).enumerate();
        terms.map(|(i, (s, w))| w * (s - other(i)).powi(2)).sum::<f64>() / total
    };
    let variance = spread(&|_| mean);
    let error = spread(&|i| fitted.get(i).copied().unwrap_or(f64::NAN));
    // Constant scores have no variance to explain.
    let r_squared =
        if variance > 0.0 { 1.0 - error / variance } else { f64::from(u8::from(error <= 0.0)) };
    (r_squared, error.sqrt())
}

/// Returns ranks from 0. Equal values share their mean rank.
pub(crate) fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<(usize, f64)> = values.iter().copied().enumerate().collect();
    order.sort_by(|a, b| a.1.total_cmp(&b.1));
    let mut ranks = vec![0.0; values.len()];
    let mut start = 0;
    for group in order.chunk_by(|a, b| a.1 <= b.1 && b.1 <= a.1) {
        let shared = start as f64 + (group.len() - 1) as f64 / 2.0;
        for (index, _) in group {
            if let Some(rank) = ranks.get_mut(*index) {
                *rank = shared;
            }
        }
        start += group.len();
    }
    ranks
}

/// Returns Pearson's correlation, 0 if one side is constant.
pub(crate) fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let n = a.len() as f64;
    let (mean_a, mean_b) = (a.iter().sum::<f64>() / n, b.iter().sum::<f64>() / n);
    let (mut ab, mut aa, mut bb) = (0.0, 0.0, 0.0);
    for (x, y) in a.iter().zip(b) {
        let (x, y) = (x - mean_a, y - mean_b);
        ab += x * y;
        aa += x * x;
        bb += y * y;
    }
    if aa > 0.0 && bb > 0.0 { ab / (aa * bb).sqrt() } else { 0.0 }
}
