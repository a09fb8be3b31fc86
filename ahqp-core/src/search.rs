//! The primal active-set search of one level, from a point where every hard row holds.
//!
//! Each iteration either moves to the minimum of the present equality problem, stops at the
//! first row in the way, or lets go of a row whose multiplier has the wrong sign (Nocedal &
//! Wright, Numerical Optimization, algorithm 16.3, with w as variables that are never formed).
//! The objective never rises; when it stalls, rows are taken by least index (Bland), which
//! cannot cycle.

use crate::active_set::{ActiveSet, End, Goal, RowState};
use crate::least_squares::Minimum;
use crate::vector::{add_scaled, norm};

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
        let mut stalled = 0;
        loop {
            if self.iterations >= self.settings.max_iterations {
                return End::OutOfIterations;
            }
            self.iterations += 1;
            // Least index first cannot cycle (Bland), but is slow: only after a stall.
            let careful = stalled > self.table.n;
            let minimum = self.equality_step(goal);
            let (length, blocking) = self.first_in_the_way(goal, minimum, careful);
            self.advance(goal, length);
            stalled = if length * norm(&self.direction) > 1e-14 * (1.0 + norm(&self.x)) {
                0
            } else {
                stalled + 1
            };
            if let Some((id, state)) = blocking {
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
                    self.release(position);
                }
                Some(Release::Soft(id)) => {
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
        let x_norm = norm(&self.x);
        for candidate in &self.candidates {
            let slack = if careful { 0.0 } else { self.tolerance(candidate.id, x_norm) };
            reach = reach.min((candidate.room + slack) / candidate.slope);
        }
        if reach >= full {
            return (full, None);
        }
        let mut best: Option<(f64, f64, usize, RowState)> = None;
        for &Candidate { id, state, room, slope } in &self.candidates {
            let ratio = room / slope;
            let pivot = slope / self.table.row(id).norm().max(f64::MIN_POSITIVE);
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
        for &id in &self.hard {
            self.slope[id] = if self.state[id] == RowState::Inside {
                self.table.row(id).dot(&self.direction)
            } else {
                0.0
            };
        }
        if let Goal::Rows { rows, .. } = goal {
            self.table.multiply(rows.clone(), &self.direction, &mut self.slope);
        }
    }

    /// The rows whose bounds the direction meets within `full` of its length.
    fn find_candidates(&mut self, goal: &Goal, full: f64) {
        let least = self.dependence_tolerance() * norm(&self.direction);
        let (table, found) = (&self.table, &mut self.candidates);
        found.clear();
        let mut consider = |id: usize, value: f64, slope: f64| {
            let (state, room) = if slope > 0.0 {
                (RowState::Upper, table.upper[id] - value)
            } else {
                (RowState::Lower, value - table.lower[id])
            };
            let slope = slope.abs();
            if room < full * slope && slope > least * table.row(id).norm() {
                found.push(Candidate { id, state, room: room.max(0.0), slope });
            }
        };
        for &id in &self.hard {
            if self.state[id] == RowState::Inside {
                consider(id, self.value[id], self.slope[id]);
            }
        }
        if let Goal::Rows { rows, .. } = goal {
            for id in rows.clone() {
                if self.state[id] == RowState::Inside {
                    let residual = self.residual[id];
                    consider(id, self.value[id] - residual, self.slope[id] + residual);
                }
            }
        }
    }

    /// x ← x + length · direction.
    fn advance(&mut self, goal: &Goal, length: f64) {
        if !length.is_finite() {
            return;
        }
        add_scaled(&mut self.x, length, &self.direction);
        self.farthest = self.farthest.max(norm(&self.x));
        for &id in &self.hard {
            self.value[id] += length * self.slope[id];
        }
        if let Goal::Rows { rows, .. } = goal {
            for id in rows.clone() {
                self.value[id] += length * self.slope[id];
                self.residual[id] *= 1.0 - length.min(1.0);
            }
        }
    }

    /// The row to let go: the one that is most wrong, or the first of the wrong ones.
    fn wrong_sign(&mut self, goal: &Goal, careful: bool) -> Option<Release> {
        let threshold = self.refresh_multipliers(goal);
        if threshold == f64::INFINITY {
            return None;
        }
        let mut worst: Option<(f64, usize, Release)> = None;
        let mut consider = |wrongness: f64, id: usize, release: Release| {
            let better = worst
                .is_none_or(|(most, least, _)| if careful { id < least } else { wrongness > most });
            if wrongness > threshold && better {
                worst = Some((wrongness, id, release));
            }
        };
        for (position, &id) in self.basis.active().iter().enumerate() {
            let force = self.multipliers[position] * self.table.row(id).norm();
            match self.state[id] {
                RowState::Upper => consider(-force, id, Release::Hard(position)),
                RowState::Lower => consider(force, id, Release::Hard(position)),
                _ => {}
            }
        }
        if let Goal::Rows { rows, .. } = goal {
            for id in rows.clone() {
                let force = (self.value[id] - self.bound(id)) * self.table.row(id).norm();
                match self.state[id] {
                    RowState::Upper => consider(-force, id, Release::Soft(id)),
                    RowState::Lower => consider(force, id, Release::Soft(id)),
                    _ => {}
                }
            }
        }
        worst.map(|(_, _, release)| release)
    }
}
