//! Hybrid dynamics: some joints move as they are told, the others as forces make them.

use super::articulated::Part;
use super::external::ExternalWrench;
use crate::error::Error;
use crate::state::moving::Moving;

impl Moving<'_> {
    /// Accelerations where those of some entries of q̇ are prescribed: `acceleration` holds these at
    /// first, and all of them afterwards. `torque` counts where entries are free, with friction taken
    /// off. (Featherstone 2008, Sec. 9.2: the prescribed accelerations are part of the bias force, and
    /// their joints are then as good as locked.)
    ///
    /// The sizes must be that of q̇, and the model without mimic joints.
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
