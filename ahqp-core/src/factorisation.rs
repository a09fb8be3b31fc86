//! One orthogonal factorisation of all levels, for a given active set.
//!
//! Active bounds leave as columns. The active rows that remain are stacked by priority,
//! [H₀ O₀ H₁ O₁ …]: a level's hard rows at their bounds, then the rows of its objective. They are
//! factored from the right, A = [L 0] Qᵀ, with pivoting inside each group, so that the
//! coordinates y = Qᵀx which a level decides are those that no level above has used. Coordinates
//! that no level decides stay zero: the least norm.

use crate::active_set::{RowState, bound};
use crate::kernels::{FourReflections, RowsMut, reflect_rows, reflect_rows_four};
use crate::table::RowTable;
use crate::tall::solve_tall;
use crate::vector::{add_scaled, dot, norm, reflector};

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
    /// Variables that are not at a bound.
    pub(crate) free: Vec<usize>,
    /// Variables that are, in the order of the variables.
    pub(crate) bounded: Vec<usize>,
    /// Rows of the table, stacked; pivots of a group stand first in it.
    pub(crate) stacked: Vec<usize>,
    pub(crate) groups: Vec<Group>,
    /// L, a stacked row in `n` entries.
    rows: Vec<f64>,
    target: Vec<f64>,
    /// Of stacked rows, the square of what no pivot has taken, and what it was when computed last.
    rest: Vec<f64>,
    measured: Vec<f64>,
    /// Of stacked rows, the square of the norm.
    square: Vec<f64>,
    /// Stacked row of each pivot.
    pub(crate) pivots: Vec<usize>,
    reflectors: Vec<f64>,
    tau: Vec<f64>,
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
        Self {
            n,
            free: Vec::with_capacity(n),
            bounded: Vec::with_capacity(n),
            stacked: Vec::with_capacity(count),
            groups: Vec::with_capacity(2 * table.levels.len()),
            rows: vec![0.0; count * n],
            target: vec![0.0; count],
            rest: vec![0.0; count],
            measured: vec![0.0; count],
            square: vec![0.0; count],
            pivots: Vec::with_capacity(n),
            reflectors: vec![0.0; n * n],
            tau: vec![0.0; n],
            y: vec![0.0; n],
            turned: vec![0.0; n],
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
        for group in 0..self.groups.len() {
            self.eliminate(group, tolerance);
            if !self.decide(table, group, tolerance) {
                return false;
            }
        }
        self.turn_back();
        true
    }

    fn take_bounds(&mut self, table: &RowTable, state: &[RowState]) {
        self.free.clear();
        self.bounded.clear();
        self.x.fill(0.0);
        for i in 0..self.n {
            match state[i] {
                RowState::Lower | RowState::Upper | RowState::Equal => {
                    self.x[i] = bound(table, state, i);
                    self.bounded.push(i);
                }
                _ => self.free.push(i),
            }
        }
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
                let start = self.stacked.len();
                for id in ids.filter(|&id| state[id].is_active() && table.row(id).norm() > 0.0) {
                    self.push(table, state, id);
                }
                let end = self.stacked.len();
                if end > start || linear_of.is_some() {
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
        let row = &mut self.rows[at * self.n..at * self.n + self.free.len()];
        for (entry, &variable) in row.iter_mut().zip(&self.free) {
            *entry = coefficients[variable];
        }
        let known: f64 = self.bounded.iter().map(|&i| coefficients[i] * self.x[i]).sum();
        self.target[at] = bound(table, state, id) - known;
        self.square[at] = table.row(id).norm().powi(2);
        self.stacked.push(id);
    }

    /// Reflections that turn the group's rows onto coordinates of their own.
    fn eliminate(&mut self, group: usize, tolerance: f64) {
        let (n, k) = (self.n, self.free.len());
        let Group { start, end, .. } = self.groups[group];
        let first_pivot = self.pivots.len();
        self.groups[group].first_pivot = first_pivot;
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
            let reflection = &mut self.reflectors[step * n..step * n + k];
            reflection[first_pivot..step].fill(0.0);
            let v = &mut reflection[step..];
            v.copy_from_slice(row);
            let (tau, image) = reflector(v);
            row[0] = image;
            self.tau[step] = tau;
            let data = &mut below[..(end - at - 1) * n];
            reflect_rows(&mut RowsMut { data, stride: n }, step, v, tau);
            let taken = self.rows.iter().skip((at + 1) * n + step).step_by(n);
            for (rest, entry) in self.rest[at + 1..end].iter_mut().zip(taken) {
                *rest -= entry * entry;
            }
            self.pivots.push(at);
            self.groups[group].rank += 1;
        }
        self.turn_below(end, first_pivot);
    }

    /// Turns the rows of later groups by the reflections from `first` on.
    fn turn_below(&mut self, end: usize, first: usize) {
        let (n, k, rank) = (self.n, self.free.len(), self.pivots.len());
        let stride = n;
        let data = &mut self.rows[end * n..self.stacked.len() * n];
        let mut step = first;
        while step + 4 <= rank {
            let v = |i: usize| &self.reflectors[(step + i) * n + step..(step + i) * n + k];
            let tau = std::array::from_fn(|i| self.tau[step + i]);
            let four = FourReflections::new([v(0), v(1), v(2), v(3)], tau);
            reflect_rows_four(&mut RowsMut { data, stride }, step, &four);
            step += 4;
        }
        for step in step..rank {
            let v = &self.reflectors[step * n + step..step * n + k];
            reflect_rows(&mut RowsMut { data, stride }, step, v, self.tau[step]);
        }
    }

    /// Squares of what remains of rows from column `step` on.
    fn measure(&mut self, rows: std::ops::Range<usize>, step: usize) {
        for at in rows {
            let row = &self.rows[at * self.n + step..at * self.n + self.free.len()];
            self.rest[at] = dot(row, row);
            self.measured[at] = self.rest[at];
        }
    }

    /// The row with the largest remainder relative to its norm.
    fn best_row(
        &mut self,
        rows: std::ops::Range<usize>,
        step: usize,
        tolerance: f64,
    ) -> Option<usize> {
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
        let mut largest = tolerance.powi(2);
        for (i, (&rest, &square)) in
            self.rest[rows.clone()].iter().zip(&self.square[rows]).enumerate()
        {
            if rest > largest * square {
                largest = rest / square;
                best = Some(first + i);
            }
        }
        best
    }

    fn swap(&mut self, i: usize, j: usize) {
        if i != j {
            let n = self.n;
            let (head, tail) = self.rows.split_at_mut(j * n);
            head[i * n..(i + 1) * n].swap_with_slice(&mut tail[..n]);
            self.target.swap(i, j);
            self.stacked.swap(i, j);
            self.rest.swap(i, j);
            self.measured.swap(i, j);
            self.square.swap(i, j);
        }
    }

    /// The coordinates that the group decides; false if its linear term has no minimum.
    fn decide(&mut self, table: &RowTable, group: usize, tolerance: f64) -> bool {
        let n = self.n;
        let Group { purpose, start, end, rank, first_pivot, linear_of, .. } = self.groups[group];
        if let Some(level) = linear_of {
            let decided = first_pivot + rank;
            let size = self.turn_linear(table, level);
            if norm(&self.linear[level * n + decided..level * n + self.free.len()])
                > tolerance * size
            {
                return false;
            }
            self.decide_tall(start, end, rank, first_pivot, linear_of);
        } else if purpose == Purpose::Held || rank == end - start {
            for (offset, at) in (start..start + rank).enumerate() {
                let pivot = first_pivot + offset;
                let row = &self.rows[at * n..(at + 1) * n];
                let known = dot(&row[..pivot], &self.y[..pivot]);
                self.y[pivot] = (self.target[at] - known) / row[pivot];
            }
        } else if rank > 0 {
            self.decide_tall(start, end, rank, first_pivot, None);
        }
        true
    }

    /// Takes a level's linear term into the coordinates y; its size.
    fn turn_linear(&mut self, table: &RowTable, level: usize) -> f64 {
        let (n, k) = (self.n, self.free.len());
        let source = &table.levels[level].linear;
        let linear = &mut self.linear[level * n..level * n + k];
        for (entry, &variable) in linear.iter_mut().zip(&self.free) {
            *entry = source[variable];
        }
        for step in 0..self.pivots.len() {
            let v = &self.reflectors[step * n + step..step * n + k];
            let part = &mut linear[step..];
            let weight = self.tau[step] * dot(part, v);
            add_scaled(part, -weight, v);
        }
        norm(source)
    }

    /// min ½‖L t − c‖² + d₁ᵀt over the group's own coordinates t, L tall.
    fn decide_tall(
        &mut self,
        start: usize,
        end: usize,
        rank: usize,
        first: usize,
        linear_of: Option<usize>,
    ) {
        let (n, m) = (self.n, end - start);
        for (i, at) in (start..end).enumerate() {
            let row = &self.rows[at * n..at * n + first + rank];
            self.tall_target[i] = self.target[at] - dot(&row[..first], &self.y[..first]);
            for (column, &entry) in row[first..].iter().enumerate() {
                self.tall[column * m + i] = if column <= i { entry } else { 0.0 };
            }
        }
        let linear = linear_of.map(|level| {
            let from = &self.linear[level * n + first..level * n + first + rank];
            let to = &mut self.turned[..rank];
            to.copy_from_slice(from);
            to
        });
        let out = &mut self.y[first..first + rank];
        solve_tall(&mut self.tall[..rank * m], &mut self.tall_target[..m], linear, out);
    }

    /// x from y.
    fn turn_back(&mut self) {
        let (n, k, rank) = (self.n, self.free.len(), self.pivots.len());
        // y is read again for multipliers: turn a copy.
        let z = &mut self.turned;
        z[..rank].copy_from_slice(&self.y[..rank]);
        z[rank..k].fill(0.0);
        for step in (0..rank).rev() {
            let v = &self.reflectors[step * n + step..step * n + k];
            reflect_rows(&mut RowsMut { data: &mut z[..k], stride: k }, step, v, self.tau[step]);
        }
        for (&variable, &value) in self.free.iter().zip(z.iter()) {
            self.x[variable] = value;
        }
    }
}

impl Factorisation {
    /// Multipliers μ of the pivots before `first_pivot` that balance a gradient whose
    /// coordinates stand in `coordinates`: Σ μᵢ Lᵢ = −coordinates. Overwrites it with μ.
    pub(crate) fn balance(&self, coordinates: &mut [f64]) {
        let n = self.n;
        for pivot in (0..coordinates.len()).rev() {
            let at = self.pivots[pivot];
            let row = &self.rows[at * n..(at + 1) * n];
            let multiplier = -coordinates[pivot] / row[pivot];
            add_scaled(&mut coordinates[..pivot], multiplier, &row[..pivot]);
            coordinates[pivot] = multiplier;
        }
    }

    /// Adds `weight` times the first coordinates of a stacked row.
    pub(crate) fn add_row(&self, at: usize, weight: f64, coordinates: &mut [f64]) {
        let row = &self.rows[at * self.n..at * self.n + coordinates.len()];
        add_scaled(coordinates, weight, row);
    }

    /// Adds `weight` times the entries of a row that belong to variables at a bound.
    pub(crate) fn add_at_bounds(&self, row: &[f64], weight: f64, gradient: &mut [f64]) {
        for &variable in &self.bounded {
            gradient[variable] += weight * row[variable];
        }
    }

    /// Adds the first coordinates of a level's linear term.
    pub(crate) fn add_linear(&self, level: usize, coordinates: &mut [f64]) {
        let linear = &self.linear[level * self.n..level * self.n + coordinates.len()];
        add_scaled(coordinates, 1.0, linear);
    }

    /// y, the coordinates decided.
    pub(crate) fn decided(&self) -> &[f64] {
        &self.y[..self.pivots.len()]
    }
}
