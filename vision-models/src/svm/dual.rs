//! The dual problem, solved by the steps of sequential minimal optimisation.
//!
//! With β_i = α_i y_i, K = X Xᵀ and r = 1 / (2C) for the squared hinge, 0 for the hinge:
//!
//! maximise Σ y_i β_i − ½ βᵀ (K + r I) β, subject to 0 ≤ y_i β_i ≤ C (no upper bound for the squared
//! hinge) and, if the bias is free, Σ β_i = 0. Then w = Xᵀ β.
//!
//! A bias that is the weight of a feature s adds s² to every element of K and drops the sum.

use ndarray::{Array1, Array2};

use super::{Bias, Loss, SvmSettings};

/// How the training of a plane ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Training {
    /// Whether every sample meets its optimality condition within the tolerance.
    pub converged: bool,
    /// Steps taken.
    pub iterations: usize,
    /// ½ wᵀw + C Σ ξ, or with ξ²; with the bias's cost if it has one.
    pub objective: f64,
    /// The largest value that the dual problem reached: the objective's minimum is not below it.
    pub bound: f64,
}

pub(super) struct Solution {
    /// β: w is the sum of the samples with these weights.
    pub(super) coefficients: Array1<f64>,
    pub(super) bias: f64,
    pub(super) training: Training,
}

/// The state of the search.
struct Dual<'a> {
    products: &'a Array2<f64>,
    /// y: 1 or −1 each.
    sides: &'a [f64],
    /// r above.
    ridge: f64,
    /// The largest |β|.
    ceiling: f64,
    /// β.
    coefficients: Array1<f64>,
    /// The derivative of the dual objective by each β.
    slopes: Array1<f64>,
}

/// Finds the plane of the smallest objective for samples with these inner products, on the side
/// that `sides` says (1 or −1, both present).
pub(super) fn solve(products: &Array2<f64>, sides: &[f64], settings: &SvmSettings) -> Solution {
    let with_bias;
    let (products, scaling) = match settings.bias {
        Bias::Free => (products, None),
        Bias::Regularised { scaling } => {
            with_bias = products + scaling * scaling;
            (&with_bias, Some(scaling))
        }
    };
    let (ridge, ceiling) = match settings.loss {
        Loss::Hinge => (0.0, settings.cost),
        Loss::SquaredHinge => (0.5 / settings.cost, f64::INFINITY),
    };
    let mut dual = Dual {
        products,
        sides,
        ridge,
        ceiling,
        coefficients: Array1::zeros(sides.len()),
        slopes: sides.iter().copied().collect(),
    };
    let mut iterations = 0;
    let mut converged = false;
    while !converged && iterations < settings.max_iterations {
        let moved = match scaling {
            None => dual.exchange(settings.tolerance),
            Some(_) => dual.raise(settings.tolerance),
        };
        converged = !moved;
        iterations += 1;
    }
    dual.finish(settings, scaling, converged, iterations)
}

impl Dual<'_> {
    fn can_rise(&self, index: usize) -> bool {
        let top = if self.sides[index] > 0.0 { self.ceiling } else { 0.0 };
        self.coefficients[index] < top
    }

    fn can_fall(&self, index: usize) -> bool {
        let bottom = if self.sides[index] > 0.0 { 0.0 } else { -self.ceiling };
        self.coefficients[index] > bottom
    }

    /// How far a coefficient can move up, or down.
    fn room(&self, index: usize, up: bool) -> f64 {
        let room = match (up, self.sides[index] > 0.0) {
            (true, true) => self.ceiling - self.coefficients[index],
            (true, false) => -self.coefficients[index],
            (false, true) => self.coefficients[index],
            (false, false) => self.coefficients[index] + self.ceiling,
        };
        room.max(0.0)
    }

    /// Moves one coefficient up and another down by as much, so that the sum stays. The first has
    /// the steepest slope up, the second promises the largest gain (Fan, Chen, Lin 2005, WSS 2).
    /// False at the optimum.
    fn exchange(&mut self, tolerance: f64) -> bool {
        let count = self.sides.len();
        let Some(up) = (0..count)
            .filter(|&index| self.can_rise(index))
            .max_by(|&one, &other| self.slopes[one].total_cmp(&self.slopes[other]))
        else {
            return false;
        };
        let row = self.products.row(up);
        let mut best = None;
        let mut most = 0.0;
        let mut violation: f64 = 0.0;
        for down in (0..count).filter(|&index| self.can_fall(index)) {
            let slope = self.slopes[up] - self.slopes[down];
            violation = violation.max(slope);
            if slope > 0.0 {
                let bend =
                    self.curvature(row[up] + self.products[[down, down]] - 2.0 * row[down], 2.0);
                if slope * slope / bend > most {
                    most = slope * slope / bend;
                    best = Some((down, slope / bend));
                }
            }
        }
        let Some((down, step)) = best.filter(|_| violation > tolerance) else {
            return false;
        };
        let step = step.min(self.room(up, true)).min(self.room(down, false));
        self.shift(up, step);
        self.shift(down, -step);
        true
    }

    /// Moves the coefficient that promises the largest gain. False at the optimum.
    fn raise(&mut self, tolerance: f64) -> bool {
        let mut best = None;
        let mut most = 0.0;
        for index in 0..self.sides.len() {
            let slope = self.slopes[index];
            let free = if slope > 0.0 { self.can_rise(index) } else { self.can_fall(index) };
            let bend = self.curvature(self.products[[index, index]], 1.0);
            if free && slope.abs() > tolerance && slope * slope / bend > most {
                most = slope * slope / bend;
                best = Some((index, slope / bend));
            }
        }
        let Some((index, step)) = best else { return false };
        let room = self.room(index, step > 0.0);
        self.shift(index, step.clamp(-room, room));
        true
    }

    /// The dual objective's curvature along a step that changes `moved` coefficients.
    fn curvature(&self, products: f64, moved: f64) -> f64 {
        (products + moved * self.ridge).max(1e-12)
    }

    fn shift(&mut self, index: usize, step: f64) {
        self.coefficients[index] += step;
        self.slopes.scaled_add(-step, &self.products.row(index));
        self.slopes[index] -= step * self.ridge;
    }

    fn finish(
        mut self,
        settings: &SvmSettings,
        scaling: Option<f64>,
        converged: bool,
        iterations: usize,
    ) -> Solution {
        let products = self.products.dot(&self.coefficients);
        // The slopes again, without what the steps rounded off.
        self.slopes = self.sides.iter().copied().collect::<Array1<f64>>()
            - &products
            - self.ridge * &self.coefficients;
        let bias = scaling.map_or_else(
            || self.free_bias(),
            |scaling| scaling * scaling * self.coefficients.sum(),
        );
        // K has the regularised bias in it.
        let shift = if scaling.is_none() { bias } else { 0.0 };
        let norm = self.coefficients.dot(&products);
        let losses = products.iter().zip(self.sides).map(|(product, side)| {
            let short = (1.0 - side * (product + shift)).max(0.0);
            if settings.loss == Loss::Hinge { short } else { short * short }
        });
        let objective = 0.5 * norm + settings.cost * losses.sum::<f64>();
        let bound = self.coefficients.iter().map(|value| value.abs()).sum::<f64>()
            - 0.5 * norm
            - 0.5 * self.ridge * self.coefficients.dot(&self.coefficients);
        Solution {
            bias,
            training: Training { converged, iterations, objective, bound },
            coefficients: self.coefficients,
        }
    }

    /// The bias is the slope that all coefficients within their bounds share; without any, the
    /// middle of what the others allow.
    fn free_bias(&self) -> f64 {
        let indices = || 0..self.sides.len();
        let inside: Vec<f64> = indices()
            .filter(|&index| self.can_rise(index) && self.can_fall(index))
            .map(|index| self.slopes[index])
            .collect();
        if !inside.is_empty() {
            return inside.iter().sum::<f64>() / inside.len() as f64;
        }
        let rising = indices().filter(|&index| self.can_rise(index)).map(|i| self.slopes[i]);
        let falling = indices().filter(|&index| self.can_fall(index)).map(|i| self.slopes[i]);
        let (low, high) =
            (rising.fold(f64::NEG_INFINITY, f64::max), falling.fold(f64::INFINITY, f64::min));
        match (low.is_finite(), high.is_finite()) {
            (true, true) => 0.5 * (low + high),
            (true, false) => low,
            (false, true) => high,
            (false, false) => 0.0,
        }
    }
}
