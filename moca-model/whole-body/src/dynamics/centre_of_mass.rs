//! The centre of mass of all links that move.

use nalgebra::{Matrix3xX, Point3, Vector3};

use crate::error::{Error, check_size};
use crate::robot::description::Base;
use crate::spatial::Motion;
use crate::state::posed::Posed;

impl Posed<'_> {
    /// The centre of mass of all links that move, in the world \[m\]; the world's origin if they
    /// have no mass.
    pub fn centre_of_mass(&self) -> Point3<f64> {
        let (mass, moment) = self.mass_and_moment();
        if mass > 0.0 { Point3::from(moment / mass) } else { Point3::origin() }
    }

    /// The Jacobian of the centre of mass, 3 × the size of q̇, in world axes \[m/s\].
    ///
    /// Column i is zᵢ × Σ mₖ(cₖ − pᵢ) / m for a revolute joint, and zᵢ Σ mₖ / m for a prismatic one. The sums are over
    /// the links k that the joint moves.
    ///
    /// # Errors
    /// [`Error::Size`] unless `out` has as many columns as q̇ entries.
    pub fn centre_of_mass_jacobian_into(&mut self, out: &mut Matrix3xX<f64>) -> Result<(), Error> {
        check_size("the Jacobian's list of columns", out.ncols(), self.model.velocities)?;
        self.sum_up_carried();
        out.as_mut_slice().fill(0.0);
        let carried = &self.data.scratch.carried;
        let Some(root) = carried.first().filter(|root| root.mass > 0.0) else {
            return Ok(());
        };
        let columns = out.as_mut_slice().as_chunks_mut::<3>().0;
        let bodies = self.data.poses.iter().zip(carried).skip(1);
        for (mover, (pose, carried)) in self.model.movers.iter().zip(bodies) {
            let moved = match mover.motion {
                Motion::Turns => pose.axis().cross(&carried.moment),
                Motion::Slides => carried.mass * pose.axis(),
            };
            let moved = (mover.ratio / root.mass) * moved;
            columns[mover.velocity].iter_mut().zip(&moved).for_each(|(out, by)| *out += by);
        }
        if let (Base::Floating, [x, y, z, wx, wy, wz, ..]) = (self.model.base, columns) {
            let apart = root.moment / root.mass;
            (*x, *y, *z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
            *wx = Vector3::x().cross(&apart).into();
            *wy = Vector3::y().cross(&apart).into();
            *wz = Vector3::z().cross(&apart).into();
        }
        Ok(())
    }

    /// m and Σ m c of all bodies.
    pub(super) fn mass_and_moment(&self) -> (f64, Vector3<f64>) {
        let bodies = self.data.inertias.iter().zip(&self.data.poses);
        bodies.fold((0.0, Vector3::zeros()), |(mass, moment), (own, pose)| {
            let centre = pose.position + pose.rotation * own.centre;
            (mass + own.mass, moment + own.mass * centre)
        })
    }
}
