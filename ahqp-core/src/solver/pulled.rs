//! The rows that a search pulls, kept triangular in the basis while the working set changes.
//!
//! Along the pulled directions, which follow the active ones in the basis, these rows read
//! [L; D]: L is lower triangular, one pivot row a direction; the rows of D depend on the pivots.
//! All are zero along the idle directions, which come last. Every change of the working set is a
//! reflection of the idle directions and a chain of plane rotations (Gill, Golub, Murray,
//! Saunders, Mathematics of Computation 28, 1974), so that an iteration costs O(n²).
//!
//! Ranks are taken for granted here only where they are beyond doubt. Where a pivot is small
//! but not rounding, the rows are given up and the caller factors with pivoting instead.

mod minimum;

use crate::linalg::kernels::{BlockFactor, FourReflections, Rotation, RowsMut, reflect_rows};
use crate::linalg::list::List;
use crate::linalg::vector::{length, norm, reflector};
use crate::solver::basis::Basis;
use crate::solver::data::{RowTable, RowView};

/// A part of a row below this fraction of it is rounding.
const NOTHING: f64 = 1e-12;
/// A part of a row above this fraction of it is beyond doubt.
const CLEAR: f64 = 1e-6;

/// The rows and their factor; sized once.
#[derive(Debug, Clone)]
pub(crate) struct Pulled {
    stride: usize,
    /// Pivots first, in the order of L, then dependent rows.
    rows: List<usize>,
    rank: usize,
    sound: bool,
    /// Column j: the coordinates of all rows along pulled direction j.
    columns: Vec<f64>,
    carry: Vec<f64>,
    coordinates: Vec<f64>,
    rotations: List<Rotation>,
    target: Vec<f64>,
    weights: Vec<f64>,
    system: Vec<f64>,
    step: Vec<f64>,
    reflections: Vec<f64>,
    tau: Vec<f64>,
}

impl Pulled {
    /// For up to `rows` rows in `n` variables.
    pub(crate) fn new(rows: usize, n: usize) -> Self {
        Self {
            stride: rows,
            rows: List::with_capacity(rows),
            rank: 0,
            sound: false,
            columns: vec![0.0; rows * (n + 1)],
            carry: vec![0.0; rows],
            coordinates: vec![0.0; n],
            rotations: List::with_capacity(n),
            target: vec![0.0; rows],
            weights: vec![0.0; (rows + 1) * n],
            system: vec![0.0; n * n],
            step: vec![0.0; n],
            reflections: vec![0.0; n * n],
            tau: vec![0.0; n],
        }
    }

    /// Lets go of all rows; `sound` when rows are to be pulled next.
    pub(crate) fn clear(&mut self, sound: bool) {
        self.rows.clear();
        self.rank = 0;
        self.sound = sound;
    }

    /// Whether the rows here are all that are pulled, in a factor that can be trusted.
    pub(crate) fn is_sound(&self) -> bool {
        self.sound
    }

    /// Starts with these rows: those that depend on the ones before them stand last.
    pub(crate) fn begin(
        &mut self,
        basis: &mut Basis,
        table: &RowTable,
        ids: impl Iterator<Item = usize>,
    ) {
        self.clear(true);
        self.rows.extend(ids.filter(|&id| table.norm(id) > 0.0));
        // Heavy rows first, light ones in what these leave.
        self.rows.sort_unstable_by(|&i, &j| table.norm(j).total_cmp(&table.norm(i)));
        let (n, k, m) = (self.coordinates.len(), basis.free_count(), self.rows.len());
        for (along, &id) in self.weights.chunks_exact_mut(n).zip(&self.rows) {
            basis.free_coordinates(table.row(id), along);
        }
        for index in 0..m {
            let rank = self.rank;
            let (above, below) = self.weights[..m * n].split_at_mut((index + 1) * n);
            let along = &mut above[index * n..index * n + k];
            let part = norm(&along[rank..]) / table.norm(self.rows[index]);
            if part > NOTHING && part < CLEAR {
                return self.give_up();
            }
            let columns = self.columns.chunks_exact_mut(self.stride);
            for (column, &entry) in columns.zip(&along[..rank]) {
                column[index] = entry;
            }
            if part >= CLEAR {
                let (tau, image) = reflector(&mut along[rank..]);
                let v = &along[rank..];
                reflect_rows(&mut RowsMut { data: below, stride: n }, rank, v, tau);
                let reflection = &mut self.reflections[rank * n..(rank + 1) * n];
                reflection[..rank].fill(0.0);
                reflection[rank..k].copy_from_slice(v);
                self.tau[rank] = tau;
                let column = &mut self.columns[rank * self.stride..(rank + 1) * self.stride];
                column[..index].fill(0.0);
                column[index] = image;
                self.rank += 1;
                // Dependent rows before this one make room among the pivots.
                self.swap_rows(rank, index);
            }
        }
        self.turn_free(basis, n, k);
    }

    /// Turns the free directions by all reflections.
    fn turn_free(&mut self, basis: &mut Basis, n: usize, k: usize) {
        let fours = self.rank / 4 * 4;
        for first in (0..fours).step_by(4) {
            let v = |i: usize| &self.reflections[(first + i) * n + first..(first + i) * n + k];
            let v = [v(0), v(1), v(2), v(3)];
            let factor = BlockFactor::new(v, &self.tau[first..]);
            let four = FourReflections::new(v, &factor);
            basis.reflect_free_four(first, &four);
        }
        for j in fours..self.rank {
            basis.reflect_free(j, &self.reflections[j * n + j..j * n + k], self.tau[j]);
        }
    }

    fn give_up(&mut self) {
        self.clear(false);
    }

    /// Pulls a row more.
    pub(crate) fn pull(&mut self, basis: &mut Basis, table: &RowTable, id: usize) {
        let row = table.row(id);
        if !self.sound || row.norm() == 0.0 {
            return;
        }
        let (k, rank, last) = (basis.free_count(), self.rank, self.rows.len());
        basis.free_coordinates(row, &mut self.coordinates);
        let (along, idle) = self.coordinates[..k].split_at_mut(rank);
        let part = norm(idle) / row.norm();
        if part > NOTHING && part < CLEAR {
            return self.give_up();
        }
        self.rows.push(id);
        for (column, &entry) in self.columns.chunks_exact_mut(self.stride).zip(along.iter()) {
            column[last] = entry;
        }
        if part >= CLEAR {
            let (tau, image) = reflector(idle);
            basis.reflect_free(rank, idle, tau);
            let column = &mut self.columns[rank * self.stride..(rank + 1) * self.stride];
            column[..last].fill(0.0);
            column[last] = image;
            self.swap_rows(rank, last);
            self.rank += 1;
        }
    }

    /// Lets go of a row that is pulled.
    pub(crate) fn let_go(&mut self, basis: &mut Basis, table: &RowTable, id: usize) {
        let Some(index) = self.rows.iter().position(|&row| row == id) else { return };
        let pivot = index < self.rank;
        let index = if pivot { self.demote(basis, index) } else { index };
        let last = self.rows.len() - 1;
        self.swap_rows(index, last);
        self.rows.pop();
        if pivot {
            self.adopt(table);
        }
    }

    /// Adds a hard row to the working set; false if it depends on the rows there, within
    /// `tolerance`.
    pub(crate) fn activate(
        &mut self,
        basis: &mut Basis,
        table: &RowTable,
        id: usize,
        tolerance: f64,
    ) -> bool {
        let row = table.row(id);
        let k = basis.free_count();
        basis.free_coordinates(row, &mut self.coordinates);
        if norm(&self.coordinates[..k]) <= tolerance * row.norm() {
            return false;
        }
        let mut entry = self.take_carry(basis, row);
        self.rotations.clear();
        let (m, stride) = (self.rows.len(), self.stride);
        for j in (0..self.rank).rev() {
            let part = self.coordinates[j];
            let radius = length(part, entry);
            let (cosine, sine) =
                if radius == 0.0 { (0.0, 1.0) } else { (part / radius, entry / radius) };
            self.rotations.push(Rotation { first: j, second: j + 1, cosine, sine });
            let column = &mut self.columns[j * stride..j * stride + m];
            for (pulled, carry) in column[j..].iter_mut().zip(&mut self.carry[j..m]) {
                let (x, y) = (*pulled, *carry);
                (*carry, *pulled) = (cosine * x + sine * y, cosine * y - sine * x);
            }
            entry = radius;
        }
        basis.rotate_free(0, &self.rotations);
        basis.append_active(id, row);
        self.mend(basis, table);
        true
    }

    /// The direction into which the row that is being activated is turned: an idle one, turned so
    /// that the row has no part along the others, or else the last pulled one. Returns the row's
    /// entry along it.
    fn take_carry(&mut self, basis: &mut Basis, row: RowView<'_>) -> f64 {
        let (k, m) = (basis.free_count(), self.rows.len());
        let idle = &mut self.coordinates[self.rank..k];
        if self.rank == 0 || norm(idle) > NOTHING * row.norm() {
            let (tau, image) = reflector(idle);
            basis.reflect_free(self.rank, idle, tau);
            self.carry[..m].fill(0.0);
            image
        } else {
            self.rank -= 1;
            let start = self.rank * self.stride;
            self.carry[..m].copy_from_slice(&self.columns[start..start + m]);
            self.coordinates[self.rank]
        }
    }

    /// Takes a hard row out of the working set; its direction is free again.
    pub(crate) fn release(&mut self, basis: &mut Basis, table: &RowTable, position: usize) {
        basis.remove_active(position);
        let (m, stride) = (self.rows.len(), self.stride);
        let direction = basis.vector(basis.free_start());
        for (entry, &id) in self.carry.iter_mut().zip(&self.rows) {
            *entry = table.row(id).dot(direction);
        }
        self.rotations.clear();
        for j in 0..self.rank {
            let column = &mut self.columns[j * stride..j * stride + m];
            let radius = length(self.carry[j], column[j]);
            let (cosine, sine) = (self.carry[j] / radius, column[j] / radius);
            self.rotations.push(Rotation { first: j, second: j + 1, cosine, sine });
            for (pulled, carry) in column[j..].iter_mut().zip(&mut self.carry[j..m]) {
                let (x, y) = (*carry, *pulled);
                (*pulled, *carry) = (cosine * x + sine * y, cosine * y - sine * x);
            }
        }
        basis.rotate_free(0, &self.rotations);
        if m > 0 {
            let start = self.rank * stride;
            self.columns[start..start + m].copy_from_slice(&self.carry[..m]);
            self.adopt(table);
        }
    }

    /// Fixes the directions of the rows here and of the working set, but for the weak rows of it:
    /// these stay in it, except those that depend on what is fixed. False, and nothing done, where
    /// a rank is in doubt.
    pub(crate) fn fix(&mut self, basis: &mut Basis, table: &RowTable, weak: &[bool]) -> bool {
        let count = basis.active().len();
        let dependent = self.rows.len() > self.rank && weak[..count].contains(&true);
        if !self.sound || dependent || !basis.is_clear(CLEAR, |id| table.norm(id)) {
            return false;
        }
        if weak[..count].contains(&true) {
            basis.bring_forward(weak);
            self.turn_from_weak(basis, table, weak);
        }
        basis.fix_ahead(weak, self.rank);
        for position in (0..basis.active().len()).rev() {
            if !basis.is_clear_at(position, CLEAR, |id| table.norm(id)) {
                basis.remove_active(position);
            }
        }
        true
    }

    /// Turns the pulled directions so that the pivots have no part along the directions of weak
    /// rows of the working set.
    fn turn_from_weak(&mut self, basis: &mut Basis, table: &RowTable, weak: &[bool]) {
        let (rank, count) = (self.rank, basis.active().len());
        // Of every weak row of the working set, what the pivots have along its direction.
        let along_weak = &mut self.weights[..count * rank];
        for (row, &id) in self.rows[..rank].iter().enumerate() {
            let along = &mut self.coordinates[..count];
            basis.active_coordinates(table.row(id), along);
            for (entries, &entry) in along_weak.chunks_exact_mut(rank).zip(along.iter()) {
                entries[row] = entry;
            }
        }
        basis.begin_turning();
        for j in 0..rank {
            let fill = &mut self.coordinates;
            fill.fill(0.0);
            let column = &mut self.columns[j * self.stride + j..j * self.stride + rank];
            // From the last to the first, so that the weak rows stay triangular.
            for i in (0..count).rev().filter(|&i| weak[i]) {
                let along = &mut self.weights[i * rank + j..(i + 1) * rank];
                let (a, b) = (column[0], along[0]);
                let radius = length(a, b);
                let (cosine, sine) = (a / radius, b / radius);
                for (x, y) in column.iter_mut().zip(along) {
                    (*x, *y) = (cosine * *x + sine * *y, cosine * *y - sine * *x);
                }
                basis.rotate_with_active(j, i, cosine, sine, fill);
            }
        }
        basis.end_turning();
    }

    /// Makes pivot `index` the first of the dependent rows, and returns where it stands; the last
    /// pulled direction has no pivot then, and its column stays behind the others.
    fn demote(&mut self, basis: &mut Basis, index: usize) -> usize {
        let (m, stride, last) = (self.rows.len(), self.stride, self.rank - 1);
        self.rotations.clear();
        for j in index..last {
            let (left, right) = self.columns.split_at_mut((j + 1) * stride);
            let (first, second) = (&mut left[j * stride..j * stride + m], &mut right[..m]);
            let radius = length(first[j + 1], second[j + 1]);
            if radius == 0.0 {
                continue;
            }
            let (cosine, sine) = (first[j + 1] / radius, second[j + 1] / radius);
            self.rotations.push(Rotation { first: j, second: j + 1, cosine, sine });
            for (a, b) in first[index..].iter_mut().zip(&mut second[index..]) {
                let (x, y) = (*a, *b);
                (*a, *b) = (cosine * x + sine * y, cosine * y - sine * x);
            }
        }
        basis.rotate_free(0, &self.rotations);
        self.rows[index..=last].rotate_left(1);
        for j in 0..=last {
            self.columns[j * stride + index..=j * stride + last].rotate_left(1);
        }
        self.rank = last;
        last
    }

    /// Gives the direction behind the pivots a pivot of the dependent rows, or leaves it idle.
    fn adopt(&mut self, table: &RowTable) {
        let column = &self.columns[self.rank * self.stride..];
        let (mut best, mut largest, mut any) = (None, 0.0, false);
        for (index, &id) in self.rows.iter().enumerate().skip(self.rank) {
            let part = column[index].abs() / table.norm(id);
            any |= part > NOTHING;
            if part >= CLEAR && column[index].abs() > largest {
                (best, largest) = (Some(index), column[index].abs());
            }
        }
        if best.is_none() && any {
            return self.give_up();
        }
        if let Some(index) = best {
            self.rank += 1;
            self.swap_rows(self.rank - 1, index);
        }
    }

    /// Pivots that have become too small give way to dependent rows.
    fn mend(&mut self, basis: &mut Basis, table: &RowTable) {
        for _ in 0..self.rank {
            let small = (0..self.rank).find(|&j| {
                self.columns[j * self.stride + j].abs() < CLEAR * table.norm(self.rows[j])
            });
            let Some(index) = small else { return };
            self.demote(basis, index);
            self.adopt(table);
        }
    }

    fn swap_rows(&mut self, i: usize, j: usize) {
        if i != j {
            self.rows.swap(i, j);
            for column in self.columns.chunks_exact_mut(self.stride).take(self.rank + 1) {
                column.swap(i, j);
            }
        }
    }
}
