//! Energy and momentum.

use nalgebra::{Vector3, Vector6};

use crate::spatial::Spatial;
use crate::state::moving::Moving;

impl Moving<'_> {
    /// Kinetic energy of the links that move \[J\].
    pub fn kinetic_energy(&self) -> f64 {
        let energies = self.bodies().map(|body| {
            0.5 * (body.mass * body.velocity.norm_squared() + body.turning.dot(&body.spin))
        });
        energies.sum()
    }

    /// Momentum of the links that move: linear \[kg m/s\], then angular about their centre of mass
    /// \[kg m²/s\], in world axes (Orin, Goswami, Lee, "Centroidal dynamics of a humanoid robot",
    /// 2013).
    pub fn momentum(&self) -> Vector6<f64> {
        let common = self.posed.centre_of_mass().coords;
        let none = (Vector3::zeros(), Vector3::zeros());
        let (linear, angular) = self.bodies().fold(none, |(linear, angular), body| {
            let own = body.mass * body.velocity;
            (linear + own, angular + body.spin + (body.centre - common).cross(&own))
        });
        Spatial { linear, angular }.to_vector()
    }

    fn bodies(&self) -> impl Iterator<Item = MovingBody> {
        let data = &*self.posed.data;
        let states = data.poses.iter().zip(&data.motions);
        data.inertias.iter().zip(states).map(|(inertia, (pose, motion))| {
            let arm = pose.rotation * inertia.centre;
            let turning = motion.velocity.angular;
            MovingBody {
                mass: inertia.mass,
                centre: pose.position + arm,
                velocity: motion.velocity.linear + turning.cross(&arm),
                turning,
                spin: pose.rotation * (inertia.inertia * pose.rotation.tr_mul(&turning)),
            }
        })
    }
}

/// A body at its centre of mass, in world axes.
struct MovingBody {
    mass: f64,
    centre: Vector3<f64>,
    velocity: Vector3<f64>,
    /// Angular velocity.
    turning: Vector3<f64>,
    /// Angular momentum about the centre of mass.
    spin: Vector3<f64>,
}
