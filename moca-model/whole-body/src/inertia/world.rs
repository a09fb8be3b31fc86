//! The inertia of rigid bodies in world axes.

use nalgebra::Vector3;

use super::body::BodyInertia;
use super::symmetric::Symmetric3;
use crate::spatial::{Motion, Pose, Spatial};

/// The inertia of bodies in world axes about a point.
#[derive(Debug, Clone, Copy)]
pub(crate) struct WorldInertia {
    /// \[kg\]
    pub(crate) mass: f64,
    /// Σ m (c − point) \[kg m\].
    pub(crate) moment: Vector3<f64>,
    /// Inertia about the point \[kg m²\].
    pub(crate) inertia: Symmetric3,
}

impl WorldInertia {
    pub(crate) const ZERO: Self =
        Self { mass: 0.0, moment: Vector3::new(0.0, 0.0, 0.0), inertia: Symmetric3::ZERO };

    /// The inertia of one body about its origin.
    #[inline]
    pub(crate) fn of_body(body: &BodyInertia, pose: &Pose) -> Self {
        let centre = pose.rotation * body.centre;
        Self {
            mass: body.mass,
            moment: body.mass * centre,
            inertia: Symmetric3::turned(&body.inertia, &pose.rotation)
                .plus(&Symmetric3::about_distance(body.mass, &centre)),
        }
    }

    /// Adds bodies whose point is `apart` from this one.
    #[inline]
    pub(crate) fn add(&mut self, other: &Self, apart: &Vector3<f64>) {
        // The parallel axis theorem twice: to the centre of mass and on to the point.
        let between = other.moment.dot(apart);
        let moved = Symmetric3 {
            xx: 2.0 * (between - other.moment.x * apart.x),
            yy: 2.0 * (between - other.moment.y * apart.y),
            zz: 2.0 * (between - other.moment.z * apart.z),
            xy: -(other.moment.x * apart.y + other.moment.y * apart.x),
            xz: -(other.moment.x * apart.z + other.moment.z * apart.x),
            yz: -(other.moment.y * apart.z + other.moment.z * apart.y),
        };
        self.inertia = self
            .inertia
            .plus(&other.inertia)
            .plus(&moved)
            .plus(&Symmetric3::about_distance(other.mass, apart));
        self.moment += other.moment + other.mass * apart;
        self.mass += other.mass;
    }

    /// The force and moment at the point for a unit acceleration along or about an axis through it.
    #[inline]
    pub(crate) fn along(&self, motion: Motion, axis: &Vector3<f64>) -> Spatial {
        match motion {
            Motion::Turns => {
                Spatial { linear: axis.cross(&self.moment), angular: self.inertia.times(axis) }
            }
            Motion::Slides => {
                Spatial { linear: self.mass * axis, angular: self.moment.cross(axis) }
            }
        }
    }
}
