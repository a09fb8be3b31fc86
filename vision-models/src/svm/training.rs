//! The training of one plane.

use ndarray::Array1;

use super::ascent::{Start, ascend};
use super::line::Line;
use super::newton::{Newton, Slope};
use super::problem::{Forces, Plane, Problem};
use super::smoothing::Smoothing;
use crate::svm::settings::Loss;

/// A step whose expected relative decrease is below this is rounding.
const ROUNDING: f64 = 1e-15;
/// Largest number of consecutive steps that do not reduce the gap. Rounding then prevents further
/// progress.
const PATIENCE: usize = 100;

/// Ending of the training of a plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Training {
    /// True if the duality gap is within the tolerance.
    pub converged: bool,
    /// Number of Newton steps.
    pub iterations: usize,
    /// ½ wᵀw + Σ C_i ξ_i, or with ξ_i², plus the cost of the bias.
    pub objective: f64,
    /// The largest value of the dual problem that was reached. No plane's objective is below it.
    pub bound: f64,
}

impl Training {
    /// Returns the relative duality gap, an upper bound of how far this plane's objective is above
    /// the best one's.
    pub fn gap(&self) -> f64 {
        (self.objective - self.bound).max(0.0) / self.objective
    }
}

/// The state of the training.
struct Search<'a, 'b> {
    problem: &'a Problem<'b>,
    smoothing: Smoothing,
    plane: Plane,
    /// f of each sample.
    decisions: Vec<f64>,
    alphas: Vec<f64>,
    /// The samples that contribute curvature, and how much.
    curved: Vec<(usize, f64)>,
}

/// Minimises the objective to a relative duality gap of `tolerance`, in a limited number of steps.
///
/// Newton's method on w and b with an exact line search. It ends after finitely many steps, because
/// the objective is piecewise quadratic (O. Mangasarian, "A finite Newton method for
/// classification", Optimization Methods and Software 17, 2002). The hinge is replaced by a
/// sequence of [`Smoothing`]s. Each plane on the way gives an α, and so a bound.
pub(super) fn train(
    problem: &Problem<'_>,
    newton: &mut Newton,
    tolerance: f64,
    most: usize,
) -> (Plane, Training) {
    let mut search = Search::new(problem);
    let mut best = search.plane.clone();
    let mut training =
        Training { converged: false, iterations: 0, objective: f64::INFINITY, bound: 0.0 };
    let mut last_progress = 0;
    loop {
        search.update_alphas();
        let Forces { combination, sum, bound } = problem.forces(&search.alphas);
        let objective = problem.objective(&search.plane, &search.decisions);
        if objective < training.objective || bound > training.bound {
            last_progress = training.iterations;
        }
        if objective < training.objective {
            training.objective = objective;
            best.clone_from(&search.plane);
        }
        training.bound = training.bound.max(bound);
        training.converged = training.gap() <= tolerance;
        let stuck = training.iterations > last_progress + PATIENCE;
        if training.converged || stuck || training.iterations >= most {
            return (best, training);
        }
        training.iterations += 1;
        let slope = Slope {
            weights: &search.plane.weights - &combination,
            bias: problem.bias_cost() * search.plane.bias - sum,
            curved: &search.curved,
            of_one: search.smoothing.steepness(problem),
        };
        let direction = newton.direction(problem, &slope);
        let promised = -(slope.weights.dot(&direction.weights) + slope.bias * direction.bias);
        let rounded = promised.is_nan() || promised <= ROUNDING * objective;
        let minimised = rounded || search.smoothing.is_minimised(promised, &search.alphas);
        // If this step is the run's last, it comes nearest to its minimum.
        search.step(&direction);
        if minimised {
            search.update_alphas();
            search.smoothing.sharpen(&search.alphas);
        }
    }
}

impl<'a, 'b> Search<'a, 'b> {
    fn new(problem: &'a Problem<'b>) -> Self {
        let samples = problem.sides.len();
        let (plane, smoothing) = match problem.loss {
            Loss::Hinge => {
                let Start { plane, alphas, mean_square } = ascend(problem);
                (plane, Smoothing::of_hinge(alphas, mean_square))
            }
            Loss::SquaredHinge => {
                let weights = Array1::zeros(problem.samples.ncols());
                (Plane { weights, bias: 0.0 }, Smoothing::SquaredHinge)
            }
        };
        let decisions = problem.decisions(&plane);
        Self { problem, smoothing, plane, decisions, alphas: vec![0.0; samples], curved: vec![] }
    }

    /// Computes α and the curvature at the plane.
    fn update_alphas(&mut self) {
        self.curved.clear();
        let margins = self.decisions.iter().zip(&self.problem.sides).map(|(f, side)| side * f);
        for (sample, (alpha, margin)) in self.alphas.iter_mut().zip(margins).enumerate() {
            let (value, curvature) = self.smoothing.alpha(self.problem, sample, margin);
            *alpha = value;
            if curvature > 0.0 {
                self.curved.push((sample, curvature));
            }
        }
    }

    /// Moves to the minimum along a direction.
    fn step(&mut self, direction: &Plane) {
        let changes = self.problem.decisions(direction);
        let line = Line {
            problem: self.problem,
            smoothing: &self.smoothing,
            from: &self.plane,
            direction,
            decisions: &self.decisions,
            changes: &changes,
        };
        let step = line.minimum();
        self.plane.weights.scaled_add(step, &direction.weights);
        self.plane.bias += step * direction.bias;
        self.decisions = self.problem.decisions(&self.plane);
    }
}
