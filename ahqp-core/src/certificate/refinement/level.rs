//! Minimum of one level by a primal active-set method.
//!
//! The violations of soft rows form a convex, piecewise quadratic objective. Each step leads
//! towards the minimum of the current piece, with the working rows held at their bounds. It ends
//! where the objective stops falling, or where another hard row stops it. If no step is left, a
//! working row whose multiplier has the wrong sign is removed.

use super::double_double::DoubleDouble;
use super::least_squares;
use super::row::Row;
use super::span::{Span, add_scaled, dot, length};
use crate::certificate::tolerances::{EFFORT, NO_STEP, NOTHING, SHORT_STEP, SUM};

/// The bound at which a working row is held.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Side {
    Lower,
    Upper,
}

impl Side {
    pub(super) fn bound(self, row: &Row) -> Option<DoubleDouble> {
        match self {
            Self::Lower => row.lower,
            Self::Upper => row.upper,
        }
    }
}

/// A level and the state of its search.
pub(super) struct Search<'a> {
    /// Directions that are decided.
    pub(super) decided: &'a Span,
    pub(super) hard: &'a [Row],
    pub(super) soft: &'a [Row],
    /// The linear term of the objective.
    pub(super) linear: &'a [DoubleDouble],
    /// Step from x. All hard rows hold at its end.
    pub(super) p: Vec<DoubleDouble>,
    /// Hard rows that are held at a bound.
    pub(super) working: Vec<(usize, Side)>,
    /// Length of the longest vector, which rounding is relative to.
    pub(super) reach: f64,
}

/// Rows with nonzero multipliers at the minimum of a level.
pub(super) struct Pushing {
    pub(super) hard: Vec<usize>,
    pub(super) soft: Vec<usize>,
}

impl Search<'_> {
    /// Goes to the minimum. None if that takes too many steps.
    pub(super) fn minimise(&mut self) -> Option<Pushing> {
        let n = self.p.len();
        let (mut stalled, mut last) = (0, f64::INFINITY);
        for _ in 0..EFFORT * (n + self.hard.len() + self.soft.len()) {
            let (span, triangle) = self.held();
            let violated = self.violated();
            let step = least_squares::step(&span, &violated, self.linear);
            let size = length(&step);
            let reach = self.reach + length(&self.p);
            let is_short = size <= SHORT_STEP * reach && 2.0 * size >= last;
            let short = if is_short { size } else { NO_STEP * reach };
            last = size;
            // The least index first cannot cycle (Bland).
            let is_stalled = stalled > n;
            let (room, blocking) = self.ratio_test(&step, size, is_stalled);
            let t = if size > short { self.line_search(&step, room) } else { DoubleDouble::ZERO };
            let is_blocked = size > short && room.is_some_and(|room| t == room);
            let is_short = t.abs().rounded() * size <= short;
            stalled = if is_short { stalled + 1 } else { 0 };
            if is_blocked || !is_short {
                add_scaled(&mut self.p, t, &step);
                self.working.extend(blocking.filter(|_| is_blocked));
                continue;
            }
            let multipliers = self.multipliers(&span, &triangle, &violated);
            let Some(wrong) = self.wrong_sign(&multipliers, is_stalled) else {
                return Some(self.pushing(&multipliers, &violated));
            };
            self.working.remove(wrong);
        }
        None
    }

    /// Returns the span of the decided directions and the working rows, with the coordinates of the
    /// working rows in it.
    fn held(&mut self) -> (Span, Vec<Vec<DoubleDouble>>) {
        let (mut span, mut triangle) = (self.decided.clone(), Vec::new());
        let hard = self.hard;
        self.working.retain(|&(id, _)| {
            let row = &hard[id];
            let parts = span.extend(&row.a, NOTHING * row.norm);
            let is_independent = parts.is_some();
            triangle.extend(parts);
            is_independent
        });
        (span, triangle)
    }

    /// Returns the violated soft rows, including all equalities, with their violations.
    fn violated(&self) -> Vec<(&Row, DoubleDouble)> {
        let rows = self.soft.iter().map(|row| (row, row.violation(dot(&row.a, &self.p))));
        rows.filter(|(row, violation)| row.is_equality() || *violation != DoubleDouble::ZERO)
            .collect()
    }

    /// Returns the multipliers λ of the working rows, and the rounding in the gradient. −Σ λ a is
    /// the gradient Σ w r a + d except in the decided directions.
    fn multipliers(
        &self,
        span: &Span,
        triangle: &[Vec<DoubleDouble>],
        violated: &[(&Row, DoubleDouble)],
    ) -> Multipliers {
        let mut gradient = self.linear.to_vec();
        let mut rounding = SUM * length(self.linear);
        for &(row, violation) in violated {
            add_scaled(&mut gradient, DoubleDouble::from(row.weight) * violation, &row.a);
            rounding += row.weight * row.norm * row.rounding();
        }
        let first = self.decided.len();
        let mut values: Vec<_> =
            span.units[first..].iter().map(|unit| -dot(unit, &gradient)).collect();
        for k in (0..values.len()).rev() {
            values[k] = values[k] / triangle[k][first + k];
            for j in 0..k {
                let taken = triangle[k][first + j] * values[k];
                values[j] -= taken;
            }
        }
        Multipliers { values, rounding }
    }

    /// Returns the position of a working row whose multiplier has the wrong sign: the worst one, or
    /// the first row.
    fn wrong_sign(&self, multipliers: &Multipliers, first: bool) -> Option<usize> {
        let places = self.working.iter().enumerate();
        let wrong = places.zip(&multipliers.values).filter_map(|((place, &(id, side)), &value)| {
            let force = value.rounded() * self.hard[id].norm;
            let force = if side == Side::Upper { force } else { -force };
            (force < -multipliers.rounding).then_some((place, id, force))
        });
        let worst = if first {
            wrong.min_by_key(|&(_, id, _)| id)
        } else {
            wrong.min_by(|a, b| a.2.total_cmp(&b.2))
        };
        worst.map(|(place, ..)| place)
    }

    /// Returns the rows whose multipliers exceed rounding.
    fn pushing(&self, multipliers: &Multipliers, violated: &[(&Row, DoubleDouble)]) -> Pushing {
        let is_there = |force: f64| force.abs() > multipliers.rounding;
        let working = self.working.iter().zip(&multipliers.values);
        let hard = working
            .filter(|((id, _), value)| is_there(value.rounded() * self.hard[*id].norm))
            .map(|((id, _), _)| *id)
            .collect();
        let pushes = |row: &Row| {
            row.is_equality()
                || violated.iter().any(|(other, violation)| {
                    std::ptr::eq(*other, row)
                        && is_there(row.weight * row.norm * violation.rounded())
                })
        };
        let soft = (0..self.soft.len()).filter(|&id| pushes(&self.soft[id])).collect();
        Pushing { hard, soft }
    }

    /// Returns how far along a step the hard rows hold, and the row that is met there.
    fn ratio_test(
        &self,
        step: &[DoubleDouble],
        size: f64,
        first: bool,
    ) -> (Option<DoubleDouble>, Option<(usize, Side)>) {
        let mut best: Option<(DoubleDouble, f64, (usize, Side))> = None;
        for (id, row) in self.hard.iter().enumerate() {
            let slope = dot(&row.a, step);
            let across = slope.abs().rounded();
            if across <= NOTHING * row.norm * size || self.working.iter().any(|w| w.0 == id) {
                continue;
            }
            let side = if slope.is_positive() { Side::Upper } else { Side::Lower };
            let Some(bound) = side.bound(row) else { continue };
            let gap = bound - dot(&row.a, &self.p);
            let is_closed =
                gap.abs().rounded() <= row.rounding() || gap.is_positive() != slope.is_positive();
            let room = if is_closed { DoubleDouble::ZERO } else { gap / slope };
            let across = across / row.norm;
            let is_first = best.as_ref().is_none_or(|&(least, most, _)| {
                room < least || (room == least && !first && across > most)
            });
            if is_first {
                best = Some((room, across, (id, side)));
            }
        }
        best.map_or((None, None), |(room, _, row)| (Some(room), Some(row)))
    }

    /// Returns the point along a step, within `room`, at which the violation of the soft rows is
    /// least.
    fn line_search(&self, step: &[DoubleDouble], room: Option<DoubleDouble>) -> DoubleDouble {
        let rows: Vec<_> =
            self.soft.iter().map(|row| (row, dot(&row.a, &self.p), dot(&row.a, step))).collect();
        let within = |t: DoubleDouble| room.is_none_or(|room| t < room);
        let mut kinks: Vec<DoubleDouble> = rows
            .iter()
            .filter(|(row, ..)| !row.is_equality())
            .flat_map(|(row, value, slope)| {
                [row.lower, row.upper].into_iter().flatten().map(|bound| (bound - *value) / *slope)
            })
            .filter(|&t| t.rounded().is_finite() && t.is_positive() && within(t))
            .collect();
        kinks.sort_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
        let linear = dot(self.linear, step);
        let derivative = |t: DoubleDouble| {
            rows.iter().fold(linear, |sum, &(row, value, slope)| {
                sum + DoubleDouble::from(row.weight) * row.violation(value + t * slope) * slope
            })
        };
        let (mut from, mut falls) = (DoubleDouble::ZERO, derivative(DoubleDouble::ZERO));
        // After the last kink the objective is a single quadratic.
        let last = kinks.last().copied().unwrap_or(DoubleDouble::ZERO) + DoubleDouble::ONE;
        for to in kinks.into_iter().chain([room.unwrap_or(last)]) {
            let slope = derivative(to);
            if !slope.is_negative() {
                return from + falls / (falls - slope) * (to - from);
            }
            (from, falls) = (to, slope);
        }
        if room.is_some() {
            return from;
        }
        let rise = derivative(from + DoubleDouble::ONE) - falls;
        if rise.is_positive() { from - falls / rise } else { from }
    }
}

/// Multipliers of the working rows, and the rounding in their forces.
struct Multipliers {
    values: Vec<DoubleDouble>,
    rounding: f64,
}
