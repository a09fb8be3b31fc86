//! The task of rotating a frame to an orientation.

use ahqp_core::rotation_log;
use nalgebra::{UnitQuaternion, Vector3};

use super::curvature::Curvature;
use super::feedback::Feedback;
use super::input::TaskInput;
use super::rows::TaskRows;
use super::vector_task::{VectorQuantity, VectorTask};
use crate::error::Error;
use crate::kinematics::jacobian::Axes;
use crate::robot::frame::FrameId;
use crate::robot::model::Model;

/// Rotates a frame to an orientation in the world: J_ω q̇ = ω_d + feedback(log(R_d Rᵀ)). Up to three rows, in world
/// axes \[rad/s\] (Siciliano et al. 2009, Sec. 3.7.3, with the rotation vector as the error).
///
/// See [`PositionTask`](crate::tasks::PositionTask) for an example.
pub type OrientationTask = VectorTask<FrameOrientation>;

/// The orientation of a frame.
#[derive(Debug, Clone, Copy)]
pub struct FrameOrientation(FrameId);

impl OrientationTask {
    /// Creates the quantity for `frame`, about all axes. Set the target before the first step.
    pub fn new(frame: FrameId) -> Self {
        Self::of(FrameOrientation(frame))
    }
}

impl VectorQuantity for FrameOrientation {
    type Value = UnitQuaternion<f64>;
    const FEEDBACK: Feedback = Feedback::ANGULAR;

    fn validate(&self, model: &Model) -> Result<(), Error> {
        model.expect_moving(self.0)
    }

    fn numbers(value: &UnitQuaternion<f64>) -> impl Iterator<Item = f64> {
        value.coords.iter().copied()
    }

    fn value(&self, input: &TaskInput<'_, '_>) -> Result<UnitQuaternion<f64>, Error> {
        Ok(input.posed().world_from(self.0)?.rotation)
    }

    fn difference(target: &UnitQuaternion<f64>, actual: &UnitQuaternion<f64>) -> Vector3<f64> {
        rotation_log(&(target * actual.inverse()))
    }

    fn write_jacobian(
        &mut self,
        axes: impl Iterator<Item = usize>,
        input: &mut TaskInput<'_, '_>,
        rows: &mut TaskRows<'_>,
    ) -> Result<(), Error> {
        let jacobian = input.jacobian(self.0, Axes::World)?;
        for (row, axis) in axes.enumerate() {
            rows.set_jacobian_row(row, jacobian, 3 + axis);
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
        curvature.add_orientation(input.jacobian(self.0, Axes::World)?, missing);
        Ok(())
    }
}
