//! The inertia of one rigid body in its own frame.

use nalgebra::{Matrix3, Vector3};

use super::symmetric::Symmetric3;
use crate::spatial::Pose;

/// Mass, centre of mass and inertia of a rigid body in the body's frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BodyInertia {
    /// \[kg\]
    pub(crate) mass: f64,
    /// \[m\]
    pub(crate) centre: Vector3<f64>,
    /// Inertia about the centre of mass \[kg m²\].
    pub(crate) inertia: Matrix3<f64>,
}

impl BodyInertia {
    pub(crate) fn zero() -> Self {
        Self { mass: 0.0, centre: Vector3::zeros(), inertia: Matrix3::zeros() }
    }

    /// The same inertia in the frame in which the body's own frame is at `pose`.
    pub(crate) fn placed(&self, pose: &Pose) -> Self {
        Self {
            mass: self.mass,
            centre: pose.position + pose.rotation * self.centre,
            inertia: pose.rotation * self.inertia * pose.rotation.transpose(),
        }
    }

    /// The inertia of both bodies as one.
    pub(crate) fn joined(&self, other: &Self) -> Self {
        let mass = self.mass + other.mass;
        let inertia = self.inertia + other.inertia;
        if mass <= 0.0 {
            return Self { mass, centre: self.centre, inertia };
        }
        let centre = self.centre * (self.mass / mass) + other.centre * (other.mass / mass);
        // The parallel axis theorem for two points of the reduced mass.
        let reduced = self.mass * (other.mass / mass);
        let apart = other.centre - self.centre;
        Self {
            mass,
            centre,
            inertia: inertia + Symmetric3::about_distance(reduced, &apart).to_matrix(),
        }
    }
}
