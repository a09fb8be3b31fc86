//! Ratio test: how far x may move along a direction, and the row that blocks it.

use std::ops::Range;

use super::ActiveSet;
use crate::linalg::kernels::{MovingRows, rows_outside};
use crate::linalg::vector::norm;
use crate::solver::active_set::goal::Goal;
use crate::solver::activity::Activity;
use crate::solver::tolerances::MOTIONLESS;

/// Part of its tolerance by which a row may pass its bound \[-\]. The tolerance changes with x, and
/// the row must still hold at the end.
const PASSED: f64 = 0.5;
/// Number of rows that are examined at a time.
const BLOCK: usize = u64::BITS as usize;

/// A blocking row, with the room left before its bound and the rate at which the room shrinks. The
/// room is negative for a row beyond its bound by up to its tolerance.
#[derive(Debug, Clone, Copy)]
pub(super) struct Candidate {
    id: usize,
    bound: Activity,
    room: f64,
    slope: f64,
}

impl ActiveSet {
    /// Returns how far x may move along `direction`, up to `full`, and the row that blocks it.
    pub(super) fn ratio_test(
        &mut self,
        goal: &Goal,
        full: f64,
    ) -> (f64, Option<(usize, Activity)>) {
        self.set_slopes(goal);
        self.find_candidates(full);
        // The first pass finds how far x may move within the bounds relaxed by the tolerance. Among
        // the rows met by then, the second pass takes the one most across the direction, which gives
        // the least rounding.
        let mut reach = full;
        for candidate in &self.candidates {
            if candidate.room < reach * candidate.slope {
                let slack = PASSED * self.tolerance(candidate.id);
                reach = reach.min(((candidate.room + slack) / candidate.slope).max(0.0));
            }
        }
        if reach >= full {
            return (full, None);
        }
        let across = |row: &Candidate| row.slope / self.data.norm(row.id).max(f64::MIN_POSITIVE);
        let met = self.candidates.iter().filter(|row| row.room / row.slope <= reach);
        let best = met.min_by(|a, b| across(b).total_cmp(&across(a)));
        match best {
            Some(row) => ((row.room / row.slope).clamp(0.0, full), Some((row.id, row.bound))),
            None => (reach, None),
        }
    }

    /// Computes the rates of change of the monitored rows along `direction`. Rows that are held do
    /// not move, except those of the goal.
    fn set_slopes(&mut self, goal: &Goal) {
        let Self { data, factorisation, direction, slope, .. } = self;
        for rows in &self.monitored {
            if rows.start < data.n {
                slope[..data.n].copy_from_slice(direction);
            }
            data.multiply(rows.start.max(data.n)..rows.end, direction, slope);
        }
        let held = match goal {
            Goal::Rows(_) => factorisation.groups.last().map_or(0, |group| group.start),
            Goal::Norm => factorisation.stacked.len(),
        };
        for &id in factorisation.stacked[..held].iter().chain(&factorisation.bounded) {
            slope[id] = 0.0;
        }
    }

    /// Finds the rows whose bounds the direction meets within `full`.
    fn find_candidates(&mut self, full: f64) {
        let part = self.factorisation.tolerances.dependent.min(MOTIONLESS);
        let least = part * norm(&self.direction).min(f64::MAX);
        self.candidates.clear();
        for block in 0..self.monitored.len() {
            let Range { start, end } = self.monitored[block];
            let mut first = start;
            while first < end {
                let next = end.min(first + BLOCK);
                self.find_candidates_among(first..next, full, least);
                first = next;
            }
        }
    }

    fn find_candidates_among(&mut self, rows: Range<usize>, full: f64, least: f64) {
        let Self { data, activity, value, slope, residual, candidates, .. } = self;
        let mut outside = 0;
        let moving = MovingRows {
            value: &value[rows.clone()],
            slope: &slope[rows.clone()],
            residual: &residual[rows.clone()],
            lower: &data.lower[rows.clone()],
            upper: &data.upper[rows.clone()],
        };
        rows_outside(moving, full, &mut outside);
        while outside != 0 {
            let id = rows.start + outside.trailing_zeros() as usize;
            outside &= outside - 1;
            if activity[id].is_active() {
                continue;
            }
            let (value, slope) = (value[id] - residual[id], slope[id] + residual[id]);
            let (bound, room) = if slope > 0.0 {
                (Activity::Upper, data.upper[id] - value)
            } else {
                (Activity::Lower, value - data.lower[id])
            };
            let slope = slope.abs();
            if room < full * slope && slope > least * data.norm(id) {
                candidates.push(Candidate { id, bound, room, slope });
            }
        }
    }
}
