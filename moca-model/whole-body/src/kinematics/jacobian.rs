//! Geometric Jacobians.

use nalgebra::{Matrix3, Matrix6xX, Vector3};

use crate::error::{Error, check_size};
use crate::robot::description::Base;
use crate::robot::frame::FrameId;
use crate::spatial::{Motion, Spatial};
use crate::state::posed::Posed;

/// The axes of twists, Jacobians and accelerations of a frame, which always refer to its origin.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Axes {
    /// Axes parallel to the world's.
    #[default]
    World,
    /// The frame's own axes. Rates are those of the components in these rotating axes.
    Local,
}

impl Posed<'_> {
    /// The Jacobian of a frame, 6 × the size of q̇, which maps q̇ to its twist: linear rows \[m/s\], then angular ones
    /// \[rad/s\]. Columns of joints that do not move the frame are zero.
    ///
    /// Column i is [zᵢ × (p − pᵢ); zᵢ] for a revolute joint and [zᵢ; 0] for a prismatic one. Here zᵢ is its axis, pᵢ
    /// its origin and p the frame's origin (Siciliano, Sciavicco, Villani, Oriolo, *Robotics: Modelling, Planning and
    /// Control*, 2009, eq. 3.30). A mimic joint adds to the column of the joint that it follows.
    ///
    /// # Errors
    /// [`Error::ForeignId`]; [`Error::Size`] unless `out` has as many columns as q̇ entries.
    pub fn jacobian_into(
        &self,
        frame: FrameId,
        axes: Axes,
        out: &mut Matrix6xX<f64>,
    ) -> Result<(), Error> {
        let found = self.model.frame(frame)?;
        check_size("the Jacobian's list of columns", out.ncols(), self.model.velocities)?;
        let carrier = &self.data.poses[found.body];
        let position = carrier.position + carrier.rotation * found.pose.position;
        out.as_mut_slice().fill(0.0);
        self.add_columns(found.body, &position, 1.0, out);
        if axes == Axes::Local {
            turn_columns(&(carrier.rotation * found.pose.rotation), out);
        }
        Ok(())
    }

    /// Adds the columns of a point on a body, times `factor`.
    pub(super) fn add_columns(
        &self,
        body: usize,
        point: &Vector3<f64>,
        factor: f64,
        out: &mut Matrix6xX<f64>,
    ) {
        let columns = out.as_mut_slice().as_chunks_mut::<6>().0;
        let mut below = body;
        while let Some(index) = below.checked_sub(1) {
            let (mover, pose) = (&self.model.movers[index], &self.data.poses[below]);
            let axis = (factor * mover.ratio) * pose.axis();
            let moved = match mover.motion {
                Motion::Turns => {
                    Spatial { linear: axis.cross(&(point - pose.position)), angular: axis }
                }
                Motion::Slides => Spatial { linear: axis, angular: Vector3::zeros() },
            };
            add(&mut columns[mover.velocity], &moved);
            below = mover.parent;
        }
        if let (Base::Floating, [x, y, z, wx, wy, wz, ..]) = (self.model.base, columns) {
            let apart = factor * (point - self.data.poses[0].position);
            for (column, entry) in [(x, 0), (y, 1), (z, 2)] {
                column[entry] += factor;
            }
            for (column, axis) in [(wx, Vector3::x()), (wy, Vector3::y()), (wz, Vector3::z())] {
                add(column, &Spatial { linear: axis.cross(&apart), angular: factor * axis });
            }
        }
    }
}

#[inline]
fn add(column: &mut [f64; 6], by: &Spatial) {
    let [a, b, c, d, e, f] = column;
    (*a, *b, *c) = (*a + by.linear.x, *b + by.linear.y, *c + by.linear.z);
    (*d, *e, *f) = (*d + by.angular.x, *e + by.angular.y, *f + by.angular.z);
}

/// Transforms columns from world axes to those of a frame with this `rotation`.
pub(super) fn turn_columns(rotation: &Matrix3<f64>, out: &mut Matrix6xX<f64>) {
    for column in out.as_mut_slice().as_chunks_mut::<6>().0 {
        let [a, b, c, d, e, f] = *column;
        let world = Spatial { linear: Vector3::new(a, b, c), angular: Vector3::new(d, e, f) };
        *column = world.in_axes_of(rotation).to_vector().into();
    }
}
