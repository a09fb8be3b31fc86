//! A point that all limits admit, so that they never contradict each other.

use ahqp_core::{Rows, VelocityInterval};

use super::joint_intervals::nearest_to_rest;
use crate::vector::dot;

/// Rounds of going back within the rows. Where they do not suffice the rows are widened by more
/// than they must.
const ROUNDS: usize = 20;
/// Of a row's value, what counts as rounding.
const ROUNDING: f64 = 1e-12;

/// Widens rows as far as the intervals of the joints make it necessary, and returns true if it was.
///
/// The rows of limits admit rest, but a joint that moves cannot always be at rest in the next
/// period. Mostly they admit that accelerations fade, which gives the entries the velocities `faded`.
/// Else the point starts as near to rest as the intervals allow, is moved onto each row that it
/// violates in turn and back within the intervals (projections onto convex sets: Bregman, USSR
/// Computational Mathematics and Mathematical Physics 7(3), 1967), and then every row is widened
/// until it admits the point. Intervals and rows have that point in common: they are feasible.
/// `values` is room for a number a row.
pub(crate) fn widen(
    rows: &mut Rows,
    intervals: &[VelocityInterval],
    faded: impl Fn(usize) -> f64,
    point: &mut [f64],
    values: &mut [f64],
) -> bool {
    let rest = |_, interval: &VelocityInterval| nearest_to_rest(interval);
    let fading =
        |entry, interval: &VelocityInterval| faded(entry).max(interval.lower).min(interval.upper);
    for guess in [&fading as &dyn Fn(usize, &VelocityInterval) -> f64, &rest] {
        for (entry, (velocity, interval)) in point.iter_mut().zip(intervals).enumerate() {
            *velocity = guess(entry, interval);
        }
        if admits(rows, point, values) {
            return false;
        }
    }
    for _ in 0..ROUNDS {
        let mut holds = true;
        for (row, lower, upper) in rows.iter() {
            let value = dot(row, point);
            let excess = value - value.clamp(lower, upper);
            if excess.abs() <= ROUNDING * value.abs() {
                continue;
            }
            let square: f64 = row.iter().map(|a| a * a).sum();
            if square == 0.0 {
                continue;
            }
            holds = false;
            let bounded = point.iter_mut().zip(intervals).zip(row);
            for ((velocity, interval), coefficient) in bounded {
                let moved = *velocity - excess / square * coefficient;
                *velocity = moved.max(interval.lower).min(interval.upper);
            }
        }
        if holds {
            return false;
        }
    }
    let mut widened = false;
    for index in 0..rows.len() {
        let row = rows.row(index).unwrap_or_default();
        let value = dot(row, point);
        // What the sum rounds to in another order is admitted too.
        let size: f64 = row.iter().zip(&*point).map(|(a, b)| (a * b).abs()).sum();
        let room = ROUNDING * size;
        if let Some(lower) = rows.lower_mut().get_mut(index)
            && value < *lower
        {
            *lower = value - room;
            widened = true;
        }
        if let Some(upper) = rows.upper_mut().get_mut(index)
            && value > *upper
        {
            *upper = value + room;
            widened = true;
        }
    }
    widened
}

/// Whether a point is within all rows, up to rounding.
fn admits(rows: &Rows, point: &[f64], values: &mut [f64]) -> bool {
    let bounds = rows.lower().iter().zip(rows.upper());
    rows.multiply_into(0, point, values).is_ok()
        && bounds.zip(values).all(|((lower, upper), value)| {
            let room = ROUNDING * value.abs();
            *lower - room <= *value && *value <= *upper + room
        })
}
