//! The orthogonal factor Q of the stacked rows, A = [L 0] Qᵀ, multiplied out.

use std::ops::Range;

use super::{LANES, first_lane};
use crate::linalg::kernels::{
    Rotation, RowsMut, add_rows, mix_rows, multiply_rows, reflect_rows, rotate_rows,
};
use crate::linalg::vector::reflector;

/// Q, for vectors over the free variables; sized once.
#[derive(Debug, Clone)]
pub(crate) struct Orthogonal {
    /// Entries from vector to vector: the variables, and zeros up to whole lanes.
    stride: usize,
    /// Entries of vectors in use.
    size: usize,
    /// The columns of Q one after the other.
    columns: Vec<f64>,
    is_identity: bool,
    /// Reflector i stands at i times the stride, from entry i on.
    reflectors: Vec<f64>,
    tau: Vec<f64>,
    scratch: Vec<f64>,
}

impl Orthogonal {
    pub(super) fn new(variables: usize) -> Self {
        let stride = variables.next_multiple_of(LANES);
        Self {
            stride,
            size: 0,
            columns: vec![0.0; variables * stride],
            is_identity: true,
            reflectors: vec![0.0; variables * stride],
            tau: vec![0.0; variables],
            scratch: vec![0.0; stride],
        }
    }

    /// The identity, for vectors of `size` entries.
    pub(super) fn begin(&mut self, size: usize) {
        (self.size, self.is_identity) = (size, true);
        self.columns[..size * self.stride].fill(0.0);
        self.columns.iter_mut().step_by(self.stride + 1).take(size).for_each(|one| *one = 1.0);
    }

    /// Adds the reflection that turns what `row` has from entry `step` on into that entry, and applies
    /// it to the rows in `below`. Returns the entry.
    pub(super) fn reflect(&mut self, step: usize, row: &[f64], below: &mut [f64]) -> f64 {
        let stride = self.stride;
        let reflection = &mut self.reflectors[step * stride..(step + 1) * stride];
        reflection[step.saturating_sub(LANES)..step].fill(0.0);
        reflection[self.size..].fill(0.0);
        let v = &mut reflection[step..self.size];
        v.copy_from_slice(&row[step..self.size]);
        let (tau, image) = reflector(v);
        self.tau[step] = tau;
        let first = first_lane(step);
        let v = &reflection[first..self.size.next_multiple_of(LANES)];
        reflect_rows(&mut RowsMut { data: below, stride }, first, v, tau);
        image
    }

    /// Multiplies the reflections of these steps into Q.
    pub(super) fn absorb(&mut self, steps: Range<usize>) {
        self.is_identity &= steps.is_empty();
        let (stride, size) = (self.stride, self.size);
        for step in steps {
            let v = &self.reflectors[step * stride + step..step * stride + size];
            let data = &mut self.columns[step * stride..size * stride];
            mix_rows(&mut RowsMut { data, stride }, v, self.tau[step]);
        }
    }

    /// Takes rows over the free variables, with zeros behind, into the coordinates of Q. Coordinates before
    /// `first` become zero.
    pub(super) fn turn_rows(&mut self, data: &mut [f64], first: usize) {
        if self.is_identity {
            return;
        }
        for row in data.chunks_exact_mut(self.stride) {
            self.scratch.copy_from_slice(row);
            row[..first].fill(0.0);
            let part = &mut row[first..self.size];
            multiply_rows(&self.columns[first * self.stride..], self.stride, &self.scratch, part);
        }
    }

    /// Takes the unit vector at `place` into the coordinates of Q; `vector` is zero. Those before `first`
    /// stay zero.
    pub(super) fn turn_unit(&self, vector: &mut [f64], place: usize, first: usize) {
        let entries = self.columns[first * self.stride..].iter().skip(place);
        let coordinates = &mut vector[first..self.size];
        for (to, from) in coordinates.iter_mut().zip(entries.step_by(self.stride)) {
            *to = *from;
        }
    }

    /// The coordinates from `first` on of a vector.
    pub(super) fn turn_part(&self, vector: &[f64], first: usize, out: &mut [f64]) {
        multiply_rows(&self.columns[first * self.stride..], self.stride, vector, out);
    }

    /// Takes coordinates from `first` on, the others zero, to the vector over the free variables.
    pub(super) fn turn_part_back(&self, coordinates: &[f64], first: usize, out: &mut [f64]) {
        out.fill(0.0);
        add_rows(&self.columns[first * self.stride..], self.stride, coordinates, out);
    }

    /// Turns the coordinates by rotations, one after the other.
    pub(super) fn rotate(&mut self, rotations: &[Rotation]) {
        self.is_identity &= rotations.is_empty();
        let data = &mut self.columns[..self.size * self.stride];
        rotate_rows(&mut RowsMut { data, stride: self.stride }, rotations);
    }

    /// The last coordinate comes to stand at `place`; those from there on make room.
    pub(super) fn move_last(&mut self, place: usize) {
        self.is_identity = false;
        self.columns[place * self.stride..self.size * self.stride].rotate_right(self.stride);
    }

    /// Turns the coordinates from `first` on, along which no stacked row has an entry, so that `row` has
    /// only the first of them.
    pub(super) fn reflect_free(&mut self, row: &mut [f64], first: usize) {
        self.is_identity = false;
        let v = &mut self.scratch[..self.size - first];
        v.copy_from_slice(&row[first..self.size]);
        let (tau, image) = reflector(v);
        let stride = self.stride;
        let data = &mut self.columns[first * stride..self.size * stride];
        mix_rows(&mut RowsMut { data, stride }, v, tau);
        row[first..self.size].fill(0.0);
        row[first] = image;
    }

    /// Adds a variable, and a coordinate that is that variable, behind the others.
    pub(super) fn grow(&mut self) {
        let (stride, last) = (self.stride, self.size);
        self.columns[last * stride..(last + 1) * stride].fill(0.0);
        self.columns[last * stride + last] = 1.0;
        self.size += 1;
    }
}
