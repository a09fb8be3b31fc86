//! The contact force at a frame that explains external torques.

use nalgebra::{Matrix3, Matrix6xX, Vector3};

use super::joints::joints;
use crate::error::{Error, check_size};
use crate::kinematics::jacobian::Axes;
use crate::robot::frame::FrameId;
use crate::robot::model::Model;
use crate::state::posed::Posed;

/// Share of the trace of J Jᵀ that is added to its diagonal. The force in a direction that hardly loads the
/// joints is then small.
const DAMPING: f64 = 1e-4;

/// The force at a frame's origin that best explains external torques: the least squares of Jᵥᵀ f = r over the joints
/// that it loads, where Jᵥ is the linear Jacobian.
///
/// It is the contact force if the contact is at the frame. Other contacts appear as the most similar force at the
/// frame. Moments at the frame count as zero.
///
/// ```
/// use whole_body::torque::ContactForce;
/// use whole_body::Data;
/// # use whole_body::{Description, Model};
/// # let model = Model::from_urdf(r#"<robot name="one"><link name="base"/><link name="tip"/>
/// #   <joint name="rail" type="prismatic"><parent link="base"/><child link="tip"/><axis xyz="0 1 0"/>
/// #   <limit lower="-1" upper="1" velocity="1" effort="50"/></joint></robot>"#, &Description::default())?;
/// let mut contact = ContactForce::new(&model, model.frame_id("tip")?, &[])?;
/// let mut data = Data::new(&model);
/// let force = contact.estimate(&data.pose(&model, &[0.2])?, &[-7.0])?;
/// assert!((force.y + 7.0).abs() < 1e-2); // N, in world axes
/// # Ok::<(), whole_body::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct ContactForce {
    frame: FrameId,
    /// Entries of q̇ that count.
    joints: Vec<usize>,
    jacobian: Matrix6xX<f64>,
}

impl ContactForce {
    /// Creates the estimator for the origin of `frame` and these joints, in the order of q; an empty list takes all.
    ///
    /// # Errors
    /// [`Error::UnknownName`]; [`Error::Unsuitable`] for a floating joint or a frame that no joint moves.
    pub fn new(model: &Model, frame: FrameId, names: &[String]) -> Result<Self, Error> {
        model.expect_moving(frame)?;
        let joints = joints(model, names)?.into_iter().map(|(_, entry)| entry).collect();
        Ok(Self { frame, joints, jacobian: Matrix6xX::zeros(model.velocity_count()) })
    }

    /// Returns the force \[N\] in world axes for external torques, one a joint \[Nm or N\]. Allocates nothing.
    ///
    /// # Errors
    /// [`Error::Size`]; [`Error::ForeignId`] for another robot.
    pub fn estimate(&mut self, robot: &Posed<'_>, torque: &[f64]) -> Result<Vector3<f64>, Error> {
        check_size("the list of torques", torque.len(), self.joints.len())?;
        robot.jacobian_into(self.frame, Axes::World, &mut self.jacobian)?;
        let (mut square, mut right) = (Matrix3::zeros(), Vector3::zeros());
        for (&entry, &torque) in self.joints.iter().zip(torque) {
            let column: Vector3<f64> = self.jacobian.fixed_view::<3, 1>(0, entry).into_owned();
            square += column * column.transpose();
            right += torque * column;
        }
        let damping = DAMPING * square.trace();
        let solved = (square + damping * Matrix3::identity()).cholesky();
        Ok(solved.map_or_else(Vector3::zeros, |factor| factor.solve(&right)))
    }
}
