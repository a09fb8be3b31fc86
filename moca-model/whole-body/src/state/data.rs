//! The memory of one thread, sized for one model.

use nalgebra::Vector3;

use super::payload::Payloads;
use crate::error::Error;
use crate::inertia::articulated::{ArticulatedInertia, ArticulatedJoint};
use crate::inertia::body::BodyInertia;
use crate::inertia::world::WorldInertia;
use crate::robot::model::Model;
use crate::spatial::{Pose, Spatial};

/// The memory for all results about a robot's state.
///
/// It is sized for one model at construction; nothing allocates afterwards. Results are read through views:
/// [`pose`](Self::pose) returns a [`Posed`](crate::Posed), whose [`moving`](crate::Posed::moving) returns a
/// [`Moving`](crate::Moving). The view borrows the data, so that its results cannot be of another configuration.
///
/// Payloads are part of the data, since the model is shared: see [`attach`](Self::attach).
#[derive(Debug, Clone)]
pub struct Data {
    pub(crate) model: u64,
    /// True if a configuration was set.
    pub(crate) is_posed: bool,
    pub(crate) q: Vec<f64>,
    pub(crate) v: Vec<f64>,
    /// Pose of each body in the world.
    pub(crate) poses: Vec<Pose>,
    /// Inertia of each body with its payloads.
    pub(crate) inertias: Vec<BodyInertia>,
    pub(crate) payloads: Payloads,
    /// Motion of each body.
    pub(crate) motions: Vec<BodyMotion>,
    pub(crate) scratch: Scratch,
}

/// The motion of a body's frame origin, in world axes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BodyMotion {
    pub(crate) velocity: Spatial,
    /// J̇ q̇, the acceleration for q̈ = 0.
    pub(crate) bias: Spatial,
}

/// Scratch memory of the algorithms.
#[derive(Debug, Clone)]
pub(crate) struct Scratch {
    /// Mass and first moment of the subtree of each body.
    pub(crate) carried: Vec<Carried>,
    /// Acceleration of each body by joints alone.
    pub(crate) accelerations: Vec<Spatial>,
    /// Force and moment of each body.
    pub(crate) wrenches: Vec<Spatial>,
    /// Composite inertia of each body's subtree.
    pub(crate) composites: Vec<WorldInertia>,
    /// Articulated inertia of each body.
    pub(crate) articulated: Vec<ArticulatedInertia>,
    /// Factors of each mover's joint.
    pub(crate) pivots: Vec<ArticulatedJoint>,
    /// The mass matrix; empty without mimic joints.
    pub(crate) mass_matrix: Vec<f64>,
    /// Vectors of the size of q̇.
    pub(crate) row: Vec<f64>,
    pub(crate) solved: Vec<f64>,
}

/// Mass \[kg\] and Σ m (c − p) \[kg m\] of the subtree of a body at p.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Carried {
    pub(crate) mass: f64,
    pub(crate) moment: Vector3<f64>,
}

impl Data {
    /// Creates memory for `model`.
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

    /// Returns an error unless this was made for `model`.
    #[inline]
    pub(crate) fn check(&self, model: &Model) -> Result<(), Error> {
        if self.model == model.tag {
            Ok(())
        } else {
            Err(Error::ForeignData { robot: model.name.clone() })
        }
    }
}
