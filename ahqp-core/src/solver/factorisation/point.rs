//! The point that a factorisation gives, and multipliers.

use std::ops::Range;

use super::{Factorisation, Group, LANES, Purpose, aligned};
use crate::linalg::kernels::{
    FourReflections, RowsMut, add_rows, multiply_rows, reflect_rows, reflect_rows_four,
};
use crate::linalg::tall::solve_tall;
use crate::linalg::vector::{add_scaled, dot, norm};
use crate::solver::data::RowTable;
use crate::solver::tolerances::ROUNDING;

impl Factorisation {
    /// The coordinates that the levels decide, and x; false if a linear term falls for ever along
    /// what they leave open.
    pub(super) fn find_point(&mut self, table: &RowTable, tolerance: f64) -> bool {
        for group in 0..self.groups.len() {
            if !self.decide(table, group, tolerance) {
                return false;
            }
        }
        self.turn_back();
        true
    }

    /// The coordinates that the group decides; false if its linear term has no minimum.
    fn decide(&mut self, table: &RowTable, group: usize, tolerance: f64) -> bool {
        let n = self.stride;
        let Group { purpose, start, end, rank, first_pivot, linear_of, .. } = self.groups[group];
        if let Some(level) = linear_of {
            let decided = first_pivot + rank;
            let size = self.turn_linear(table, level);
            if norm(&self.linear[level * self.n + decided..level * self.n + self.free.len()])
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
        let mut linear = std::mem::take(&mut self.linear);
        self.coordinates(source, &mut linear[level * n..level * n + k]);
        self.linear = linear;
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
        let (n, m) = (self.stride, end - start);
        multiply_rows(&self.rows[start * n..], n, &self.y[..first], &mut self.tall_target[..m]);
        for (i, at) in (start..end).enumerate() {
            let row = &self.rows[at * n + first..at * n + first + rank];
            self.tall_target[i] = self.target[at] - self.tall_target[i];
            for (column, &entry) in row.iter().enumerate() {
                self.tall[column * m + i] = if column <= i { entry } else { 0.0 };
            }
        }
        let linear = linear_of.map(|level| {
            let from = &self.linear[level * self.n + first..level * self.n + first + rank];
            let to = &mut self.turned[..rank];
            to.copy_from_slice(from);
            to
        });
        let out = &mut self.y[first..first + rank];
        solve_tall(&mut self.tall[..rank * m], &mut self.tall_target[..m], linear, out);
    }

    /// Takes a vector over the free variables, with zeros behind it, into the coordinates of Q.
    pub(super) fn turn(&self, vector: &mut [f64]) {
        for (block, factor) in self.blocks.iter().enumerate() {
            let four = FourReflections::new(self.block(block), factor);
            reflect_rows_four(&mut only_row(vector), block * LANES, &four);
        }
        for step in self.blocks.len() * LANES..self.reflections {
            self.reflect(step, vector);
        }
        for step in &self.moves {
            step.apply(&self.rotations, vector);
        }
    }

    /// x from y.
    fn turn_back(&mut self) {
        let rank = self.pivots.len();
        // y is read again for multipliers: turn a copy.
        let mut z = std::mem::take(&mut self.turned);
        z[..rank].copy_from_slice(&self.y[..rank]);
        z[rank..].fill(0.0);
        for step in self.moves.iter().rev() {
            step.undo(&self.rotations, &mut z);
        }
        for step in (self.blocks.len() * LANES..self.reflections).rev() {
            self.reflect(step, &mut z);
        }
        for (block, factor) in self.blocks.iter().enumerate().rev() {
            let four = FourReflections::reversed(self.block(block), factor);
            reflect_rows_four(&mut only_row(&mut z), block * LANES, &four);
        }
        for (&variable, &value) in self.free.iter().zip(&z) {
            self.x[variable] = value;
        }
        self.turned = z;
    }

    /// Applies one of the reflections to a vector.
    fn reflect(&self, step: usize, vector: &mut [f64]) {
        let first = aligned(step);
        let v = &self.reflectors[step * self.stride..][first..self.reflected_lanes()];
        reflect_rows(&mut only_row(vector), first, v, self.tau[step]);
    }
}

/// A vector as a matrix of one row.
fn only_row(vector: &mut [f64]) -> RowsMut<'_> {
    RowsMut { stride: vector.len(), data: vector }
}

impl Factorisation {
    /// Multipliers μ of the pivots before `first_pivot` that balance a gradient whose
    /// coordinates stand in `coordinates`: Σ μᵢ Lᵢ = −coordinates. Overwrites it with μ.
    pub(crate) fn balance(&self, coordinates: &mut [f64]) {
        let n = self.stride;
        for pivot in (0..coordinates.len()).rev() {
            let at = self.pivots[pivot];
            let row = &self.rows[at * n..(at + 1) * n];
            let multiplier = -coordinates[pivot] / row[pivot];
            add_scaled(&mut coordinates[..pivot], multiplier, &row[..pivot]);
            coordinates[pivot] = multiplier;
        }
    }

    /// The rounding in the multipliers of [`balance`](Self::balance), given that in the coordinates,
    /// which it replaces. `norm` is that of a row.
    pub(crate) fn balance_rounding(
        &self,
        multipliers: &[f64],
        norm: impl Fn(usize) -> f64,
        rounding: &mut [f64],
    ) {
        let n = self.stride;
        for pivot in (0..multipliers.len()).rev() {
            let at = self.pivots[pivot];
            let row = &self.rows[at * n..at * n + pivot];
            let size = ROUNDING * multipliers[pivot].abs();
            let turned = size * norm(self.stacked[at]);
            let of_pivot = rounding[pivot] / self.rows[at * n + pivot].abs() + size;
            rounding[pivot] = of_pivot;
            for (rounding, entry) in rounding[..pivot].iter_mut().zip(row) {
                *rounding += of_pivot * entry.abs() + turned;
            }
        }
    }

    /// Replaces the residuals of a group's pivots by those that balance the others, and the linear
    /// term, along the coordinates that the group decides, as they do at its minimum. A heavy row's
    /// residual may be far below the rounding of its own terms. `rounding` is that in the residuals;
    /// both are in the order of the stack.
    pub(crate) fn balance_group(
        &self,
        table: &RowTable,
        group: usize,
        residual: &mut [f64],
        rounding: &mut [f64],
    ) {
        let Group { start, rank, first_pivot, linear_of, .. } = self.groups[group];
        for pivot in (0..rank).rev() {
            let coordinate = first_pivot + pivot;
            let linear = linear_of.map_or(0.0, |level| self.linear[level * self.n + coordinate]);
            let (mut sum, mut doubt) = (linear, ROUNDING * linear.abs());
            let entries = self.rows[start * self.stride + coordinate..].iter().step_by(self.stride);
            let terms = residual.iter().zip(rounding.iter()).zip(&self.stacked[start..]);
            for (entry, ((residual, rounding), &id)) in entries.zip(terms).skip(pivot + 1) {
                sum += entry * residual;
                // Each entry has the rounding of its whole row.
                doubt += entry.abs() * rounding + table.entry_rounding(id) * residual.abs();
            }
            let own = self.rows[(start + pivot) * self.stride + coordinate];
            (residual[pivot], rounding[pivot]) = (-sum / own, doubt / own.abs());
        }
    }

    /// The first coordinates of a vector over all variables.
    pub(crate) fn coordinates(&mut self, vector: &[f64], out: &mut [f64]) {
        let (mut turned, k) = (std::mem::take(&mut self.turned), self.free.len());
        for (entry, &variable) in turned.iter_mut().zip(&self.free) {
            *entry = vector[variable];
        }
        turned[k..].fill(0.0);
        self.turn(&mut turned);
        out.copy_from_slice(&turned[..out.len()]);
        self.turned = turned;
    }

    /// Adds the first coordinates of stacked rows, times their weights.
    pub(crate) fn add_rows(&self, rows: Range<usize>, weights: &[f64], coordinates: &mut [f64]) {
        add_rows(&self.rows[rows.start * self.stride..], self.stride, weights, coordinates);
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
