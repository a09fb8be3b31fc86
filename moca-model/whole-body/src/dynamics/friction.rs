//! Friction in the joints.

use crate::error::{Error, check_size};
use crate::state::moving::Moving;

impl Moving<'_> {
    /// The friction in the joints, of the size of q̇ \[Nm or N\]. Zero for joints of which the
    /// [`Description`](crate::Description) states none.
    ///
    /// Inverse and forward dynamics leave friction out. Add this to the torques that motors must give, and subtract it
    /// from the torques that move the robot.
    ///
    /// # Errors
    /// [`Error::Size`].
    pub fn friction_into(&self, out: &mut [f64]) -> Result<(), Error> {
        check_size("the list of torques", out.len(), self.posed.model.velocities)?;
        let joints = self.posed.model.friction.iter().zip(self.velocity());
        for (out, (friction, velocity)) in out.iter_mut().zip(joints) {
            *out = friction.map_or(0.0, |friction| friction.torque(*velocity));
        }
        Ok(())
    }
}
