//! A point that all limits admit, so that they never contradict each other.

use ahqp_core::{Rows, VelocityInterval};

use super::joint_intervals::nearest_to_rest;
use crate::vector::dot;

/// Largest number of rounds of projections. If they do not suffice, rows are widened more than necessary.
const ROUNDS: usize = 20;
/// Share of the sizes of a row's products that counts as rounding.
const ROUNDING: f64 = 1e-12;

/// Widens rows as far as the intervals of the joints make it necessary.
///
/// The rows of limits admit rest, but a moving joint cannot always be at rest in the next period. Usually they admit
/// that accelerations fade, which gives the velocities `faded`. Otherwise a common point is searched:
///
/// 1. It starts as near to rest as the intervals allow.
/// 2. It is projected in turn on each row that it violates and back into the intervals, equalities last (projections
///    onto convex sets: Bregman, USSR Computational Mathematics and Mathematical Physics 7(3), 1967).
/// 3. Every row is widened until it admits the point.
///
/// So intervals and rows have a point in common. `values` is scratch memory of one number a row.
pub(crate) fn widen(
    rows: &mut Rows,
    intervals: &[VelocityInterval],
    faded: impl Fn(usize) -> f64,
    point: &mut [f64],
    values: &mut [f64],
) {
    let rest = |_, interval: &VelocityInterval| nearest_to_rest(interval);
    let fading =
        |entry, interval: &VelocityInterval| faded(entry).max(interval.lower).min(interval.upper);
    for guess in [&fading as &dyn Fn(usize, &VelocityInterval) -> f64, &rest] {
        for (entry, (velocity, interval)) in point.iter_mut().zip(intervals).enumerate() {
            *velocity = guess(entry, interval);
        }
        if admits(rows, point, values) {
            return admit(rows, point);
        }
    }
    for _ in 0..ROUNDS {
        let mut holds = true;
        for leaves_choice in [true, false] {
            let rows = rows.iter().filter(|(_, lower, upper)| (lower < upper) == leaves_choice);
            for row in rows {
                holds &= !moved_onto(row, intervals, point);
            }
        }
        if holds {
            break;
        }
    }
    admit(rows, point);
}

/// Projects a point on a row and back into the intervals. Returns true if the row was violated.
fn moved_onto(
    (row, lower, upper): (&[f64], f64, f64),
    intervals: &[VelocityInterval],
    point: &mut [f64],
) -> bool {
    let value = dot(row, point);
    let excess = value - value.clamp(lower, upper);
    let square: f64 = row.iter().map(|a| a * a).sum();
    if excess.abs() <= rounding(row, point) || square == 0.0 {
        return false;
    }
    for ((velocity, interval), coefficient) in point.iter_mut().zip(intervals).zip(row) {
        let moved = *velocity - excess / square * coefficient;
        *velocity = moved.max(interval.lower).min(interval.upper);
    }
    true
}

/// Widens the rows that do not admit a point, with room for the rounding of another order of summation.
fn admit(rows: &mut Rows, point: &[f64]) {
    for index in 0..rows.len() {
        let row = rows.row(index).unwrap_or_default();
        let (value, room) = (dot(row, point), rounding(row, point));
        if let Some(lower) = rows.lower_mut().get_mut(index)
            && value < *lower
        {
            *lower = value - room;
        }
        if let Some(upper) = rows.upper_mut().get_mut(index)
            && value > *upper
        {
            *upper = value + room;
        }
    }
}

/// The bound on the rounding of the sum of a row's products.
fn rounding(row: &[f64], point: &[f64]) -> f64 {
    ROUNDING * row.iter().zip(point).map(|(a, b)| (a * b).abs()).sum::<f64>()
}

/// True if a point is within all rows, up to rounding.
fn admits(rows: &Rows, point: &[f64], values: &mut [f64]) -> bool {
    rows.multiply_into(0, point, values).is_ok()
        && rows.iter().zip(values).all(|((row, lower, upper), value)| {
            let excess = *value - value.clamp(lower, upper);
            excess == 0.0 || excess.abs() <= rounding(row, point)
        })
}
