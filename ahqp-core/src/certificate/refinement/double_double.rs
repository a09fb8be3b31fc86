//! Numbers of about 32 digits: the unevaluated sum of two doubles (Dekker, Numerische Mathematik
//! 18, 1971; Hida, Li and Bailey, ARITH-15, 2001).

use std::cmp::Ordering;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// A number as the sum of a double and a remainder too small for that double.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct DoubleDouble {
    high: f64,
    low: f64,
}

impl DoubleDouble {
    pub(super) const ZERO: Self = Self { high: 0.0, low: 0.0 };
    pub(super) const ONE: Self = Self { high: 1.0, low: 0.0 };

    /// Returns the nearest double.
    pub(super) fn rounded(self) -> f64 {
        self.high
    }

    pub(super) fn abs(self) -> Self {
        if self.high < 0.0 { -self } else { self }
    }

    pub(super) fn is_positive(self) -> bool {
        self.high > 0.0
    }

    pub(super) fn is_negative(self) -> bool {
        self.high < 0.0
    }

    /// Returns the root of a number that is not negative: one step of Newton's method from the root
    /// as a double.
    pub(super) fn sqrt(self) -> Self {
        if self.high <= 0.0 {
            return Self::ZERO;
        }
        let near = Self::from(self.high.sqrt());
        near + (self - near * near) / (near + near)
    }
}

/// Returns a + b with its rounding.
fn sum(a: f64, b: f64) -> DoubleDouble {
    let high = a + b;
    let part = high - a;
    DoubleDouble { high, low: (a - (high - part)) + (b - part) }
}

/// Returns a + b with its rounding, for |a| ≥ |b|.
fn ordered_sum(a: f64, b: f64) -> DoubleDouble {
    let high = a + b;
    DoubleDouble { high, low: b - (high - a) }
}

/// Splits a number into two halves of 26 bits each, whose products are exact.
fn halves(a: f64) -> (f64, f64) {
    const SPLITTER: f64 = 134_217_729.0;
    let scaled = SPLITTER * a;
    let high = scaled - (scaled - a);
    (high, a - high)
}

/// Returns a b with its rounding.
fn product(a: f64, b: f64) -> DoubleDouble {
    let high = a * b;
    let ((a1, a2), (b1, b2)) = (halves(a), halves(b));
    DoubleDouble { high, low: ((a1 * b1 - high) + a1 * b2 + a2 * b1) + a2 * b2 }
}

impl From<f64> for DoubleDouble {
    fn from(value: f64) -> Self {
        Self { high: value, low: 0.0 }
    }
}

impl PartialOrd for DoubleDouble {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        (self.high, self.low).partial_cmp(&(other.high, other.low))
    }
}

impl Neg for DoubleDouble {
    type Output = Self;

    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Add for DoubleDouble {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let (high, low) = (sum(self.high, other.high), sum(self.low, other.low));
        let high = ordered_sum(high.high, high.low + low.high);
        ordered_sum(high.high, high.low + low.low)
    }
}

impl Sub for DoubleDouble {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for DoubleDouble {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let exact = product(self.high, other.high);
        ordered_sum(exact.high, exact.low + (self.high * other.low + self.low * other.high))
    }
}

impl Div for DoubleDouble {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        let first = self.high / other.high;
        let rest = self - other * first.into();
        let second = rest.high / other.high;
        let rest = rest - other * second.into();
        ordered_sum(first, second) + (rest.high / other.high).into()
    }
}

impl AddAssign for DoubleDouble {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for DoubleDouble {
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sums, products, quotients and roots keep 30 digits. Their errors are far below the last
    /// digit of a double.
    #[test]
    fn thirty_digits_are_kept() {
        let third = DoubleDouble::ONE / DoubleDouble::from(3.0);
        let rest = third + third + third - DoubleDouble::ONE;
        assert!(rest.abs().rounded() < 1e-31, "{rest:?}");
        for value in [2.0, 1e-7, 3e90] {
            let value = DoubleDouble::from(value);
            let rest = (value.sqrt() * value.sqrt() - value) / value;
            assert!(rest.abs().rounded() < 1e-30, "{rest:?}");
        }
        let tiny = DoubleDouble::from(1e-25);
        let rest = (DoubleDouble::ONE + tiny) * (DoubleDouble::ONE - tiny) - DoubleDouble::ONE;
        assert!(rest.abs().rounded() < 1e-31, "{rest:?}");
        assert!(((DoubleDouble::ONE + tiny) - DoubleDouble::ONE).rounded() / 1e-25 - 1.0 < 1e-6);
    }
}
