//! Rows of approximately unit size, and the signs of numbers computed from them.

use qd::Quad;

/// A number below this part of its terms is zero. Rounding is near 1e-31.
const ZERO: f64 = 1e-24;
/// A number above this part of its terms has a sign. Between the two it is in doubt.
const CLEAR: f64 = 1e-14;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Sign {
    Negative,
    Zero,
    Positive,
}

/// A number, and the sum of the sizes of the terms that it is the difference of.
#[derive(Debug, Clone, Copy)]
pub(super) struct Difference {
    pub(super) value: Quad,
    pub(super) terms: f64,
}

impl Difference {
    /// Returns the sign. None if the number is neither clearly zero nor clearly nonzero.
    pub(super) fn sign(self) -> Option<Sign> {
        let size = self.value.0.abs();
        if size <= ZERO * self.terms {
            Some(Sign::Zero)
        } else if size >= CLEAR * self.terms && size.is_finite() {
            Some(if self.value.0 > 0.0 { Sign::Positive } else { Sign::Negative })
        } else {
            None
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// The equality a x = b.
    Equality,
    /// The inequality a x ≤ b.
    Inequality,
}

/// A row a whose largest entry is between 1 and 2, and a number b. The given row is `weight` times
/// as large.
#[derive(Debug, Clone)]
pub(super) struct Row {
    pub(super) a: Vec<f64>,
    pub(super) b: f64,
    pub(super) weight: f64,
    pub(super) kind: Kind,
}

impl Row {
    /// Creates the row and its bound, multiplied by `sign`. None if the division by the weight
    /// rounds.
    pub(super) fn new(row: &[f64], bound: f64, sign: f64, kind: Kind) -> Option<Self> {
        let largest = row.iter().fold(0.0_f64, |largest, a| largest.max(a.abs()));
        // Division by a power of two is exact.
        let weight = if largest > 0.0 { largest.log2().floor().exp2() } else { 1.0 };
        let is_exact = |value: f64| value / weight * weight == value;
        (is_exact(bound) && row.iter().all(|&a| is_exact(a))).then(|| Self {
            a: row.iter().map(|a| sign * a / weight).collect(),
            b: sign * bound / weight,
            weight,
            kind,
        })
    }

    /// Returns a x − b.
    pub(super) fn gap(&self, x: &[Quad]) -> Difference {
        let mut gap = Difference { value: Quad::from(-self.b), terms: self.b.abs() };
        for (&a, x) in self.a.iter().zip(x).filter(|(a, _)| **a != 0.0) {
            gap.value += Quad::from(a) * x;
            gap.terms += (a * x.0).abs();
        }
        gap
    }
}
