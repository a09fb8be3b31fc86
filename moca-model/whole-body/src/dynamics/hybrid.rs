//! Hybrid dynamics: some joints have prescribed accelerations, forces move the others.

use super::articulated::Part;
use super::external::ExternalWrench;
use crate::error::Error;
use crate::state::moving::Moving;

impl Moving<'_> {
    /// Computes the accelerations of all entries of q̇, where those of some are prescribed (Featherstone 2008, Sec.
    /// 9.2). `acceleration` holds the prescribed entries before and all of them afterwards. `torque` counts for free
    /// entries, with friction already subtracted. The prescribed accelerations are part of the bias force, and their
    /// joints count as locked.
    ///
    /// The sizes must be that of q̇, and the model must have no mimic joints.
    pub(crate) fn hybrid_dynamics_into(
        &mut self,
        torque: &[f64],
        parts: &[Part],
        external: &[ExternalWrench],
        room: &mut [f64],
        acceleration: &mut [f64],
    ) -> Result<(), Error> {
        for (acceleration, part) in acceleration.iter_mut().zip(parts) {
            if *part != Part::Prescribed {
                *acceleration = 0.0;
            }
        }
        self.forces(Some(acceleration));
        self.posed.relieve(external)?;
        self.collect(room);
        room.iter_mut().zip(torque).for_each(|(room, torque)| *room = torque - *room);
        self.posed.solve_by_articulated_bodies(room, parts)?;
        for ((acceleration, solved), part) in acceleration.iter_mut().zip(&*room).zip(parts) {
            if *part != Part::Prescribed {
                *acceleration = *solved;
            }
        }
        Ok(())
    }
}
