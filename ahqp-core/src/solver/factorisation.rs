//! Orthogonal factorisation of the active rows of all levels.
//!
//! Active bounds are removed as columns. The remaining active rows are stacked in groups by
//! priority, [H₀ O₀ H₁ O₁ …]: hard rows that are held, then the rows of an objective. They are
//! factored from the right, A = [L 0] Qᵀ, with row pivoting inside each group. A group thereby
//! decides coordinates of y = Qᵀx that no earlier group has used. Coordinates that no group decides
//! are free.

mod least_squares;
mod orthogonal;
mod point;
mod rank_tolerances;
#[cfg(test)]
mod tests;
mod update;

use std::ops::Range;

use super::activity::Activity;
use super::data::{Coefficients, ProblemData, active_bound};
use super::tolerances::SHRUNK;
use crate::linalg::kernels::Rotation;
use crate::linalg::list::List;
use crate::linalg::vector::dot;
use least_squares::LeastSquares;
use orthogonal::Orthogonal;

pub(crate) use point::{FreeCoordinates, Step};
pub(crate) use rank_tolerances::RankTolerances;

/// Number of values that a kernel processes at a time.
const LANES: usize = 4;

/// Returns the start of the lanes that contain `index`.
fn first_lane(index: usize) -> usize {
    index - index % LANES
}

/// Purpose of a group of stacked rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Purpose {
    /// Rows that hold with equality.
    Held,
    /// Rows whose violation is minimised.
    Minimised,
}

/// A range of stacked rows.
#[derive(Debug, Clone)]
pub(crate) struct Group {
    pub(crate) level: usize,
    pub(crate) purpose: Purpose,
    /// Stacked rows `start..end`, of which the first `rank` are pivots.
    pub(crate) start: usize,
    pub(crate) end: usize,
    pub(crate) rank: usize,
    /// Number of coordinates decided before this group.
    pub(crate) first_pivot: usize,
    /// The level whose linear term belongs to the group, if there is one.
    pub(crate) linear_of: Option<usize>,
}

/// The factors and their point. All memory is allocated once.
#[derive(Debug, Clone)]
pub(crate) struct Factorisation {
    n: usize,
    /// Distance between rows: n, padded with zeros to whole lanes.
    stride: usize,
    /// Variables that are not at a bound, in the order of the columns.
    pub(crate) free: List<usize>,
    /// Variables at a bound that were removed as columns.
    pub(crate) bounded: List<usize>,
    /// Rows of the problem in stacked order. The pivots of a group are its first rows.
    pub(crate) stacked: List<usize>,
    pub(crate) groups: List<Group>,
    /// L, with `stride` entries for each stacked row.
    rows: Vec<f64>,
    target: Vec<f64>,
    /// Contribution of the variables at a bound to each row of the problem.
    known: Vec<f64>,
    /// Squared remainder of each stacked row after the pivots so far, and its value when it was
    /// last computed exactly.
    rest: Vec<f64>,
    measured: Vec<f64>,
    /// Squared norm of each stacked row.
    square: Vec<f64>,
    /// Stacked row of each pivot.
    pub(crate) pivots: List<usize>,
    orthogonal: Orthogonal,
    /// Rotations of the coordinates by the current change.
    rotations: List<Rotation>,
    /// Variables that are not at their own places, with their places.
    moved: List<(usize, usize)>,
    /// Number of groups whose coordinates are decided.
    decided: usize,
    has_rows_near_threshold: bool,
    /// True if the rank neglects parts of rows that exceed rounding. An update would lose them.
    leaves_parts_out: bool,
    /// Coordinates: first the decided ones, then those of free directions.
    y: Vec<f64>,
    turned: Vec<f64>,
    gathered: Vec<f64>,
    /// Remainder of a row after the pivots.
    left: Vec<f64>,
    least_squares: LeastSquares,
    /// Linear terms in the coordinates y, with `n` entries for each level.
    linear: Vec<f64>,
    pub(crate) tolerances: RankTolerances,
    pub(crate) x: Vec<f64>,
}

impl Factorisation {
    pub(crate) fn new(data: &ProblemData, tolerances: RankTolerances) -> Self {
        let (n, count) = (data.n, data.len());
        let stride = n.next_multiple_of(LANES);
        let levels = data.levels.len();
        Self {
            n,
            stride,
            free: List::with_capacity(n),
            bounded: List::with_capacity(n),
            stacked: List::with_capacity(count),
            groups: List::with_capacity(3 * levels + 2),
            // One extra row, so that a whole row can be read from every entry.
            rows: vec![0.0; (count + 1) * stride],
            target: vec![0.0; count],
            known: vec![0.0; count],
            rest: vec![0.0; count],
            measured: vec![0.0; count],
            square: vec![0.0; count],
            pivots: List::with_capacity(n),
            orthogonal: Orthogonal::new(n),
            rotations: List::with_capacity(2 * n),
            moved: List::with_capacity(2 * n),
            decided: 0,
            has_rows_near_threshold: false,
            leaves_parts_out: false,
            y: vec![0.0; stride],
            turned: vec![0.0; stride],
            gathered: vec![0.0; stride],
            left: vec![0.0; n],
            least_squares: LeastSquares::new(n, count),
            linear: vec![0.0; levels * n],
            tolerances,
            x: vec![0.0; n],
        }
    }

    /// Factors the active rows of all levels and computes x. Returns false if a linear term
    /// decreases without bound along a free direction.
    pub(crate) fn factorise(&mut self, data: &ProblemData, activity: &[Activity]) -> bool {
        self.begin(data, activity);
        for (level, rows) in data.levels.iter().enumerate() {
            // Bounds that become active later join the first group.
            if level == 0 || !rows.constraints.is_empty() {
                self.push_group(level, Purpose::Held, None);
                self.push_active(data, activity, rows.constraints.clone());
            }
            let linear_of = rows.has_linear.then_some(level);
            let objective = rows.used_objective();
            if !objective.is_empty() || linear_of.is_some() {
                self.push_group(level, Purpose::Minimised, linear_of);
                self.push_active(data, activity, objective);
            }
        }
        self.eliminate_from(0);
        self.set_point(data)
    }

    /// Starts without rows. Active bounds are removed as columns.
    pub(crate) fn begin(&mut self, data: &ProblemData, activity: &[Activity]) {
        self.bounded.clear();
        self.bounded.extend((0..self.n).filter(|&i| activity[i].is_active()));
        self.order_variables(data, activity);
        self.stacked.clear();
        self.groups.clear();
        self.pivots.clear();
        self.invalidate_from(0);
        self.has_rows_near_threshold = false;
        self.leaves_parts_out = false;
        self.orthogonal.begin(self.free.len());
    }

    /// Sets the order of the free variables.
    fn order_variables(&mut self, data: &ProblemData, activity: &[Activity]) {
        self.x.fill(0.0);
        for &i in &self.bounded {
            self.x[i] = active_bound(data, activity, i);
        }
        // Free variables keep their places, except the last ones, which fill the places of the
        // bounded variables.
        let k = self.n - self.bounded.len();
        self.free.clear();
        self.free.extend(0..k);
        self.moved.clear();
        let behind = (k..self.n).filter(|i| !self.bounded.contains(i));
        self.moved.extend(self.bounded.iter().copied().zip(behind));
        for &(place, variable) in &self.moved {
            self.free[place] = variable;
        }
        // x is zero except for the variables at a bound.
        if self.bounded.is_empty() {
            self.known.fill(0.0);
        } else {
            data.multiply_all(&self.x, &mut self.known);
        }
    }

    /// Turns the last group, that of an objective, into hard rows if all its rows are pivots and
    /// hence satisfied. Returns true if it did.
    pub(crate) fn hold_met_group(&mut self) -> bool {
        let Some(group) = self.groups.last_mut() else { return false };
        let is_met = group.rank == group.end - group.start && group.linear_of.is_none();
        if is_met {
            group.purpose = Purpose::Held;
        }
        is_met
    }

    /// Appends an empty group.
    pub(crate) fn push_group(&mut self, level: usize, purpose: Purpose, linear_of: Option<usize>) {
        let (start, first_pivot) = (self.stacked.len(), self.pivots.len());
        let end = start;
        self.groups.push(Group { level, purpose, start, end, rank: 0, first_pivot, linear_of });
    }

    /// Adds the active rows among `ids` to the last group.
    pub(crate) fn push_active(
        &mut self,
        data: &ProblemData,
        activity: &[Activity],
        ids: Range<usize>,
    ) {
        for id in ids.filter(|&id| activity[id].is_active() && data.norm(id) > 0.0) {
            self.stacked.push(id);
            self.load_row(data, activity, self.stacked.len() - 1);
        }
        let end = self.stacked.len();
        self.groups.last_mut().into_iter().for_each(|group| group.end = end);
    }

    /// Removes the last group. The directions that it decided become free.
    pub(crate) fn pop_group(&mut self) {
        if let Some(group) = self.groups.pop() {
            self.stacked.truncate(group.start);
            self.pivots.truncate(group.first_pivot);
            self.orthogonal.forget_from(group.first_pivot);
            self.invalidate_from(self.groups.len());
        }
    }

    /// Copies a stacked row from the data.
    fn load_row(&mut self, data: &ProblemData, activity: &[Activity], at: usize) {
        let id = self.stacked[at];
        let row = &mut self.rows[at * self.stride..(at + 1) * self.stride];
        match data.row(id).coefficients() {
            Coefficients::Dense(coefficients) => {
                row[..self.n].copy_from_slice(coefficients);
                for &(place, variable) in &self.moved {
                    row[place] = coefficients[variable];
                }
            }
            Coefficients::Unit(variable) => {
                for (entry, &free) in row.iter_mut().zip(&self.free) {
                    *entry = f64::from(u8::from(free == variable));
                }
            }
        }
        row[self.free.len()..].fill(0.0);
        self.target[at] = active_bound(data, activity, id) - self.known[id];
        self.square[at] = data.norm(id).powi(2);
    }

    /// Factors the last group with pivoting, for a search that changes it.
    pub(crate) fn eliminate_last(&mut self) {
        self.eliminate_from(self.groups.len().saturating_sub(1));
        self.orthogonal.multiply_out();
    }

    /// Factors the groups from this one on with pivoting.
    fn eliminate_from(&mut self, group: usize) {
        for group in group..self.groups.len() {
            self.eliminate(group);
        }
    }

    /// Factors all groups again, with pivoting.
    pub(crate) fn eliminate_again(&mut self, data: &ProblemData, activity: &[Activity]) {
        self.bounded.sort_unstable();
        self.order_variables(data, activity);
        self.pivots.clear();
        self.leaves_parts_out = false;
        self.invalidate_from(0);
        self.orthogonal.begin(self.free.len());
        for at in 0..self.stacked.len() {
            self.load_row(data, activity, at);
        }
        self.eliminate_from(0);
    }

    /// Transforms the group's rows by Q, and reflects them onto coordinates of their own.
    fn eliminate(&mut self, group: usize) {
        let (n, k) = (self.stride, self.free.len());
        let Group { start, end, purpose, .. } = self.groups[group];
        let tolerance = match purpose {
            Purpose::Held => self.tolerances.nothing,
            Purpose::Minimised => self.tolerances.dependent,
        };
        let first_pivot = self.pivots.len();
        self.orthogonal.turn_rows(&mut self.rows[start * n..end * n]);
        self.measure(start..end, first_pivot);
        for at in start..end {
            let step = self.pivots.len();
            if step == k {
                break;
            }
            let Some(pivot) = self.heaviest_row(at..end, step, tolerance) else {
                self.leaves_parts_out |= self.exceeds(at..end, self.tolerances.nothing);
                self.has_rows_near_threshold |= self.leaves_parts_out;
                break;
            };
            self.swap(at, pivot);
            let (above, below) = self.rows.split_at_mut((at + 1) * n);
            let row = &mut above[at * n..];
            row[step] = self.orthogonal.reflect(step, row, &mut below[..(end - at - 1) * n]);
            let taken = self.rows.iter().skip((at + 1) * n + step).step_by(n);
            for (rest, entry) in self.rest[at + 1..end].iter_mut().zip(taken) {
                *rest -= entry * entry;
            }
            self.pivots.push(at);
        }
        self.invalidate_from(group);
        let group = &mut self.groups[group];
        (group.first_pivot, group.rank) = (first_pivot, self.pivots.len() - first_pivot);
    }

    /// Computes the squared remainders of rows from column `step` on.
    fn measure(&mut self, rows: Range<usize>, step: usize) {
        for at in rows {
            let row = &self.rows[at * self.stride + step..at * self.stride + self.free.len()];
            self.rest[at] = dot(row, row);
            self.measured[at] = self.rest[at];
        }
    }

    /// Returns the row with the largest remainder among those whose remainder exceeds `tolerance`
    /// of their norm. Heavy rows come first, and light rows in what these leave.
    fn heaviest_row(&mut self, rows: Range<usize>, step: usize, tolerance: f64) -> Option<usize> {
        let (mut best, mut largest) = (None, 0.0);
        for at in rows {
            // A remainder that has shrunk much consists mostly of rounding.
            if self.rest[at] < SHRUNK * self.measured[at] {
                self.measure(at..at + 1, step);
            }
            let rest = self.rest[at];
            if rest > largest && rest > tolerance.powi(2) * self.square[at] {
                (best, largest) = (Some(at), rest);
            }
        }
        best
    }

    /// Returns true if the remainder of any of these rows exceeds this part of the row.
    fn exceeds(&self, rows: Range<usize>, part: f64) -> bool {
        let mut squares = self.rest[rows.clone()].iter().zip(&self.square[rows]);
        squares.any(|(rest, square)| *rest > part.powi(2) * square)
    }

    /// Returns true if rows of objectives count as dependent only by the rank tolerance, and not by
    /// rounding. Which rows these are depends on the order of rows and bounds.
    pub(crate) fn has_rows_near_threshold(&self) -> bool {
        self.has_rows_near_threshold
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

    /// Marks the coordinates of this group and of later groups as unknown.
    fn invalidate_from(&mut self, group: usize) {
        self.decided = self.decided.min(group);
    }

    /// Bounds that became active after the factorisation was made. They are rows of the first
    /// group.
    pub(crate) fn bounds_in_stack(&self) -> impl Iterator<Item = usize> {
        let first = self.groups.first().map_or(0, |group| group.end);
        self.stacked[..first].iter().copied().filter(|&id| id < self.n)
    }

    /// Returns the group of an active row. A bound that was removed as a column counts as one of
    /// the first group.
    pub(crate) fn group_with(&self, id: usize) -> usize {
        let at = self.stacked.iter().position(|&row| row == id);
        let group = at.and_then(|at| self.groups.iter().position(|group| at < group.end));
        group.unwrap_or(0)
    }

    /// Iterates over the objectives in groups before the last.
    fn objectives_above(&self) -> impl Iterator<Item = &Group> {
        let above = self.groups.iter().rev().skip(1);
        above.filter(|group| group.purpose == Purpose::Minimised)
    }

    /// Number of coordinates that the objectives before the last group decide.
    pub(crate) fn rank_of_objectives_above(&self) -> usize {
        self.objectives_above().map(|group| group.rank).sum()
    }

    /// Returns an upper bound of the norm of row `id`'s coefficients at free variables. If the
    /// forces of rows differ much, it is the norm itself.
    pub(crate) fn norm_of_entries(
        &self,
        data: &ProblemData,
        id: usize,
        has_scale_disparity: bool,
    ) -> f64 {
        match data.row(id).coefficients() {
            Coefficients::Dense(row) if has_scale_disparity && !self.bounded.is_empty() => {
                self.free.iter().map(|&variable| row[variable].powi(2)).sum::<f64>().sqrt()
            }
            _ => data.norm(id),
        }
    }

    /// Number of coordinates that the groups decide.
    pub(crate) fn rank(&self) -> usize {
        self.pivots.len()
    }
}
