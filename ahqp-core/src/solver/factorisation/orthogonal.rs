//! The orthogonal factor Q of the stacked rows, A = [L 0] Qᵀ.
//!
//! Elimination gives it as a product of reflections. That is all it takes to solve with; what changes it
//! later needs it multiplied out.

use std::ops::Range;

use super::{LANES, first_lane};
use crate::linalg::kernels::{
    BlockFactor, FourReflections, Rotation, RowsMut, add_rows, mix_rows, multiply_rows,
    reflect_rows, reflect_rows_four, rotate_rows,
};
use crate::linalg::vector::reflector;

/// Q, for vectors over the free variables; sized once.
#[derive(Debug, Clone)]
pub(crate) struct Orthogonal {
    /// Entries from vector to vector: the variables, and zeros up to whole lanes.
    stride: usize,
    /// Entries of vectors in use.
    size: usize,
    /// The columns of Q one after the other, but for the pending reflections; unless they are the identity's.
    columns: Vec<f64>,
    is_identity: bool,
    /// Reflector i stands at i times the stride, from entry i on.
    reflectors: Vec<f64>,
    tau: Vec<f64>,
    /// What makes one of four reflections, for every four of them.
    blocks: Vec<BlockFactor>,
    /// Reflections that are not multiplied out.
    pending: Range<usize>,
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
            blocks: vec![BlockFactor::default(); variables / LANES],
            pending: 0..0,
            scratch: vec![0.0; stride],
        }
    }

    /// The identity, for vectors of `size` entries.
    pub(super) fn begin(&mut self, size: usize) {
        (self.size, self.is_identity, self.pending) = (size, true, 0..0);
    }

    /// Adds the reflection that turns what `row` has from entry `step` on into that entry, and applies
    /// it to the rows in `below`. Returns the entry.
    pub(super) fn reflect(&mut self, step: usize, row: &[f64], below: &mut [f64]) -> f64 {
        if self.pending.is_empty() {
            self.pending = step..step;
        }
        self.pending.end = step + 1;
        let stride = self.stride;
        let reflection = &mut self.reflectors[step * stride..(step + 1) * stride];
        reflection[first_lane(step)..step].fill(0.0);
        reflection[self.size..].fill(0.0);
        let v = &mut reflection[step..self.size];
        v.copy_from_slice(&row[step..self.size]);
        let (tau, image) = reflector(v);
        self.tau[step] = tau;
        self.reflect_rows(step, below);
        if (step + 1).is_multiple_of(LANES) && self.pending.start + LANES <= step + 1 {
            let block = step / LANES;
            let factor = FourReflections::factor(self.block(block), &self.tau[block * LANES..]);
            self.blocks[block] = factor;
        }
        image
    }

    /// What reflector `step` has from entry `first` on.
    fn reflector(&self, step: usize, first: usize) -> &[f64] {
        let start = step * self.stride;
        &self.reflectors[start + first..start + self.size.next_multiple_of(LANES)]
    }

    /// The reflectors of four steps.
    fn block(&self, block: usize) -> [&[f64]; LANES] {
        std::array::from_fn(|i| self.reflector(block * LANES + i, block * LANES))
    }

    /// Applies one of the reflections to rows.
    fn reflect_rows(&self, step: usize, data: &mut [f64]) {
        let (stride, first) = (self.stride, first_lane(step));
        let v = self.reflector(step, first);
        reflect_rows(&mut RowsMut { data, stride }, first, v, self.tau[step]);
    }

    /// Applies pending reflections to rows, from the first to the last.
    pub(super) fn apply(&self, steps: Range<usize>, data: &mut [f64]) {
        let mut step = steps.start;
        while step < steps.end && !data.is_empty() {
            if step.is_multiple_of(LANES) && step + LANES <= steps.end {
                let block = step / LANES;
                let four = FourReflections::forward(self.block(block), &self.blocks[block]);
                reflect_rows_four(&mut RowsMut { data, stride: self.stride }, step, &four);
                step += LANES;
            } else {
                self.reflect_rows(step, data);
                step += 1;
            }
        }
    }

    /// Applies the pending reflections to rows, from the last to the first. `changed` gives the rows that
    /// those from a step on change.
    fn apply_back(&self, data: &mut [f64], changed: impl Fn(usize) -> usize) {
        let Range { start, mut end } = self.pending;
        while end > start {
            if end.is_multiple_of(LANES) && start + LANES <= end {
                end -= LANES;
                let block = end / LANES;
                let four = FourReflections::backward(self.block(block), &self.blocks[block]);
                let data = &mut data[changed(end) * self.stride..];
                reflect_rows_four(&mut RowsMut { data, stride: self.stride }, end, &four);
            } else {
                end -= 1;
                self.reflect_rows(end, &mut data[changed(end) * self.stride..]);
            }
        }
    }

    /// Forgets the reflections of elimination from this step on, if they are pending: no row needs them.
    pub(super) fn forget_from(&mut self, step: usize) {
        self.pending.end = self.pending.end.min(step);
        self.pending.start = self.pending.start.min(step);
    }

    /// Multiplies the pending reflections into the columns.
    pub(super) fn multiply_out(&mut self) {
        let (stride, size) = (self.stride, self.size);
        if self.is_identity {
            self.is_identity = false;
            let mut columns = std::mem::take(&mut self.columns);
            let data = &mut columns[..size * stride];
            data.fill(0.0);
            data.iter_mut().step_by(stride + 1).for_each(|one| *one = 1.0);
            // From the last to the first, as each meets only what those behind it have mixed.
            self.apply_back(data, |step| step);
            self.columns = columns;
        } else {
            for step in self.pending.clone() {
                let v = &self.reflectors[step * stride + step..step * stride + size];
                let data = &mut self.columns[step * stride..size * stride];
                mix_rows(&mut RowsMut { data, stride }, stride, v, self.tau[step]);
            }
        }
        self.pending = 0..0;
    }

    /// The first coordinate that pending reflections need of those from `first` on.
    fn first_needed(&self, first: usize) -> usize {
        if self.pending.is_empty() { first } else { first.min(self.pending.start) }
    }

    /// Takes rows over the free variables, with zeros behind, into the coordinates of Q. Coordinates before
    /// `first` become zero.
    pub(super) fn turn_rows(&mut self, data: &mut [f64], first: usize) {
        if !self.is_identity {
            let needed = self.first_needed(first);
            for row in data.chunks_exact_mut(self.stride) {
                self.scratch.copy_from_slice(row);
                row[..needed].fill(0.0);
                let part = &mut row[needed..self.size];
                let columns = &self.columns[needed * self.stride..];
                multiply_rows(columns, self.stride, &self.scratch, part);
            }
        }
        self.apply(self.pending.clone(), data);
        if first > 0 {
            data.chunks_exact_mut(self.stride).for_each(|row| row[..first].fill(0.0));
        }
    }

    /// Takes the unit vector at `place` into the coordinates of Q, multiplied out; `vector` is zero. Those
    /// before `first` stay zero.
    pub(super) fn turn_unit(&self, vector: &mut [f64], place: usize, first: usize) {
        let entries = self.columns[first * self.stride..].iter().skip(place);
        let coordinates = &mut vector[first..self.size];
        for (to, from) in coordinates.iter_mut().zip(entries.step_by(self.stride)) {
            *to = *from;
        }
    }

    /// The coordinates from `first` on of a vector.
    pub(super) fn turn_part(&mut self, vector: &[f64], first: usize, out: &mut [f64]) {
        if self.is_identity || !self.pending.is_empty() {
            let mut turned = std::mem::take(&mut self.scratch);
            let needed = self.first_needed(first);
            if self.is_identity {
                turned.copy_from_slice(vector);
            } else {
                turned[self.size..].fill(0.0);
                let columns = &self.columns[needed * self.stride..];
                multiply_rows(columns, self.stride, vector, &mut turned[needed..self.size]);
            }
            self.apply(self.pending.clone(), &mut turned);
            out.copy_from_slice(&turned[first..first + out.len()]);
            self.scratch = turned;
        } else {
            multiply_rows(&self.columns[first * self.stride..], self.stride, vector, out);
        }
    }

    /// Takes coordinates from `first` on, the others zero, to the vector over the free variables.
    pub(super) fn turn_part_back(&mut self, coordinates: &[f64], first: usize, out: &mut [f64]) {
        out.fill(0.0);
        if self.is_identity || !self.pending.is_empty() {
            let mut turned = std::mem::take(&mut self.scratch);
            turned.fill(0.0);
            turned[first..first + coordinates.len()].copy_from_slice(coordinates);
            self.apply_back(&mut turned, |_| 0);
            if self.is_identity {
                out.copy_from_slice(&turned[..out.len()]);
            } else {
                let needed = self.first_needed(first);
                let columns = &self.columns[needed * self.stride..];
                add_rows(columns, self.stride, &turned[needed..self.size], out);
            }
            self.scratch = turned;
        } else {
            add_rows(&self.columns[first * self.stride..], self.stride, coordinates, out);
        }
    }

    /// Turns the coordinates by rotations, one after the other.
    pub(super) fn rotate(&mut self, rotations: &[Rotation]) {
        let data = &mut self.columns[..self.size * self.stride];
        rotate_rows(&mut RowsMut { data, stride: self.stride }, rotations);
    }

    /// The last coordinate comes to stand at `place`; those from there on make room.
    pub(super) fn move_last(&mut self, place: usize) {
        self.columns[place * self.stride..self.size * self.stride].rotate_right(self.stride);
    }

    /// Turns the coordinates from `first` on, along which no stacked row has an entry, so that `row` has
    /// only the first of them.
    pub(super) fn reflect_free(&mut self, row: &mut [f64], first: usize) {
        let v = &mut self.scratch[..self.size - first];
        v.copy_from_slice(&row[first..self.size]);
        let (tau, image) = reflector(v);
        let stride = self.stride;
        let data = &mut self.columns[first * stride..self.size * stride];
        mix_rows(&mut RowsMut { data, stride }, stride, v, tau);
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
