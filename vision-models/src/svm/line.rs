//! The line search.

use super::{
    problem::{Plane, Problem},
    smoothing::Smoothing,
};

/// Largest number of evaluations. Each costs one pass over the samples, not over their features.
const MOST: usize = 40;
/// The minimum is reached if the derivative is smaller than this share of the first one.
const REACHED: f64 = 1e-6;

/// A line that starts at a plane.
#[derive(Debug)]
pub(super) struct Line<'a, 'b> {
    pub(super) problem: &'a Problem<'b>,
    pub(super) smoothing: &'a Smoothing,
    pub(super) from: &'a Plane,
    pub(super) direction: &'a Plane,
    /// Decisions at its start.
    pub(super) decisions: &'a [f64],
    /// Change of the decisions along it.
    pub(super) changes: &'a [f64],
}

impl Line<'_, '_> {
    /// Returns the step to the minimum along the line, on which the objective must fall at the
    /// start.
    ///
    /// The minimum is the zero of the derivative, which rises piecewise linearly. Newton's steps
    /// find the piece, and bisection keeps them within the known bounds.
    pub(super) fn minimum(&self) -> f64 {
        let (first, _) = self.derivatives(0.0);
        let reached = REACHED * first.abs();
        let (mut low, mut high) = (0.0, f64::INFINITY);
        let mut step = 1.0;
        // Rounding can keep the derivative above this limit. The smallest one is then used.
        let mut best = (f64::INFINITY, 0.0);
        for _ in 0..MOST {
            let (derivative, curvature) = self.derivatives(step);
            if derivative.abs() < best.0 {
                best = (derivative.abs(), step);
            }
            if derivative.abs() <= reached {
                break;
            }
            if derivative < 0.0 {
                low = step;
            } else {
                high = step;
            }
            let newton = step - derivative / curvature;
            step = if newton > low && newton < high && newton.is_finite() {
                newton
            } else if high.is_finite() {
                0.5 * (low + high)
            } else {
                2.0 * step
            };
        }
        best.1
    }

    /// Returns the first and second derivative by the step.
    fn derivatives(&self, step: f64) -> (f64, f64) {
        let Self { problem, smoothing, from, direction, .. } = self;
        let cost = problem.bias_cost();
        let square =
            direction.weights.dot(&direction.weights) + cost * direction.bias * direction.bias;
        let start = from.weights.dot(&direction.weights) + cost * from.bias * direction.bias;
        let (mut first, mut second) = (start + step * square, square);
        let samples = self.decisions.iter().zip(self.changes).zip(&problem.sides);
        for (sample, ((decision, change), side)) in samples.enumerate() {
            let (alpha, curvature) =
                smoothing.alpha(problem, sample, side * (decision + step * change));
            first -= side * change * alpha;
            second += change * change * curvature;
        }
        (first, second)
    }
}
