//! Inverse dynamics: the forces that a motion needs.

use nalgebra::Vector3;

use super::external::ExternalWrench;
use crate::error::{Error, check_size};
use crate::inertia::body::BodyInertia;
use crate::robot::description::Base;
use crate::spatial::{Motion, Pose, Spatial};
use crate::state::data::BodyMotion;
use crate::state::moving::Moving;

impl Moving<'_> {
    /// The torques and forces τ that give the robot the `acceleration` q̈ against gravity and external wrenches, of the
    /// size of q̇ \[Nm or N\]: τ = M(q) q̈ + C(q, q̇) q̇ + g(q) − Σ Jₖᵀ wₖ.
    ///
    /// The recursive Newton-Euler algorithm (Luh, Walker, Paul 1980; Siciliano et al. 2009, eqs. 7.107-7.114) in world
    /// axes. Accelerations of the bodies go from the root to the tips, forces come back. Gravity is an acceleration of
    /// the root. Friction is left out; see [`friction_into`](Self::friction_into).
    ///
    /// # Errors
    /// [`Error::Size`], [`Error::Value`], [`Error::ForeignId`].
    pub fn inverse_dynamics_into(
        &mut self,
        acceleration: &[f64],
        external: &[ExternalWrench],
        out: &mut [f64],
    ) -> Result<(), Error> {
        let model = self.posed.model;
        model.check_velocity("q̈", acceleration)?;
        check_size("the list of torques", out.len(), model.velocities)?;
        self.forces(Some(acceleration));
        self.posed.relieve(external)?;
        self.collect(out);
        Ok(())
    }

    /// The bias forces C(q, q̇) q̇ + g(q), of the size of q̇ \[Nm or N\].
    ///
    /// # Errors
    /// [`Error::Size`].
    pub fn bias_forces_into(&mut self, out: &mut [f64]) -> Result<(), Error> {
        check_size("the list of torques", out.len(), self.posed.model.velocities)?;
        self.forces(None);
        self.collect(out);
        Ok(())
    }

    /// Computes the wrench that each body alone needs, about its origin.
    pub(super) fn forces(&mut self, acceleration: Option<&[f64]>) {
        let (model, data) = (self.posed.model, &mut *self.posed.data);
        let (accelerations, wrenches) =
            (&mut data.scratch.accelerations, &mut data.scratch.wrenches);
        let mut root = Spatial { linear: -model.gravity, angular: Vector3::zeros() };
        if let (Base::Floating, Some([x, y, z, wx, wy, wz, ..])) = (model.base, acceleration) {
            root.linear += Vector3::new(*x, *y, *z);
            root.angular = Vector3::new(*wx, *wy, *wz);
        }
        accelerations[0] = root;
        wrenches[0] = match model.base {
            Base::Floating => wrench(&data.inertias[0], &data.poses[0], &data.motions[0], &root),
            _ => Spatial::ZERO,
        };
        for (index, mover) in model.movers.iter().enumerate() {
            let body = index + 1;
            let pose = &data.poses[body];
            // All bodies have the acceleration of the root, that of gravity, if q̈ is zero.
            let mut own = root;
            if let Some(acceleration) = acceleration {
                let apart = pose.position - data.poses[mover.parent].position;
                let along = (mover.ratio * acceleration[mover.velocity]) * pose.axis();
                own = accelerations[mover.parent];
                own.linear += own.angular.cross(&apart);
                match mover.motion {
                    Motion::Turns => own.angular += along,
                    Motion::Slides => own.linear += along,
                }
                accelerations[body] = own;
            }
            wrenches[body] = wrench(&data.inertias[body], pose, &data.motions[body], &own);
        }
    }

    /// Sums the wrenches of the bodies towards the root and writes each joint's share.
    pub(super) fn collect(&mut self, out: &mut [f64]) {
        let (model, data) = (self.posed.model, &mut *self.posed.data);
        let wrenches = &mut data.scratch.wrenches;
        out.fill(0.0);
        for (index, mover) in model.movers.iter().enumerate().rev() {
            let (own, pose) = (wrenches[index + 1], &data.poses[index + 1]);
            let apart = pose.position - data.poses[mover.parent].position;
            out[mover.velocity] += mover.ratio * mover.motion.part(&pose.axis(), &own);
            let parent = &mut wrenches[mover.parent];
            parent.linear += own.linear;
            parent.angular += own.angular + apart.cross(&own.linear);
        }
        if model.base == Base::Floating {
            let root = wrenches[0].to_vector();
            out.iter_mut().zip(&root).for_each(|(out, own)| *out = *own);
        }
    }
}

/// Newton's and Euler's equations of one body, about its origin.
#[inline]
fn wrench(body: &BodyInertia, pose: &Pose, motion: &BodyMotion, by_joints: &Spatial) -> Spatial {
    let turning = &motion.velocity.angular;
    let angular = motion.bias.angular + by_joints.angular;
    let arm = pose.rotation * body.centre;
    let centre = motion.bias.linear
        + by_joints.linear
        + angular.cross(&arm)
        + turning.cross(&turning.cross(&arm));
    let force = body.mass * centre;
    let (turning, angular) = (pose.rotation.tr_mul(turning), pose.rotation.tr_mul(&angular));
    let moment = body.inertia * angular + turning.cross(&(body.inertia * turning));
    Spatial { linear: force, angular: pose.rotation * moment + arm.cross(&force) }
}
