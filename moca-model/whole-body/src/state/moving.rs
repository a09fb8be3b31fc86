//! View of the robot at a configuration and a velocity.

use nalgebra::Vector3;

use super::data::BodyMotion;
use super::posed::Posed;
use crate::error::Error;
use crate::robot::description::Base;
use crate::spatial::{Motion, Spatial};

/// The robot at a configuration q, moving at q̇. It gives twists, J̇q̇ and dynamics.
///
/// [`Posed::moving`] creates it, and [`posed`](Self::posed) gives the results of the configuration.
#[derive(Debug)]
pub struct Moving<'a> {
    pub(crate) posed: Posed<'a>,
}

impl<'a> Posed<'a> {
    /// Sets the velocity `v` = q̇ \[rad/s or m/s\] and returns a view with twists, J̇q̇ and dynamics.
    ///
    /// # Errors
    /// [`Error::Size`] and [`Error::Value`] on v.
    pub fn moving(self, v: &[f64]) -> Result<Moving<'a>, Error> {
        Moving::new(self, v)
    }
}

impl<'a> Moving<'a> {
    /// Computes velocities from the root outwards, and the accelerations for q̈ = 0 (Featherstone, *Rigid Body Dynamics
    /// Algorithms*, 2008, Sec. 5.3, here for the bodies' origins in world axes).
    fn new(posed: Posed<'a>, v: &[f64]) -> Result<Self, Error> {
        let (model, data) = (posed.model, &mut *posed.data);
        model.check_velocity("q̇", v)?;
        data.v.copy_from_slice(v);
        let root = match (model.base, v) {
            (Base::Floating, [vx, vy, vz, wx, wy, wz, ..]) => Spatial {
                linear: Vector3::new(*vx, *vy, *vz),
                angular: Vector3::new(*wx, *wy, *wz),
            },
            _ => Spatial::ZERO,
        };
        if let Some(first) = data.motions.first_mut() {
            *first = BodyMotion { velocity: root, bias: Spatial::ZERO };
        }
        for (index, mover) in model.movers.iter().enumerate() {
            let (parent, pose) = (&data.motions[mover.parent], &data.poses[index + 1]);
            let rate = mover.ratio * v[mover.velocity];
            let apart = pose.position - data.poses[mover.parent].position;
            let along = rate * pose.axis();
            let motion = carried(parent, &apart);
            data.motions[index + 1] = match mover.motion {
                Motion::Turns => turned(motion, &along),
                Motion::Slides => slid(motion, &along),
            };
        }
        Ok(Self { posed })
    }

    /// The view of the configuration.
    pub fn posed(&self) -> &Posed<'a> {
        &self.posed
    }

    /// The view of the configuration, for results that need scratch memory.
    pub fn posed_mut(&mut self) -> &mut Posed<'a> {
        &mut self.posed
    }

    /// The given q̇ \[rad/s or m/s\].
    pub fn velocity(&self) -> &[f64] {
        &self.posed.data.v
    }
}

/// The motion of a point of the body at a distance of `apart` from its origin.
#[inline]
pub(crate) fn carried(body: &BodyMotion, apart: &Vector3<f64>) -> BodyMotion {
    let (velocity, bias) = (&body.velocity, &body.bias);
    let around = velocity.angular.cross(apart);
    BodyMotion {
        velocity: Spatial { linear: velocity.linear + around, angular: velocity.angular },
        bias: Spatial {
            linear: bias.linear + bias.angular.cross(apart) + velocity.angular.cross(&around),
            angular: bias.angular,
        },
    }
}

/// Adds a joint at the point that rotates at `along` \[rad/s\] about an axis of the body.
#[inline]
fn turned(mut motion: BodyMotion, along: &Vector3<f64>) -> BodyMotion {
    motion.bias.angular += motion.velocity.angular.cross(along);
    motion.velocity.angular += along;
    motion
}

/// Adds a joint that slides at `along` \[m/s\] on an axis of the body, with the Coriolis acceleration.
#[inline]
fn slid(mut motion: BodyMotion, along: &Vector3<f64>) -> BodyMotion {
    motion.bias.linear += 2.0 * motion.velocity.angular.cross(along);
    motion.velocity.linear += along;
    motion
}
