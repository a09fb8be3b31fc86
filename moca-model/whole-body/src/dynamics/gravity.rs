//! Gravity forces and potential energy.

use crate::error::{Error, check_size};
use crate::robot::description::Base;
use crate::spatial::Motion;
use crate::state::posed::Posed;

impl Posed<'_> {
    /// The torques and forces that hold the robot still against gravity, of the size of q̇ \[Nm or N\]. A floating base
    /// has the force and the moment about its origin.
    ///
    /// The potential energy is U = −gᵀ Σ mₖ cₖ, with cₖ the centres of mass. Its derivative depends only on the links
    /// that joint i moves: ∂U/∂qᵢ = −gᵀ (zᵢ × Σ mₖ(cₖ − pᵢ)) for a revolute joint and −gᵀzᵢ Σ mₖ for a prismatic one.
    ///
    /// # Errors
    /// [`Error::Size`].
    pub fn gravity_into(&mut self, out: &mut [f64]) -> Result<(), Error> {
        check_size("the list of torques", out.len(), self.model.velocities)?;
        self.sum_up_carried();
        let (gravity, carried) = (&self.model.gravity, &self.data.scratch.carried);
        out.fill(0.0);
        let bodies = self.data.poses.iter().zip(carried).skip(1);
        for (mover, (pose, carried)) in self.model.movers.iter().zip(bodies) {
            let torque = match mover.motion {
                Motion::Turns => gravity.cross(&pose.axis()).dot(&carried.moment),
                Motion::Slides => carried.mass * gravity.dot(&pose.axis()),
            };
            out[mover.velocity] -= mover.ratio * torque;
        }
        if let (Base::Floating, Some(root)) = (self.model.base, carried.first()) {
            let (force, moment) = (-root.mass * gravity, -root.moment.cross(gravity));
            out.iter_mut().zip(force.iter().chain(&moment)).for_each(|(out, own)| *out = *own);
        }
        Ok(())
    }

    /// The potential energy of the links that move \[J\]. It is zero where their centre of mass is at the world's
    /// origin.
    pub fn potential_energy(&self) -> f64 {
        -self.model.gravity.dot(&self.mass_and_moment().1)
    }
}
