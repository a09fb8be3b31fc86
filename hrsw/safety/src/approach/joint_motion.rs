//! Motion of the robot's joints.

use nalgebra::{DMatrix, Matrix6xX, Vector3, Vector6};

use crate::error::{Error, check_size, check_slice};

/// Motion of the robot's joints in this tick.
#[derive(Debug, Clone, Copy)]
pub struct JointMotion<'a> {
    /// Geometric Jacobian of a point fixed to the last link, 6 × n, linear then angular, in world
    /// axes. The Jacobian of a point p on a link moved by the first k joints follows from its first
    /// k columns, v + ω × (p − o).
    pub jacobian: &'a Matrix6xX<f64>,
    /// Reference point o of the Jacobian \[m\].
    pub origin: Vector3<f64>,
    /// Joint velocities q̇ commanded last, n.
    pub velocity: &'a [f64],
    /// Joint velocities that all other constraints admit, n: usually those nearest to rest within
    /// the limits. Every row is relaxed to admit them, so that hard rows never make the problem
    /// infeasible. None for rows that are minimised in a level of their own.
    pub braking: Option<&'a [f64]>,
    /// Largest change of each joint's velocity within this tick, n. Pairs that cannot use up their
    /// headroom by it get no row, and most of their distances need not be computed. None if it is
    /// not known.
    pub change: Option<&'a [f64]>,
    /// Inverse M⁻¹ of the joint-space inertia, n × n, with which the robot gives way in a contact.
    /// None for a robot that does not give way, the worst case.
    pub inverse_inertia: Option<&'a DMatrix<f64>>,
}

impl JointMotion<'_> {
    /// Returns the linear and angular parts of the first `joints` columns of the Jacobian.
    pub(crate) fn columns(&self, joints: usize) -> impl Iterator<Item = [Vector3<f64>; 2]> + Clone {
        let columns = self.jacobian.as_slice().as_chunks::<6>().0;
        let part = |&[x, y, z, a, b, c]: &[f64; 6]| [Vector3::new(x, y, z), Vector3::new(a, b, c)];
        columns.iter().take(joints).map(part)
    }

    /// Returns the twist of the point o as if fixed to a body that the first `joints` joints move.
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
