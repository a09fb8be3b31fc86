//! External forces on the robot.

use nalgebra::Vector6;

use crate::error::{Error, check_finite};
use crate::robot::frame::FrameId;
use crate::spatial::Spatial;
use crate::state::posed::Posed;

/// An external wrench on a link: a contact, a push, a weight on a rope.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExternalWrench {
    /// The frame at whose origin it acts.
    pub frame: FrameId,
    /// Force \[N\], then moment about the frame's origin \[Nm\], on the robot, in world axes.
    pub wrench: Vector6<f64>,
}

impl Posed<'_> {
    /// Subtracts external wrenches from the wrenches that the joints must exert on each body.
    pub(super) fn relieve(&mut self, external: &[ExternalWrench]) -> Result<(), Error> {
        for ExternalWrench { frame, wrench } in external {
            for value in wrench {
                check_finite(*value, || "a number of an external wrench".to_owned())?;
            }
            let frame = self.model.frame(*frame)?;
            let arm = self.data.poses[frame.body].rotation * frame.pose.position;
            let Spatial { linear, angular } = Spatial::from_vector(wrench);
            let own = &mut self.data.scratch.wrenches[frame.body];
            own.linear -= linear;
            own.angular -= angular + arm.cross(&linear);
        }
        Ok(())
    }
}
