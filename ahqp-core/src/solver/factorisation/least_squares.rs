//! Least squares of one group: its pivots and the rows that depend on them.

use super::{Factorisation, Group, LANES};
use crate::linalg::kernels::{RowsMut, mix_rows, multiply_rows};
use crate::linalg::vector::{add_scaled, dot, norm, reflector};
use crate::solver::data::ProblemData;
use crate::solver::tolerances::ROUNDING;

/// Working memory of one least-squares problem, allocated once.
#[derive(Debug, Clone)]
pub(super) struct LeastSquares {
    /// One pivot row and all dependent rows, with `stride` entries each.
    stack: Vec<f64>,
    /// Remaining target of each of these rows.
    target: Vec<f64>,
    /// The factor L' and its targets.
    triangular: Vec<f64>,
    triangular_target: Vec<f64>,
    /// Target of each row of the group, less the contribution of the coordinates of earlier groups.
    remaining: Vec<f64>,
    column: Vec<f64>,
    /// The group's own coordinates at the minimum.
    solution: Vec<f64>,
}

impl LeastSquares {
    pub(super) fn new(variables: usize, rows: usize) -> Self {
        let stride = variables.next_multiple_of(LANES);
        Self {
            stack: vec![0.0; (rows + 1) * stride],
            target: vec![0.0; rows + 1],
            triangular: vec![0.0; variables * stride],
            triangular_target: vec![0.0; variables],
            remaining: vec![0.0; rows],
            column: vec![0.0; rows + 1],
            solution: vec![0.0; variables],
        }
    }

    /// Reflects column `j` of the stack, with `width` entries in use, into the pivot row, which is
    /// the first. `least` is a target below which the forces of rows may balance each other.
    fn reflect(&mut self, j: usize, count: usize, stride: usize, least: f64) {
        let (column, target) = (&mut self.column[..=count], &mut self.target[..=count]);
        for (entry, row) in column.iter_mut().zip(self.stack.chunks_exact(stride)) {
            *entry = row[j];
        }
        let sum = dot(column, target);
        // The sum can be the rounding of its terms only below this threshold.
        let may_balance = sum.powi(2) <= least.powi(2) * dot(column, column);
        let balances = may_balance && {
            let terms = column.iter().zip(target.iter()).map(|(entry, target)| entry * target);
            sum.abs() <= ROUNDING * terms.map(f64::abs).sum::<f64>()
        };
        let (tau, _) = reflector(column);
        let data = &mut self.stack[..(count + 1) * stride];
        mix_rows(&mut RowsMut { data, stride }, (j + 1).next_multiple_of(LANES), column, tau);
        add_scaled(target, -tau * dot(column, target), column);
        // Forces that balance each other move nothing.
        if balances {
            target[0] = 0.0;
        }
    }
}

impl Factorisation {
    /// Computes the group's own coordinates at the minimum of its least squares. Coordinates before
    /// `from` are taken as zero.
    pub(super) fn decide_least_squares(&mut self, data: &ProblemData, group: usize, from: usize) {
        let n = self.stride;
        let Group { start, end, rank, first_pivot: first, linear_of, .. } = self.groups[group];
        let remaining = &mut self.least_squares.remaining[..end - start];
        multiply_rows(&self.rows[start * n + from..], n, &self.y[from..first], remaining);
        for (remaining, target) in remaining.iter_mut().zip(&self.target[start..end]) {
            *remaining = target - *remaining;
        }
        self.solve_least_squares(data, group, linear_of);
        self.y[first..first + rank].copy_from_slice(&self.least_squares.solution[..rank]);
    }

    /// Returns the rounding in the residual of the stacked row `at` of the group that comes from the
    /// rows that decide x.
    ///
    /// The minimum follows the targets. Errors δ of these change the residuals by (I − P) δ, where P
    /// projects onto the range of the rows. No share of an error exceeds one, also where rows nearly
    /// agree. The rows summed with these shares depend on the pivots of earlier groups alone, and
    /// show the share of their errors.
    pub(crate) fn rounding_of_point(
        &mut self,
        data: &ProblemData,
        group: usize,
        at: usize,
        x_norm: f64,
    ) -> f64 {
        let n = self.stride;
        let Group { start, end, rank, first_pivot: first, .. } = self.groups[group];
        self.least_squares.remaining[..end - start].fill(0.0);
        self.least_squares.remaining[at - start] = 1.0;
        self.solve_least_squares(data, group, None);
        let LeastSquares { remaining, solution, .. } = &self.least_squares;
        let mut left = std::mem::take(&mut self.turned);
        left.fill(0.0);
        let mut rounding = 0.0;
        for (index, unit) in remaining[..end - start].iter().enumerate() {
            let (place, width) = ((start + index) * n, rank.min(index + 1));
            let row = &self.rows[place..place + first + width];
            let share = unit - dot(&row[first..], &solution[..width]);
            rounding += share.abs() * data.rounding(self.stacked[start + index], x_norm);
            add_scaled(&mut left[..first], share, &row[..first]);
        }
        for coordinate in (0..first).rev() {
            let pivot = self.pivots[coordinate];
            let row = &self.rows[pivot * n..=pivot * n + coordinate];
            let part = left[coordinate] / row[coordinate];
            add_scaled(&mut left[..coordinate], -part, &row[..coordinate]);
            rounding += part.abs() * data.rounding(self.stacked[pivot], x_norm);
        }
        self.turned = left;
        rounding
    }

    /// Minimises ½‖[L; D] t − c‖² + dᵀt over the group's own coordinates t, with pivots L and
    /// dependent rows D. The targets c are `remaining`.
    ///
    /// From the last column to the first, a reflection of a pivot row and all dependent rows
    /// removes the column from the dependent rows: [L; D] = Q' [L'; 0] with a lower triangular L'.
    /// The pivots are the heavier rows.
    fn solve_least_squares(&mut self, data: &ProblemData, group: usize, linear_of: Option<usize>) {
        let n = self.stride;
        let Group { start, end, rank, first_pivot: first, .. } = self.groups[group];
        if rank == 0 {
            return;
        }
        let stride = rank.next_multiple_of(LANES);
        let count = end - start - rank;
        let squares = &mut self.least_squares;
        let least = ROUNDING * norm(&squares.remaining[..end - start]);
        let entries = |index: usize, width: usize| {
            let place = (start + index) * n + first;
            &self.rows[place..place + width]
        };
        squares.target[1..=count].copy_from_slice(&squares.remaining[rank..end - start]);
        for (index, row) in (rank..).zip(squares.stack.chunks_exact_mut(stride).skip(1)).take(count)
        {
            // Rounding of rotations of a heavy row would act as a force on light rows.
            let nothing = ROUNDING * data.norm(self.stacked[start + index]);
            for (to, &entry) in row.iter_mut().zip(entries(index, rank)) {
                *to = if entry.abs() <= nothing { 0.0 } else { entry };
            }
            row[rank..].fill(0.0);
        }
        for j in (0..rank).rev() {
            squares.stack[..=j].copy_from_slice(entries(j, j + 1));
            squares.stack[j + 1..stride].fill(0.0);
            squares.target[0] = squares.remaining[j];
            if count > 0 {
                squares.reflect(j, count, stride, least);
            }
            let row = j * stride;
            squares.triangular[row..=row + j].copy_from_slice(&squares.stack[..=j]);
            squares.triangular_target[j] = squares.target[0];
        }
        let LeastSquares { triangular, triangular_target: target, solution: y, .. } = squares;
        let row = |j: usize| &triangular[j * stride..=j * stride + j];
        if let Some(level) = linear_of {
            // Solves L'ᵀ (L' t − c') = −d.
            let linear = &mut self.turned[..rank];
            let from = level * self.n + first;
            linear.copy_from_slice(&self.linear[from..from + rank]);
            for j in (0..rank).rev() {
                let part = linear[j] / row(j)[j];
                target[j] -= part;
                add_scaled(&mut linear[..j], -part, row(j));
            }
        }
        for j in 0..rank {
            y[j] = (target[j] - dot(&row(j)[..j], &y[..j])) / row(j)[j];
        }
    }
}
