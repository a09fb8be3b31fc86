//! Rows of the problem as a step from x sees them.

use super::double_double::DoubleDouble;
use super::span::{dot, length};
use crate::certificate::tolerances::SUM;

/// lower ≤ a p ≤ upper for a step p.
#[derive(Debug, Clone)]
pub(super) struct Row {
    pub(super) a: Vec<DoubleDouble>,
    /// ‖a‖.
    pub(super) norm: f64,
    pub(super) weight: f64,
    /// The bounds less a x, where there are any.
    pub(super) lower: Option<DoubleDouble>,
    pub(super) upper: Option<DoubleDouble>,
    /// The size of what a x is made of, and of its nearer bound.
    pub(super) size: f64,
}

/// The size of the bound nearer to zero, zero where there is none.
pub(super) fn nearer(lower: f64, upper: f64) -> f64 {
    let nearer = lower.abs().min(upper.abs());
    if nearer.is_finite() { nearer } else { 0.0 }
}

impl Row {
    /// The row a with these bounds, seen from x. Vectors are up to `reach` long.
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

    /// How far a value of a p is above the upper bound, or, negative, below the lower.
    pub(super) fn violation(&self, value: DoubleDouble) -> DoubleDouble {
        match (self.lower, self.upper) {
            (_, Some(upper)) if value > upper => value - upper,
            (Some(lower), _) if value < lower => value - lower,
            _ => DoubleDouble::ZERO,
        }
    }

    /// What of a p is rounding.
    pub(super) fn rounding(&self) -> f64 {
        SUM * self.size
    }

    /// Returns true if a p is within the bounds, but for rounding.
    pub(super) fn holds(&self, value: DoubleDouble) -> bool {
        self.violation(value).abs().rounded() <= self.rounding()
    }

    /// Moves the bounds to where a p violates neither.
    pub(super) fn admit(&mut self, value: DoubleDouble) {
        self.lower = self.lower.map(|lower| if value < lower { value } else { lower });
        self.upper = self.upper.map(|upper| if value > upper { value } else { upper });
    }
}
