//! One orthogonal factorisation of all levels, for a given active set.
//!
//! Active bounds leave as columns. The active rows that remain are stacked by priority,
//! [H₀ O₀ H₁ O₁ …]: a level's hard rows at their bounds, then the rows of its objective. They are
//! factored from the right, A = [L 0] Qᵀ, with pivoting inside each group, so that the
//! coordinates y = Qᵀx which a level decides are those that no level above has used. Coordinates
//! that no level decides stay zero: the least norm.

mod moves;
mod point;
#[cfg(test)]
mod tests;
mod update;

use std::ops::Range;

use crate::linalg::kernels::{
    BlockFactor, FourReflections, Rotation, RowsMut, reflect_rows, reflect_rows_four,
};
use crate::linalg::list::List;
use crate::linalg::vector::{dot, reflector};
use crate::solver::active_set::{RowState, bound};
use crate::solver::data::RowTable;
use moves::Move;

/// Rotations kept, in numbers of variables, before everything is factored anew.
const ROTATIONS: usize = 24;

/// Numbers that the kernels take at a time.
const LANES: usize = 4;

/// Where the lanes begin in which `index` lies.
fn aligned(index: usize) -> usize {
    index - index % LANES
}

/// What a group of stacked rows is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Purpose {
    /// Equalities that hold.
    Held,
    /// Rows whose violation is minimised.
    Minimised,
}

/// A run of stacked rows.
#[derive(Debug, Clone)]
pub(crate) struct Group {
    pub(crate) level: usize,
    pub(crate) purpose: Purpose,
    /// Stacked rows `start..end`, and of them the pivots `start..start + rank`.
    pub(crate) start: usize,
    pub(crate) end: usize,
    pub(crate) rank: usize,
    /// Coordinates decided before this group.
    pub(crate) first_pivot: usize,
    /// The level whose linear term belongs to the group, if it has one.
    pub(crate) linear_of: Option<usize>,
}

/// The factors and the point that they give; sized once.
#[derive(Debug, Clone)]
pub(crate) struct Factorisation {
    n: usize,
    /// Entries from row to row: n, and zeros up to whole lanes.
    stride: usize,
    /// Variables that are not at a bound, in the order of the columns.
    pub(crate) free: List<usize>,
    /// Variables that are, in the order of the variables.
    pub(crate) bounded: List<usize>,
    /// Rows of the table, stacked; pivots of a group stand first in it.
    pub(crate) stacked: List<usize>,
    pub(crate) groups: List<Group>,
    /// L, a stacked row in `stride` entries.
    rows: Vec<f64>,
    target: Vec<f64>,
    /// What the variables at a bound add to each row of the table.
    known: Vec<f64>,
    /// Of stacked rows, the square of what no pivot has taken, and what it was when computed last.
    rest: Vec<f64>,
    measured: Vec<f64>,
    /// Of stacked rows, the square of the norm.
    square: Vec<f64>,
    /// Stacked row of each pivot.
    pub(crate) pivots: List<usize>,
    reflectors: Vec<f64>,
    tau: Vec<f64>,
    /// What makes one of four reflections, for every four of them.
    blocks: List<BlockFactor>,
    /// Variables behind the free ones in order, in the places of those at a bound.
    moved: List<usize>,
    /// How many variables were free when the reflections were made, and how many these are.
    reflected: usize,
    reflections: usize,
    /// What the coordinates have been through since, and the rotations in it.
    moves: List<Move>,
    rotations: List<Rotation>,
    y: Vec<f64>,
    turned: Vec<f64>,
    tall: Vec<f64>,
    tall_target: Vec<f64>,
    /// Linear terms in the coordinates y, a level in `n` entries.
    linear: Vec<f64>,
    pub(crate) x: Vec<f64>,
}

impl Factorisation {
    pub(crate) fn new(table: &RowTable) -> Self {
        let (n, count) = (table.n, table.len());
        let stride = n.next_multiple_of(LANES);
        Self {
            n,
            stride,
            free: List::with_capacity(n),
            bounded: List::with_capacity(n),
            stacked: List::with_capacity(count),
            groups: List::with_capacity(2 * table.levels.len()),
            rows: vec![0.0; count * stride],
            target: vec![0.0; count],
            known: vec![0.0; count],
            rest: vec![0.0; count],
            measured: vec![0.0; count],
            square: vec![0.0; count],
            pivots: List::with_capacity(n),
            reflectors: vec![0.0; n * stride],
            tau: vec![0.0; n],
            blocks: List::with_capacity(n / LANES),
            moved: List::with_capacity(n),
            reflected: 0,
            reflections: 0,
            rotations: List::with_capacity(ROTATIONS * n),
            moves: List::with_capacity(ROTATIONS * n),
            y: vec![0.0; n],
            turned: vec![0.0; stride],
            tall: vec![0.0; count * n],
            tall_target: vec![0.0; count],
            linear: vec![0.0; table.levels.len() * n],
            x: vec![0.0; n],
        }
    }

    /// Factors the rows that are active in `state` and computes x; false if a linear term falls
    /// for ever along what they leave open.
    pub(crate) fn factorise(
        &mut self,
        table: &RowTable,
        state: &[RowState],
        tolerance: f64,
    ) -> bool {
        self.take_bounds(table, state);
        self.stack(table, state);
        self.pivots.clear();
        self.blocks.clear();
        self.rotations.clear();
        self.moves.clear();
        self.reflected = self.free.len();
        for group in 0..self.groups.len() {
            self.eliminate(group, tolerance);
        }
        self.reflections = self.pivots.len();
        self.find_point(table, tolerance)
    }

    /// Bounds that became active after the factorisation was made: rows of the first group.
    pub(crate) fn bounds_in_stack(&self) -> impl Iterator<Item = usize> {
        let first = self.groups.first().map_or(0, |group| group.end);
        self.stacked[..first].iter().copied().filter(|&id| id < self.n)
    }

    fn take_bounds(&mut self, table: &RowTable, state: &[RowState]) {
        self.free.clear();
        self.bounded.clear();
        self.x.fill(0.0);
        for i in 0..self.n {
            if state[i].is_active() {
                self.x[i] = bound(table, state, i);
                self.bounded.push(i);
            }
        }
        // Free variables keep their places, but for the last, which fill the places of the others.
        let k = self.n - self.bounded.len();
        self.free.extend(0..k);
        self.moved.clear();
        self.moved.extend((k..self.n).filter(|&i| !state[i].is_active()));
        for (&place, &variable) in self.bounded.iter().zip(&self.moved) {
            self.free[place] = variable;
        }
        // x is zero but for the variables at a bound.
        table.multiply(self.n..table.len(), &self.x, &mut self.known);
    }

    fn stack(&mut self, table: &RowTable, state: &[RowState]) {
        self.stacked.clear();
        self.groups.clear();
        for (level, rows) in table.levels.iter().enumerate() {
            let linear_of = rows.has_linear.then_some(level);
            for (purpose, ids, linear_of) in [
                (Purpose::Held, rows.constraints.clone(), None),
                (Purpose::Minimised, rows.used_objective(), linear_of),
            ] {
                let (start, of_level) = (self.stacked.len(), ids.clone());
                for id in ids.filter(|&id| state[id].is_active() && table.norm(id) > 0.0) {
                    self.push(table, state, id);
                }
                let end = self.stacked.len();
                // Bounds that become active later join the first group.
                let first = purpose == Purpose::Held && level == 0;
                if first || !of_level.is_empty() || linear_of.is_some() {
                    let (rank, first_pivot) = (0, 0);
                    self.groups.push(Group {
                        level,
                        purpose,
                        start,
                        end,
                        rank,
                        first_pivot,
                        linear_of,
                    });
                }
            }
        }
    }

    fn push(&mut self, table: &RowTable, state: &[RowState], id: usize) {
        let at = self.stacked.len();
        let coefficients = table.coefficients(id);
        let row = &mut self.rows[at * self.stride..(at + 1) * self.stride];
        row[..self.n].copy_from_slice(coefficients);
        for (&place, &variable) in self.bounded.iter().zip(&self.moved) {
            row[place] = coefficients[variable];
        }
        row[self.free.len()..].fill(0.0);
        self.target[at] = bound(table, state, id) - self.known[id];
        self.square[at] = table.norm(id).powi(2);
        self.stacked.push(id);
    }

    /// Reflections that turn the group's rows onto coordinates of their own.
    fn eliminate(&mut self, group: usize, tolerance: f64) {
        let (n, k) = (self.stride, self.free.len());
        let whole = self.reflected_lanes();
        let Group { start, end, .. } = self.groups[group];
        let first_pivot = self.pivots.len();
        self.groups[group].first_pivot = first_pivot;
        self.turn_rows(start..end);
        self.measure(start..end, first_pivot);
        for at in start..end {
            let step = self.pivots.len();
            if step == k {
                break;
            }
            let Some(pivot) = self.best_row(at..end, step, tolerance) else { break };
            self.swap(at, pivot);
            let (above, below) = self.rows.split_at_mut((at + 1) * n);
            let row = &mut above[at * n + step..at * n + k];
            let reflection = &mut self.reflectors[step * n..step * n + whole];
            reflection[aligned(step)..step].fill(0.0);
            reflection[k..].fill(0.0);
            let v = &mut reflection[step..k];
            v.copy_from_slice(row);
            let (tau, image) = reflector(v);
            row[0] = image;
            self.tau[step] = tau;
            let data = &mut below[..(end - at - 1) * n];
            let first = aligned(step);
            reflect_rows(&mut RowsMut { data, stride: n }, first, &reflection[first..], tau);
            let taken = self.rows.iter().skip((at + 1) * n + step).step_by(n);
            for (rest, entry) in self.rest[at + 1..end].iter_mut().zip(taken) {
                *rest -= entry * entry;
            }
            self.pivots.push(at);
            self.groups[group].rank += 1;
            if self.pivots.len().is_multiple_of(LANES) {
                let block = self.pivots.len() / LANES - 1;
                let factor = BlockFactor::new(self.block(block), &self.tau[block * LANES..]);
                self.blocks.push(factor);
            }
        }
    }

    /// Turns rows by the reflections so far.
    fn turn_rows(&mut self, rows: Range<usize>) {
        let stride = self.stride;
        let whole = self.reflected_lanes();
        let mut all = std::mem::take(&mut self.rows);
        let data = &mut all[rows.start * stride..rows.end * stride];
        for (block, factor) in self.blocks.iter().enumerate() {
            let four = FourReflections::new(self.block(block), factor);
            reflect_rows_four(&mut RowsMut { data, stride }, block * LANES, &four);
        }
        for step in self.blocks.len() * LANES..self.pivots.len() {
            let from = aligned(step);
            let v = &self.reflectors[step * stride..][from..whole];
            reflect_rows(&mut RowsMut { data, stride }, from, v, self.tau[step]);
        }
        self.rows = all;
    }

    /// How many entries whole lanes of reflectors have.
    fn reflected_lanes(&self) -> usize {
        self.reflected.next_multiple_of(LANES)
    }

    /// Four reflectors, over the lanes from the first one's on.
    fn block(&self, block: usize) -> [&[f64]; LANES] {
        let whole = self.reflected_lanes();
        let first = block * LANES;
        std::array::from_fn(|i| &self.reflectors[(first + i) * self.stride..][first..whole])
    }

    /// Squares of what remains of rows from column `step` on.
    fn measure(&mut self, rows: Range<usize>, step: usize) {
        for at in rows {
            let row = &self.rows[at * self.stride + step..at * self.stride + self.free.len()];
            self.rest[at] = dot(row, row);
            self.measured[at] = self.rest[at];
        }
    }

    /// The row with the largest remainder, of those where it is more than `tolerance` of the norm: heavy
    /// rows first, light ones in what these leave.
    fn best_row(&mut self, rows: Range<usize>, step: usize, tolerance: f64) -> Option<usize> {
        // Of a remainder that has shrunk much, little is left but rounding.
        let shrunk = |(rest, measured): (&f64, &f64)| *rest < 1e-4 * *measured;
        let first = rows.start;
        if self.rest[rows.clone()].iter().zip(&self.measured[rows.clone()]).any(shrunk) {
            for at in rows.clone() {
                if shrunk((&self.rest[at], &self.measured[at])) {
                    self.measure(at..at + 1, step);
                }
            }
        }
        let mut best = None;
        let mut largest = 0.0;
        for (i, (&rest, &square)) in
            self.rest[rows.clone()].iter().zip(&self.square[rows]).enumerate()
        {
            if rest > tolerance.powi(2) * square && rest > largest {
                largest = rest;
                best = Some(first + i);
            }
        }
        best
    }

    fn swap(&mut self, i: usize, j: usize) {
        if i != j {
            let n = self.stride;
            let (head, tail) = self.rows.split_at_mut(j * n);
            head[i * n..(i + 1) * n].swap_with_slice(&mut tail[..n]);
            self.target.swap(i, j);
            self.stacked.swap(i, j);
            self.rest.swap(i, j);
            self.measured.swap(i, j);
            self.square.swap(i, j);
        }
    }
}
