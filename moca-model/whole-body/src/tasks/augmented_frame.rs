//! The task of a frame that follows a desired pose whose velocity is itself a variable.

use ahqp_core::{AugmentedRow, PoseAxes, pose_error};
use nalgebra::{Isometry3, Matrix6xX, Vector3, Vector6};

use super::input::TaskInput;
use super::rows::TaskRows;
use super::task::Task;
use super::variables::Variables;
use crate::error::{Error, check_finite, check_size};
use crate::kinematics::jacobian::Axes;
use crate::robot::frame::FrameId;
use crate::robot::model::Model;

/// The augmented closed-loop inverse kinematics of Tassi et al. The frame follows a desired pose x_d whose velocity ẋ_d
/// is a further variable, which levels below can choose.
///
/// The rows are J q̇ − (I + K_p Δt) ẋ_d = K_p (x_d − x) (the paper's eq. 4), where Δt is the period of the step. There
/// are up to six, in world axes, linear \[m/s\], then angular \[rad/s\].
///
/// ```
/// use nalgebra::Isometry3;
/// use whole_body::tasks::{AugmentedFrameTask, VariableLayout};
/// # use whole_body::{Description, Model};
/// # let model = Model::from_urdf(r#"<robot name="slide"><link name="base"/><link name="tool"/>
/// #   <joint name="j" type="prismatic"><parent link="base"/><child link="tool"/><axis xyz="1 0 0"/>
/// #   <limit lower="0" upper="1" velocity="1" effort="1"/></joint></robot>"#, &Description::default())?;
/// let mut layout = VariableLayout::new(&model);
/// let desired = layout.add("desired twist", 6);
/// let mut task = AugmentedFrameTask::new(model.frame_id("tool")?, &desired);
/// task.set_desired(Isometry3::translation(0.4, 0.0, 0.0))?; // x_d of the tick before
/// # Ok::<(), whole_body::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct AugmentedFrameTask {
    frame: FrameId,
    /// Pose of the controlled point in the frame.
    point: Isometry3<f64>,
    desired_twist: Variables,
    desired: Option<Isometry3<f64>>,
    gains: Vector6<f64>,
    coordinates: PoseAxes,
}

impl AugmentedFrameTask {
    /// Creates a task for all coordinates of `frame`, with these variables as ẋ_d and gains of 20 1/s. Set x_d before
    /// the first step.
    pub fn new(frame: FrameId, desired_twist: &Variables) -> Self {
        let (gains, coordinates) = (Vector6::repeat(20.0), PoseAxes::ALL);
        Self {
            frame,
            point: Isometry3::identity(),
            desired_twist: desired_twist.clone(),
            desired: None,
            gains,
            coordinates,
        }
    }

    /// Sets the diagonal of K_p \[1/s\]. Each gain is at most one over the period.
    #[must_use]
    pub fn with_gains(mut self, gains: Vector6<f64>) -> Self {
        self.gains = gains;
        self
    }

    /// Restricts the task to these coordinates. ẋ_d has one variable for each.
    #[must_use]
    pub fn with_coordinates(mut self, coordinates: PoseAxes) -> Self {
        self.coordinates = coordinates;
        self
    }

    /// Sets the point that follows x_d, by its pose in the frame. It may be the tip of a tool that the frame holds.
    ///
    /// # Errors
    /// [`Error::Value`]; the point is then unchanged.
    pub fn set_point(&mut self, frame_from_point: Isometry3<f64>) -> Result<(), Error> {
        check_pose(&frame_from_point, "the pose of a point in its frame")?;
        self.point = frame_from_point;
        Ok(())
    }

    /// Sets x_d of the previous tick. The next x_d is where ẋ_d takes it
    /// ([`integrate_pose`](ahqp_core::integrate_pose)).
    ///
    /// # Errors
    /// [`Error::Value`]; x_d is then unchanged.
    pub fn set_desired(&mut self, pose: Isometry3<f64>) -> Result<(), Error> {
        check_pose(&pose, "the desired pose")?;
        self.desired = Some(pose);
        Ok(())
    }
}

fn check_pose(pose: &Isometry3<f64>, what: &str) -> Result<(), Error> {
    let numbers = pose.translation.vector.iter().chain(pose.rotation.coords.iter());
    numbers.into_iter().try_for_each(|value| check_finite(*value, || format!("a number of {what}")))
}

impl Task for AugmentedFrameTask {
    fn dimension(&self, _model: &Model) -> usize {
        self.coordinates.len()
    }

    fn validate(&self, model: &Model) -> Result<(), Error> {
        let gains = self.coordinates.iter().map(|axis| self.gains[axis]);
        if let Some(value) = gains.into_iter().find(|gain| !(*gain > 0.0 && gain.is_finite())) {
            let (what, expected) = ("a gain", "positive and finite [1/s]");
            return Err(Error::value(what, value, expected));
        }
        let variables = self.desired_twist.range().len();
        check_size("the desired twist", variables, self.coordinates.len())?;
        model.expect_moving(self.frame)
    }

    fn is_damped(&self) -> bool {
        false
    }

    fn hold(&mut self, input: &mut TaskInput<'_, '_>) -> Result<(), Error> {
        if self.desired.is_none() {
            self.desired = Some(input.posed().world_from(self.frame)? * self.point);
        }
        Ok(())
    }

    fn write(
        &mut self,
        input: &mut TaskInput<'_, '_>,
        rows: &mut TaskRows<'_>,
    ) -> Result<(), Error> {
        let desired = self.desired.ok_or(Error::TargetMissing)?;
        let period = input.period();
        let world_from_frame = input.posed().world_from(self.frame)?;
        let lever = world_from_frame.rotation * self.point.translation.vector;
        let error = pose_error(&desired, &(world_from_frame * self.point));
        let jacobian = input.jacobian(self.frame, Axes::World)?;
        let twist = self.desired_twist.range();
        for (row, (axis, variable)) in self.coordinates.iter().zip(twist).enumerate() {
            let gain = self.gains[axis];
            if gain * period > 1.0 + 1e-9 {
                return Err(Error::too_high(gain, period));
            }
            rows.set_jacobian_row(row, jacobian, axis);
            if axis < 3 && lever != Vector3::zeros() {
                carry(rows.row_mut(row), jacobian, axis, &lever);
            }
            let (got, own) = (variable + 1, rows.row_mut(row));
            let (what, wanted) =
                ("the list of variables up to those of the desired twist", own.len());
            let entry = own.get_mut(variable).ok_or(Error::Size { what, got, wanted })?;
            let clik = AugmentedRow::new(gain, period, error[axis]);
            *entry = clik.desired;
            rows.set_target(row, clik.target);
        }
        Ok(())
    }
}

/// Adds ω × lever to the row of a linear axis, for the angular velocity of each joint.
fn carry(row: &mut [f64], jacobian: &Matrix6xX<f64>, axis: usize, lever: &Vector3<f64>) {
    let mut unit = Vector3::zeros();
    unit[axis] = 1.0;
    // e · (ω × r) = ω · (r × e)
    let moment = lever.cross(&unit);
    for (entry, column) in row.iter_mut().zip(jacobian.column_iter()) {
        *entry += column.fixed_rows::<3>(3).dot(&moment);
    }
}
