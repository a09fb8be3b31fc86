//! One orthogonal factorisation of all levels, for a given active set.
//!
//! Active bounds leave as columns. The active rows that remain are stacked by priority,
//! [H₀ O₀ H₁ O₁ …]: a level's hard rows at their bounds, then the rows of its objective. They are
//! factored from the right, A = [L 0] Qᵀ, with pivoting inside each group, so that the
//! coordinates y = Qᵀx which a level decides are those that no level above has used. Coordinates
//! that no level decides stay zero: the least norm.

use crate::active_set::RowState;
use crate::kernels::{RowsMut, reflect_rows};
use crate::table::RowTable;
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
    pub(crate) purpose: Purpose,
    /// Stacked rows `start..end`, and of them the pivots `start..start + rank`.
    pub(crate) start: usize,
    pub(crate) end: usize,
    pub(crate) rank: usize,
    /// Coordinates decided before this group.
    pub(crate) first_pivot: usize,
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
    /// Stacked row of each pivot.
    pub(crate) pivots: Vec<usize>,
    reflectors: Vec<f64>,
    tau: Vec<f64>,
    y: Vec<f64>,
    turned: Vec<f64>,
    tall: Vec<f64>,
    tall_target: Vec<f64>,
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
            pivots: Vec::with_capacity(n),
            reflectors: vec![0.0; n * n],
            tau: vec![0.0; n],
            y: vec![0.0; n],
            turned: vec![0.0; n],
            tall: vec![0.0; count * n],
            tall_target: vec![0.0; count],
            x: vec![0.0; n],
        }
    }

    /// Factors the rows that are active in `state` and computes x.
    pub(crate) fn factorise(&mut self, table: &RowTable, state: &[RowState], tolerance: f64) {
        self.take_bounds(table, state);
        self.stack(table, state);
        self.pivots.clear();
        for group in 0..self.groups.len() {
            self.eliminate(table, group, tolerance);
            self.decide(group);
        }
        self.turn_back();
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
        for rows in &table.levels {
            for (purpose, ids) in [
                (Purpose::Held, rows.constraints.clone()),
                (Purpose::Minimised, rows.used_objective()),
            ] {
                let start = self.stacked.len();
                for id in ids.filter(|&id| state[id].is_active() && table.row(id).norm() > 0.0) {
                    self.push(table, state, id);
                }
                let end = self.stacked.len();
                if end > start {
                    self.groups.push(Group { purpose, start, end, rank: 0, first_pivot: 0 });
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
        self.stacked.push(id);
    }

    /// Reflections that turn the group's rows onto coordinates of their own.
    fn eliminate(&mut self, table: &RowTable, group: usize, tolerance: f64) {
        let (n, k) = (self.n, self.free.len());
        let Group { start, end, .. } = self.groups[group];
        self.groups[group].first_pivot = self.pivots.len();
        for at in start..end {
            let step = self.pivots.len();
            if step == k {
                break;
            }
            let Some(pivot) = self.best_row(table, at..end, step, tolerance) else { break };
            self.swap(at, pivot);
            let (above, below) = self.rows.split_at_mut((at + 1) * n);
            let row = &mut above[at * n + step..at * n + k];
            let v = &mut self.reflectors[step * n + step..step * n + k];
            v.copy_from_slice(row);
            let (tau, image) = reflector(v);
            row[0] = image;
            self.tau[step] = tau;
            let data = &mut below[..(self.stacked.len() - at - 1) * n];
            reflect_rows(&mut RowsMut { data, stride: n }, step, v, tau);
            self.pivots.push(at);
            self.groups[group].rank += 1;
        }
    }

    /// The row with the largest remainder relative to its norm.
    fn best_row(
        &self,
        table: &RowTable,
        rows: std::ops::Range<usize>,
        step: usize,
        tolerance: f64,
    ) -> Option<usize> {
        let mut best = None;
        let mut largest = tolerance;
        for at in rows {
            let rest = norm(&self.rows[at * self.n + step..at * self.n + self.free.len()]);
            let length = table.row(self.stacked[at]).norm();
            if rest > largest * length {
                largest = rest / length;
                best = Some(at);
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
        }
    }

    /// The coordinates that the group decides.
    fn decide(&mut self, group: usize) {
        let n = self.n;
        let Group { purpose, start, end, rank, first_pivot, .. } = self.groups[group];
        if purpose == Purpose::Held || rank == end - start {
            for (offset, at) in (start..start + rank).enumerate() {
                let pivot = first_pivot + offset;
                let row = &self.rows[at * n..(at + 1) * n];
                let known = dot(&row[..pivot], &self.y[..pivot]);
                self.y[pivot] = (self.target[at] - known) / row[pivot];
            }
        } else if rank > 0 {
            self.decide_tall(start, end, rank, first_pivot);
        }
    }

    /// min ‖L t − c‖ over the group's own coordinates t, L tall, by reflections from the left.
    fn decide_tall(&mut self, start: usize, end: usize, rank: usize, first: usize) {
        let (n, m) = (self.n, end - start);
        for (i, at) in (start..end).enumerate() {
            let row = &self.rows[at * n..at * n + first + rank];
            self.tall_target[i] = self.target[at] - dot(&row[..first], &self.y[..first]);
            for (column, &entry) in row[first..].iter().enumerate() {
                self.tall[column * m + i] = if column <= i { entry } else { 0.0 };
            }
        }
        for column in 0..rank {
            let (left, right) = self.tall.split_at_mut((column + 1) * m);
            let v = &mut left[column * m + column..];
            let (tau, image) = reflector(v);
            for other in right.chunks_exact_mut(m).take(rank - column - 1) {
                let part = &mut other[column..];
                let weight = tau * dot(part, v);
                add_scaled(part, -weight, v);
            }
            let part = &mut self.tall_target[column..m];
            let weight = tau * dot(part, v);
            add_scaled(part, -weight, v);
            v[0] = image;
        }
        for i in (0..rank).rev() {
            let known: f64 = (i + 1..rank).map(|j| self.tall[j * m + i] * self.y[first + j]).sum();
            self.y[first + i] = (self.tall_target[i] - known) / self.tall[i * m + i];
        }
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
            let part = &mut z[step..k];
            let weight = self.tau[step] * dot(part, v);
            add_scaled(part, -weight, v);
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

    /// y, the coordinates decided.
    pub(crate) fn decided(&self) -> &[f64] {
        &self.y[..self.pivots.len()]
    }
}

/// The bound that an active row is at, or is pulled towards.
pub(crate) fn bound(table: &RowTable, state: &[RowState], id: usize) -> f64 {
    match state[id] {
        RowState::Lower => table.lower[id],
        _ => table.upper[id],
    }
}
