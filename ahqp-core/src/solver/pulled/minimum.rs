//! The minimum of the rows that a search pulls, and the residuals there.

use super::Pulled;
use crate::linalg::kernels::multiply_rows;
use crate::linalg::vector::{add_scaled, dot, solve_positive_definite};
use crate::solver::basis::Basis;
use crate::solver::data::RowTable;

/// Rows of D are combinations of the pivots with weights up to this; larger ones cost digits.
const LARGEST_WEIGHT: f64 = 1e2;

impl Pulled {
    /// min ½‖[L; D] t − c‖² over the pulled directions, `target` giving c of a row; none when the
    /// rows cannot be trusted for it.
    pub(crate) fn solve(
        &mut self,
        basis: &mut Basis,
        table: &RowTable,
        target: impl Fn(usize) -> f64,
    ) -> Option<&[f64]> {
        self.exchange(basis, table);
        if !self.sound {
            return None;
        }
        for (entry, &id) in self.target.iter_mut().zip(&self.rows) {
            *entry = target(id);
        }
        let (rank, stride) = (self.rank, self.stride);
        let dependent = self.rows.len() - rank;
        if dependent > 0 && rank > 0 {
            self.balance_dependent(dependent);
        }
        for j in 0..rank {
            let column = &self.columns[j * stride..j * stride + rank];
            let entry = self.target[j] / column[j];
            self.step[j] = entry;
            add_scaled(&mut self.target[j + 1..rank], -entry, &column[j + 1..]);
        }
        Some(&self.step[..rank])
    }

    /// Replaces the residuals of the pivots by those that balance the dependent rows along the pulled
    /// directions, as they do at the minimum: Lᵀr₁ = −Dᵀr₂. A heavy row's residual may be far below
    /// the rounding of its own terms. `rounding` is that in the residuals; both are by row.
    pub(crate) fn balance(&self, table: &RowTable, residual: &mut [f64], rounding: &mut [f64]) {
        for j in (0..self.rank).rev() {
            let column = &self.columns[j * self.stride..j * self.stride + self.rows.len()];
            let (mut sum, mut doubt) = (0.0, 0.0);
            for (&entry, &id) in column.iter().zip(&self.rows).skip(j + 1) {
                sum += entry * residual[id];
                // Each entry has the rounding of its whole row.
                doubt += entry.abs() * rounding[id] + table.entry_rounding(id) * residual[id].abs();
            }
            let id = self.rows[j];
            residual[id] = -sum / column[j];
            rounding[id] = doubt / column[j].abs();
        }
    }

    /// Makes pivots of the rows on which others depend the most, so that rows of D are combinations
    /// of the pivots with small weights. Each exchange enlarges the determinant of L.
    fn exchange(&mut self, basis: &mut Basis, table: &RowTable) {
        for _ in 0..2 * self.rows.len() {
            let dependent = self.rows.len() - self.rank;
            if !self.sound || dependent == 0 || self.rank == 0 {
                return;
            }
            let Err(pivot) = self.weigh_dependent(dependent) else { return };
            self.demote(basis, pivot);
            self.adopt(table);
        }
        self.give_up();
    }

    /// E with D = E L; the pivot of an entry that is so large that digits are lost, if there is one.
    fn weigh_dependent(&mut self, dependent: usize) -> Result<(), usize> {
        let (n, rank, stride) = (self.coordinates.len(), self.rank, self.stride);
        let known = &mut self.carry[..dependent];
        for j in (0..rank).rev() {
            let column = &self.columns[j * stride..(j + 1) * stride];
            let later = &self.weights[j + 1..j + 1 + dependent * n];
            multiply_rows(later, n, &column[j + 1..rank], known);
            let entries = self.weights.iter_mut().skip(j).step_by(n);
            for ((entry, &part), &known) in entries.zip(&column[rank..]).zip(known.iter()) {
                *entry = (part - known) / column[j];
                if entry.abs() > LARGEST_WEIGHT {
                    return Err(j);
                }
            }
        }
        Ok(())
    }

    /// min ‖u − c₁‖² + ‖E u − c₂‖²: leaves u in place of c₁.
    fn balance_dependent(&mut self, dependent: usize) {
        let (n, rank) = (self.coordinates.len(), self.rank);
        let (c1, c2) = self.target.split_at_mut(rank);
        let c2 = &mut c2[..dependent];
        let rows = || self.weights.chunks_exact(n).take(dependent).map(|row| &row[..rank]);
        if dependent <= rank {
            // u = c₁ + Eᵀs with (I + EEᵀ) s = c₂ − E c₁.
            let system = &mut self.system[..dependent * dependent];
            for (i, row) in rows().enumerate() {
                c2[i] -= dot(row, c1);
                for (j, other) in rows().take(i + 1).enumerate() {
                    system[i * dependent + j] = dot(row, other) + f64::from(u8::from(i == j));
                }
            }
            solve_positive_definite(system, c2);
            for (row, &s) in rows().zip(c2.iter()) {
                add_scaled(c1, s, row);
            }
        } else {
            // (I + EᵀE) u = c₁ + Eᵀc₂.
            let system = &mut self.system[..rank * rank];
            system.fill(0.0);
            for (i, entry) in system.iter_mut().step_by(rank + 1).enumerate() {
                debug_assert!(i < rank);
                *entry = 1.0;
            }
            for (row, &c) in rows().zip(c2.iter()) {
                add_scaled(c1, c, row);
                for (i, &weight) in row.iter().enumerate() {
                    add_scaled(&mut system[i * rank..=i * rank + i], weight, &row[..=i]);
                }
            }
            solve_positive_definite(system, c1);
        }
    }
}
