//! Damping of targets near singular configurations.

#[cfg(test)]
mod tests;

use std::ops::Range;

use ahqp_core::Rows;

use crate::eigen::eigenvectors;
use crate::vector::{dot, subtract};

/// Takes from the targets of levels what their rows reach only by very large velocities, and hands
/// directions that a level loses over to the levels below.
///
/// Level by level, highest priority first, the rows are scaled to norm one and freed of what the
/// rows above determine; G = P Pᵀ then has the squared singular values σ² of what is left to the
/// level, and p² = 1/tr G⁻¹ is a lower bound of the least. Where p is above the threshold σ₀ nothing
/// changes. Below, with W the weights of the scaled rows over the largest and uₖ, σₖ² the eigenvectors
/// and eigenvalues of W^½ G W^½, of what is missing to the targets along uₖ the part
/// (μ²/(σₖ² + μ²))³ is given up: damped least squares (Nakamura and Hanafusa, Journal of Dynamic
/// Systems, Measurement and Control 108, 1986), iterated twice so that well-conditioned directions
/// keep all but (μ/σ)⁶ of their targets (King and Chillingworth, Numerical Functional Analysis and
/// Optimization 1(5), 1979), and
///
/// > μ² = ((σ₀/12)² + ((‖r‖/2v)² + ‖r‖/κ) max(0, 1 − v²/s²)) (1 − p²/σ₀²),
///
/// r being what is missing to the scaled targets, s = ‖L⁻¹r‖ the speed that they take and v = 1
/// rad/s: near a singular configuration a fast target is given up to where joints need not go
/// faster than about v, and κ = 5 1/s bounds how fast their velocities change with the configuration,
/// so that they can stop there. Rows that contradict each other keep their weighted compromise.
///
/// A level that keeps a direction as an equality up to σ = 0 would let go of it at once there, and
/// take it back as soon as the levels below have moved: the robot trembles. So where p < 3σ₀/10 the
/// rows are turned along the uₖ, which leaves the weighted squares as they are, and those of σₖ < σ₀/10
/// become ranges, within which the levels below move at up to v_f (1 − 10 σₖ/σ₀), v_f = 0.05 rad/s,
/// times min(1, (9 − 100 p²/σ₀²)/8). All is continuous in the configuration.
///
/// The levels stay rows with other targets: priorities and limits are not touched.
///
/// Of the orthonormal directions that the levels take only the coordinates of the rows along them are
/// computed: they are the Cholesky factor of all rows' products with each other, row by row (Golub and
/// Van Loan, *Matrix Computations*, 4th ed., Sec. 4.2.5). That of a level's rows among themselves is
/// the Cholesky factor of its G.
#[derive(Debug, Clone)]
pub(super) struct SingularityDamping {
    threshold: f64,
    /// How many rows all levels have.
    total: usize,
    /// How many rows a level has at most.
    most: usize,
    /// How many rows the levels above have. Each row has a direction; those of rows that depend on
    /// others are zero.
    first: usize,
    /// The rows of all levels, scaled to norm one.
    rows: Rows,
    /// By row: products with the rows before it, then coordinates along the directions.
    coordinates: Vec<f64>,
    /// By direction: one over the coordinate of its own row; zero where there is no direction.
    reciprocals: Vec<f64>,
    /// Along the directions: what the levels above do by themselves.
    point: Vec<f64>,
    norms: Vec<f64>,
    /// √(weight · norm² over the largest).
    scales: Vec<f64>,
    residual: Vec<f64>,
    gram: Vec<f64>,
    factor: Vec<f64>,
    inverse: Vec<f64>,
    given_up: Vec<f64>,
    /// By direction uₖ: its coordinates along the rows.
    vectors: Vec<f64>,
    /// The rows along the directions uₖ, and their targets.
    turned: Vec<f64>,
    turned_targets: Vec<f64>,
    /// Weights of turned rows: theirs are in the rows.
    unit_weights: Vec<f64>,
}

/// A row of which less than the root of this is left belongs to the levels below.
const NOTHING: f64 = 1e-12;
/// Of the largest weight, what the others count as at least here.
const LIGHTEST: f64 = 1e-12;
/// Norm of velocities above which a singular level is damped more than it must be at least
/// \[rad/s, m/s\].
const SPEED: f64 = 1.0;
/// How fast a singular direction may come and go \[1/s\]; with an order of 3, three times as fast.
const RATE: f64 = 5.0;
/// Of the threshold, the least damping of a singular level.
const LEAST: f64 = 1.0 / 12.0;
/// How often the damping is applied.
const ORDER: i32 = 3;
/// Of the threshold, the singular value below which a direction is handed over.
const HANDOVER: f64 = 0.1;
/// Of that, where p is when rows begin to be turned.
const GATE: f64 = 3.0;
/// How fast levels below may move along a direction that is lost \[rad/s, m/s\].
const FREE_SPEED: f64 = 0.05;

impl SingularityDamping {
    /// For levels of so many rows each, over so many variables.
    pub(super) fn new(threshold: f64, levels: &[usize], columns: usize) -> Self {
        let (total, most) = (levels.iter().sum(), levels.iter().copied().max().unwrap_or(0));
        Self {
            threshold,
            total,
            most,
            first: 0,
            rows: Rows::zeros(total, columns),
            coordinates: vec![0.0; total * total],
            reciprocals: vec![0.0; total],
            point: vec![0.0; total],
            norms: vec![0.0; most],
            scales: vec![1.0; most],
            residual: vec![0.0; most],
            gram: vec![0.0; most * most],
            factor: vec![0.0; most * most],
            inverse: vec![0.0; most * most],
            given_up: vec![0.0; most],
            vectors: vec![0.0; most * most],
            turned: vec![0.0; most * columns],
            turned_targets: vec![0.0; most],
            // A level has at most as many further rows as there are variables.
            unit_weights: vec![1.0; most + columns],
        }
    }

    /// Begins with the highest level.
    pub(super) fn begin(&mut self) {
        self.first = 0;
    }

    /// Damps the targets of the next level, of whose rows the first `m` count. Returns true if that changed them; what was asked is in
    /// `asked`, rows of the same size, then. A level with ranges, or for which there is no room, is
    /// left as it is.
    pub(super) fn damp(&mut self, rows: &mut Rows, m: usize, asked: &mut Rows) -> bool {
        let first = self.first;
        let fits = m <= self.most && m <= rows.len() && first + m <= self.total;
        let equalities = rows.lower().iter().zip(rows.upper()).take(m).all(|(l, u)| l == u);
        if self.threshold == 0.0 || m == 0 || !fits || !equalities {
            return false;
        }
        let span = first..first + m;
        self.load(rows, &span);
        self.project(&span);
        let closeness = 1.0 / (self.invert_factor(m) * self.threshold * self.threshold);
        let is_singular = closeness < 1.0 && asked.copy_from(rows).is_ok();
        if is_singular {
            self.give_up(m, closeness, rows);
        }
        // Nothing below the last level asks for its directions.
        if span.end < self.total {
            self.take(&span);
        }
        self.first = span.end;
        is_singular
    }

    /// Scales the rows and their targets, and writes the rows' products with each other and with those
    /// above.
    fn load(&mut self, rows: &Rows, span: &Range<usize>) {
        let total = self.total;
        for (i, (row, target, _)) in rows.iter().enumerate().take(span.len()) {
            let index = span.start + i;
            let norm = dot(row, row).sqrt();
            let norm = if norm > 0.0 { norm } else { 1.0 };
            self.norms[i] = norm;
            self.residual[i] = target / norm;
            let reciprocal = 1.0 / norm;
            let own = self.rows.row_mut(index).unwrap_or_default();
            own.iter_mut().zip(row).for_each(|(own, entry)| *own = reciprocal * entry);
            let own = self.rows.row(index).unwrap_or_default();
            let products = &mut self.coordinates[index * total..][..=index];
            // Of rows that there are: no error is possible.
            let _ = self.rows.multiply_into(0, own, products);
        }
    }

    /// Takes from the rows and their targets what the levels above determine: computes the coordinates
    /// along their directions, G and what is missing to the targets.
    fn project(&mut self, span: &Range<usize>) {
        let (total, first, m) = (self.total, span.start, span.len());
        let (known, own) = self.coordinates.split_at_mut(first * total);
        let own = &mut own[..m * total];
        for (j, (above, reciprocal)) in known.chunks_exact(total).zip(&self.reciprocals).enumerate()
        {
            for row in own.chunks_exact_mut(total) {
                row[j] = (row[j] - dot(&above[..j], &row[..j])) * reciprocal;
            }
        }
        for (i, row) in own.chunks_exact(total).enumerate() {
            let coordinates = &row[..first];
            for (j, other) in own.chunks_exact(total).enumerate().take(i + 1) {
                let product = row[first + j] - dot(&other[..first], coordinates);
                self.gram[i * m + j] = product;
                self.gram[j * m + i] = product;
            }
            self.residual[i] -= dot(coordinates, &self.point[..first]);
        }
    }

    /// Writes the inverse of the Cholesky factor of G, zero in rows that depend on others, and
    /// returns the trace of G⁻¹; infinite where there are such rows.
    fn invert_factor(&mut self, m: usize) -> f64 {
        let (factor, inverse) = (&mut self.factor[..m * m], &mut self.inverse[..m * m]);
        factor.copy_from_slice(&self.gram[..m * m]);
        inverse.fill(0.0);
        let mut trace = 0.0;
        for i in 0..m {
            let (done, rest) = factor.split_at_mut(i * m);
            let row = &mut rest[..m];
            for (j, other) in done.chunks_exact(m).enumerate() {
                // The diagonal of L⁻¹ is that of L turned over.
                row[j] = (row[j] - dot(&row[..j], &other[..j])) * inverse[j * m + j];
            }
            let pivot = row[i] - dot(&row[..i], &row[..i]);
            let depends = pivot.is_nan() || pivot <= NOTHING;
            let reciprocal = if depends { 0.0 } else { 1.0 / pivot.sqrt() };
            let (above, own) = inverse.split_at_mut(i * m);
            let own = &mut own[..m];
            own[i] = reciprocal;
            for (j, other) in above.chunks_exact(m).enumerate() {
                subtract(&mut own[..=j], row[j] * reciprocal, &other[..=j]);
            }
            trace += if depends { f64::INFINITY } else { dot(&own[..=i], &own[..=i]) };
        }
        trace
    }

    /// μ² of a level that is singular.
    fn damping(&self, m: usize) -> f64 {
        let residual = &self.residual[..m];
        let speeds = self.inverse[..m * m].chunks_exact(m).map(|row| dot(row, residual).powi(2));
        // (s/v)², s being the norm of the velocities that the targets take.
        let excess = speeds.sum::<f64>() / (SPEED * SPEED);
        let square = dot(residual, residual);
        let bound = 0.25 * square / (SPEED * SPEED) + square.sqrt() / RATE;
        let least = LEAST * self.threshold;
        least * least + bound * (1.0 - 1.0 / excess.max(1.0))
    }

    /// Gives up what takes large velocities.
    fn give_up(&mut self, m: usize, closeness: f64, rows: &mut Rows) {
        let heaviest = self.weigh(m, rows);
        let square = self.damping(m) * (1.0 - closeness);
        let lost = closeness / (GATE * HANDOVER).powi(2);
        let is_lost = lost < 1.0 && (0..m).all(|row| rows.weight(row) > 0.0);
        if is_lost {
            eigenvectors(&mut self.gram[..m * m], m, &mut self.vectors[..m * m]);
            self.damp_along_vectors(m, square);
        } else {
            self.damp_by_factor(m, square);
        }
        for i in 0..m {
            let part = self.given_up[i] / self.scales[i];
            self.residual[i] -= part;
            self.given_up[i] = part * self.norms[i];
        }
        subtract(&mut rows.lower_mut()[..m], 1.0, &self.given_up);
        subtract(&mut rows.upper_mut()[..m], 1.0, &self.given_up);
        if is_lost {
            let share = (1.0 - lost) * GATE * GATE / (GATE * GATE - 1.0);
            self.hand_over(m, heaviest, share.min(1.0), rows);
        }
    }

    /// What is given up, by (μ² (W^½ G W^½ + μ²)⁻¹)³.
    fn damp_by_factor(&mut self, m: usize, square: f64) {
        let (system, missing) = (&mut self.gram[..m * m], &mut self.given_up[..m]);
        system.iter_mut().step_by(m + 1).for_each(|entry| *entry += square);
        factorise(system, m);
        for (missing, (residual, scale)) in
            missing.iter_mut().zip(self.residual.iter().zip(&self.scales))
        {
            *missing = residual * scale;
        }
        for _ in 0..ORDER {
            solve(system, missing);
            for part in missing.iter_mut() {
                *part *= square;
            }
        }
    }

    /// The same where the eigenvectors are known.
    fn damp_along_vectors(&mut self, m: usize, square: f64) {
        self.given_up[..m].fill(0.0);
        for (k, vector) in self.vectors[..m * m].chunks_exact(m).enumerate() {
            let weighted = vector.iter().zip(&self.residual).zip(&self.scales);
            let missing: f64 = weighted.map(|((u, r), scale)| u * r * scale).sum();
            let eigenvalue = self.gram[k * m + k].max(0.0);
            let part = missing * (square / (square + eigenvalue)).powi(ORDER);
            subtract(&mut self.given_up[..m], -part, vector);
        }
    }

    /// Turns the rows along the directions, and makes ranges of those that are lost, so wide as a
    /// `share` says.
    fn hand_over(&mut self, m: usize, heaviest: f64, share: f64, rows: &mut Rows) {
        let (columns, root) = (rows.columns(), heaviest.sqrt());
        self.turned[..m * columns].fill(0.0);
        for (vector, (turned, target)) in self
            .vectors
            .chunks_exact(m)
            .zip(self.turned.chunks_exact_mut(columns).zip(&mut self.turned_targets))
        {
            *target = 0.0;
            for (i, (row, own, _)) in rows.iter().enumerate().take(m) {
                let factor = root * vector[i] * self.scales[i] / self.norms[i];
                subtract(turned, -factor, row);
                *target += factor * own;
            }
        }
        let handover = HANDOVER * self.threshold;
        for k in 0..m {
            let sigma = self.gram[k * m + k].max(0.0).sqrt();
            let room = root * FREE_SPEED * share * (1.0 - sigma / handover).max(0.0) * sigma;
            if let Ok(row) = rows.row_mut(k) {
                row.copy_from_slice(&self.turned[k * columns..][..columns]);
            }
            let target = self.turned_targets[k];
            (rows.lower_mut()[k], rows.upper_mut()[k]) = (target - room, target + room);
        }
        // Of the size of the rows, and positive: no error is possible.
        let _ = rows.set_weights(&self.unit_weights[..rows.len()]);
    }

    /// Weighs G, and returns the largest weight of a scaled row.
    fn weigh(&mut self, m: usize, rows: &Rows) -> f64 {
        let heaviness = |norms: &[f64], row: usize| rows.weight(row) * norms[row] * norms[row];
        let largest = (0..m).map(|row| heaviness(&self.norms, row)).fold(0.0, f64::max);
        for row in 0..m {
            let part = if largest > 0.0 { heaviness(&self.norms, row) / largest } else { 1.0 };
            self.scales[row] = part.max(LIGHTEST).sqrt();
        }
        for i in 0..m {
            for j in 0..m {
                self.gram[i * m + j] *= self.scales[i] * self.scales[j];
            }
        }
        largest
    }

    /// Takes the directions of the rows, and what the level does along them.
    fn take(&mut self, span: &Range<usize>) {
        let (total, m) = (self.total, span.len());
        let factors = self.factor[..m * m].chunks_exact(m).zip(self.inverse.chunks_exact(m));
        for (i, (factor, inverse)) in factors.enumerate() {
            let direction = span.start + i;
            self.coordinates[direction * total + span.start..][..i].copy_from_slice(&factor[..i]);
            self.reciprocals[direction] = inverse[i];
            self.point[direction] = dot(&inverse[..=i], &self.residual[..=i]);
        }
    }
}

/// The Cholesky factor of a positive matrix, in its lower half.
fn factorise(matrix: &mut [f64], m: usize) {
    for i in 0..m {
        let (done, rest) = matrix.split_at_mut(i * m);
        let row = &mut rest[..m];
        for (j, other) in done.chunks_exact(m).enumerate() {
            row[j] = (row[j] - dot(&row[..j], &other[..j])) / other[j];
        }
        row[i] = (row[i] - dot(&row[..i], &row[..i])).max(f64::MIN_POSITIVE).sqrt();
    }
}

/// Solves L Lᵀ x = b in place.
fn solve(factor: &[f64], b: &mut [f64]) {
    let m = b.len();
    for (i, row) in factor.chunks_exact(m).enumerate() {
        b[i] = (b[i] - dot(&row[..i], &b[..i])) / row[i];
    }
    for (i, row) in factor.chunks_exact(m).enumerate().rev() {
        let (before, own) = b.split_at_mut(i);
        own[0] /= row[i];
        subtract(before, own[0], &row[..i]);
    }
}
