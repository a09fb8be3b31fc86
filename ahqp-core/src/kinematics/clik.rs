//! Closed-loop inverse kinematics in the augmented state χ = [q̇; ẋ_d; s].

use std::ops::Range;

use nalgebra::{DMatrix, Isometry3, Translation3, UnitQuaternion, Vector3, Vector6};

use crate::error::Error;
use crate::kinematics::rotation::rotation_log;
use crate::problem::rows::{Rows, expect_size};

/// Where the parts of χ = [q̇ (n); ẋ_d (m); s] stand (the paper's eq. 3, with the slack of its
/// Sec. III-C behind).
///
/// ```
/// use ahqp_core::AugmentedState;
///
/// let state = AugmentedState { joints: 10, task: 6, slack: 6 };
/// assert_eq!(state.desired_velocity(), 10..16);
/// assert_eq!(state.len(), 22);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AugmentedState {
    /// n, the number of joints.
    pub joints: usize,
    /// m, the dimension of the task.
    pub task: usize,
    /// The number of slack variables; zero for a hard or row-wise softened workspace.
    pub slack: usize,
}

impl AugmentedState {
    /// Where q̇ stands.
    pub fn joint_velocity(&self) -> Range<usize> {
        0..self.joints
    }

    /// Where ẋ_d stands.
    pub fn desired_velocity(&self) -> Range<usize> {
        self.joints..self.joints + self.task
    }

    /// Where s stands.
    pub fn slack(&self) -> Range<usize> {
        self.joints + self.task..self.len()
    }

    /// The number of variables.
    pub fn len(&self) -> usize {
        self.joints + self.task + self.slack
    }

    /// Whether there are no variables.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// The difference of two poses, [p_d − p_a; log(R_d R_aᵀ)] \[m, rad\], linear then angular, in
/// world axes.
///
/// ```
/// use ahqp_core::pose_error;
/// use nalgebra::{Isometry3, Vector3};
///
/// let actual = Isometry3::identity();
/// let desired = Isometry3::new(Vector3::new(0.1, 0.0, 0.0), Vector3::new(0.0, 0.0, 0.2));
/// let error = pose_error(&desired, &actual);
/// assert!((error[0] - 0.1).abs() < 1e-15 && (error[5] - 0.2).abs() < 1e-15);
/// ```
pub fn pose_error(desired: &Isometry3<f64>, actual: &Isometry3<f64>) -> Vector6<f64> {
    let linear = desired.translation.vector - actual.translation.vector;
    let angular = rotation_log(&(desired.rotation * actual.rotation.inverse()));
    Vector6::new(linear.x, linear.y, linear.z, angular.x, angular.y, angular.z)
}

/// The pose after moving with `twist` (linear then angular, world axes) for `period` seconds.
pub fn integrate_pose(pose: &Isometry3<f64>, twist: &Vector6<f64>, period: f64) -> Isometry3<f64> {
    let linear = Vector3::new(twist[0], twist[1], twist[2]);
    let angular = Vector3::new(twist[3], twist[4], twist[5]);
    let mut rotation = UnitQuaternion::from_scaled_axis(angular * period) * pose.rotation;
    rotation.renormalize_fast();
    Isometry3::from_parts(Translation3::from(pose.translation.vector + linear * period), rotation)
}

/// The augmented inverse kinematics, min ‖[J −(I + K_p Δt) 0] χ − K_p (x_d(t−1) − x_a)‖²
/// (the paper's eq. 4).
///
/// ```
/// use ahqp_core::{AugmentedClik, AugmentedState};
/// use nalgebra::{DMatrix, Vector6};
///
/// let state = AugmentedState { joints: 7, task: 6, slack: 0 };
/// let clik = AugmentedClik::new(state, Vector6::repeat(40.0), 1e-3)?;
/// let mut rows = clik.rows();
/// clik.write(&DMatrix::zeros(6, 7), &Vector6::zeros(), &mut rows)?;
/// assert_eq!(rows.row(0).map(|row| row[7]), Some(-1.04));
/// # Ok::<(), ahqp_core::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AugmentedClik {
    state: AugmentedState,
    gain: Vector6<f64>,
    period: f64,
}

impl AugmentedClik {
    /// With the diagonal of K_p \[1/s\] and the control period Δt \[s\].
    ///
    /// # Errors
    /// [`Error::Size`] unless the task has 6 dimensions; [`Error::Parameter`] for gains or a
    /// period that are not positive and finite, or a gain above 1/Δt, where the loop of one
    /// step would overshoot.
    pub fn new(state: AugmentedState, gain: Vector6<f64>, period: f64) -> Result<Self, Error> {
        expect_size("the dimension of the task", state.task, 6)?;
        if !(period.is_finite() && period > 0.0) {
            return Err(Error::Parameter {
                name: "the control period",
                value: period,
                expected: "positive and finite [s]",
            });
        }
        if let Some(&value) = gain.iter().find(|&&k| !(k > 0.0 && k <= 1.0 / period)) {
            return Err(Error::Parameter {
                name: "a gain of the inverse kinematics",
                value,
                expected: "positive and at most 1/Δt [1/s]",
            });
        }
        Ok(Self { state, gain, period })
    }

    /// Empty rows of the right size for [`write`](Self::write).
    pub fn rows(&self) -> Rows {
        Rows::zeros(self.state.task, self.state.len())
    }

    /// Writes the rows A_clik χ = b_clik for the Jacobian J (6 × n) and the pose error
    /// x_d(t−1) − x_a of [`pose_error`].
    ///
    /// # Errors
    /// [`Error::Size`] when the Jacobian or the rows do not fit.
    pub fn write(
        &self,
        jacobian: &DMatrix<f64>,
        error: &Vector6<f64>,
        rows: &mut Rows,
    ) -> Result<(), Error> {
        expect_size("the rows of the Jacobian", jacobian.nrows(), self.state.task)?;
        expect_size("the columns of the Jacobian", jacobian.ncols(), self.state.joints)?;
        expect_size("the rows of the task", rows.len(), self.state.task)?;
        expect_size("a row of the task", rows.columns(), self.state.len())?;
        let desired = self.state.desired_velocity().start;
        for i in 0..self.state.task {
            if let Some(row) = rows.row_mut(i) {
                row.fill(0.0);
                for (j, entry) in row.iter_mut().take(self.state.joints).enumerate() {
                    *entry = jacobian[(i, j)];
                }
                row[desired + i] = -(1.0 + self.gain[i] * self.period);
            }
            rows.lower_mut()[i] = self.gain[i] * error[i];
            rows.upper_mut()[i] = self.gain[i] * error[i];
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn pose() -> impl Strategy<Value = Isometry3<f64>> {
        (prop::array::uniform3(-1.0..1.0_f64), prop::array::uniform3(-1.5..1.5_f64))
            .prop_map(|(p, v)| Isometry3::new(Vector3::from(p), Vector3::from(v)))
    }

    proptest! {
        #[test]
        fn moving_along_the_error_for_a_second_removes_it(desired in pose(), actual in pose()) {
            let moved = integrate_pose(&actual, &pose_error(&desired, &actual), 1.0);
            prop_assert!(pose_error(&desired, &moved).norm() < 1e-9);
        }

        #[test]
        fn the_error_decays_at_the_gain_when_the_rows_hold(
            desired in pose(), velocity in prop::array::uniform6(-0.3..0.3_f64),
        ) {
            // With J = I the joint velocity is the twist itself: q̇ = (1 + kΔt) ẋ_d + k e.
            let (gain, period) = (40.0, 1e-3);
            let actual = integrate_pose(&desired, &Vector6::repeat(0.01), 1.0);
            let error = pose_error(&desired, &actual);
            let velocity = Vector6::from(velocity);
            let state = AugmentedState { joints: 6, task: 6, slack: 0 };
            let clik = AugmentedClik::new(state, Vector6::repeat(gain), period).unwrap();
            let mut rows = clik.rows();
            clik.write(&DMatrix::identity(6, 6), &error, &mut rows).unwrap();
            let twist = velocity * (1.0 + gain * period) + error * gain;
            for (row, lower, _) in rows.iter() {
                let value: f64 = row[..6].iter().zip(&twist).map(|(a, b)| a * b).sum::<f64>()
                    + row[6..].iter().zip(&velocity).map(|(a, b)| a * b).sum::<f64>();
                prop_assert!((value - lower).abs() < 1e-12);
            }
            let next = pose_error(
                &integrate_pose(&desired, &velocity, period),
                &integrate_pose(&actual, &twist, period),
            );
            let expected = error * (1.0 - gain * period) - velocity * (gain * period * period);
            // Rotations do not commute: what is left is of second order.
            let second_order = 2.0 * period * velocity.norm() * error.norm();
            prop_assert!((next - expected).norm() < second_order + 1e-6);
        }
    }

    #[test]
    fn bad_parameters_are_named() {
        let state = AugmentedState { joints: 7, task: 6, slack: 0 };
        for gain in [0.0, -1.0, f64::NAN, 2000.0] {
            let error = AugmentedClik::new(state, Vector6::repeat(gain), 1e-3).unwrap_err();
            assert!(error.to_string().contains("gain"), "{error}");
        }
        assert!(AugmentedClik::new(state, Vector6::repeat(1.0), 0.0).is_err());
        let clik = AugmentedClik::new(state, Vector6::repeat(1.0), 1e-3).unwrap();
        let mut rows = clik.rows();
        assert!(clik.write(&DMatrix::zeros(6, 8), &Vector6::zeros(), &mut rows).is_err());
    }
}
