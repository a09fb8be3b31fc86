//! The orthogonal factor Q of the stacked rows, A = [L 0] Qᵀ.

use std::ops::Range;

use super::chain::Chain;
use super::{LANES, first_lane};
use crate::linalg::kernels::{
    BlockFactor, FourReflections, Rotation, RowsMut, add_rows, mix_rows, mix_rows_four,
    multiply_rows, reflect_rows, reflect_rows_four, rotate_rows,
};
use crate::linalg::list::List;
use crate::linalg::vector::reflector;
use crate::solver::tolerances::ROTATIONS;

/// How Q is kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Form {
    /// As the product of the reflections and rotations that made it: cheap to make.
    Product,
    /// Multiplied out: cheap to change often.
    Explicit,
}

/// Q, for vectors over the free variables; sized once.
#[derive(Debug, Clone)]
pub(crate) struct Orthogonal {
    form: Form,
    /// Entries from vector to vector: the variables, and zeros up to whole lanes.
    stride: usize,
    /// Entries of vectors in use, and how many the reflections have.
    size: usize,
    reflected: usize,
    /// The columns of Q one after the other, where it is explicit.
    columns: Vec<f64>,
    /// Reflector i stands at i times the stride, from entry i on.
    reflectors: Vec<f64>,
    tau: Vec<f64>,
    reflections: usize,
    /// What makes one of four reflections, for every four of them.
    blocks: List<BlockFactor>,
    /// What the coordinates have been through since, and the rotations in it.
    chains: List<Chain>,
    pub(super) rotations: List<Rotation>,
    scratch: Vec<f64>,
}

impl Orthogonal {
    pub(super) fn new(variables: usize) -> Self {
        let stride = variables.next_multiple_of(LANES);
        Self {
            form: Form::Product,
            stride,
            size: 0,
            reflected: 0,
            columns: vec![0.0; variables * stride],
            reflectors: vec![0.0; variables * stride],
            tau: vec![0.0; variables],
            reflections: 0,
            blocks: List::with_capacity(variables / LANES),
            chains: List::with_capacity(ROTATIONS * variables),
            rotations: List::with_capacity(ROTATIONS * variables),
            scratch: vec![0.0; stride],
        }
    }

    /// The identity, for vectors of `size` entries.
    pub(super) fn begin(&mut self, size: usize, form: Form) {
        (self.form, self.size, self.reflected, self.reflections) = (form, size, size, 0);
        self.blocks.clear();
        self.chains.clear();
        self.rotations.clear();
        if form == Form::Explicit {
            self.columns[..size * self.stride].fill(0.0);
            self.columns.iter_mut().step_by(self.stride + 1).take(size).for_each(|one| *one = 1.0);
        }
    }

    pub(super) fn form(&self) -> Form {
        self.form
    }

    /// The identity again, in the same form.
    pub(super) fn begin_again(&mut self, size: usize) {
        self.begin(size, self.form);
    }

    /// Adds the reflection that turns what `row` has from entry `step` on into that entry, and applies
    /// it to the rows in `below`. Returns the entry.
    pub(super) fn reflect(&mut self, step: usize, row: &[f64], below: &mut [f64]) -> f64 {
        let (stride, whole) = (self.stride, self.reflected.next_multiple_of(LANES));
        let reflection = &mut self.reflectors[step * stride..step * stride + whole];
        reflection[step.saturating_sub(LANES)..step].fill(0.0);
        reflection[self.size..].fill(0.0);
        let v = &mut reflection[step..self.size];
        v.copy_from_slice(&row[step..self.size]);
        let (tau, image) = reflector(v);
        self.tau[step] = tau;
        let first = first_lane(step);
        let v = &reflection[first..];
        reflect_rows(&mut RowsMut { data: below, stride }, first, v, tau);
        if self.form == Form::Product {
            self.reflections = step + 1;
            if self.reflections.is_multiple_of(LANES) {
                let first = self.reflections - LANES;
                let factor = BlockFactor::new(self.four(first, first), &self.tau[first..]);
                self.blocks.push(factor);
            }
        }
        image
    }

    /// Multiplies the reflections of these steps into an explicit Q.
    pub(super) fn absorb(&mut self, steps: Range<usize>) {
        if self.form == Form::Product {
            return;
        }
        let (stride, size) = (self.stride, self.size);
        let mut columns = std::mem::take(&mut self.columns);
        let mut step = steps.start;
        while step < steps.end {
            let data = &mut columns[step * stride..size * stride];
            if step + LANES <= steps.end {
                let v: [_; LANES] = std::array::from_fn(|i| &self.reflector(step + i)[step..size]);
                let factor = BlockFactor::new(v, &self.tau[step..]);
                let four = FourReflections::new(v, &factor);
                mix_rows_four(&mut RowsMut { data, stride }, &four);
                step += LANES;
            } else {
                let v = &self.reflector(step)[step..size];
                mix_rows(&mut RowsMut { data, stride }, v, self.tau[step]);
                step += 1;
            }
        }
        self.columns = columns;
    }

    fn reflector(&self, step: usize) -> &[f64] {
        &self.reflectors[step * self.stride..(step + 1) * self.stride]
    }

    /// Four reflectors, over whole lanes from entry `start` on.
    fn four(&self, first: usize, start: usize) -> [&[f64]; LANES] {
        let whole = self.reflected.next_multiple_of(LANES);
        std::array::from_fn(|i| &self.reflector(first + i)[start..whole])
    }

    /// The four reflections of a block as one.
    fn block(&self, block: usize) -> ([&[f64]; LANES], &BlockFactor) {
        (self.four(block * LANES, block * LANES), &self.blocks[block])
    }

    /// Reflections behind the last whole block.
    fn single_reflections(&self) -> Range<usize> {
        self.blocks.len() * LANES..self.reflections
    }

    /// Takes rows over the free variables, with zeros behind, into the coordinates of Q. A product may
    /// hold reflections only. Coordinates before `first` become zero where Q is explicit.
    pub(super) fn turn_rows(&mut self, data: &mut [f64], first: usize) {
        let stride = self.stride;
        if self.form == Form::Explicit {
            for row in data.chunks_exact_mut(stride) {
                self.scratch.copy_from_slice(row);
                row[..first].fill(0.0);
                let part = &mut row[first..self.size];
                multiply_rows(&self.columns[first * stride..], stride, &self.scratch, part);
            }
            return;
        }
        for block in 0..self.blocks.len() {
            let (v, factor) = self.block(block);
            let four = FourReflections::new(v, factor);
            reflect_rows_four(&mut RowsMut { data, stride }, block * LANES, &four);
        }
        for step in self.single_reflections() {
            self.apply_reflection(step, data);
        }
    }

    fn apply_reflection(&self, step: usize, data: &mut [f64]) {
        let whole = self.reflected.next_multiple_of(LANES);
        let first = first_lane(step);
        let v = &self.reflector(step)[first..whole];
        reflect_rows(&mut RowsMut { data, stride: self.stride }, first, v, self.tau[step]);
    }

    /// Takes one vector into the coordinates of Q; those before `first` become zero where it is explicit.
    pub(super) fn turn(&mut self, vector: &mut [f64], first: usize) {
        self.turn_rows(vector, first);
        for chain in &self.chains {
            chain.apply(&self.rotations, vector);
        }
    }

    /// Takes the unit vector at `place` into the coordinates of Q; `vector` is zero. Those before `first`
    /// stay zero where it is explicit.
    pub(super) fn turn_unit(&mut self, vector: &mut [f64], place: usize, first: usize) {
        if self.form == Form::Explicit {
            let entries = self.columns[first * self.stride..].iter().skip(place);
            let coordinates = &mut vector[first..self.size];
            for (to, from) in coordinates.iter_mut().zip(entries.step_by(self.stride)) {
                *to = *from;
            }
        } else {
            vector[place] = 1.0;
            self.turn(vector, first);
        }
    }

    /// The coordinates from `first` on of a vector, where Q is explicit.
    pub(super) fn turn_part(&self, vector: &[f64], first: usize, out: &mut [f64]) {
        multiply_rows(&self.columns[first * self.stride..], self.stride, vector, out);
    }

    /// Takes coordinates from `first` on, the others zero, to the vector, where Q is explicit.
    pub(super) fn turn_part_back(&self, coordinates: &[f64], first: usize, out: &mut [f64]) {
        out.fill(0.0);
        add_rows(&self.columns[first * self.stride..], self.stride, coordinates, out);
    }

    /// Takes coordinates, with zeros behind, to the vector over the free variables.
    pub(super) fn turn_back(&mut self, vector: &mut [f64]) {
        if self.form == Form::Explicit {
            self.scratch.fill(0.0);
            add_rows(&self.columns, self.stride, &vector[..self.size], &mut self.scratch);
            vector.copy_from_slice(&self.scratch);
            return;
        }
        for chain in self.chains.iter().rev() {
            chain.undo(&self.rotations, vector);
        }
        for step in self.single_reflections().rev() {
            self.apply_reflection(step, vector);
        }
        let stride = self.stride;
        for block in (0..self.blocks.len()).rev() {
            let (v, factor) = self.block(block);
            let four = FourReflections::reversed(v, factor);
            reflect_rows_four(&mut RowsMut { data: vector, stride }, block * LANES, &four);
        }
    }

    /// Returns true if the product has become so long that making it anew is cheaper.
    pub(super) fn is_long(&self) -> bool {
        // A change adds at most three chains of as many rotations as there are variables.
        self.form == Form::Product
            && (self.rotations.len() + 3 * self.stride > self.rotations.capacity()
                || self.chains.len() + 2 > self.chains.capacity())
    }

    /// Begins a change of the coordinates by rotations.
    pub(super) fn begin_change(&mut self) {
        if self.form == Form::Explicit {
            self.rotations.clear();
        }
    }

    /// Turns the coordinates by a chain of the present rotations.
    pub(super) fn push_chain(&mut self, chain: Chain) {
        if self.form == Form::Product {
            self.chains.push(chain);
            return;
        }
        let stride = self.stride;
        match chain {
            Chain::Down(places) | Chain::Up(places) | Chain::Aside(places) => {
                let data = &mut self.columns[..self.size * stride];
                rotate_rows(&mut RowsMut { data, stride }, &self.rotations[places]);
            }
            Chain::Insert { from, to } => {
                self.columns[to * stride..(from + 1) * stride].rotate_right(stride);
            }
        }
    }

    /// Turns the coordinates from `first` on, along which no stacked row has an entry, so that `row` has
    /// only the first of them. Does so where Q is explicit, and returns true.
    pub(super) fn reflect_free(&mut self, row: &mut [f64], first: usize) -> bool {
        if self.form == Form::Product {
            return false;
        }
        let v = &mut self.scratch[..self.size - first];
        v.copy_from_slice(&row[first..self.size]);
        let (tau, image) = reflector(v);
        let stride = self.stride;
        let data = &mut self.columns[first * stride..self.size * stride];
        mix_rows(&mut RowsMut { data, stride }, v, tau);
        row[first..self.size].fill(0.0);
        row[first] = image;
        true
    }

    /// Adds a variable, and a coordinate that is that variable, behind the others.
    pub(super) fn grow(&mut self) {
        let (stride, last) = (self.stride, self.size);
        if self.form == Form::Explicit {
            self.columns[last * stride..(last + 1) * stride].fill(0.0);
            self.columns[last * stride + last] = 1.0;
            self.reflected = last + 1;
        }
        self.size += 1;
    }
}
