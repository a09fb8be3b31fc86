//! Least squares of one group: its pivots and the rows that depend on them.

use super::{Factorisation, Group, LANES};
use crate::linalg::kernels::{RowsMut, multiply_rows, rows, rows_mut, triangularise};
use crate::linalg::vector::{add_scaled, dot, norm};
use crate::solver::data::ProblemData;
use crate::solver::tolerances::ROUNDING;

/// Working memory of one least-squares problem, allocated once. Each row of a matrix begins with its
/// target.
#[derive(Debug, Clone)]
pub(super) struct LeastSquares {
    /// A row of working memory and all dependent rows.
    stack: Vec<f64>,
    /// The factor L'.
    triangular: Vec<f64>,
    /// Target of each row of the group, less the contribution of the coordinates of earlier groups.
    remaining: Vec<f64>,
    column: Vec<f64>,
    /// The group's own coordinates at the minimum.
    solution: Vec<f64>,
}

impl LeastSquares {
    pub(super) fn new(variables: usize, rows: usize) -> Self {
        let stride = (variables + 1).next_multiple_of(LANES);
        Self {
            stack: vec![0.0; (rows + 1) * stride],
            triangular: vec![0.0; variables * stride],
            remaining: vec![0.0; rows],
            column: vec![0.0; rows + 1],
            solution: vec![0.0; variables],
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
        let stride = (rank + 1).next_multiple_of(LANES);
        let count = end - start - rank;
        let LeastSquares { stack, triangular, remaining, column, solution: y } =
            &mut self.least_squares;
        let remaining = &remaining[..end - start];
        let least = ROUNDING * norm(remaining);
        let triangular = &mut triangular[..rank * stride];
        let place = |index: usize| (start + index) * n + first;
        let pivots = rows_mut(triangular, stride).zip(remaining).enumerate();
        for (index, (row, &target)) in pivots {
            row[0] = target;
            row[1..=index + 1].copy_from_slice(&self.rows[place(index)..=place(index) + index]);
        }
        if count > 0 {
            let stack = &mut stack[..(count + 1) * stride];
            let dependent = rows_mut(stack, stride).skip(1).zip(&remaining[rank..]);
            for (index, (row, &target)) in (rank..).zip(dependent) {
                // Rounding of rotations of a heavy row would act as a force on light rows.
                let nothing = ROUNDING * data.norm(self.stacked[start + index]);
                row[0] = target;
                let entries = &self.rows[place(index)..place(index) + rank];
                for (to, &entry) in row[1..].iter_mut().zip(entries) {
                    *to = if entry.abs() <= nothing { 0.0 } else { entry };
                }
            }
            let mut stack = RowsMut { data: stack, stride };
            triangularise(&mut stack, triangular, &mut column[..=count], least, ROUNDING);
        }
        if let Some(level) = linear_of {
            // Solves L'ᵀ (L' t − c') = −d.
            let linear = &mut self.turned[..rank];
            let from = level * self.n + first;
            linear.copy_from_slice(&self.linear[from..from + rank]);
            for (j, row) in triangular.chunks_exact_mut(stride).enumerate().rev() {
                let part = linear[j] / row[j + 1];
                row[0] -= part;
                add_scaled(&mut linear[..j], -part, &row[1..=j]);
            }
        }
        for (j, row) in rows(triangular, stride).enumerate() {
            y[j] = (row[0] - dot(&row[1..=j], &y[..j])) / row[j + 1];
        }
    }
}
