//! The robot's state-dependent quantities, with room for them made once.

use nalgebra::{DMatrix, DVector, Isometry3};

use super::kinematics;
use super::model::{Frame, RobotModel};
use crate::error::Error;

/// What [`forward_kinematics`](crate::forward_kinematics),
/// [`jacobian`](crate::jacobian) and [`gravity`](crate::gravity) compute.
///
/// Sized for one model at construction; nothing allocates afterwards.
#[derive(Debug, Clone)]
pub struct RobotData {
    pub(super) frames: Vec<Frame>,
    pub(super) tool: Frame,
    pub(super) world_from_tool: Isometry3<f64>,
    pub(super) jacobian: DMatrix<f64>,
    pub(super) gravity: DVector<f64>,
}

impl RobotData {
    /// Room for `model`, placed at q = 0; Jacobian and gravity are zero until
    /// they are computed.
    pub fn new(model: &RobotModel) -> Self {
        let n = model.joint_count();
        let mut data = Self {
            frames: vec![Frame::identity(); n],
            tool: Frame::identity(),
            world_from_tool: Isometry3::identity(),
            jacobian: DMatrix::zeros(6, n),
            gravity: DVector::zeros(n),
        };
        kinematics::place(model, &mut data, std::iter::repeat(0.0));
        data
    }

    /// Pose of the tool in the world.
    pub fn world_from_tool(&self) -> &Isometry3<f64> {
        &self.world_from_tool
    }

    /// The geometric Jacobian, 6×n: the tool's twist for q̇, linear rows \[m/s\]
    /// then angular ones \[rad/s\], in the world's axes, at the tool's origin.
    pub fn jacobian(&self) -> &DMatrix<f64> {
        &self.jacobian
    }

    /// Torques and forces that hold the robot still against gravity, n \[Nm or N\].
    pub fn gravity(&self) -> &DVector<f64> {
        &self.gravity
    }

    pub(super) fn check(&self, model: &RobotModel) -> Result<(), Error> {
        if self.frames.len() == model.joint_count() {
            Ok(())
        } else {
            Err(Error::ForeignData { expected: model.joint_count(), got: self.frames.len() })
        }
    }
}
