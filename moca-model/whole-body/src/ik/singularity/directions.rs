//! Orthogonalisation: the rows of each level without what the rows above determine.

use std::ops::Range;

use ahqp_core::Rows;

use crate::vector::{dot, subtract};

/// The rows of all levels, scaled to norm one or less, and their orthonormal directions in order of priority.
///
/// Directions are only known by the coordinates of the rows along them. These are the Cholesky factor of the products
/// of all rows with each other (Golub and Van Loan, *Matrix Computations*, 4th ed., Sec. 4.2.5). The block of a level's
/// own rows is the Cholesky factor of its G.
///
/// A number that belongs to two rows stands in the row of the upper one and the column of the lower one. Columns before
/// a row's own have no meaning. Columns are processed four at a time.
#[derive(Debug, Clone)]
pub(super) struct Directions {
    /// Number of rows.
    count: usize,
    /// Number of groups of four columns.
    width: usize,
    rows: Rows,
    norms: Vec<f64>,
    /// Reciprocals of the norms; zero in columns without rows.
    scales: Vec<Four>,
    /// Residual of the scaled targets after the levels above.
    residual: Vec<Four>,
    /// Products of the scaled rows with each other.
    products: Vec<Four>,
    /// Coordinates of all rows along each direction; zero where the direction's row depends on others.
    coordinates: Vec<Four>,
    /// Reciprocal of each direction's coordinate of its own row; zero where there is no direction.
    reciprocals: Vec<f64>,
    /// The transposed inverse of a level's coordinates.
    inverse: Vec<Four>,
    /// Factors of the rows above a level.
    above: Vec<f64>,
}

type Four = [f64; 4];

/// Squared norm below which the rest of a row counts as zero. Products are exact to 1e-16, so the error of a direction
/// is 1e-16 over this, and its square is still smaller.
const NOTHING: f64 = 1e-9;
/// Smallest norm over the largest norm of a level's rows that a row is scaled by. A row that has nearly vanished then
/// counts as lost.
const SMALLEST: f64 = 0.3;

impl Directions {
    /// Creates room for `room` rows over `columns` variables, with at most `most` rows on one level.
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

    /// Takes the first `m` rows of the next level and returns their places; no places if there is no room.
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

    /// Inserts a row with a target of zero before place `at`. Later rows move one place. Returns false if there is no
    /// room.
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

    /// Removes the rows at these places. Later rows move to the front.
    pub(super) fn remove(&mut self, places: Range<usize>) {
        let (count, columns) = (self.count, self.rows.columns());
        if let Ok(rows) = self.rows.coefficients_mut(places.start..count) {
            rows.copy_within(places.len() * columns.., 0);
        }
        self.norms.copy_within(places.end..count, places.start);
        self.residual.as_flattened_mut().copy_within(places.end..count, places.start);
        self.count -= places.len();
    }

    /// Scales the targets and computes the directions of all rows.
    pub(super) fn factorise(&mut self) {
        let targets = self.residual.as_flattened_mut().iter_mut().zip(&self.norms);
        targets.take(self.count).for_each(|(target, norm)| *target /= norm);
        self.find_coordinates();
    }

    /// Computes the directions of all rows again, after rows were inserted.
    pub(super) fn find_coordinates(&mut self) {
        let (width, n) = (self.width, self.count);
        let scales = self.scales.as_flattened_mut();
        scales[n..].fill(0.0);
        for (i, scale) in scales[..n].iter_mut().enumerate() {
            let products = &mut self.products[i * width..][..width].as_flattened_mut()[i..n];
            let own = self.rows.row(i).unwrap_or_default();
            // The rows exist, so no error is possible.
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

    /// The trace of G⁻¹ of a level; infinite if a row depends on others.
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

    /// Writes the sum of a level's scaled rows times `factors`, projected on what the rows above leave.
    pub(super) fn combine(&mut self, span: &Range<usize>, factors: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        let size = 4 * self.width;
        let scales = self.scales.as_flattened();
        for (factor, index) in factors.iter().zip(span.clone()) {
            subtract(out, -factor * scales[index], self.rows.row(index).unwrap_or_default());
        }
        // Subtracts the combination of the rows above that has the same coordinates along their directions.
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

    /// Writes the orthonormal direction of a row; returns false if it has none.
    pub(super) fn direction_into(&mut self, row: usize, out: &mut [f64]) -> bool {
        let reciprocal = self.reciprocals[row];
        if reciprocal > 0.0 {
            self.combine(&(row..row + 1), &[reciprocal], out);
        }
        reciprocal > 0.0
    }

    /// ‖L⁻¹r‖² of a level, where L Lᵀ is its G and r the residual of its targets. `room` is scratch memory.
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

    /// Subtracts what a level does by itself from the targets below.
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

    /// The residual of the scaled targets of a level.
    pub(super) fn residual(&self, span: &Range<usize>) -> &[f64] {
        &self.residual.as_flattened()[span.clone()]
    }

    /// The residual of the scaled targets of a level, to be reduced.
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
