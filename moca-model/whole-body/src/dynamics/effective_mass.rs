//! Effective mass of the robot at a point in a direction.

use nalgebra::{UnitVector3, Vector3};

use crate::error::Error;
use crate::robot::description::Base;
use crate::robot::frame::FrameId;
use crate::spatial::Motion;
use crate::state::posed::Posed;

impl Posed<'_> {
    /// The effective mass at the frame's origin along `direction`, in world axes \[kg\].
    ///
    /// It is 1 / (nᵀ J M⁻¹ Jᵀ n) with J the linear Jacobian (Khatib, "Inertial properties in robotic manipulation",
    /// 1995, eq. 26), and infinite where no joint yields. ISO/TS 15066 uses it for the transfer of energy in contact
    /// with a person.
    ///
    /// # Errors
    /// [`Error::ForeignId`]; [`Error::NoInertia`] for a joint that moves nothing.
    pub fn effective_mass(
        &mut self,
        frame: FrameId,
        direction: &UnitVector3<f64>,
    ) -> Result<f64, Error> {
        let found = self.model.frame(frame)?;
        let point = self.data.poses[found.body].position
            + self.data.poses[found.body].rotation * found.pose.position;
        let mut row = std::mem::take(&mut self.data.scratch.row);
        let mut solved = std::mem::take(&mut self.data.scratch.solved);
        self.row_of(found.body, &point, direction, &mut row);
        solved.copy_from_slice(&row);
        let outcome = self.divide_by_mass_matrix(&mut solved);
        let mobility: f64 = row.iter().zip(&solved).map(|(row, solved)| row * solved).sum();
        (self.data.scratch.row, self.data.scratch.solved) = (row, solved);
        outcome.map(|()| if mobility > 0.0 { 1.0 / mobility } else { f64::INFINITY })
    }

    /// Jᵀ n of a point on a body.
    fn row_of(&self, body: usize, point: &Vector3<f64>, n: &Vector3<f64>, out: &mut [f64]) {
        out.fill(0.0);
        let mut below = body;
        while let Some(index) = below.checked_sub(1) {
            let (mover, pose) = (&self.model.movers[index], &self.data.poses[below]);
            let along = match mover.motion {
                Motion::Turns => pose.axis().cross(&(point - pose.position)).dot(n),
                Motion::Slides => pose.axis().dot(n),
            };
            out[mover.velocity] += mover.ratio * along;
            below = mover.parent;
        }
        if self.model.base == Base::Floating {
            let moment = (point - self.data.poses[0].position).cross(n);
            let base = n.iter().chain(&moment);
            out.iter_mut().zip(base).for_each(|(out, own)| *out += own);
        }
    }
}
