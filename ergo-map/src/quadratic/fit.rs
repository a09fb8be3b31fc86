//! From scored points to a quadratic.

use nalgebra::Vector3;

use super::ErgonomicsQuadratic;
use super::admm::convex_fit;
use super::report::FitReport;
use super::scored_point::ScoredPoint;
use crate::error::{Error, Result, within};
use crate::region::Region;

/// Fewest points for a fit: twice the number of coefficients.
const FEWEST: usize = 20;
/// Scores that differ by less are the same.
const SAME: f64 = 0.01;

/// Where the minimum of a fitted quadratic lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Optimum {
    /// Where all points together are fitted best. A score that rises faster on one side than on the
    /// other pulls it away from the lowest scores.
    #[default]
    Fitted,
    /// Where the score is lowest, and the shape around it is fitted: what follows the quadratic to its end
    /// is there. It is the middle of the points with the lowest scores, weighed by exp(-(e - min e)/0.01):
    /// scores that differ by less count as the same.
    LowestScore,
}

/// How a quadratic is fitted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FitOptions {
    /// The points that count, in the person's frame; `None` is [`Region::work_zone`] for a map and
    /// every point for bare samples.
    pub region: Option<Region>,
    /// T in the weight exp(-(e - min e)/T): the smaller, the more good postures count. Infinity
    /// weighs all alike.
    pub temperature: f64,
    /// ε \[1/m²\] in H ⪰ εI, positive.
    pub min_curvature: f64,
    /// Where its minimum lies.
    pub optimum: Optimum,
}

impl Default for FitOptions {
    fn default() -> Self {
        Self { region: None, temperature: 0.5, min_curvature: 1e-3, optimum: Optimum::Fitted }
    }
}

impl FitOptions {
    /// Checks temperature and curvature.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with the name of the option.
    pub fn validate(&self) -> Result<()> {
        if self.temperature != f64::INFINITY {
            within("temperature", self.temperature, [1e-3, 1e9], "(score)")?;
        }
        within("min_curvature", self.min_curvature, [1e-12, 1e6], "1/m²").map(drop)
    }
}

impl ErgonomicsQuadratic {
    /// The convex quadratic that fits scored points best:
    /// minimise Σ w (e(x) - score)² subject to H ⪰ εI, w = exp(-(score - min)/T), and to the minimum
    /// that the options ask for.
    ///
    /// # Errors
    /// [`Error::TooFewSamples`] below 20 points, [`Error::DegenerateSamples`] where they do not
    /// determine a quadratic, [`Error::NotFinite`] or [`Error::OutOfRange`] for a point or an
    /// option.
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
    /// exp(-(e - min e)/T) of each point.
    pub(crate) fn weights(&self, points: &[ScoredPoint]) -> Vec<f64> {
        weights(points, self.temperature)
    }
}

fn weights(points: &[ScoredPoint], temperature: f64) -> Vec<f64> {
    let lowest = points.iter().map(|p| p.score).fold(f64::INFINITY, f64::min);
    points.iter().map(|p| (-(p.score - lowest) / temperature).exp()).collect()
}

impl Optimum {
    /// The point that is to be the minimum, if there is one.
    fn anchor(self, points: &[ScoredPoint]) -> Option<Vector3<f64>> {
        match self {
            Self::Fitted => None,
            Self::LowestScore => {
                let weights = weights(points, SAME);
                let total: f64 = weights.iter().sum();
                let sum =
                    points.iter().zip(&weights).map(|(point, weight)| point.position * *weight);
                Some(sum.sum::<Vector3<f64>>() / total)
            }
        }
    }
}

/// Points with their weights, as many of one as of the other.
pub(crate) struct FitInput {
    pub(crate) points: Vec<ScoredPoint>,
    pub(crate) weights: Vec<f64>,
}

/// The fit of weighted points, with its report.
pub(crate) fn fit_weighted(
    input: &FitInput,
    options: &FitOptions,
) -> Result<(ErgonomicsQuadratic, FitReport)> {
    options.validate()?;
    let FitInput { points, weights } = input;
    if points.len() < FEWEST {
        let (what, needed, found) = ("the fit of a quadratic", FEWEST, points.len());
        return Err(Error::TooFewSamples { what, needed, found });
    }
    for point in points {
        let coordinates = point.position.iter();
        coordinates
            .copied()
            .try_for_each(|x| within("position of a sample", x, [-1e3, 1e3], "m").map(drop))?;
        within("score of a sample", point.score, [-1e6, 1e6], "(score)")?;
    }
    let anchor = options.optimum.anchor(points);
    let fit = convex_fit(points, weights, options.min_curvature, anchor)?;
    let report = FitReport::new(&fit.quadratic, fit.bound_active, points, weights);
    Ok((fit.quadratic, report))
}
