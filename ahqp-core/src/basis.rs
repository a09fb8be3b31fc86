//! An orthonormal basis of ℝⁿ, split into fixed, active and free directions.
//!
//! Fixed directions are decided by higher levels and never move again; active ones are held by
//! the working set, whose rows are lower triangular in them; free ones span what may still
//! move. Dimensions shrink from level to level because fixed directions are not touched again.

use crate::kernels::{Rotation, RowsMut, mix_rows, rotate_rows};
use crate::table::RowView;
use crate::vector::{add_scaled, dot, norm, reflector};

/// The basis, its partition, and the triangular factor of the working set.
#[derive(Debug, Clone)]
pub(crate) struct Basis {
    n: usize,
    /// Basis vectors, one after the other.
    vectors: Vec<f64>,
    fixed: usize,
    /// Rows of the working set in the order of the triangular factor.
    active: Vec<usize>,
    /// Row i: the coordinates of active row i along active directions 0 to i.
    triangular: Vec<f64>,
    coordinates: Vec<f64>,
    image: Vec<f64>,
    rotations: Vec<Rotation>,
}

impl Basis {
    pub(crate) fn new(n: usize) -> Self {
        let mut basis = Self {
            n,
            vectors: vec![0.0; n * n],
            fixed: 0,
            active: Vec::with_capacity(n),
            triangular: vec![0.0; n * n],
            coordinates: vec![0.0; n],
            image: vec![0.0; n],
            rotations: Vec::with_capacity(n),
        };
        basis.reset();
        basis
    }

    /// Back to the unit vectors, all free.
    pub(crate) fn reset(&mut self) {
        self.vectors.fill(0.0);
        for i in 0..self.n {
            self.vectors[i * self.n + i] = 1.0;
        }
        self.fixed = 0;
        self.active.clear();
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
        let start = self.free_start();
        for (j, value) in out.iter_mut().take(self.n - start).enumerate() {
            *value = row.dot(self.vector(start + j));
        }
    }

    /// Coordinates of the vector `v` along the free directions.
    pub(crate) fn free_coordinates_of(&self, v: &[f64], out: &mut [f64]) {
        let start = self.free_start();
        for (j, value) in out.iter_mut().take(self.n - start).enumerate() {
            *value = dot(v, self.vector(start + j));
        }
    }

    /// x ← x + Σ zⱼ · (free direction j).
    pub(crate) fn add_free(&self, z: &[f64], x: &mut [f64]) {
        let start = self.free_start();
        for (j, &coefficient) in z.iter().take(self.n - start).enumerate() {
            add_scaled(x, coefficient, self.vector(start + j));
        }
    }

    /// Leaves the working set empty; its directions become free.
    pub(crate) fn clear_active(&mut self) {
        self.active.clear();
    }

    /// Puts a row that lies in the active directions and the first free one into the working set;
    /// that direction becomes active.
    pub(crate) fn append_active(&mut self, id: usize, row: RowView<'_>) {
        let count = self.active.len();
        for j in 0..=count {
            let value = row.dot(self.vector(self.fixed + j));
            self.triangular[count * self.n + j] = value;
        }
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
            let length = a.hypot(b);
            if length == 0.0 {
                continue;
            }
            let (cosine, sine) = (a / length, b / length);
            for row in self.triangular[i * n..(count - 1) * n].chunks_exact_mut(n) {
                let (x, y) = (row[i], row[i + 1]);
                row[i] = cosine * x + sine * y;
                row[i + 1] = cosine * y - sine * x;
            }
            self.rotations.push(Rotation { first: i, cosine, sine });
        }
        let data = &mut self.vectors[self.fixed * n..];
        rotate_rows(&mut RowsMut { data, stride: n }, &self.rotations);
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

    /// Fixes all active directions and the first `count` free ones for good; the working set is
    /// empty then.
    pub(crate) fn fix_active_and(&mut self, count: usize) {
        self.fixed += self.active.len() + count;
        self.active.clear();
    }

    /// Whether every row of the working set has a clear direction of its own: more than
    /// `fraction` of it, given its norm, lies outside the rows before it.
    pub(crate) fn is_clear(&self, fraction: f64, norm: impl Fn(usize) -> f64) -> bool {
        self.active
            .iter()
            .enumerate()
            .all(|(i, &id)| self.triangular[i * self.n + i].abs() > fraction * norm(id))
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
        for (i, value) in out.iter_mut().enumerate().take(count) {
            *value = -dot(gradient, self.vector(self.fixed + i));
        }
        for i in (0..count).rev() {
            out[i] /= self.triangular[i * n + i];
            let value = out[i];
            let row = &self.triangular[i * n..i * n + i];
            add_scaled(&mut out[..i], -value, row);
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
        mix_rows(&mut RowsMut { data, stride: self.n }, v, tau, &mut self.image);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
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
