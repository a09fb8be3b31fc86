//! How the robot moves.

use nalgebra::{DMatrix, Matrix6xX, Vector3, Vector6};

use crate::error::{Error, check_all, check_size};

/// How the robot moves with its joints now.
#[derive(Debug, Clone, Copy)]
pub struct JointMotion<'a> {
    /// The geometric Jacobian, 6 × n, linear then angular, in world axes, of a point fixed to
    /// the last link. That of a point p on a link moved by the first k joints follows from its
    /// first k columns, v + ω × (p − o).
    pub jacobian: &'a Matrix6xX<f64>,
    /// o, the point that the Jacobian is of \[m\].
    pub origin: Vector3<f64>,
    /// q̇ commanded last, n.
    pub velocity: &'a [f64],
    /// A q̇ that all other constraints admit, n: usually the one nearest to rest within the
    /// limits. Every row is relaxed to admit it, so that hard rows never make the problem
    /// infeasible. None for rows that are minimised in a level of their own.
    pub braking: Option<&'a [f64]>,
    /// By how much each joint's velocity may change in this tick at most, n: pairs that cannot use up their
    /// headroom by that get no row, and most of their distances need not be computed. None where it is
    /// not known.
    pub change: Option<&'a [f64]>,
    /// M⁻¹, the inverse of the joint-space inertia, n × n, with which the robot gives way in a contact.
    /// None for a robot that does not give way at all, the worst case.
    pub inverse_inertia: Option<&'a DMatrix<f64>>,
}

impl JointMotion<'_> {
    /// The twist of the point o as if fixed to a body that the first `joints` move, at a `velocity` of all.
    pub(super) fn twist(&self, velocity: &[f64], joints: usize) -> Vector6<f64> {
        let columns = self.jacobian.column_iter().zip(velocity).take(joints);
        columns.fold(Vector6::zeros(), |twist, (column, &velocity)| twist + column * velocity)
    }

    pub(super) fn check(&self, joints: usize) -> Result<(), Error> {
        check_size("the columns of the Jacobian", self.jacobian.ncols(), joints)?;
        check_size("the joint velocity", self.velocity.len(), joints)?;
        let braking = self.braking.unwrap_or(self.velocity);
        check_size("the braking velocity", braking.len(), joints)?;
        check_all("the Jacobian", self.jacobian.iter())?;
        check_all("the origin of the Jacobian", self.origin.iter())?;
        if let Some(inverse) = self.inverse_inertia {
            check_size("the rows of the inverse inertia", inverse.nrows(), joints)?;
            check_size("the columns of the inverse inertia", inverse.ncols(), joints)?;
            check_all("the inverse inertia", inverse.iter())?;
        }
        check_all("a joint velocity", self.velocity.iter().chain(braking))
    }
}
