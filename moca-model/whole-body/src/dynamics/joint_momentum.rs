//! The generalised momentum and its rate.

use crate::error::{Error, check_size};
use crate::robot::description::Base;
use crate::spatial::{Motion, Spatial};
use crate::state::moving::Moving;

impl Moving<'_> {
    /// The generalised momentum p = M(q) q̇ and β = C(q, q̇)ᵀ q̇ − g(q), both of the size of q̇ \[Nm s or N s; Nm or
    /// N\]. The rate is ṗ = τ + β + Σ Jₖᵀ wₖ.
    ///
    /// The entry (Cᵀ q̇)ᵢ is the derivative of the kinetic energy along qᵢ. A revolute joint i turns its subtree
    /// against the twist Vᵢ of the body that carries it, so that (Cᵀ q̇)ᵢ = hᵢ · (Vᵢ × sᵢ). Here hᵢ is the momentum of
    /// the subtree and sᵢ the joint's axis. One pass gives all entries without the matrices. (Spatial cross product:
    /// Featherstone 2008, eq. 2.31. Ṁ = C + Cᵀ: Siciliano et al. 2009, Sec. 7.2.1.)
    ///
    /// Friction is left out; see [`friction_into`](Self::friction_into).
    ///
    /// # Errors
    /// [`Error::Size`].
    pub fn joint_momentum_into(
        &mut self,
        momentum: &mut [f64],
        bias: &mut [f64],
    ) -> Result<(), Error> {
        let size = self.posed.model.velocities;
        check_size("the list of momenta", momentum.len(), size)?;
        self.posed.gravity_into(bias)?;
        for bias in bias.iter_mut() {
            *bias = -*bias;
        }
        momentum.fill(0.0);
        self.momenta_of_bodies();
        let (model, data) = (self.posed.model, &mut *self.posed.data);
        let carried = &mut data.scratch.wrenches;
        for (index, mover) in model.movers.iter().enumerate().rev() {
            let (own, pose) = (carried[index + 1], &data.poses[index + 1]);
            let (axis, twist) = (pose.axis(), &data.motions[index + 1].velocity);
            momentum[mover.velocity] += mover.ratio * mover.motion.part(&axis, &own);
            let turned = twist.angular.cross(&axis);
            let rate = match mover.motion {
                Motion::Turns => {
                    own.angular.dot(&turned) + own.linear.dot(&twist.linear.cross(&axis))
                }
                Motion::Slides => own.linear.dot(&turned),
            };
            bias[mover.velocity] += mover.ratio * rate;
            let apart = pose.position - data.poses[mover.parent].position;
            let parent = &mut carried[mover.parent];
            parent.linear += own.linear;
            parent.angular += own.angular + apart.cross(&own.linear);
        }
        if let (Base::Floating, Some(root), Some(motion)) =
            (model.base, carried.first(), data.motions.first())
        {
            momentum.iter_mut().zip(&root.to_vector()).for_each(|(out, own)| *out = *own);
            // The angular momentum is about an origin that moves.
            let rate = root.linear.cross(&motion.velocity.linear);
            bias.iter_mut().skip(3).zip(&rate).for_each(|(bias, rate)| *bias += rate);
        }
        Ok(())
    }

    /// Computes the momentum of each body alone about its origin.
    fn momenta_of_bodies(&mut self) {
        let data = &mut *self.posed.data;
        let states = data.poses.iter().zip(&data.motions);
        let bodies = data.scratch.wrenches.iter_mut().zip(data.inertias.iter().zip(states));
        for (momentum, (body, (pose, motion))) in bodies {
            let (arm, turning) = (pose.rotation * body.centre, &motion.velocity.angular);
            let linear = body.mass * (motion.velocity.linear + turning.cross(&arm));
            let spin = pose.rotation * (body.inertia * pose.rotation.tr_mul(turning));
            *momentum = Spatial { linear, angular: spin + arm.cross(&linear) };
        }
    }
}
