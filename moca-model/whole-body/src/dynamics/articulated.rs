//! The articulated-body algorithm, which divides by the mass matrix joint by joint.

use nalgebra::Vector6;

use crate::error::Error;
use crate::inertia::articulated::{ArticulatedInertia, ArticulatedJoint};
use crate::inertia::world::WorldInertia;
use crate::robot::description::Base;
use crate::spatial::{Motion, Spatial};
use crate::state::posed::Posed;

/// The role of an entry of q̇ where forces become accelerations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Part {
    /// The entry is free. The rotor before its gear adds this inertia \[kg m² or kg\].
    Free { rotor_inertia: f64 },
    /// The acceleration is prescribed. The entry of x is zero.
    Prescribed,
}

impl Posed<'_> {
    /// Solves M x = b in place by articulated-body inertias (Featherstone 2008, Sec. 7.3 without velocities), in world
    /// axes. Inertias and remainders of b go from the tips to the root, accelerations come back. An empty `parts`
    /// leaves all entries free and without rotors. Models with mimic joints are not supported.
    pub(super) fn solve_by_articulated_bodies(
        &mut self,
        b: &mut [f64],
        parts: &[Part],
    ) -> Result<(), Error> {
        self.eliminate(b, parts)?;
        self.accelerate_base(b)?;
        self.accelerate_joints(b);
        Ok(())
    }

    /// Eliminates one joint after the other, the last first.
    fn eliminate(&mut self, b: &mut [f64], parts: &[Part]) -> Result<(), Error> {
        let (model, data) = (self.model, &mut *self.data);
        let (scratch, poses) = (&mut data.scratch, &data.poses);
        for (body, (inertia, pose)) in data.inertias.iter().zip(poses).enumerate() {
            scratch.articulated[body] =
                ArticulatedInertia::rigid(&WorldInertia::of_body(inertia, pose));
            scratch.wrenches[body] = Spatial::ZERO;
        }
        for (index, mover) in model.movers.iter().enumerate().rev() {
            let pose = &poses[index + 1];
            let own = &scratch.articulated[index + 1];
            let (force, pivot) = own.along(mover.motion, &pose.axis());
            let inverse = match parts.get(mover.velocity) {
                // The joint does not yield to forces.
                Some(Part::Prescribed) => 0.0,
                Some(Part::Free { rotor_inertia }) if *rotor_inertia > 0.0 => {
                    1.0 / (pivot + rotor_inertia)
                }
                // The pivot is no larger than the rounding of its own sum.
                _ if pivot <= 8.0 * f64::EPSILON * own.size(mover.motion) || pivot.is_nan() => {
                    return Err(self.no_inertia(mover.velocity));
                }
                _ => 1.0 / pivot,
            };
            let joint = ArticulatedJoint { force, inverse };
            scratch.pivots[index] = joint;
            let mut left = scratch.wrenches[index + 1];
            let rest = b[mover.velocity] - mover.motion.part(&pose.axis(), &left);
            b[mover.velocity] = rest;
            if mover.parent == 0 && model.base != Base::Floating {
                continue; // The world takes any force.
            }
            let given = own.without(&joint);
            let share = rest * joint.inverse;
            left.linear += share * force.linear;
            left.angular += share * force.angular;
            let apart = pose.position - poses[mover.parent].position;
            scratch.articulated[mover.parent].add(&given, &apart);
            let parent = &mut scratch.wrenches[mover.parent];
            parent.linear += left.linear;
            parent.angular += left.angular + apart.cross(&left.linear);
        }
        Ok(())
    }

    fn accelerate_base(&mut self, b: &mut [f64]) -> Result<(), Error> {
        let scratch = &mut self.data.scratch;
        scratch.accelerations[0] = Spatial::ZERO;
        let (Base::Floating, [x, y, z, wx, wy, wz, ..]) = (self.model.base, b) else {
            return Ok(());
        };
        let given = Vector6::new(*x, *y, *z, *wx, *wy, *wz) - scratch.wrenches[0].to_vector();
        let factor = scratch.articulated[0].to_matrix().cholesky();
        let solved = factor.ok_or_else(|| self.no_inertia(0))?.solve(&given);
        self.data.scratch.accelerations[0] = Spatial::from_vector(&solved);
        [*x, *y, *z, *wx, *wy, *wz] = solved.into();
        Ok(())
    }

    fn accelerate_joints(&mut self, b: &mut [f64]) {
        let (scratch, poses) = (&mut self.data.scratch, &self.data.poses);
        for (index, mover) in self.model.movers.iter().enumerate() {
            let (pose, joint) = (&poses[index + 1], &scratch.pivots[index]);
            let apart = pose.position - poses[mover.parent].position;
            let mut motion = scratch.accelerations[mover.parent];
            motion.linear += motion.angular.cross(&apart);
            let own = (b[mover.velocity] - joint.force.dot(&motion)) * joint.inverse;
            b[mover.velocity] = own;
            match mover.motion {
                Motion::Turns => motion.angular += own * pose.axis(),
                Motion::Slides => motion.linear += own * pose.axis(),
            }
            scratch.accelerations[index + 1] = motion;
        }
    }

    #[cold]
    pub(super) fn no_inertia(&self, velocity: usize) -> Error {
        let own = |joint: &&crate::robot::joint::Joint| joint.velocity_index <= velocity;
        let joint = self.model.joints.iter().rfind(own);
        Error::NoInertia { joint: joint.map_or_else(String::new, |joint| joint.name.clone()) }
    }
}
