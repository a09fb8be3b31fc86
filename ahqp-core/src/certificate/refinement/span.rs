//! Spans of orthonormal vectors.

use super::double_double::DoubleDouble;

/// Returns aᵀb.
pub(super) fn dot(a: &[DoubleDouble], b: &[DoubleDouble]) -> DoubleDouble {
    a.iter().zip(b).fold(DoubleDouble::ZERO, |sum, (&a, &b)| sum + a * b)
}

/// Computes y ← y + αx.
pub(super) fn add_scaled(y: &mut [DoubleDouble], alpha: DoubleDouble, x: &[DoubleDouble]) {
    for (y, &x) in y.iter_mut().zip(x) {
        *y += alpha * x;
    }
}

/// Returns ‖a‖ as a double.
pub(super) fn length(a: &[DoubleDouble]) -> f64 {
    a.iter().map(|a| a.rounded().powi(2)).sum::<f64>().sqrt()
}

/// Subtracts from `v` its component along the unit vector `unit`, and returns that component.
pub(super) fn take_off(v: &mut [DoubleDouble], unit: &[DoubleDouble]) -> DoubleDouble {
    let part = dot(v, unit);
    add_scaled(v, -part, unit);
    part
}

/// The span of orthonormal vectors.
#[derive(Debug, Clone, Default)]
pub(super) struct Span {
    pub(super) units: Vec<Vec<DoubleDouble>>,
}

impl Span {
    pub(super) fn len(&self) -> usize {
        self.units.len()
    }

    /// Extends the span by a row, and returns the row's coordinates in it. The last coordinate is
    /// the length outside the span. None if that length is at most `least`, which depends on the
    /// row's norm.
    pub(super) fn extend(&mut self, row: &[DoubleDouble], least: f64) -> Option<Vec<DoubleDouble>> {
        let (mut rest, mut parts) = (row.to_vec(), vec![DoubleDouble::ZERO; self.len()]);
        // The second pass removes what rounding has left.
        for _ in 0..2 {
            for (part, unit) in parts.iter_mut().zip(&self.units) {
                *part += take_off(&mut rest, unit);
            }
        }
        (length(&rest) > least).then(|| {
            parts.push(self.push_direction(rest));
            parts
        })
    }

    /// Adds the direction of a vector that is orthogonal to the span, and returns the vector's
    /// length.
    pub(super) fn push_direction(&mut self, mut direction: Vec<DoubleDouble>) -> DoubleDouble {
        let length = dot(&direction, &direction).sqrt();
        for entry in &mut direction {
            *entry = *entry / length;
        }
        self.units.push(direction);
        length
    }
}
