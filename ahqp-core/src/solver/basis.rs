//! An orthonormal basis of ℝⁿ, split into fixed, active and free directions.
//!
//! Fixed directions are decided by higher levels and never move again; active ones are held by
//! the working set, whose rows are lower triangular in them; free ones span what may still
//! move. Dimensions shrink from level to level because fixed directions are not touched again.

use crate::linalg::kernels::{
    FourReflections, Rotation, RowsMut, add_rows, mix_rows, mix_rows_four, multiply_rows,
    rotate_rows,
};
use crate::linalg::list::List;
use crate::linalg::vector::{add_scaled, length, norm, reflector};
use crate::solver::data::{Coefficients, RowView};
use crate::solver::tolerances::ROUNDING;

/// The basis, its partition, and the triangular factor of the working set.
#[derive(Debug, Clone)]
pub(crate) struct Basis {
    n: usize,
    /// Basis vectors, one after the other.
    vectors: Vec<f64>,
    fixed: usize,
    /// Rows of the working set in the order of the triangular factor.
    active: List<usize>,
    /// Row i: the coordinates of active row i along active directions 0 to i.
    triangular: Vec<f64>,
    coordinates: Vec<f64>,
    rotations: List<Rotation>,
    spare: Vec<f64>,
}

impl Basis {
    pub(crate) fn new(n: usize) -> Self {
        let mut basis = Self {
            n,
            vectors: vec![0.0; n * n],
            fixed: 0,
            active: List::with_capacity(n),
            triangular: vec![0.0; n * n],
            coordinates: vec![0.0; n],
            rotations: List::with_capacity(n * n),
            spare: vec![0.0; n * n],
        };
        basis.reset(|_| false);
        basis
    }

    /// Back to the unit vectors; those of the variables whose bounds are active stand first, the
    /// others are free.
    pub(crate) fn reset(&mut self, is_active: impl Fn(usize) -> bool) {
        let n = self.n;
        self.vectors.fill(0.0);
        self.fixed = 0;
        self.active.clear();
        self.active.extend((0..n).filter(|&i| is_active(i)));
        let count = self.active.len();
        for (i, row) in self.triangular.chunks_exact_mut(n).enumerate().take(count) {
            row[..i].fill(0.0);
            row[i] = 1.0;
        }
        let rest = (0..n).filter(|&i| !is_active(i));
        for (vector, i) in
            self.vectors.chunks_exact_mut(n).zip(self.active.iter().copied().chain(rest))
        {
            vector[i] = 1.0;
        }
    }

    pub(crate) fn active(&self) -> &[usize] {
        &self.active
    }

    /// The first free direction.
    pub(crate) fn free_start(&self) -> usize {
        self.fixed + self.active.len()
    }

    /// How many directions may still move.
    pub(crate) fn free_count(&self) -> usize {
        self.n - self.free_start()
    }

    /// Direction j.
    pub(crate) fn vector(&self, j: usize) -> &[f64] {
        &self.vectors[j * self.n..(j + 1) * self.n]
    }

    /// Coordinates of `row` along the free directions.
    pub(crate) fn free_coordinates(&self, row: RowView<'_>, out: &mut [f64]) {
        self.coordinates_from(self.free_start(), row, &mut out[..self.n - self.free_start()]);
    }

    /// Whether `row` lies in the fixed directions, but for a part below `tolerance` of it.
    pub(crate) fn is_fixed(&self, row: RowView<'_>, tolerance: f64) -> bool {
        let others = self.vectors[self.fixed * self.n..].chunks_exact(self.n);
        let rest = others.map(|direction| row.dot(direction).powi(2)).sum::<f64>().sqrt();
        rest <= tolerance * row.norm()
    }

    /// Coordinates of `row` along the directions from `start` on, as many as `out` has entries.
    fn coordinates_from(&self, start: usize, row: RowView<'_>, out: &mut [f64]) {
        let n = self.n;
        match row.coefficients() {
            Coefficients::Unit(variable) => {
                let entries = self.vectors[start * n..].iter().skip(variable).step_by(n);
                for (value, &entry) in out.iter_mut().zip(entries) {
                    *value = entry;
                }
            }
            Coefficients::Dense(row) => multiply_rows(&self.vectors[start * n..], n, row, out),
        }
    }

    /// Coordinates of the vector `v` along the free directions.
    pub(crate) fn free_coordinates_of(&self, v: &[f64], out: &mut [f64]) {
        let (n, start) = (self.n, self.free_start());
        multiply_rows(&self.vectors[start * n..], n, v, &mut out[..n - start]);
    }

    /// x ← x + Σ zⱼ · (free direction j).
    pub(crate) fn add_free(&self, z: &[f64], x: &mut [f64]) {
        add_rows(&self.vectors[self.free_start() * self.n..], self.n, z, x);
    }

    /// Leaves the working set empty; its directions become free.
    pub(crate) fn clear_active(&mut self) {
        self.active.clear();
    }

    /// Puts a row that lies in the active directions and the first free one into the working set;
    /// that direction becomes active.
    pub(crate) fn append_active(&mut self, id: usize, row: RowView<'_>) {
        let (n, count) = (self.n, self.active.len());
        let mut triangular = std::mem::take(&mut self.triangular);
        self.coordinates_from(self.fixed, row, &mut triangular[count * n..=count * n + count]);
        self.triangular = triangular;
        self.active.push(id);
    }

    /// Removes a row of the working set; its direction becomes the first free one.
    pub(crate) fn remove_active(&mut self, position: usize) {
        let (n, count) = (self.n, self.active.len());
        self.active.remove(position);
        self.triangular.copy_within((position + 1) * n..count * n, position * n);
        // Row i now reaches one column too far; rotate neighbouring directions to mend it.
        self.rotations.clear();
        for i in position..count - 1 {
            let (a, b) = (self.triangular[i * n + i], self.triangular[i * n + i + 1]);
            let radius = length(a, b);
            if radius == 0.0 {
                continue;
            }
            let (cosine, sine) = (a / radius, b / radius);
            for row in self.triangular[i * n..(count - 1) * n].chunks_exact_mut(n) {
                let (x, y) = (row[i], row[i + 1]);
                row[i] = cosine * x + sine * y;
                row[i + 1] = cosine * y - sine * x;
            }
            self.rotations.push(Rotation { first: i, second: i + 1, cosine, sine });
        }
        self.apply_rotations();
    }

    /// Rotates free directions; rotations count from free direction `offset`.
    pub(crate) fn rotate_free(&mut self, offset: usize, rotations: &[Rotation]) {
        let start = (self.free_start() + offset) * self.n;
        rotate_rows(&mut RowsMut { data: &mut self.vectors[start..], stride: self.n }, rotations);
    }

    /// Turns the free directions from `offset` on by I − τvvᵀ.
    pub(crate) fn reflect_free(&mut self, offset: usize, v: &[f64], tau: f64) {
        self.reflect(self.free_start() + offset, v, tau);
    }

    /// Turns the active directions so that the rows of the working set that are not weak have no
    /// part along the directions of those that are.
    pub(crate) fn bring_forward(&mut self, weak: &[bool]) {
        let (n, count) = (self.n, self.active.len());
        self.rotations.clear();
        for strong in (0..count).filter(|&i| !weak[i]) {
            for row in self.triangular.chunks_exact_mut(n).take(strong) {
                row[strong] = 0.0;
            }
            // From the last to the first, so that the weak rows stay triangular among themselves.
            for i in (0..strong).rev().filter(|&i| weak[i]) {
                let (a, b) =
                    (self.triangular[strong * n + strong], self.triangular[strong * n + i]);
                let radius = length(a, b);
                let (cosine, sine) = (a / radius, b / radius);
                for row in self.triangular[i * n..count * n].chunks_exact_mut(n) {
                    let (x, y) = (row[strong], row[i]);
                    (row[strong], row[i]) = (cosine * x + sine * y, cosine * y - sine * x);
                }
                self.rotations.push(Rotation { first: strong, second: i, cosine, sine });
            }
        }
        self.apply_rotations();
    }

    /// Coordinates of `row` along the active directions.
    pub(crate) fn active_coordinates(&self, row: RowView<'_>, out: &mut [f64]) {
        self.coordinates_from(self.fixed, row, &mut out[..self.active.len()]);
    }

    /// Begins a run of [`rotate_with_active`](Self::rotate_with_active): the triangular factor is
    /// copied with its columns in one piece.
    pub(crate) fn begin_turning(&mut self) {
        let (n, count) = (self.n, self.active.len());
        for (i, row) in self.triangular.chunks_exact(n).enumerate().take(count) {
            for (column, &entry) in self.spare.chunks_exact_mut(n).zip(&row[..=i]) {
                column[i] = entry;
            }
        }
    }

    /// Rotates free direction `free` with active direction `i`. `fill` holds what the rows of the
    /// working set have along the free one; zero before `i`.
    pub(crate) fn rotate_with_active(
        &mut self,
        free: usize,
        i: usize,
        cosine: f64,
        sine: f64,
        fill: &mut [f64],
    ) {
        let (n, count) = (self.n, self.active.len());
        let column = &mut self.spare[i * n + i..i * n + count];
        for (x, y) in fill[i..count].iter_mut().zip(column) {
            (*x, *y) = (cosine * *x + sine * *y, cosine * *y - sine * *x);
        }
        self.rotations.push(Rotation { first: count + free, second: i, cosine, sine });
    }

    /// Ends a run of [`rotate_with_active`](Self::rotate_with_active).
    pub(crate) fn end_turning(&mut self) {
        let (n, count) = (self.n, self.active.len());
        for (i, row) in self.triangular.chunks_exact_mut(n).enumerate().take(count) {
            for (column, entry) in self.spare.chunks_exact(n).zip(&mut row[..=i]) {
                *entry = column[i];
            }
        }
        self.apply_rotations();
    }

    fn apply_rotations(&mut self) {
        let data = &mut self.vectors[self.fixed * self.n..];
        rotate_rows(&mut RowsMut { data, stride: self.n }, &self.rotations);
        self.rotations.clear();
    }

    /// Turns the free directions from `offset` on by four reflections, one after the other.
    pub(crate) fn reflect_free_four(&mut self, offset: usize, four: &FourReflections<'_>) {
        let start = (self.free_start() + offset) * self.n;
        mix_rows_four(&mut RowsMut { data: &mut self.vectors[start..], stride: self.n }, four);
    }

    /// Fixes the active directions of rows that are not weak and the first `count` free ones for
    /// good; the weak rows stay in the working set.
    pub(crate) fn fix_ahead(&mut self, weak: &[bool], count: usize) {
        let (n, active) = (self.n, self.active.len());
        let held = weak[..active].iter().filter(|&&weak| weak).count();
        if held > 0 {
            let block = &mut self.vectors[self.fixed * n..(self.fixed + active + count) * n];
            let spare = &mut self.spare[..block.len()];
            spare.copy_from_slice(block);
            let ahead = (0..active).filter(|&i| !weak[i]).chain(active..active + count);
            let order = ahead.chain((0..active).filter(|&i| weak[i]));
            for (to, from) in block.chunks_exact_mut(n).zip(order) {
                to.copy_from_slice(&spare[from * n..(from + 1) * n]);
            }
            for (row, i) in (0..active).filter(|&i| weak[i]).enumerate() {
                for (column, j) in (0..=i).filter(|&j| weak[j]).enumerate() {
                    self.triangular[row * n + column] = self.triangular[i * n + j];
                }
                self.active[row] = self.active[i];
            }
        }
        self.active.truncate(held);
        self.fixed += active - held + count;
    }

    /// Whether every row of the working set has a clear direction of its own: more than
    /// `fraction` of it, given its norm, lies outside the rows before it.
    pub(crate) fn is_clear(&self, fraction: f64, norm: impl Fn(usize) -> f64) -> bool {
        (0..self.active.len()).all(|position| self.is_clear_at(position, fraction, &norm))
    }

    /// The same of one row.
    pub(crate) fn is_clear_at(
        &self,
        position: usize,
        fraction: f64,
        norm: impl Fn(usize) -> f64,
    ) -> bool {
        let pivot = self.triangular[position * self.n + position];
        pivot.abs() > fraction * norm(self.active[position])
    }

    /// Fixes the direction of `row` for good; the working set must be empty. False when the
    /// row depends on what is fixed already.
    pub(crate) fn fix(&mut self, row: RowView<'_>, tolerance: f64) -> bool {
        debug_assert!(self.active.is_empty());
        if self.free_count() == 0 || self.reflect_first_free(row, tolerance).is_none() {
            return false;
        }
        self.fixed += 1;
        true
    }

    /// Turns the free directions by a product of reflections I − τvvᵀ and fixes the first
    /// `reflectors.len() / stride` of them; the working set must be empty.
    pub(crate) fn fix_reflected(&mut self, reflectors: &[f64], stride: usize, tau: &[f64]) {
        debug_assert!(self.active.is_empty());
        let start = self.fixed;
        for (k, (v, &tau)) in reflectors.chunks_exact(stride).zip(tau).enumerate() {
            self.reflect(start + k, &v[k..self.n - start], tau);
        }
        self.fixed += tau.len();
    }

    /// Multipliers λ with Σ λᵢ aᵢ = −gradient along the active directions.
    pub(crate) fn multipliers(&self, gradient: &[f64], out: &mut [f64]) {
        let (n, count) = (self.n, self.active.len());
        multiply_rows(&self.vectors[self.fixed * n..], n, gradient, &mut out[..count]);
        for value in &mut out[..count] {
            *value = -*value;
        }
        for i in (0..count).rev() {
            out[i] /= self.triangular[i * n + i];
            let value = out[i];
            let row = &self.triangular[i * n..i * n + i];
            add_scaled(&mut out[..i], -value, row);
        }
    }

    /// The rounding in [`multipliers`](Self::multipliers), given that in each entry of the gradient:
    /// that of every sum, term by term. `norm` is that of a row.
    pub(crate) fn multiplier_rounding(
        &self,
        gradient: &[f64],
        gradient_rounding: &[f64],
        multipliers: &[f64],
        norm: impl Fn(usize) -> f64,
        out: &mut [f64],
    ) {
        let (n, count) = (self.n, self.active.len());
        for (i, rounding) in out[..count].iter_mut().enumerate() {
            let direction = self.vector(self.fixed + i).iter();
            let terms = direction.zip(gradient.iter().zip(gradient_rounding));
            *rounding = terms
                .filter(|(entry, _)| **entry != 0.0)
                .map(|(entry, (value, rounding))| entry.abs() * rounding + ROUNDING * value.abs())
                .sum();
        }
        for i in (0..count).rev() {
            let size = ROUNDING * multipliers[i].abs();
            out[i] = out[i] / self.triangular[i * n + i].abs() + size;
            let (rounding, turned) = (out[i], size * norm(self.active[i]));
            let row = &self.triangular[i * n..i * n + i];
            for (out, entry) in out[..i].iter_mut().zip(row).filter(|(_, entry)| **entry != 0.0) {
                *out += rounding * entry.abs() + turned;
            }
        }
    }

    /// Turns the free directions so that `row` lies along the first of them.
    fn reflect_first_free(&mut self, row: RowView<'_>, tolerance: f64) -> Option<()> {
        let start = self.free_start();
        let mut v = std::mem::take(&mut self.coordinates);
        self.free_coordinates(row, &mut v);
        let part = &mut v[..self.n - start];
        let independent = norm(part) > tolerance * row.norm();
        if independent {
            let (tau, _) = reflector(part);
            self.reflect(start, part, tau);
        }
        self.coordinates = v;
        independent.then_some(())
    }

    /// Applies I − τvvᵀ to the directions from `start` on.
    fn reflect(&mut self, start: usize, v: &[f64], tau: f64) {
        let data = &mut self.vectors[start * self.n..];
        mix_rows(&mut RowsMut { data, stride: self.n }, v, tau);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::vector::dot;
    use approx::assert_relative_eq;
    use proptest::prelude::*;

    impl Basis {
        fn push_active(&mut self, id: usize, row: RowView<'_>, tolerance: f64) -> bool {
            let added = self.reflect_first_free(row, tolerance).is_some();
            if added {
                self.append_active(id, row);
            }
            added
        }
    }

    fn gram_error(basis: &Basis) -> f64 {
        let mut worst = 0.0_f64;
        for i in 0..basis.n {
            for j in 0..=i {
                let expected = f64::from(u8::from(i == j));
                worst = worst.max((dot(basis.vector(i), basis.vector(j)) - expected).abs());
            }
        }
        worst
    }

    proptest! {
        #[test]
        fn adding_and_removing_rows_keeps_the_basis_orthonormal_and_the_factor_exact(
            entries in prop::collection::vec(-1.0_f64..1.0, 7 * 5),
            removals in prop::collection::vec(0_usize..5, 0..4),
        ) {
            let n = 7;
            let mut basis = Basis::new(n);
            for (id, row) in entries.chunks_exact(n).enumerate() {
                prop_assume!(norm(row) > 1e-3);
                basis.push_active(id, RowView::dense(row, norm(row)), 1e-6);
            }
            for &position in &removals {
                if position < basis.active.len() {
                    basis.remove_active(position);
                }
            }
            prop_assert!(gram_error(&basis) < 1e-12);
            for (i, &id) in basis.active.iter().enumerate() {
                let row = &entries[id * n..(id + 1) * n];
                for j in 0..n {
                    let expected = if j <= i { basis.triangular[i * n + j] } else { 0.0 };
                    prop_assert!((dot(row, basis.vector(j)) - expected).abs() < 1e-11);
                }
            }
        }
    }

    #[test]
    fn a_dependent_row_is_refused() {
        let mut basis = Basis::new(3);
        assert!(basis.push_active(0, RowView::dense(&[1.0, 1.0, 0.0], 2.0_f64.sqrt()), 1e-10));
        assert!(!basis.push_active(1, RowView::dense(&[2.0, 2.0, 0.0], 8.0_f64.sqrt()), 1e-10));
        assert_eq!(basis.free_count(), 2);
    }

    #[test]
    fn multipliers_balance_the_gradient() {
        let mut basis = Basis::new(3);
        let rows = [[1.0, 2.0, 0.0], [0.0, 1.0, 3.0]];
        for (id, row) in rows.iter().enumerate() {
            assert!(basis.push_active(id, RowView::dense(row, norm(row)), 1e-10));
        }
        let mut gradient = [0.0; 3];
        add_scaled(&mut gradient, -0.5, &rows[0]);
        add_scaled(&mut gradient, 0.25, &rows[1]);
        let mut multipliers = [0.0; 2];
        basis.multipliers(&gradient, &mut multipliers);
        assert_relative_eq!(multipliers[0], 0.5, epsilon = 1e-12);
        assert_relative_eq!(multipliers[1], -0.25, epsilon = 1e-12);
    }
}
