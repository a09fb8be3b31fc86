//! The inverse of the joint-space inertia.

use nalgebra::{Cholesky, DMatrix};
use whole_body::Posed;

/// M⁻¹, the inverse of the joint-space inertia, at the robot's configuration.
#[derive(Debug, Clone)]
pub(super) struct InverseInertia {
    inertia: DMatrix<f64>,
    inverse: DMatrix<f64>,
    known: bool,
}

impl InverseInertia {
    /// Creates room for a robot with n joints, without a value.
    pub(super) fn new(n: usize) -> Self {
        Self { inertia: DMatrix::zeros(n, n), inverse: DMatrix::zeros(n, n), known: false }
    }

    /// Forgets the value after the robot has moved.
    pub(super) fn forget(&mut self) {
        self.known = false;
    }

    /// Computes the value for the robot's configuration. Allocates nothing.
    pub(super) fn update(&mut self, posed: &mut Posed<'_>) {
        self.known = false;
        if self.inertia.is_empty() || posed.mass_matrix_into(&mut self.inertia).is_err() {
            return;
        }
        // The factor takes the memory of the matrix, which returns for the next call. A robot without a factor has none
        // in any configuration; the matrix then stays empty.
        let Some(factor) = Cholesky::new(std::mem::take(&mut self.inertia)) else { return };
        self.inverse.fill_with_identity();
        factor.solve_mut(&mut self.inverse);
        self.inertia = factor.unpack_dirty();
        self.known = true;
    }

    /// The matrix, n × n; `None` for a robot with a joint that moves no mass.
    pub(super) fn get(&self) -> Option<&DMatrix<f64>> {
        self.known.then_some(&self.inverse)
    }
}
