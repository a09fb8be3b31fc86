//! Ratio test: how far x may move along a direction, and the row that blocks it.

use std::ops::Range;

use super::ActiveSet;
use crate::linalg::vector::norm;
use crate::solver::active_set::goal::Goal;
use crate::solver::activity::Activity;

/// Number of rows that are examined at a time.
const BLOCK: usize = u64::BITS as usize;

/// A blocking row, with the room left before its bound and the rate at which the room shrinks.
#[derive(Debug, Clone, Copy)]
pub(super) struct Candidate {
    id: usize,
    bound: Activity,
    room: f64,
    slope: f64,
}

/// Choice among several blocking rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Choice {
    /// The row most across the direction, which gives the least rounding.
    Steepest,
    /// The first row, which cannot cycle (Bland).
    First,
}

impl ActiveSet {
    /// Returns how far x may move along `direction`, up to `full`, and the row that blocks it.
    pub(super) fn ratio_test(
        &mut self,
        goal: &Goal,
        full: f64,
        choice: Choice,
    ) -> (f64, Option<(usize, Activity)>) {
        self.set_slopes(goal);
        self.find_candidates(goal, full);
        // The first pass finds how far x may move within the bounds relaxed by the tolerance. Among
        // the rows met by then, the second pass takes the one most across the direction.
        let mut reach = full;
        for candidate in &self.candidates {
            if candidate.room < reach * candidate.slope {
                let slack = self.tolerance(candidate.id);
                reach = reach.min((candidate.room + slack) / candidate.slope);
            }
        }
        if reach >= full {
            return (full, None);
        }
        let across = |row: &Candidate| row.slope / self.data.norm(row.id).max(f64::MIN_POSITIVE);
        let mut best: Option<&Candidate> = None;
        for row in self.candidates.iter().filter(|row| row.room / row.slope <= reach) {
            let is_better = best.is_none_or(|best| match choice {
                Choice::Steepest => across(row) > across(best),
                Choice::First => row.id < best.id,
            });
            if is_better {
                best = Some(row);
            }
        }
        match best {
            Some(row) => ((row.room / row.slope).min(full), Some((row.id, row.bound))),
            None => (reach, None),
        }
    }

    /// Computes the rates of change of the monitored rows along `direction`.
    fn set_slopes(&mut self, goal: &Goal) {
        let n = self.data.n;
        for rows in &self.monitored {
            if rows.start < n {
                self.slope[..n].copy_from_slice(&self.direction);
            } else {
                self.data.multiply(rows.clone(), &self.direction, &mut self.slope);
            }
            let slopes = self.slope[rows.clone()].iter_mut();
            for (slope, &activity) in slopes.zip(&self.activity[rows.clone()]) {
                *slope = if activity == Activity::Inactive { *slope } else { 0.0 };
            }
        }
        if let Goal::Rows(rows) = goal {
            self.data.multiply(rows.clone(), &self.direction, &mut self.slope);
        }
    }

    /// Finds the rows whose bounds the direction meets within `full`.
    fn find_candidates(&mut self, goal: &Goal, full: f64) {
        let least = self.factorisation.least_part() * norm(&self.direction).min(f64::MAX);
        self.candidates.clear();
        for block in 0..self.monitored.len() {
            self.find_candidates_among(self.monitored[block].clone(), full, least);
        }
        if let Goal::Rows(rows) = goal {
            self.find_candidates_among(rows.clone(), full, least);
        }
    }

    fn find_candidates_among(&mut self, rows: Range<usize>, full: f64, least: f64) {
        let data = &self.data;
        let mut next = rows.start;
        while next < rows.end {
            let first = next;
            next = rows.end.min(first + BLOCK);
            let mut met = self.rows_ahead(first..next, full);
            while met != 0 {
                let id = first + met.trailing_zeros() as usize;
                met &= met - 1;
                let residual = self.residual[id];
                let (value, slope) = (self.value[id] - residual, self.slope[id] + residual);
                let (bound, room) = if slope > 0.0 {
                    (Activity::Upper, data.upper[id] - value)
                } else {
                    (Activity::Lower, value - data.lower[id])
                };
                let slope = slope.abs();
                if room < full * slope && slope > least * data.norm(id) {
                    self.candidates.push(Candidate { id, bound, room: room.max(0.0), slope });
                }
            }
        }
    }

    /// Returns, as one bit for each row, which inactive rows of a block are outside their bounds at
    /// `full`. The loop has no branches, since they would be unpredictable.
    #[expect(clippy::needless_bitwise_bool, reason = "no branches")]
    fn rows_ahead(&self, block: Range<usize>, full: f64) -> u64 {
        let [value, slope, residual] =
            [&self.value, &self.slope, &self.residual].map(|of_rows| &of_rows[block.clone()]);
        let [lower, upper] =
            [&self.data.lower, &self.data.upper].map(|of_rows| &of_rows[block.clone()]);
        let moving = value.iter().zip(slope).zip(residual);
        let rows = self.activity[block.clone()].iter().zip(moving).zip(lower.iter().zip(upper));
        let mut met = 0;
        for (bit, ((&activity, ((value, slope), residual)), (lower, upper))) in rows.enumerate() {
            let ahead = value - residual + full * (slope + residual);
            let outside = (ahead > *upper) | (ahead < *lower);
            met |= u64::from(outside & (activity == Activity::Inactive)) << bit;
        }
        met
    }
}
