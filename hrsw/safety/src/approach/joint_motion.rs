//! How the robot moves.

use nalgebra::{DMatrix, Matrix6xX, Vector3, Vector6};

use crate::error::{Error, check_size, check_slice};

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
    /// The columns of the Jacobian of the first `joints`: linear and angular parts.
    pub(crate) fn columns(&self, joints: usize) -> impl Iterator<Item = [Vector3<f64>; 2]> {
        let columns = self.jacobian.as_slice().as_chunks::<6>().0;
        let part = |&[x, y, z, a, b, c]: &[f64; 6]| [Vector3::new(x, y, z), Vector3::new(a, b, c)];
        columns.iter().take(joints).map(part)
    }

    /// The twist of the point o as if fixed to a body that the first `joints` move, at a `velocity` of all.
    pub(super) fn twist(&self, velocity: &[f64], joints: usize) -> Vector6<f64> {
        let [mut linear, mut angular] = [Vector3::zeros(); 2];
        for ([of_linear, of_angular], &velocity) in self.columns(joints).zip(velocity) {
            linear += of_linear * velocity;
            angular += of_angular * velocity;
        }
        Vector6::new(linear.x, linear.y, linear.z, angular.x, angular.y, angular.z)
    }

    pub(super) fn check(&self, joints: usize) -> Result<(), Error> {
        check_size("the columns of the Jacobian", self.jacobian.ncols(), joints)?;
        check_size("the joint velocity", self.velocity.len(), joints)?;
        let braking = self.braking.unwrap_or(self.velocity);
        check_size("the braking velocity", braking.len(), joints)?;
        check_slice("the Jacobian", self.jacobian.as_slice())?;
        check_slice("the origin of the Jacobian", self.origin.as_slice())?;
        if let Some(inverse) = self.inverse_inertia {
            check_size("the rows of the inverse inertia", inverse.nrows(), joints)?;
            check_size("the columns of the inverse inertia", inverse.ncols(), joints)?;
            check_slice("the inverse inertia", inverse.as_slice())?;
        }
        check_slice("a joint velocity", self.velocity)?;
        check_slice("a joint velocity", braking)
    }
}
