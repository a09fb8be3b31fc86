//! Minimum-norm least squares of one level inside the free directions.
//!
//! Minimise over z: ½‖B z − c‖² + dᵀz, and among the minimisers ‖z‖; B is m × k.
//! The rows are factored from the right with row pivoting, B = P [L 0] Qᵀ, so that a short
//! level costs little, the rank shows in the pivots, and the first columns of Q are the
//! directions that the level decides. Only where rows depend on each other is L, tall then,
//! factored once more from the left.

use crate::linalg::kernels::{RowsMut, reflect_rows};
use crate::linalg::tall::solve_tall;
use crate::linalg::vector::{add_scaled, dot, norm, reflector};

/// The problem and its factors; sized once for m and k up to given limits.
#[derive(Debug, Clone)]
pub(crate) struct LeastSquares {
    stride: usize,
    m: usize,
    k: usize,
    rank: usize,
    /// B, row after row; becomes L in its first `rank` columns.
    rows: Vec<f64>,
    target: Vec<f64>,
    norms: Vec<f64>,
    /// Reflector i in row i, from entry i on.
    reflectors: Vec<f64>,
    tau: Vec<f64>,
    tall: Vec<f64>,
    linear: Vec<f64>,
    has_linear: bool,
    solution: Vec<f64>,
}

/// Where the minimum lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Minimum {
    /// At the solution.
    Point,
    /// Infinitely far along the solution, taken as a direction.
    Ray,
}

impl LeastSquares {
    pub(crate) fn new(max_rows: usize, columns: usize) -> Self {
        let capacity = max_rows.max(1) * columns;
        Self {
            stride: columns,
            m: 0,
            k: 0,
            rank: 0,
            rows: vec![0.0; capacity],
            target: vec![0.0; max_rows],
            norms: vec![0.0; max_rows],
            reflectors: vec![0.0; columns * columns],
            tau: vec![0.0; columns],
            tall: vec![0.0; capacity.max(columns * columns)],
            linear: vec![0.0; columns],
            has_linear: false,
            solution: vec![0.0; columns],
        }
    }

    /// Starts a problem in `k` unknowns without rows.
    pub(crate) fn start(&mut self, k: usize) {
        self.m = 0;
        self.k = k;
        self.rank = 0;
        self.has_linear = false;
    }

    /// Adds a row, written by `fill`, with its target; `norm` is what ranks are relative to.
    pub(crate) fn push(&mut self, target: f64, norm: f64, fill: impl FnOnce(&mut [f64])) {
        let at = self.m * self.stride;
        fill(&mut self.rows[at..at + self.k]);
        self.target[self.m] = target;
        self.norms[self.m] = norm;
        self.m += 1;
    }

    /// Sets d.
    pub(crate) fn set_linear(&mut self, fill: impl FnOnce(&mut [f64])) {
        fill(&mut self.linear[..self.k]);
        self.has_linear = true;
    }

    /// The reflectors of the factorisation, one in `stride` entries, and their τ.
    pub(crate) fn reflectors(&self) -> (&[f64], usize, &[f64]) {
        (&self.reflectors[..self.rank * self.stride], self.stride, &self.tau[..self.rank])
    }

    /// z, or a direction; valid after [`solve`](Self::solve).
    pub(crate) fn solution(&self) -> &[f64] {
        &self.solution[..self.k]
    }

    /// Factors from the right; a row whose remaining part is below `tolerance` times its norm
    /// depends on the rows before it.
    pub(crate) fn factorise(&mut self, tolerance: f64) {
        let stride = self.stride;
        while self.rank < self.m.min(self.k) {
            let step = self.rank;
            let Some(pivot) = self.best_row(step, tolerance) else { break };
            self.swap(step, pivot);
            let (above, below) = self.rows.split_at_mut((step + 1) * stride);
            let row = &mut above[step * stride..step * stride + self.k];
            let v = &mut self.reflectors[step * stride..step * stride + self.k];
            v[step..].copy_from_slice(&row[step..]);
            let (tau, image) = reflector(&mut v[step..]);
            row[step..].fill(0.0);
            row[step] = image;
            let data = &mut below[..(self.m - step - 1) * stride];
            reflect_rows(&mut RowsMut { data, stride }, step, &v[step..], tau);
            self.tau[step] = tau;
            self.rank += 1;
        }
    }

    fn best_row(&self, step: usize, tolerance: f64) -> Option<usize> {
        let mut best = None;
        let mut largest = 0.0;
        for i in step..self.m {
            let at = i * self.stride;
            let rest = norm(&self.rows[at + step..at + self.k]);
            if rest > tolerance * self.norms[i] && rest > largest {
                largest = rest;
                best = Some(i);
            }
        }
        best
    }

    fn swap(&mut self, i: usize, j: usize) {
        if i != j {
            let (head, tail) = self.rows.split_at_mut(j * self.stride);
            head[i * self.stride..i * self.stride + self.k].swap_with_slice(&mut tail[..self.k]);
            self.target.swap(i, j);
            self.norms.swap(i, j);
        }
    }

    /// Solves after [`factorise`](Self::factorise).
    pub(crate) fn solve(&mut self, tolerance: f64) -> Minimum {
        if self.has_linear && self.follow_linear(tolerance) {
            return Minimum::Ray;
        }
        if self.rank == self.m && !self.has_linear {
            self.solve_triangular();
        } else {
            self.solve_tall();
        }
        self.solution[self.rank..self.k].fill(0.0);
        self.turn_back();
        Minimum::Point
    }

    /// Takes d into the coordinates of Q; whether it has a part that no row opposes, along
    /// which the objective falls for ever.
    fn follow_linear(&mut self, tolerance: f64) -> bool {
        let size = norm(&self.linear[..self.k]);
        for step in 0..self.rank {
            let at = step * self.stride;
            let v = &self.reflectors[at + step..at + self.k];
            let part = &mut self.linear[step..self.k];
            let weight = self.tau[step] * dot(part, v);
            add_scaled(part, -weight, v);
        }
        let free = &self.linear[self.rank..self.k];
        if norm(free) <= tolerance * size || size == 0.0 {
            return false;
        }
        self.solution[..self.rank].fill(0.0);
        for (to, from) in self.solution[self.rank..self.k].iter_mut().zip(free) {
            *to = -from;
        }
        self.turn_back();
        true
    }

    /// L t = c with L square.
    fn solve_triangular(&mut self) {
        for i in 0..self.rank {
            let row = &self.rows[i * self.stride..(i + 1) * self.stride];
            let known = dot(&row[..i], &self.solution[..i]);
            self.solution[i] = (self.target[i] - known) / row[i];
        }
    }

    /// min ½‖L t − c‖² + d₁ᵀt with L tall.
    fn solve_tall(&mut self) {
        let (m, rank) = (self.m, self.rank);
        for column in 0..rank {
            for i in 0..m {
                self.tall[column * m + i] =
                    if column <= i { self.rows[i * self.stride + column] } else { 0.0 };
            }
        }
        let linear = self.has_linear.then_some(&mut self.linear[..rank]);
        let (tall, target) = (&mut self.tall[..rank * m], &mut self.target[..m]);
        solve_tall(tall, target, linear, &mut self.solution[..rank]);
    }

    /// From the coordinates of Q back to z.
    fn turn_back(&mut self) {
        for step in (0..self.rank).rev() {
            let at = step * self.stride;
            let v = &self.reflectors[at + step..at + self.k];
            let part = &mut self.solution[step..self.k];
            let weight = self.tau[step] * dot(part, v);
            add_scaled(part, -weight, v);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};
    use proptest::prelude::*;

    fn solve(
        b: &DMatrix<f64>,
        c: &DVector<f64>,
        d: Option<&DVector<f64>>,
    ) -> (Minimum, DVector<f64>) {
        let mut problem = LeastSquares::new(b.nrows(), b.ncols());
        problem.start(b.ncols());
        for i in 0..b.nrows() {
            problem.push(c[i], b.row(i).norm(), |row| {
                row.iter_mut().enumerate().for_each(|(j, entry)| *entry = b[(i, j)]);
            });
        }
        if let Some(d) = d {
            problem.set_linear(|linear| linear.copy_from_slice(d.as_slice()));
        }
        problem.factorise(1e-10);
        let minimum = problem.solve(1e-10);
        (minimum, DVector::from_column_slice(problem.solution()))
    }

    proptest! {
        #[test]
        fn the_answer_is_a_minimum_without_a_part_that_no_row_sees(
            m in 1_usize..9, k in 1_usize..9, rank in 1_usize..5,
            left in prop::collection::vec(-1.0_f64..1.0, 9 * 5),
            right in prop::collection::vec(-1.0_f64..1.0, 5 * 9),
            c in prop::collection::vec(-1.0_f64..1.0, 9),
        ) {
            let rank = rank.min(k);
            let left = DMatrix::from_iterator(m, rank, left.into_iter().take(m * rank));
            let right = DMatrix::from_iterator(rank, k, right.into_iter().take(rank * k));
            let b = &left * &right;
            let c = DVector::from_iterator(m, c.into_iter().take(m));
            let values = b.clone().svd(false, false).singular_values;
            let largest = values.max();
            prop_assume!(values.iter().all(|&s| s < 1e-13 * largest || s > 1e-3 * largest));
            prop_assume!((0..m).all(|i| b.row(i).norm() > 1e-3));
            prop_assume!(right.clone().svd(false, false).singular_values.min() > 1e-2);
            let (minimum, z) = solve(&b, &c, None);
            prop_assert_eq!(minimum, Minimum::Point);
            prop_assert!((b.transpose() * (&b * &z - &c)).norm() < 1e-10);
            if left.rank(1e-6) == rank {
                let row_space = right.transpose().qr().q();
                let seen = &row_space * (row_space.transpose() * &z);
                prop_assert!((&z - seen).norm() < 1e-9 * (1.0 + z.norm()));
            }
        }

        #[test]
        fn a_linear_term_in_range_moves_the_point(
            entries in prop::collection::vec(-1.0_f64..1.0, 4 * 3),
            c in prop::collection::vec(-1.0_f64..1.0, 4),
            d in prop::collection::vec(-1.0_f64..1.0, 3),
        ) {
            let b = DMatrix::from_row_slice(4, 3, &entries);
            prop_assume!(b.clone().svd(false, false).singular_values.min() > 0.05);
            let (c, d) = (DVector::from_vec(c), DVector::from_vec(d));
            let (minimum, z) = solve(&b, &c, Some(&d));
            prop_assert_eq!(minimum, Minimum::Point);
            let gradient = b.transpose() * (&b * z - c) + d;
            prop_assert!(gradient.norm() < 1e-9);
        }
    }

    #[test]
    fn a_linear_term_that_nothing_opposes_is_a_ray() {
        let b = DMatrix::from_row_slice(1, 2, &[1.0, 0.0]);
        let (minimum, z) = solve(&b, &DVector::zeros(1), Some(&DVector::from_vec(vec![0.0, 3.0])));
        assert_eq!(minimum, Minimum::Ray);
        assert!(z[1] < 0.0 && z[0].abs() < 1e-15);
    }
}
