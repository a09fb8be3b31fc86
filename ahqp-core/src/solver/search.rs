//! The primal active-set search of one level, from a point where every hard row holds.
//!
//! Each iteration either moves to the minimum of the present equality problem, stops at the
//! first row in the way, or lets go of a row whose multiplier has the wrong sign (Nocedal &
//! Wright, Numerical Optimization, algorithm 16.3, with w as variables that are never formed).
//! The objective never rises; when it stalls, rows are taken by least index (Bland), which
//! cannot cycle. A row that is let go leaves its bound with the next step; one that stops that step
//! was let go by rounding, and stays until x moves.

use std::ops::Range;

use crate::linalg::vector::{add_scaled, norm};
use crate::solver::active_set::{ActiveSet, End, Goal, RowState};
use crate::solver::least_squares::Minimum;
use crate::solver::tolerances::CLEARLY_THERE;

/// Rows that are looked through at a time.
const BLOCK: usize = u64::BITS as usize;

/// A row in the way of a step: the room left before its bound, and how fast that shrinks.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Candidate {
    id: usize,
    state: RowState,
    room: f64,
    slope: f64,
}

/// A row of the working set, or of the objective, that should be let go.
#[derive(Debug, Clone, Copy)]
enum Release {
    Hard(usize),
    Soft(usize),
}

impl ActiveSet {
    /// Searches from x.
    pub(crate) fn search(&mut self, goal: &Goal) -> End {
        self.begin_pulling(goal);
        self.kept.clear();
        let (mut stalled, mut released) = (0, None);
        loop {
            if self.allowance.is_spent(self.iterations) {
                return End::OutOfBudget;
            }
            self.iterations += 1;
            // Least index first cannot cycle (Bland), but is slow: only after a stall.
            let careful = stalled > self.table.n;
            let minimum = self.equality_step(goal);
            let (length, blocking) = self.first_in_the_way(goal, minimum, careful);
            self.advance(goal, length);
            if length * norm(&self.direction) > 1e-14 * (1.0 + norm(&self.x)) {
                stalled = 0;
                self.kept.clear();
            } else {
                stalled += 1;
            }
            if let Some((id, state)) = blocking {
                if stalled > 0 && released == Some(id) {
                    self.kept.push(id);
                }
                released = None;
                if goal.has_row(id) {
                    self.pull(id, state);
                } else {
                    self.activate(id, state);
                }
                continue;
            }
            if minimum == Minimum::Ray {
                return End::Unbounded;
            }
            match self.wrong_sign(goal, careful) {
                None => return End::Optimal,
                Some(Release::Hard(position)) => {
                    released = Some(self.basis.active()[position]);
                    self.release(position);
                }
                Some(Release::Soft(id)) => {
                    released = Some(id);
                    self.residual[id] = self.value[id] - self.bound(id);
                    self.let_go(id);
                }
            }
        }
    }

    /// How far along `direction` x may go, and the row that stops it.
    fn first_in_the_way(
        &mut self,
        goal: &Goal,
        minimum: Minimum,
        careful: bool,
    ) -> (f64, Option<(usize, RowState)>) {
        let full = if minimum == Minimum::Ray { f64::INFINITY } else { 1.0 };
        self.set_slopes(goal);
        self.find_candidates(goal, full);
        // Two passes: the bound relaxed by the tolerance finds how far x may go, and among the
        // rows met by then the one most across the direction is taken.
        let mut reach = full;
        for candidate in &self.candidates {
            let slack = if careful { 0.0 } else { self.tolerance(candidate.id) };
            reach = reach.min((candidate.room + slack) / candidate.slope);
        }
        if reach >= full {
            return (full, None);
        }
        let mut best: Option<(f64, f64, usize, RowState)> = None;
        for &Candidate { id, state, room, slope } in &self.candidates {
            let ratio = room / slope;
            let pivot = slope / self.table.norm(id).max(f64::MIN_POSITIVE);
            let better = best.is_none_or(
                |(_, largest, least, _)| {
                    if careful { id < least } else { pivot > largest }
                },
            );
            if ratio <= reach && better {
                best = Some((ratio, pivot, id, state));
            }
        }
        match best {
            Some((ratio, _, id, state)) => (ratio.min(full), Some((id, state))),
            None => (reach, None),
        }
    }

    /// By how much the values of the rows in play change along `direction`.
    fn set_slopes(&mut self, goal: &Goal) {
        let n = self.table.n;
        for rows in &self.in_play {
            if rows.start < n {
                self.slope[..n].copy_from_slice(&self.direction);
            } else {
                self.table.multiply(rows.clone(), &self.direction, &mut self.slope);
            }
            for (slope, &state) in
                self.slope[rows.clone()].iter_mut().zip(&self.state[rows.clone()])
            {
                *slope = if state == RowState::Inside { *slope } else { 0.0 };
            }
        }
        if let Goal::Rows { rows, .. } = goal {
            self.table.multiply(rows.clone(), &self.direction, &mut self.slope);
        }
    }

    /// The rows whose bounds the direction meets within `full` of its length.
    fn find_candidates(&mut self, goal: &Goal, full: f64) {
        let least = self.dependence_tolerance() * norm(&self.direction);
        self.candidates.clear();
        for block in 0..self.in_play.len() {
            self.find_candidates_among(self.in_play[block].clone(), full, least);
        }
        if let Goal::Rows { rows, .. } = goal {
            self.find_candidates_among(rows.clone(), full, least);
        }
    }

    fn find_candidates_among(&mut self, rows: Range<usize>, full: f64, least: f64) {
        let table = &self.table;
        for first in rows.clone().step_by(BLOCK) {
            let block = first..rows.end.min(first + BLOCK);
            let mut met = self.rows_ahead(block, full);
            while met != 0 {
                let id = first + met.trailing_zeros() as usize;
                met &= met - 1;
                let residual = self.residual[id];
                let (value, slope) = (self.value[id] - residual, self.slope[id] + residual);
                let (state, room) = if slope > 0.0 {
                    (RowState::Upper, table.upper[id] - value)
                } else {
                    (RowState::Lower, value - table.lower[id])
                };
                let slope = slope.abs();
                if room < full * slope && slope > least * table.norm(id) {
                    self.candidates.push(Candidate { id, state, room: room.max(0.0), slope });
                }
            }
        }
    }

    /// Which of the inside rows of a block are outside their bounds at `full` of the direction, a
    /// bit a row. Written without branches: most rows are far away, and nobody can guess which.
    #[expect(clippy::needless_bitwise_bool, reason = "no branches")]
    fn rows_ahead(&self, block: Range<usize>, full: f64) -> u64 {
        let [value, slope, residual] =
            [&self.value, &self.slope, &self.residual].map(|of_rows| &of_rows[block.clone()]);
        let [lower, upper] =
            [&self.table.lower, &self.table.upper].map(|of_rows| &of_rows[block.clone()]);
        let moving = value.iter().zip(slope).zip(residual);
        let rows = self.state[block.clone()].iter().zip(moving).zip(lower.iter().zip(upper));
        let mut met = 0;
        for (bit, ((&state, ((value, slope), residual)), (lower, upper))) in rows.enumerate() {
            let ahead = value - residual + full * (slope + residual);
            let outside = (ahead > *upper) | (ahead < *lower);
            met |= u64::from(outside & (state == RowState::Inside)) << bit;
        }
        met
    }

    /// x ← x + length · direction.
    fn advance(&mut self, goal: &Goal, length: f64) {
        if !length.is_finite() {
            return;
        }
        add_scaled(&mut self.x, length, &self.direction);
        self.farthest = self.farthest.max(norm(&self.x));
        for rows in &self.in_play {
            add_scaled(&mut self.value[rows.clone()], length, &self.slope[rows.clone()]);
        }
        if let Goal::Rows { rows, .. } = goal {
            add_scaled(&mut self.value[rows.clone()], length, &self.slope[rows.clone()]);
            for residual in &mut self.residual[rows.clone()] {
                *residual *= 1.0 - length.min(1.0);
            }
        }
    }

    /// The row to let go: the one that is most wrong, or the first of the wrong ones.
    fn wrong_sign(&mut self, goal: &Goal, careful: bool) -> Option<Release> {
        if !self.refresh_multipliers(goal) {
            return None;
        }
        // Most rows that should go are far above rounding: how much it is need not be known then.
        let clear = CLEARLY_THERE * self.size;
        if !careful && let Some(release) = self.worst_sign(goal, careful, Some(clear)) {
            return Some(release);
        }
        self.set_multiplier_rounding(goal);
        self.worst_sign(goal, careful, None)
    }

    /// The row whose sign is most wrong, or the first of the wrong ones; of those with a force above
    /// `least`, or above their own rounding.
    fn worst_sign(&self, goal: &Goal, careful: bool, least: Option<f64>) -> Option<Release> {
        let mut worst: Option<(f64, usize, Release)> = None;
        let mut consider = |multiplier: f64, rounding: f64, id: usize, release: Release| {
            let norm = self.table.norm(id);
            let (wrongness, rounding) =
                (multiplier.abs() * norm, least.map_or(rounding, |least| least / norm));
            let better = worst
                .is_none_or(|(most, first, _)| if careful { id < first } else { wrongness > most });
            let is_wrong = self.state[id].is_wrong(multiplier, rounding);
            if is_wrong && better && !self.kept.contains(&id) {
                worst = Some((wrongness, id, release));
            }
        };
        let multipliers = self.multipliers.iter().zip(&self.multiplier_rounding);
        let positions = self.basis.active().iter().zip(multipliers).enumerate();
        for (position, (&id, (&multiplier, &rounding))) in positions {
            consider(multiplier, rounding, id, Release::Hard(position));
        }
        if let Goal::Rows { rows, .. } = goal {
            for id in rows.clone() {
                consider(self.pull[id], self.pull_rounding[id], id, Release::Soft(id));
            }
        }
        worst.map(|(_, _, release)| release)
    }
}
