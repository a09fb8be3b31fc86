//! The orthogonal factor Q of the stacked rows, A = [L 0] Qᵀ.
//!
//! Elimination gives it as a product of reflections, which is sufficient for solving. Later changes
//! need it multiplied out.

use std::ops::Range;

use super::{LANES, first_lane};
use crate::linalg::kernels::{
    BlockFactor, FourReflections, Rotation, RowsMut, add_rows, mix_rows, multiply_rows,
    reflect_rows, reflect_rows_four, rotate_rows, rows_mut,
};
use crate::linalg::vector::reflector;

/// Q for vectors over the free variables. All memory is allocated once.
#[derive(Debug, Clone)]
pub(crate) struct Orthogonal {
    /// Distance between vectors: the number of variables, padded with zeros to whole lanes.
    stride: usize,
    /// Number of entries of vectors in use.
    size: usize,
    /// Columns of Q one after the other, without the pending reflections. Unused if Q without them
    /// is the identity.
    columns: Vec<f64>,
    is_identity: bool,
    /// Reflector i starts at i times the stride, and has entries from i on.
    reflectors: Vec<f64>,
    tau: Vec<f64>,
    /// Factors that combine four reflections in one, for every four of them.
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

    /// Resets Q to the identity, for vectors of `size` entries.
    pub(super) fn begin(&mut self, size: usize) {
        (self.size, self.is_identity, self.pending) = (size, true, 0..0);
    }

    /// Adds the reflection that maps the entries of `row` from `step` on into entry `step`, and
    /// applies it to the rows in `below`. Returns the entry.
    pub(super) fn reflect(&mut self, step: usize, row: &[f64], below: &mut [f64]) -> f64 {
        if self.pending.is_empty() {
            self.pending = step..step;
        }
        self.pending.end = step + 1;
        let stride = self.stride;
        let reflection = &mut self.reflectors[step * stride..(step + 1) * stride];
        // The row is padded with zeros, as the reflector must be.
        let first = first_lane(step);
        reflection[first..].copy_from_slice(&row[first..]);
        reflection[first..step].fill(0.0);
        let v = &mut reflection[step..self.size];
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

    /// Returns the entries of reflector `step` from entry `first` on.
    fn reflector(&self, step: usize, first: usize) -> &[f64] {
        let start = step * self.stride;
        &self.reflectors[start + first..start + self.size.next_multiple_of(LANES)]
    }

    /// Returns the reflectors of four steps.
    fn block(&self, block: usize) -> [&[f64]; LANES] {
        std::array::from_fn(|i| self.reflector(block * LANES + i, block * LANES))
    }

    /// Applies one of the reflections to rows.
    fn reflect_rows(&self, step: usize, data: &mut [f64]) {
        if !data.is_empty() {
            let (stride, first) = (self.stride, first_lane(step));
            let v = self.reflector(step, first);
            reflect_rows(&mut RowsMut { data, stride }, first, v, self.tau[step]);
        }
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

    /// Applies the pending reflections to rows, from the last to the first. `changed` returns the
    /// first row that changes for reflections from a step on.
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

    /// Discards the pending reflections from this step on, since no row needs them.
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
            // From the last to the first, each reflection meets only columns that later ones have
            // changed.
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

    /// Returns the first coordinate that pending reflections need to compute those from `first` on.
    fn first_needed(&self, first: usize) -> usize {
        if self.pending.is_empty() { first } else { first.min(self.pending.start) }
    }

    /// Transforms rows over the free variables, padded with zeros, into the coordinates of Q.
    pub(super) fn turn_rows(&mut self, data: &mut [f64]) {
        if !self.is_identity {
            for row in rows_mut(data, self.stride) {
                self.scratch.copy_from_slice(row);
                multiply_rows(&self.columns, self.stride, &self.scratch, &mut row[..self.size]);
            }
        }
        self.apply(self.pending.clone(), data);
    }

    /// Transforms the unit vector at `place` into the coordinates of Q, which must be multiplied
    /// out. `vector` is zero before.
    pub(super) fn turn_unit(&self, vector: &mut [f64], place: usize) {
        let entries = self.columns.iter().skip(place).step_by(self.stride);
        for (to, from) in vector[..self.size].iter_mut().zip(entries) {
            *to = *from;
        }
    }

    /// Computes the coordinates of a vector from `first` on.
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

    /// Transforms coordinates from `first` on, with zeros before, to the vector over the free
    /// variables.
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

    /// Rotates the coordinates, one rotation after the other.
    pub(super) fn rotate(&mut self, rotations: &[Rotation]) {
        let data = &mut self.columns[..self.size * self.stride];
        rotate_rows(&mut RowsMut { data, stride: self.stride }, rotations);
    }

    /// Moves the last coordinate to `place`, and shifts those from there on.
    pub(super) fn move_last(&mut self, place: usize) {
        self.columns[place * self.stride..self.size * self.stride].rotate_right(self.stride);
    }

    /// Reflects the coordinates from `first` on so that `row` has an entry only along the first of
    /// them. No stacked row has entries along these coordinates.
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

    /// Appends a variable, and a coordinate that equals this variable.
    pub(super) fn grow(&mut self) {
        let (stride, last) = (self.stride, self.size);
        self.columns[last * stride..(last + 1) * stride].fill(0.0);
        self.columns[last * stride + last] = 1.0;
        self.size += 1;
    }
}
