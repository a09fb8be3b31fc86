//! The memory of one thread, sized for one model.

use nalgebra::Vector3;

use super::payload::Payloads;
use crate::error::Error;
use crate::inertia::articulated::{ArticulatedInertia, ArticulatedJoint};
use crate::inertia::body::BodyInertia;
use crate::inertia::world::WorldInertia;
use crate::robot::model::Model;
use crate::spatial::{Pose, Spatial};

/// Room for everything that is computed of a robot's state.
///
/// Sized for one model at construction; nothing allocates afterwards. Results are read through the
/// view that computing them returns: [`pose`](Self::pose) gives a [`Posed`](crate::Posed), whose
/// [`moving`](crate::Posed::moving) gives a [`Moving`](crate::Moving). The view borrows the data,
/// so that what it shows cannot be of another configuration.
///
/// Payloads are part of the data, for the model is shared: see [`attach`](Self::attach).
#[derive(Debug, Clone)]
pub struct Data {
    pub(crate) model: u64,
    /// Whether there has been a configuration.
    pub(crate) is_posed: bool,
    pub(crate) q: Vec<f64>,
    pub(crate) v: Vec<f64>,
    /// By body: its pose in the world.
    pub(crate) poses: Vec<Pose>,
    /// By body: the model's, with the payloads.
    pub(crate) inertias: Vec<BodyInertia>,
    pub(crate) payloads: Payloads,
    /// By body.
    pub(crate) motions: Vec<BodyMotion>,
    pub(crate) scratch: Scratch,
}

/// How a body moves, in world axes, of its frame's origin.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BodyMotion {
    pub(crate) velocity: Spatial,
    /// J̇ q̇: its acceleration where q̈ is zero.
    pub(crate) bias: Spatial,
}

/// What algorithms need while they compute.
#[derive(Debug, Clone)]
pub(crate) struct Scratch {
    /// By body: mass and first moment of all that it carries.
    pub(crate) carried: Vec<Carried>,
    /// By body: accelerations by joints alone.
    pub(crate) accelerations: Vec<Spatial>,
    /// By body: forces and moments.
    pub(crate) wrenches: Vec<Spatial>,
    /// By body.
    pub(crate) composites: Vec<WorldInertia>,
    /// By body.
    pub(crate) articulated: Vec<ArticulatedInertia>,
    /// By mover.
    pub(crate) pivots: Vec<ArticulatedJoint>,
    /// Empty where there are no mimic joints.
    pub(crate) mass_matrix: Vec<f64>,
    /// Of the size of q̇, both.
    pub(crate) row: Vec<f64>,
    pub(crate) solved: Vec<f64>,
}

/// Mass \[kg\] and Σ m (c − p) \[kg m\] of a body at p and all that it carries.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Carried {
    pub(crate) mass: f64,
    pub(crate) moment: Vector3<f64>,
}

impl Data {
    /// Room for `model`.
    pub fn new(model: &Model) -> Self {
        let bodies = model.inertias.len();
        let still = BodyMotion { velocity: Spatial::ZERO, bias: Spatial::ZERO };
        Self {
            model: model.tag,
            is_posed: false,
            q: model.neutral(),
            v: vec![0.0; model.velocities],
            poses: vec![Pose::identity(); bodies],
            inertias: model.inertias.clone(),
            payloads: Payloads::default(),
            motions: vec![still; bodies],
            scratch: Scratch {
                carried: vec![Carried { mass: 0.0, moment: Vector3::zeros() }; bodies],
                accelerations: vec![Spatial::ZERO; bodies],
                wrenches: vec![Spatial::ZERO; bodies],
                composites: vec![WorldInertia::ZERO; bodies],
                articulated: vec![ArticulatedInertia::ZERO; bodies],
                pivots: vec![ArticulatedJoint::ZERO; model.movers.len()],
                mass_matrix: vec![
                    0.0;
                    if model.mimics.is_empty() { 0 } else { model.velocities.pow(2) }
                ],
                row: vec![0.0; model.velocities],
                solved: vec![0.0; model.velocities],
            },
        }
    }

    /// An error unless this was made for `model`.
    #[inline]
    pub(crate) fn check(&self, model: &Model) -> Result<(), Error> {
        if self.model == model.tag {
            Ok(())
        } else {
            Err(Error::ForeignData { robot: model.name.clone() })
        }
    }
}
