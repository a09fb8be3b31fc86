//! Rows for the curvature of a level's tasks.

use ahqp_core::Rows;

use crate::eigen::eigenvectors;
use crate::tasks::curvature::Curvature;

/// Rows √λₖ vₖᵀ q̇ = 0 of a level, where λₖ and vₖ are the positive eigenvalues and the eigenvectors of its tasks'
/// curvature.
///
/// A level with these rows minimises ½ ‖J q̇ − b‖² + ½ q̇ᵀ H⁺ q̇. That replaces the Gauss-Newton step by Newton's step,
/// which levels with a remaining error need (Pfeiffer, Escande, Kheddar, IEEE Robotics and Automation Letters 3(4),
/// 2018). The paper is "Singularity resolution in equality and inequality constrained hierarchical task-space control
/// by adaptive nonlinear least squares". At the end of the robot's reach, the rows take the motions that would leave it
/// from the levels below. Rows without curvature are free.
#[derive(Debug, Clone)]
pub(super) struct CurvatureRows {
    pub(super) curvature: Curvature,
    /// Entries of q̇ with curvature, and the rows and columns of the curvature for them.
    entries: Vec<usize>,
    block: Vec<f64>,
    vectors: Vec<f64>,
}

/// Share of the largest eigenvalue that counts as rounding.
const ROUNDING: f64 = 1e-9;

impl CurvatureRows {
    pub(super) fn new(velocities: usize) -> Self {
        Self {
            curvature: Curvature::new(velocities),
            entries: Vec::with_capacity(velocities),
            block: vec![0.0; velocities * velocities],
            vectors: vec![0.0; velocities * velocities],
        }
    }

    /// Writes the rows from `first` to the last one.
    pub(super) fn write(&mut self, rows: &mut Rows, first: usize, least: f64) {
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
