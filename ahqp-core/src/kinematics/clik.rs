//! Closed-loop inverse kinematics: rows of a task in joint velocities or in the augmented state χ =
//! [q̇; ẋ_d; s].

use std::ops::Range;

use nalgebra::{
    Dim, Isometry3, Matrix, RawStorage, Translation3, UnitQuaternion, Vector3, Vector6,
};

use crate::error::Error;
use crate::kinematics::rotation::rotation_log;
use crate::problem::rows::{Rows, expect_size};

/// Layout of χ = [q̇ (n); ẋ_d (m); s]: the paper's eq. 3, followed by the slack of its Sec. III-C.
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
    /// Number of slack variables. Zero for a hard workspace.
    pub slack: usize,
}

impl AugmentedState {
    /// Indices of the joint velocities q̇ among the variables.
    pub fn joint_velocity(&self) -> Range<usize> {
        0..self.joints
    }

    /// Indices of the desired twist ẋ_d among the variables.
    pub fn desired_velocity(&self) -> Range<usize> {
        self.joints..self.joints + self.task
    }

    /// Indices of the slack s among the variables.
    pub fn slack(&self) -> Range<usize> {
        self.joints + self.task..self.len()
    }

    /// The number of variables.
    pub fn len(&self) -> usize {
        self.joints + self.task + self.slack
    }

    /// Returns true if there are no variables.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Returns the difference of two poses, [p_d − p_a; log(R_d R_aᵀ)] \[m, rad\], linear then angular,
/// in world axes.
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

/// Returns the pose after moving with `twist` (linear then angular, world axes) for `period`
/// seconds.
pub fn integrate_pose(pose: &Isometry3<f64>, twist: &Vector6<f64>, period: f64) -> Isometry3<f64> {
    let linear = Vector3::new(twist[0], twist[1], twist[2]);
    let angular = Vector3::new(twist[3], twist[4], twist[5]);
    let mut rotation = UnitQuaternion::from_scaled_axis(angular * period) * pose.rotation;
    rotation.renormalize_fast();
    Isometry3::from_parts(Translation3::from(pose.translation.vector + linear * period), rotation)
}

/// Coordinates of a pose that a task controls, 1 to 6 of them: x, y and z, then the rotations about
/// them, in world axes.
///
/// ```
/// use ahqp_core::PoseAxes;
///
/// assert_eq!(PoseAxes::PLANAR.iter().collect::<Vec<_>>(), [0, 1, 5]);
/// // Height and heading.
/// assert_eq!(PoseAxes::new(&[2, 5])?.len(), 2);
/// # Ok::<(), ahqp_core::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PoseAxes {
    chosen: [bool; 6],
}

impl PoseAxes {
    /// The whole pose.
    pub const ALL: Self = Self { chosen: [true; 6] };
    /// x, y and z.
    pub const POSITION: Self = Self { chosen: [true, true, true, false, false, false] };
    /// x, y and the rotation about z.
    pub const PLANAR: Self = Self { chosen: [true, true, false, false, false, true] };

    /// Selects coordinates, counted from 0. They are kept in the order of a pose.
    ///
    /// # Errors
    /// [`Error::Value`] if no coordinate is given, one is given twice, or one is above 5.
    pub fn new(axes: &[usize]) -> Result<Self, Error> {
        let mut chosen = [false; 6];
        for &axis in axes {
            match chosen.get_mut(axis) {
                Some(chosen) if !*chosen => *chosen = true,
                _ => {
                    let (name, expected) = ("a coordinate of the task", "from 0 to 5, each once");
                    return Err(Error::value(name, axis as f64, expected));
                }
            }
        }
        if axes.is_empty() {
            let (name, expected) = ("the dimension of the task", "from 1 to 6");
            return Err(Error::value(name, 0.0, expected));
        }
        Ok(Self { chosen })
    }

    /// Number of coordinates: the dimension m of the task.
    #[expect(clippy::len_without_is_empty, reason = "there is always one")]
    pub fn len(&self) -> usize {
        self.iter().count()
    }

    /// The coordinates, in order.
    pub fn iter(&self) -> impl Iterator<Item = usize> + use<> {
        self.chosen.into_iter().enumerate().filter(|(_, chosen)| *chosen).map(|(axis, _)| axis)
    }
}

/// Closed-loop inverse kinematics for plain stacks over χ = q̇ (Siciliano, Sciavicco, Villani,
/// Oriolo, *Robotics: Modelling, Planning and Control*, 2009, Sec. 3.7).
///
/// The rows are J q̇ = ẋ_d + K_p (x_d − x_a), for the coordinates that the task controls.
///
/// ```
/// use ahqp_core::{Clik, Error, Hierarchy, Level, PoseAxes, Settings, Solver, pose_error};
/// use nalgebra::{Isometry3, Matrix6xX, Vector6};
///
/// // Two links of 0.5 m in a plane: reach for a point, whatever the orientation.
/// let axes = PoseAxes::new(&[0, 1])?;
/// let clik = Clik::new(2, axes, Vector6::repeat(20.0), 1e-3)?;
/// let mut hierarchy = Hierarchy::new(2)?;
/// hierarchy.set_bounds(&[-2.0; 2], &[2.0; 2])?;
/// let reach = hierarchy.push(Level::least_squares(clik.rows()).named("reach"))?;
/// let mut solver = Solver::new(&hierarchy, Settings::default())?;
///
/// let desired = Isometry3::translation(0.3, 0.6, 0.0);
/// let (mut q, mut jacobian) = ([0.3_f64, 0.4], Matrix6xX::zeros(2));
/// let mut error = Vector6::zeros();
/// for _tick in 0..2000 {
///     let [(y1, x1), (y2, x2)] = [q[0], q[0] + q[1]].map(f64::sin_cos).map(|(s, c)| (0.5 * s, 0.5 * c));
///     let actual = Isometry3::translation(x1 + x2, y1 + y2, 0.0);
///     jacobian.column_mut(0).copy_from_slice(&[-y1 - y2, x1 + x2, 0.0, 0.0, 0.0, 1.0]);
///     jacobian.column_mut(1).copy_from_slice(&[-y2, x2, 0.0, 0.0, 0.0, 1.0]);
///     error = pose_error(&desired, &actual);
///     clik.write(&jacobian, &error, &Vector6::zeros(), hierarchy.rows_mut(reach)?)?;
///     let rates = solver.solve(&hierarchy)?.optimum()?;
///     q.iter_mut().zip(rates).for_each(|(q, rate)| *q += 1e-3 * rate);
/// }
/// assert!(error.norm() < 1e-6);
/// # Ok::<(), Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clik {
    joints: usize,
    axes: PoseAxes,
    gain: Vector6<f64>,
}

impl Clik {
    /// Creates the task for n = `joints` with the diagonal `gain` of K_p \[1/s\] and the control
    /// period Δt \[s\]. Only gains of the `axes` count.
    ///
    /// # Errors
    /// [`Error::Value`] if a gain or the period is not positive and finite. The same error if a
    /// gain exceeds 1/Δt, since the loop would overshoot within one step.
    pub fn new(
        joints: usize,
        axes: PoseAxes,
        gain: Vector6<f64>,
        period: f64,
    ) -> Result<Self, Error> {
        if !(period.is_finite() && period > 0.0) {
            return Err(Error::value("the control period", period, "positive and finite [s]"));
        }
        let gains = axes.iter().map(|axis| gain[axis]);
        if let Some(value) = gains.into_iter().find(|&k| !(k > 0.0 && k <= 1.0 / period)) {
            return Err(Error::value(
                "a gain of the inverse kinematics",
                value,
                "positive and at most 1/Δt [1/s]",
            ));
        }
        Ok(Self { joints, axes, gain })
    }

    /// Creates zero rows of the right size for [`write`](Self::write), m × n.
    pub fn rows(&self) -> Rows {
        Rows::zeros(self.axes.len(), self.joints)
    }

    /// Writes the rows for the Jacobian J (6 × n, linear then angular) and the pose error x_d − x_a
    /// of [`pose_error`]. `velocity` is the velocity ẋ_d of the desired pose, zero if it does not
    /// move. Allocates nothing.
    ///
    /// # Errors
    /// [`Error::Size`] if the Jacobian or the rows do not fit.
    pub fn write<R: Dim, C: Dim, S: RawStorage<f64, R, C>>(
        &self,
        jacobian: &Matrix<f64, R, C, S>,
        error: &Vector6<f64>,
        velocity: &Vector6<f64>,
        rows: &mut Rows,
    ) -> Result<(), Error> {
        self.write_jacobian(jacobian, self.joints, rows)?;
        for (index, axis) in self.axes.iter().enumerate() {
            let target = velocity[axis] + self.gain[axis] * error[axis];
            rows.lower_mut()[index] = target;
            rows.upper_mut()[index] = target;
        }
        Ok(())
    }

    /// Writes [J 0] into rows with this number of `columns`.
    fn write_jacobian<R: Dim, C: Dim, S: RawStorage<f64, R, C>>(
        &self,
        jacobian: &Matrix<f64, R, C, S>,
        columns: usize,
        rows: &mut Rows,
    ) -> Result<(), Error> {
        expect_size("the rows of the Jacobian", jacobian.nrows(), 6)?;
        expect_size("the columns of the Jacobian", jacobian.ncols(), self.joints)?;
        expect_size("the rows of the task", rows.len(), self.axes.len())?;
        expect_size("a row of the task", rows.columns(), columns)?;
        for (index, axis) in self.axes.iter().enumerate() {
            let (own, rest) = rows.row_mut(index)?.split_at_mut(self.joints);
            own.iter_mut().enumerate().for_each(|(j, entry)| *entry = jacobian[(axis, j)]);
            rest.fill(0.0);
        }
        Ok(())
    }
}

/// One row of the augmented inverse kinematics, J q̇ − (1 + k Δt) ẋ_d = k e (the paper's eq. 4).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AugmentedRow {
    /// Coefficient of ẋ_d, −(1 + k Δt) \[-\].
    pub desired: f64,
    /// Right-hand side, k e \[m/s or rad/s\].
    pub target: f64,
}

impl AugmentedRow {
    /// Creates the row for a gain k \[1/s\], the control period Δt \[s\] and the error x_d(t−1) −
    /// x_a of its coordinate.
    pub fn new(gain: f64, period: f64, error: f64) -> Self {
        Self { desired: -(1.0 + gain * period), target: gain * error }
    }
}

/// Augmented inverse kinematics, min ‖[J −(I + K_p Δt) 0] χ − K_p (x_d(t−1) − x_a)‖² (the paper's
/// eq. 4), for the coordinates that the task controls.
///
/// ```
/// use ahqp_core::{AugmentedClik, AugmentedState, PoseAxes};
/// use nalgebra::{DMatrix, Vector6};
///
/// let state = AugmentedState { joints: 7, task: 6, slack: 0 };
/// let clik = AugmentedClik::new(state, PoseAxes::ALL, Vector6::repeat(40.0), 1e-3)?;
/// let mut rows = clik.rows();
/// clik.write(&DMatrix::zeros(6, 7), &Vector6::zeros(), &mut rows)?;
/// assert_eq!(rows.row(0).map(|row| row[7]), Some(-1.04));
/// # Ok::<(), ahqp_core::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AugmentedClik {
    state: AugmentedState,
    clik: Clik,
    period: f64,
}

impl AugmentedClik {
    /// Creates the task with the diagonal `gain` of K_p \[1/s\] and the control period Δt \[s\].
    /// Only gains of the `axes` count. ẋ_d has one entry for each axis.
    ///
    /// # Errors
    /// [`Error::Size`] if the dimension of the task is not the number of axes. Those of
    /// [`Clik::new`].
    pub fn new(
        state: AugmentedState,
        axes: PoseAxes,
        gain: Vector6<f64>,
        period: f64,
    ) -> Result<Self, Error> {
        expect_size("the dimension of the task", state.task, axes.len())?;
        Ok(Self { state, clik: Clik::new(state.joints, axes, gain, period)?, period })
    }

    /// Creates zero rows of the right size for [`write`](Self::write).
    pub fn rows(&self) -> Rows {
        Rows::zeros(self.state.task, self.state.len())
    }

    /// Writes the rows A_clik χ = b_clik for the Jacobian J (6 × n, linear then angular) and the
    /// pose error x_d(t−1) − x_a of [`pose_error`]. Allocates nothing.
    ///
    /// # Errors
    /// [`Error::Size`] if the Jacobian or the rows do not fit.
    pub fn write<R: Dim, C: Dim, S: RawStorage<f64, R, C>>(
        &self,
        jacobian: &Matrix<f64, R, C, S>,
        error: &Vector6<f64>,
        rows: &mut Rows,
    ) -> Result<(), Error> {
        self.clik.write_jacobian(jacobian, self.state.len(), rows)?;
        let desired = self.state.desired_velocity().start;
        for (index, axis) in self.clik.axes.iter().enumerate() {
            let row = AugmentedRow::new(self.clik.gain[axis], self.period, error[axis]);
            rows.row_mut(index)?[desired + index] = row.desired;
            rows.lower_mut()[index] = row.target;
            rows.upper_mut()[index] = row.target;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};
    use proptest::prelude::*;

    fn pose() -> impl Strategy<Value = Isometry3<f64>> {
        (prop::array::uniform3(-1.0..1.0_f64), prop::array::uniform3(-1.5..1.5_f64))
            .prop_map(|(p, v)| Isometry3::new(Vector3::from(p), Vector3::from(v)))
    }

    proptest! {
        #[test]
        fn integrating_the_error_for_a_second_removes_it(desired in pose(), actual in pose()) {
            let moved = integrate_pose(&actual, &pose_error(&desired, &actual), 1.0);
            prop_assert!(pose_error(&desired, &moved).norm() < 1e-9);
        }

        #[test]
        fn the_error_decays_at_the_gain(
            desired in pose(), velocity in prop::array::uniform6(-0.3..0.3_f64),
        ) {
            // The joint velocity is the twist itself for J = I: q̇ = (1 + kΔt) ẋ_d + k e.
            let (gain, period) = (40.0, 1e-3);
            let actual = integrate_pose(&desired, &Vector6::repeat(0.01), 1.0);
            let error = pose_error(&desired, &actual);
            let velocity = Vector6::from(velocity);
            let state = AugmentedState { joints: 6, task: 6, slack: 0 };
            let clik = AugmentedClik::new(state, PoseAxes::ALL, Vector6::repeat(gain), period).unwrap();
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
            // Rotations do not commute, so the remainder is of second order.
            let second_order = 2.0 * period * velocity.norm() * error.norm();
            prop_assert!((next - expected).norm() < second_order + 1e-6);
        }
    }

    /// Generates one to six coordinates.
    fn axes() -> impl Strategy<Value = PoseAxes> {
        prop::sample::subsequence((0..6).collect::<Vec<_>>(), 1..=6)
            .prop_map(|axes| PoseAxes::new(&axes).unwrap())
    }

    proptest! {
        #[test]
        fn rows_are_those_of_the_coordinates_controlled(
            axes in axes(),
            entries in prop::collection::vec(-1.0..1.0_f64, 6 * 4),
            error in prop::array::uniform6(-1.0..1.0_f64),
            velocity in prop::array::uniform6(-1.0..1.0_f64),
            rates in prop::array::uniform4(-1.0..1.0_f64),
        ) {
            let jacobian = DMatrix::from_row_slice(6, 4, &entries);
            let (error, velocity) = (Vector6::from(error), Vector6::from(velocity));
            let gain = Vector6::from_fn(|i, _| 10.0 + i as f64);
            let twist = &jacobian * DVector::from_column_slice(&rates);

            let plain = Clik::new(4, axes, gain, 1e-3).unwrap();
            let mut rows = plain.rows();
            plain.write(&jacobian, &error, &velocity, &mut rows).unwrap();
            prop_assert_eq!((rows.len(), rows.columns()), (axes.len(), 4));
            // The augmented form has ẋ_d as a variable, held at the same velocity.
            let state = AugmentedState { joints: 4, task: axes.len(), slack: 2 };
            let augmented = AugmentedClik::new(state, axes, gain, 1e-3).unwrap();
            let mut wide = augmented.rows();
            augmented.write(&jacobian, &error, &mut wide).unwrap();
            for (index, axis) in axes.iter().enumerate() {
                let (row, lower, upper) = rows.iter().nth(index).unwrap();
                let reached: f64 = row.iter().zip(&rates).map(|(a, b)| a * b).sum();
                let left = twist[axis] - velocity[axis] - gain[axis] * error[axis];
                prop_assert!((reached - lower - left).abs() < 1e-12);
                prop_assert_eq!(lower, upper);
                let (row, lower, upper) = wide.iter().nth(index).unwrap();
                prop_assert_eq!(&row[..4], rows.row(index).unwrap());
                for (j, entry) in row[4..].iter().enumerate() {
                    let own = if j == index { -(1.0 + gain[axis] * 1e-3) } else { 0.0 };
                    prop_assert_eq!(*entry, own);
                }
                prop_assert_eq!((lower, upper), (gain[axis] * error[axis], lower));
            }
        }
    }

    #[test]
    fn axes_are_one_to_six_different_coordinates() {
        for wrong in [&[][..], &[6], &[1, 1], &[0, 1, 2, 3, 4, 5, 0]] {
            assert!(matches!(PoseAxes::new(wrong), Err(Error::Value { .. })), "{wrong:?}");
        }
        assert_eq!(PoseAxes::new(&[5, 0, 1]).unwrap(), PoseAxes::PLANAR);
        assert_eq!(PoseAxes::new(&[0, 1, 2, 3, 4, 5]).unwrap(), PoseAxes::ALL);
        // Gains of coordinates that are not controlled are ignored.
        let gain = Vector6::new(1.0, 1.0, 1.0, 0.0, f64::NAN, -1.0);
        assert!(Clik::new(7, PoseAxes::POSITION, gain, 1e-3).is_ok());
        assert!(Clik::new(7, PoseAxes::PLANAR, gain, 1e-3).is_err());
        let state = AugmentedState { joints: 7, task: 6, slack: 0 };
        let error = AugmentedClik::new(state, PoseAxes::POSITION, gain, 1e-3).unwrap_err();
        assert_eq!(error, Error::Size { what: "the dimension of the task", got: 6, wanted: 3 });
    }

    #[test]
    fn bad_parameters_are_named() {
        let state = AugmentedState { joints: 7, task: 6, slack: 0 };
        for gain in [0.0, -1.0, f64::NAN, 2000.0] {
            let error =
                AugmentedClik::new(state, PoseAxes::ALL, Vector6::repeat(gain), 1e-3).unwrap_err();
            assert!(error.to_string().contains("gain"), "{error}");
        }
        assert!(AugmentedClik::new(state, PoseAxes::ALL, Vector6::repeat(1.0), 0.0).is_err());
        let clik = AugmentedClik::new(state, PoseAxes::ALL, Vector6::repeat(1.0), 1e-3).unwrap();
        let mut rows = clik.rows();
        assert!(clik.write(&DMatrix::zeros(6, 8), &Vector6::zeros(), &mut rows).is_err());
        let clik = Clik::new(7, PoseAxes::ALL, Vector6::repeat(1.0), 1e-3).unwrap();
        let zero = Vector6::zeros();
        assert!(clik.write(&DMatrix::zeros(5, 7), &zero, &zero, &mut clik.rows()).is_err());
        assert!(clik.write(&DMatrix::zeros(6, 7), &zero, &zero, &mut clik.rows()).is_ok());
        assert!(clik.write(&DMatrix::zeros(6, 7), &zero, &zero, &mut Rows::zeros(6, 8)).is_err());
    }
}
