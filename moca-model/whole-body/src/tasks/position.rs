//! The task of moving a frame's origin to a point.

use nalgebra::{Point3, Vector3};

use super::curvature::Curvature;
use super::feedback::Feedback;
use super::input::TaskInput;
use super::rows::TaskRows;
use super::vector_task::{VectorQuantity, VectorTask};
use crate::error::Error;
use crate::kinematics::jacobian::Axes;
use crate::robot::frame::FrameId;
use crate::robot::model::Model;

/// Moves the origin of a frame to a point of the world: J_v q̇ = ṗ_d + feedback(p_d − p) (Siciliano, Sciavicco,
/// Villani, Oriolo, *Robotics: Modelling, Planning and Control*, 2009, Sec. 3.7). Up to three rows, in world axes
/// \[m/s\].
///
/// ```
/// use nalgebra::{Point3, Vector3};
/// use whole_body::tasks::{Axis, PositionTask};
/// # use whole_body::{Description, Model};
/// # let model = Model::from_urdf(r#"<robot name="slide"><link name="base"/><link name="tool"/>
/// #   <joint name="j" type="prismatic"><parent link="base"/><child link="tool"/><axis xyz="1 0 0"/>
/// #   <limit lower="0" upper="1" velocity="1" effort="1"/></joint></robot>"#, &Description::default())?;
/// let tool = model.frame_id("tool")?;
/// let mut task = PositionTask::new(tool).with_gain(50.0).with_axes(&[Axis::X]);
/// task.set_moving_target(Point3::new(0.4, 0.0, 0.0), Vector3::new(0.1, 0.0, 0.0))?;
/// # Ok::<(), whole_body::Error>(())
/// ```
pub type PositionTask = VectorTask<FramePosition>;

/// The origin of a frame \[m\].
#[derive(Debug, Clone, Copy)]
pub struct FramePosition(FrameId);

impl PositionTask {
    /// Creates the quantity for the origin of `frame`, along all axes. Set the target before the first step.
    pub fn new(frame: FrameId) -> Self {
        Self::of(FramePosition(frame))
    }
}

impl VectorQuantity for FramePosition {
    type Value = Point3<f64>;
    const FEEDBACK: Feedback = Feedback::LINEAR;

    fn validate(&self, model: &Model) -> Result<(), Error> {
        model.expect_moving(self.0)
    }

    fn numbers(value: &Point3<f64>) -> impl Iterator<Item = f64> {
        value.coords.iter().copied()
    }

    fn value(&self, input: &TaskInput<'_, '_>) -> Result<Point3<f64>, Error> {
        Ok(input.posed().placement(self.0)?.translation.vector.into())
    }

    fn difference(target: &Point3<f64>, actual: &Point3<f64>) -> Vector3<f64> {
        target - actual
    }

    fn write_jacobian(
        &mut self,
        axes: impl Iterator<Item = usize>,
        input: &mut TaskInput<'_, '_>,
        rows: &mut TaskRows<'_>,
    ) -> Result<(), Error> {
        let jacobian = input.jacobian(self.0, Axes::World)?;
        for (row, axis) in axes.enumerate() {
            rows.set_jacobian_row(row, jacobian, axis);
        }
        Ok(())
    }

    const HAS_CURVATURE: bool = true;

    fn add_curvature(
        &self,
        missing: &Vector3<f64>,
        input: &mut TaskInput<'_, '_>,
        curvature: &mut Curvature,
    ) -> Result<(), Error> {
        curvature.add_position(input.jacobian(self.0, Axes::World)?, missing);
        Ok(())
    }
}
