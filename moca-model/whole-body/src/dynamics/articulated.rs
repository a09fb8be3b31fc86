//! Articulated bodies: the mass matrix inverted, joint by joint.

use nalgebra::{Cholesky, Const, Vector6};

use crate::error::Error;
use crate::inertia::articulated::{ArticulatedInertia, ArticulatedJoint};
use crate::inertia::world::WorldInertia;
use crate::robot::description::Base;
use crate::spatial::{Motion, Spatial};
use crate::state::posed::Posed;

/// The floating base's articulated inertia, factorised; `None` for other bases.
pub(super) struct Root(Option<Cholesky<f64, Const<6>>>);

impl Posed<'_> {
    /// Factorises the mass matrix: articulated-body inertias from the tips to the root (Featherstone
    /// 2008, Sec. 7.2), in world axes. Not for models with mimic joints.
    pub(super) fn factorise(&mut self) -> Result<Root, Error> {
        let (model, data) = (self.model, &mut *self.data);
        let scratch = &mut data.scratch;
        let bodies = data.inertias.iter().zip(&data.poses);
        for (articulated, (inertia, pose)) in scratch.articulated.iter_mut().zip(bodies) {
            *articulated = ArticulatedInertia::rigid(&WorldInertia::of_body(inertia, pose));
        }
        for (index, mover) in model.movers.iter().enumerate().rev() {
            let pose = &data.poses[index + 1];
            let own = &scratch.articulated[index + 1];
            let (force, pivot) = own.along(mover.motion, &pose.axis());
            // No more than the rounding of the pivot's own sum.
            if pivot <= 8.0 * f64::EPSILON * own.size(mover.motion) || pivot.is_nan() {
                return Err(self.no_inertia(mover.velocity));
            }
            let joint = ArticulatedJoint { force, inverse: 1.0 / pivot };
            scratch.pivots[index] = joint;
            // The world takes any force.
            if mover.parent > 0 || model.base == Base::Floating {
                let rest = own.without(&joint);
                let apart = pose.position - data.poses[mover.parent].position;
                scratch.articulated[mover.parent].add(&rest, &apart);
            }
        }
        if model.base != Base::Floating {
            return Ok(Root(None));
        }
        let root = scratch.articulated[0].to_matrix().cholesky();
        Ok(Root(Some(root.ok_or_else(|| self.no_inertia(0))?)))
    }

    /// Solves M x = b in place, after [`factorise`](Self::factorise).
    pub(super) fn solve(&mut self, root: &Root, b: &mut [f64]) {
        let (model, data) = (self.model, &mut *self.data);
        let (scratch, poses) = (&mut data.scratch, &data.poses);
        let (forces, accelerations) = (&mut scratch.wrenches, &mut scratch.accelerations);
        forces.fill(Spatial::ZERO);
        for (index, mover) in model.movers.iter().enumerate().rev() {
            let (pose, joint) = (&poses[index + 1], &scratch.pivots[index]);
            let mut own = forces[index + 1];
            let rest = b[mover.velocity] - mover.motion.part(&pose.axis(), &own);
            b[mover.velocity] = rest;
            let share = rest * joint.inverse;
            own.linear += share * joint.force.linear;
            own.angular += share * joint.force.angular;
            let apart = pose.position - poses[mover.parent].position;
            let parent = &mut forces[mover.parent];
            parent.linear += own.linear;
            parent.angular += own.angular + apart.cross(&own.linear);
        }
        accelerations[0] = Spatial::ZERO;
        if let (Some(factor), [x, y, z, wx, wy, wz, ..]) = (&root.0, &mut *b) {
            let given = Vector6::new(*x, *y, *z, *wx, *wy, *wz);
            let solved = factor.solve(&(given - forces[0].to_vector()));
            accelerations[0] = Spatial::from_vector(&solved);
            [*x, *y, *z, *wx, *wy, *wz] = solved.into();
        }
        for (index, mover) in model.movers.iter().enumerate() {
            let (pose, joint) = (&poses[index + 1], &scratch.pivots[index]);
            let apart = pose.position - poses[mover.parent].position;
            let mut motion = accelerations[mover.parent];
            motion.linear += motion.angular.cross(&apart);
            let own = (b[mover.velocity] - joint.force.dot(&motion)) * joint.inverse;
            b[mover.velocity] = own;
            match mover.motion {
                Motion::Turns => motion.angular += own * pose.axis(),
                Motion::Slides => motion.linear += own * pose.axis(),
            }
            accelerations[index + 1] = motion;
        }
    }

    #[cold]
    pub(super) fn no_inertia(&self, velocity: usize) -> Error {
        let own = |joint: &&crate::robot::joint::Joint| joint.velocity_index <= velocity;
        let joint = self.model.joints.iter().rfind(own);
        Error::NoInertia { joint: joint.map_or_else(String::new, |joint| joint.name.clone()) }
    }
}
