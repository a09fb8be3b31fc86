//! Rows of the problem relative to a step from x.

use super::double_double::DoubleDouble;
use super::span::{dot, length};
use crate::certificate::tolerances::SUM;

/// A row lower ≤ a p ≤ upper for a step p.
#[derive(Debug, Clone)]
pub(super) struct Row {
    pub(super) a: Vec<DoubleDouble>,
    /// ‖a‖.
    pub(super) norm: f64,
    pub(super) weight: f64,
    /// Bounds minus a x. None if the side is unbounded.
    pub(super) lower: Option<DoubleDouble>,
    pub(super) upper: Option<DoubleDouble>,
    /// Sum of the sizes of the terms of a x and of the nearer bound.
    pub(super) size: f64,
}

/// Returns the size of the bound nearer to zero. Zero if there is none.
pub(super) fn nearer(lower: f64, upper: f64) -> f64 {
    let nearer = lower.abs().min(upper.abs());
    if nearer.is_finite() { nearer } else { 0.0 }
}

impl Row {
    /// Creates the row a with these bounds, relative to x. Vectors are at most `reach` long.
    pub(super) fn new(
        a: Vec<DoubleDouble>,
        [lower, upper]: [DoubleDouble; 2],
        weight: f64,
        (x, reach): (&[DoubleDouble], f64),
    ) -> Self {
        let value = dot(&a, x);
        let gap = |bound: DoubleDouble| bound.rounded().is_finite().then(|| bound - value);
        let norm = length(&a);
        let size = norm * reach + nearer(lower.rounded(), upper.rounded());
        Self { norm, weight, lower: gap(lower), upper: gap(upper), size, a }
    }

    pub(super) fn is_equality(&self) -> bool {
        self.lower.is_some() && self.lower == self.upper
    }

    /// Returns the violation of a value of a p: positive above the upper bound, negative below the
    /// lower bound.
    pub(super) fn violation(&self, value: DoubleDouble) -> DoubleDouble {
        match (self.lower, self.upper) {
            (_, Some(upper)) if value > upper => value - upper,
            (Some(lower), _) if value < lower => value - lower,
            _ => DoubleDouble::ZERO,
        }
    }

    /// Returns the rounding in a p.
    pub(super) fn rounding(&self) -> f64 {
        SUM * self.size
    }

    /// Returns true if a p is within the bounds, up to rounding.
    pub(super) fn holds(&self, value: DoubleDouble) -> bool {
        self.violation(value).abs().rounded() <= self.rounding()
    }

    /// Widens the bounds so that a p violates neither.
    pub(super) fn admit(&mut self, value: DoubleDouble) {
        self.lower = self.lower.map(|lower| if value < lower { value } else { lower });
        self.upper = self.upper.map(|upper| if value > upper { value } else { upper });
    }
}
