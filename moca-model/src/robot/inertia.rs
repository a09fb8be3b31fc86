//! How heavy the robot is to its own joints.

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
    /// For a robot with n joints, not known yet.
    pub(super) fn new(n: usize) -> Self {
        Self { inertia: DMatrix::zeros(n, n), inverse: DMatrix::zeros(n, n), known: false }
    }

    /// The robot has moved: it is not known.
    pub(super) fn forget(&mut self) {
        self.known = false;
    }

    /// Computes it for the robot's configuration. Allocates nothing.
    pub(super) fn update(&mut self, posed: &mut Posed<'_>) {
        self.known = false;
        if self.inertia.is_empty() || posed.mass_matrix_into(&mut self.inertia).is_err() {
            return;
        }
        // The factor takes the place of the matrix, which comes back for the next time. A robot that has
        // no factor has none in any configuration: the matrix then stays empty.
        let Some(factor) = Cholesky::new(std::mem::take(&mut self.inertia)) else { return };
        self.inverse.fill_with_identity();
        factor.solve_mut(&mut self.inverse);
        self.inertia = factor.unpack_dirty();
        self.known = true;
    }

    /// n × n; none for a robot with a joint that moves no mass.
    pub(super) fn get(&self) -> Option<&DMatrix<f64>> {
        self.known.then_some(&self.inverse)
    }
}
