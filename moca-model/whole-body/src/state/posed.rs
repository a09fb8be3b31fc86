//! View of the robot at a configuration.

use super::data::Data;
use crate::error::Error;
use crate::robot::configuration::orientation;
use crate::robot::description::Base;
use crate::robot::model::Model;
use crate::spatial::{Motion, Pose};

/// The robot at a configuration q. It gives poses, Jacobians, and forces at rest.
///
/// It borrows the [`Data`] that holds its results. Methods that need no scratch memory take `&self`.
///
/// ```
/// use nalgebra::Matrix6xX;
/// use whole_body::{Axes, Data, Description, Error, Model};
///
/// /// How fast `frame` moves where the joints move at `v`.
/// fn speed(model: &Model, frame: &str, q: &[f64], v: &[f64]) -> Result<f64, Error> {
///     let mut data = Data::new(model);
///     let mut jacobian = Matrix6xX::zeros(model.velocity_count());
///     let posed = data.pose(model, q)?;
///     posed.jacobian_into(model.frame_id(frame)?, Axes::World, &mut jacobian)?;
///     let twist = jacobian * nalgebra::DVector::from_column_slice(v);
///     Ok(twist.fixed_rows::<3>(0).norm())
/// }
/// ```
#[derive(Debug)]
pub struct Posed<'a> {
    pub(crate) model: &'a Model,
    pub(crate) data: &'a mut Data,
}

impl Data {
    /// Computes the poses of all bodies at the configuration `q`.
    ///
    /// The world pose of a body is the product of three: that of its parent, the fixed placement of the joint between
    /// them, and the joint's rotation or translation.
    ///
    /// # Errors
    /// [`Error::ForeignData`]; [`Error::Size`] and [`Error::Value`] on q.
    pub fn pose<'a>(&'a mut self, model: &'a Model, q: &[f64]) -> Result<Posed<'a>, Error> {
        self.check(model)?;
        model.check_configuration(q)?;
        // Poses depend on the configuration alone.
        if self.is_posed && self.q == q {
            return Ok(Posed { model, data: self });
        }
        self.q.copy_from_slice(q);
        let root = match (model.base, q) {
            (Base::Floating, [x, y, z, ..]) => Pose {
                rotation: *orientation(q).to_rotation_matrix().matrix(),
                position: nalgebra::Vector3::new(*x, *y, *z),
            },
            _ => Pose::identity(),
        };
        place(model, &mut self.poses, &root, q);
        self.is_posed = true;
        Ok(Posed { model, data: self })
    }

    /// The view of the last configuration of [`pose`](Self::pose), without a new computation.
    ///
    /// # Errors
    /// [`Error::ForeignData`]; [`Error::NeverPosed`] before the first configuration.
    pub fn posed<'a>(&'a mut self, model: &'a Model) -> Result<Posed<'a>, Error> {
        self.check(model)?;
        if !self.is_posed {
            return Err(Error::NeverPosed);
        }
        Ok(Posed { model, data: self })
    }
}

fn place(model: &Model, poses: &mut [Pose], root: &Pose, q: &[f64]) {
    if let Some(first) = poses.first_mut() {
        *first = *root;
    }
    for (index, mover) in model.movers.iter().enumerate() {
        let position = mover.ratio * q[mover.position] + mover.offset;
        let mut pose = poses[mover.parent].then(&mover.placement);
        match mover.motion {
            Motion::Turns => pose.turn_about_z(position),
            Motion::Slides => pose.position += position * pose.axis(),
        }
        poses[index + 1] = pose;
    }
}

impl<'a> Posed<'a> {
    /// The robot.
    pub fn model(&self) -> &'a Model {
        self.model
    }

    /// The given q.
    pub fn configuration(&self) -> &[f64] {
        &self.data.q
    }
}
