//! The curvature of a level's tasks as rows.

use ahqp_core::Rows;

use crate::eigen::eigenvectors;
use crate::tasks::curvature::Curvature;

/// Rows √λₖ vₖᵀ q̇ = 0 of a level, λₖ and vₖ being the positive eigenvalues and the eigenvectors of the
/// curvature of its tasks.
///
/// With them a level minimises ½ ‖J q̇ − b‖² + ½ q̇ᵀ H⁺ q̇: Newton's step in place of Gauss and Newton's, as
/// a level whose error remains needs it (Pfeiffer, Escande, Kheddar, "Singularity resolution in
/// equality and inequality constrained hierarchical task-space control by adaptive nonlinear
/// least squares", IEEE Robotics and Automation Letters 3(4), 2018). At the end of what a robot
/// reaches they take the joints that would lead away from there from the levels below, and leave those
/// that would not. Rows of no curvature are free.
#[derive(Debug, Clone)]
pub(crate) struct CurvatureRows {
    pub(crate) curvature: Curvature,
    /// The entries of q̇ that the curvature concerns, and its rows and columns of these.
    entries: Vec<usize>,
    block: Vec<f64>,
    vectors: Vec<f64>,
}

/// Of the largest eigenvalue, what counts as rounding.
const ROUNDING: f64 = 1e-9;

impl CurvatureRows {
    pub(crate) fn new(velocities: usize) -> Self {
        Self {
            curvature: Curvature::new(velocities),
            entries: Vec::with_capacity(velocities),
            block: vec![0.0; velocities * velocities],
            vectors: vec![0.0; velocities * velocities],
        }
    }

    /// Writes the rows from `first` to the last.
    pub(crate) fn write(&mut self, rows: &mut Rows, first: usize, least: f64) {
        for index in first..rows.len() {
            set_row(rows, index, [].into_iter(), f64::INFINITY);
        }
        if self.curvature.is_zero() {
            return;
        }
        let Self { curvature, entries, block, vectors, .. } = self;
        let matrix = curvature.matrix();
        entries.clear();
        let columns = matrix.column_iter().enumerate();
        entries.extend(columns.filter(|(_, c)| c.iter().any(|c| *c != 0.0)).map(|(j, _)| j));
        let size = entries.len();
        for (row, i) in block.chunks_exact_mut(size.max(1)).zip(&*entries) {
            row.iter_mut().zip(&*entries).for_each(|(entry, j)| *entry = matrix[(*i, *j)]);
        }
        let (block, vectors) = (&mut block[..size * size], &mut vectors[..size * size]);
        eigenvectors(block, size, vectors);
        let most = block.iter().step_by(size + 1).fold(0.0, |most: f64, value| most.max(*value));
        let pairs = vectors.chunks_exact(size.max(1)).zip(block.iter().step_by(size + 1));
        let positive = pairs.filter(|(_, value)| **value > ROUNDING * most.max(least));
        for ((vector, value), index) in positive.zip(first..) {
            let root = value.sqrt();
            let scaled = entries.iter().zip(vector).map(|(j, part)| (*j, root * part));
            set_row(rows, index, scaled, 0.0);
        }
    }
}

/// Writes a row with these coefficients and bounds ± `room`.
fn set_row(
    rows: &mut Rows,
    index: usize,
    coefficients: impl Iterator<Item = (usize, f64)>,
    room: f64,
) {
    if let Ok(row) = rows.row_mut(index) {
        row.fill(0.0);
        coefficients.for_each(|(column, coefficient)| row[column] = coefficient);
        (rows.lower_mut()[index], rows.upper_mut()[index]) = (-room, room);
    }
}
