//! Friction in the joints.

use crate::error::{Error, check_size};
use crate::state::moving::Moving;

impl Moving<'_> {
    /// What friction asks of the motors beside the forces of a frictionless robot, of the size of q̇
    /// \[Nm or N\]; zero for joints of which the [`Description`](crate::Description) states none.
    ///
    /// Inverse and forward dynamics leave friction out: add this to what a motor must give, and
    /// subtract it from what moves a robot.
    ///
    /// # Errors
    /// [`Error::WrongSize`].
    pub fn friction_into(&self, out: &mut [f64]) -> Result<(), Error> {
        check_size("the list of torques", out.len(), self.posed.model.velocities)?;
        let joints = self.posed.model.friction.iter().zip(self.velocity());
        for (out, (friction, velocity)) in out.iter_mut().zip(joints) {
            *out = friction.map_or(0.0, |friction| friction.torque(*velocity));
        }
        Ok(())
    }
}
