//! Fit of a quadratic to scored points.

use super::ErgonomicsQuadratic;
use super::admm::convex_fit;
use super::report::FitReport;
use super::scored_point::ScoredPoint;
use crate::error::{Error, Result, within};
use crate::region::Region;

/// Smallest number of points of a fit: twice the number of coefficients.
const FEWEST: usize = 20;

/// Options of a fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FitOptions {
    /// Region of the points that count, in the person's frame. `None` stands for
    /// [`Region::work_zone`] for a map, and for every point for bare samples.
    pub region: Option<Region>,
    /// T in the weight exp(-(e - min e)/T). The smaller it is, the more good postures count.
    /// Infinity gives equal weights.
    pub temperature: f64,
    /// ε \[1/m²\] in H ⪰ εI, positive.
    pub min_curvature: f64,
}

impl Default for FitOptions {
    fn default() -> Self {
        Self { region: None, temperature: 0.5, min_curvature: 1e-3 }
    }
}

impl FitOptions {
    /// Checks temperature and curvature.
    ///
    /// # Errors
    /// [`Error::Value`] with the name of the option.
    pub fn validate(&self) -> Result<()> {
        if self.temperature != f64::INFINITY {
            within("temperature", self.temperature, [1e-3, 1e9], "(score)")?;
        }
        within("min_curvature", self.min_curvature, [1e-12, 1e6], "1/m²").map(drop)
    }
}

impl ErgonomicsQuadratic {
    /// Fits a convex quadratic to scored points.
    ///
    /// minimise Σ w (e(x) - score)² subject to H ⪰ εI, w = exp(-(score - min)/T).
    ///
    /// # Errors
    /// [`Error::TooFewSamples`] if there are fewer than 20 points. [`Error::DegenerateSamples`] if
    /// they do not determine a quadratic. [`Error::Value`] if a point or an option is invalid.
    pub fn fit(points: &[ScoredPoint], options: &FitOptions) -> Result<(Self, FitReport)> {
        let inside = |point: &&ScoredPoint| {
            options.region.is_none_or(|region| region.contains(&point.position))
        };
        let points: Vec<ScoredPoint> = points.iter().filter(inside).copied().collect();
        let weights = options.weights(&points);
        fit_weighted(&FitInput { points, weights }, options)
    }
}

impl FitOptions {
    /// Returns exp(-(e - min e)/T) of each point.
    pub(crate) fn weights(&self, points: &[ScoredPoint]) -> Vec<f64> {
        let lowest = points.iter().map(|p| p.score).fold(f64::INFINITY, f64::min);
        points.iter().map(|p| (-(p.score - lowest) / self.temperature).exp()).collect()
    }
}

/// Points with their weights, in equal number.
pub(crate) struct FitInput {
    pub(crate) points: Vec<ScoredPoint>,
    pub(crate) weights: Vec<f64>,
}

/// Fits weighted points, and reports on the fit.
pub(crate) fn fit_weighted(
    input: &FitInput,
    options: &FitOptions,
) -> Result<(ErgonomicsQuadratic, FitReport)> {
    options.validate()?;
    let FitInput { points, weights } = input;
    if points.len() < FEWEST {
        let (what, got) = ("the fit of a quadratic", points.len());
        return Err(Error::TooFewSamples { what, got, wanted: FEWEST });
    }
    for point in points {
        let coordinates = point.position.iter();
        coordinates
            .copied()
            .try_for_each(|x| within("position of a sample", x, [-1e3, 1e3], "m").map(drop))?;
        within("score of a sample", point.score, [-1e6, 1e6], "(score)")?;
    }
    let fit = convex_fit(points, weights, options.min_curvature)?;
    let report = FitReport::new(&fit.quadratic, fit.bound_active, points, weights);
    Ok((fit.quadratic, report))
}
