//! The search along a direction.

use super::{
    problem::{Plane, Problem},
    smoothing::Smoothing,
};

/// Most evaluations: each costs one pass over the samples, not over their features.
const MOST: usize = 40;
/// Where the derivative is this much smaller than at the start, the minimum is reached.
const REACHED: f64 = 1e-6;

/// A line from a plane on.
#[derive(Debug)]
pub(super) struct Line<'a, 'b> {
    pub(super) problem: &'a Problem<'b>,
    pub(super) smoothing: &'a Smoothing,
    pub(super) from: &'a Plane,
    pub(super) direction: &'a Plane,
    /// Decisions at its beginning.
    pub(super) decisions: &'a [f64],
    /// How they change along it.
    pub(super) changes: &'a [f64],
}

impl Line<'_, '_> {
    /// The step to the minimum along the line, where the objective falls at its beginning: the zero of the
    /// derivative, which rises in straight pieces. Newton's steps find the piece, bisection keeps them
    /// between what is known.
    pub(super) fn minimum(&self) -> f64 {
        let (first, _) = self.derivatives(0.0);
        let reached = REACHED * first.abs();
        let (mut low, mut high) = (0.0, f64::INFINITY);
        let mut step = 1.0;
        // Rounding can keep the derivative from becoming so small: the smallest counts.
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

    /// The first and second derivative by the step.
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
