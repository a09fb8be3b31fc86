//! What each level determines: the rows of all levels, made orthogonal to those above.

use std::ops::Range;

use ahqp_core::Rows;

use crate::vector::{dot, subtract};

/// The rows of all levels, scaled to norm one or less, and the orthonormal directions that they take in turn.
///
/// Of the directions only the coordinates of the rows along them are computed: they are the Cholesky
/// factor of all rows' products with each other (Golub and Van Loan, *Matrix Computations*, 4th ed.,
/// Sec. 4.2.5). That of a level's rows among themselves is the Cholesky factor of its G.
///
/// What belongs to two rows stands in the row of the one above, with the other one as the column; what
/// stands in columns before a row's own means nothing. Columns are taken four at a time.
#[derive(Debug, Clone)]
pub(super) struct Directions {
    /// How many rows there are.
    count: usize,
    /// Fours of columns.
    width: usize,
    rows: Rows,
    norms: Vec<f64>,
    /// One over the norms; zero in columns without rows.
    scales: Vec<Four>,
    /// What is missing to the scaled targets, after what the levels above do.
    residual: Vec<Four>,
    /// Of the scaled rows.
    products: Vec<Four>,
    /// By direction: the coordinates of all rows. Those of rows that depend on others are zero.
    coordinates: Vec<Four>,
    /// By direction: one over the coordinate of its own row; zero where there is no direction.
    reciprocals: Vec<f64>,
    /// The transposed inverse of a level's coordinates.
    inverse: Vec<Four>,
    /// Factors of the rows above a level.
    above: Vec<f64>,
}

type Four = [f64; 4];

/// A row of which less than the root of this is left belongs to the levels below. Products are exact
/// to 1e-16, so a direction is to 1e-16 over this, and the square of that is still less than this.
const NOTHING: f64 = 1e-9;
/// Of the largest norm of a level's rows, the least that a row is scaled by: a row that has nearly
/// vanished is one that is lost.
const SMALLEST: f64 = 0.3;

impl Directions {
    /// With room for so many rows over so many variables, `most` of them on one level.
    pub(super) fn new(room: usize, most: usize, columns: usize) -> Self {
        let (width, none) = (room.div_ceil(4), [0.0; 4]);
        Self {
            count: 0,
            width,
            rows: Rows::zeros(room, columns),
            norms: vec![1.0; room],
            scales: vec![none; width],
            residual: vec![none; width],
            products: vec![none; room * width],
            coordinates: vec![none; room * width],
            reciprocals: vec![0.0; room],
            inverse: vec![none; most * most.div_ceil(4)],
            above: vec![0.0; room],
        }
    }

    /// Forgets all rows.
    pub(super) fn clear(&mut self) {
        self.count = 0;
    }

    /// Takes the first `m` rows of the next level and returns their places; none, where there is no
    /// room.
    pub(super) fn push(&mut self, rows: &Rows, m: usize) -> Range<usize> {
        let first = self.count;
        if first + m > self.rows.len() {
            return first..first;
        }
        for (index, (row, target, _)) in rows.iter().enumerate().take(m) {
            self.rows.row_mut(first + index).unwrap_or_default().copy_from_slice(row);
            self.residual.as_flattened_mut()[first + index] = target;
            self.norms[first + index] = dot(row, row).sqrt();
        }
        let norms = &mut self.norms[first..first + m];
        let least = SMALLEST * norms.iter().fold(0.0_f64, |most, norm| most.max(*norm));
        for norm in norms {
            *norm = if least > 0.0 { norm.max(least) } else { 1.0 };
        }
        self.count += m;
        first..self.count
    }

    /// Takes a row with a target of zero in before place `at`; rows from there on stand one place later. Returns
    /// false where there is no room.
    pub(super) fn insert(&mut self, at: usize, write: impl FnOnce(&mut [f64])) -> bool {
        let (count, columns) = (self.count, self.rows.columns());
        if count == self.rows.len() {
            return false;
        }
        if let Ok(rows) = self.rows.coefficients_mut(at..count + 1) {
            rows.copy_within(..(count - at) * columns, columns);
            let row = &mut rows[..columns];
            row.fill(0.0);
            write(row);
            self.norms.copy_within(at..count, at + 1);
            self.norms[at] = dot(row, row).sqrt();
        }
        let residual = self.residual.as_flattened_mut();
        residual.copy_within(at..count, at + 1);
        residual[at] = 0.0;
        self.count += 1;
        true
    }

    /// Takes the rows of these places out; rows behind them stand so many places earlier.
    pub(super) fn remove(&mut self, places: Range<usize>) {
        let (count, columns) = (self.count, self.rows.columns());
        if let Ok(rows) = self.rows.coefficients_mut(places.start..count) {
            rows.copy_within(places.len() * columns.., 0);
        }
        self.norms.copy_within(places.end..count, places.start);
        self.residual.as_flattened_mut().copy_within(places.end..count, places.start);
        self.count -= places.len();
    }

    /// Scales the targets, and computes the directions of all rows.
    pub(super) fn factorise(&mut self) {
        let targets = self.residual.as_flattened_mut().iter_mut().zip(&self.norms);
        targets.take(self.count).for_each(|(target, norm)| *target /= norm);
        self.find_coordinates();
    }

    /// Computes the directions of all rows anew, after some were taken in.
    pub(super) fn find_coordinates(&mut self) {
        let (width, n) = (self.width, self.count);
        let scales = self.scales.as_flattened_mut();
        scales[n..].fill(0.0);
        for (i, scale) in scales[..n].iter_mut().enumerate() {
            let products = &mut self.products[i * width..][..width].as_flattened_mut()[i..n];
            let own = self.rows.row(i).unwrap_or_default();
            // Of rows that there are: no error is possible.
            let _ = self.rows.multiply_into(i, own, products);
            *scale = 1.0 / self.norms[i];
        }
        for i in 0..n {
            let scale = self.scales.as_flattened()[i];
            let products = &mut self.products[i * width..][..width];
            let (above, own) = self.coordinates.split_at_mut(i * width);
            let own = &mut own[..width];
            let scaled = products.as_flattened_mut().iter_mut().zip(self.scales.as_flattened());
            scaled.for_each(|(product, other)| *product *= scale * other);
            own.copy_from_slice(products);
            for above in above.chunks_exact(width) {
                subtract_fours(&mut own[i / 4..], above[i / 4][i % 4], &above[i / 4..]);
            }
            let left = own.as_flattened()[i];
            let reciprocal = if left > NOTHING { 1.0 / left.sqrt() } else { 0.0 };
            self.reciprocals[i] = reciprocal;
            own.as_flattened_mut().iter_mut().for_each(|entry| *entry *= reciprocal);
        }
    }

    /// The trace of G⁻¹ of a level; infinite where a row depends on others.
    pub(super) fn inverse_trace(&mut self, span: &Range<usize>) -> f64 {
        let width = span.len().div_ceil(4);
        let mut trace = 0.0;
        for (i, index) in span.clone().enumerate() {
            let reciprocal = self.reciprocals[index];
            if reciprocal == 0.0 {
                return f64::INFINITY;
            }
            let level = &self.coordinates[span.start * self.width..];
            let (above, own) = self.inverse.split_at_mut(i * width);
            let own = &mut own[..width];
            own.fill([0.0; 4]);
            own[i / 4][i % 4] = 1.0;
            for (above, level) in above.chunks_exact(width).zip(level.chunks_exact(self.width)) {
                subtract_fours(own, level[index / 4][index % 4], above);
            }
            for value in own.as_flattened_mut() {
                *value *= reciprocal;
                trace += *value * *value;
            }
        }
        trace
    }

    /// Writes G of a level.
    pub(super) fn gram_into(&self, span: &Range<usize>, gram: &mut [f64]) {
        let (m, size) = (span.len(), 4 * self.width);
        let (products, above) = (self.products.as_flattened(), self.coordinates.as_flattened());
        for (a, own) in gram.chunks_exact_mut(m).enumerate() {
            let row = span.start + a;
            own[a..].copy_from_slice(&products[row * size..][row..span.end]);
            for above in above.chunks_exact(size).take(span.start) {
                subtract(&mut own[a..], above[row], &above[row..span.end]);
            }
        }
        for a in 1..m {
            for b in 0..a {
                gram[a * m + b] = gram[b * m + a];
            }
        }
    }

    /// Writes the sum of a level's scaled rows, freed of what the rows above determine, with these
    /// factors.
    pub(super) fn combine(&mut self, span: &Range<usize>, factors: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        let size = 4 * self.width;
        let scales = self.scales.as_flattened();
        for (factor, index) in factors.iter().zip(span.clone()) {
            subtract(out, -factor * scales[index], self.rows.row(index).unwrap_or_default());
        }
        // Those above in the sum that has the same coordinates along their directions.
        let coordinates = self.coordinates.as_flattened();
        for above in (0..span.start).rev() {
            let own = &coordinates[above * size..][..size];
            let level: f64 = own[span.clone()].iter().zip(factors).map(|(a, b)| a * b).sum();
            let later = own[above + 1..span.start].iter().zip(&self.above[above + 1..span.start]);
            let later: f64 = later.map(|(a, b)| a * b).sum();
            let part = (level - later) * self.reciprocals[above];
            self.above[above] = part;
            subtract(out, part * scales[above], self.rows.row(above).unwrap_or_default());
        }
    }

    /// Writes the orthonormal direction that a row takes; returns false if it takes none.
    pub(super) fn direction_into(&mut self, row: usize, out: &mut [f64]) -> bool {
        let reciprocal = self.reciprocals[row];
        if reciprocal > 0.0 {
            self.combine(&(row..row + 1), &[reciprocal], out);
        }
        reciprocal > 0.0
    }

    /// ‖L⁻¹r‖² of a level, L Lᵀ being its G and r what is missing to its targets; `room` is room for
    /// these.
    pub(super) fn square_of_speed(&self, span: &Range<usize>, room: &mut [f64]) -> f64 {
        room.copy_from_slice(self.residual(span));
        let mut square = 0.0;
        let directions = self.coordinates.as_flattened().chunks_exact(4 * self.width);
        let directions = directions.enumerate().skip(span.start).take(span.len());
        for (i, (index, coordinates)) in directions.enumerate() {
            let speed = room[i] * self.reciprocals[index];
            square += speed * speed;
            subtract(&mut room[i..], speed, &coordinates[index..span.end]);
        }
        square
    }

    /// Takes from the targets below what a level does by itself.
    pub(super) fn take(&mut self, span: &Range<usize>) {
        if span.end == self.count {
            return;
        }
        for index in span.clone() {
            let speed = self.residual.as_flattened()[index] * self.reciprocals[index];
            let coordinates = &self.coordinates[index * self.width..][..self.width];
            subtract_fours(&mut self.residual[index / 4..], speed, &coordinates[index / 4..]);
        }
    }

    /// What is missing to the scaled targets of a level.
    pub(super) fn residual(&self, span: &Range<usize>) -> &[f64] {
        &self.residual.as_flattened()[span.clone()]
    }

    /// The same, to be reduced.
    pub(super) fn residual_mut(&mut self, span: &Range<usize>) -> &mut [f64] {
        &mut self.residual.as_flattened_mut()[span.clone()]
    }

    /// The norms of a level's rows; 1 for rows of zeros.
    pub(super) fn norms(&self, span: &Range<usize>) -> &[f64] {
        &self.norms[span.clone()]
    }
}

/// a ← a − factor · b.
fn subtract_fours(a: &mut [Four], factor: f64, b: &[Four]) {
    a.as_flattened_mut().iter_mut().zip(b.as_flattened()).for_each(|(a, b)| *a -= factor * b);
}
