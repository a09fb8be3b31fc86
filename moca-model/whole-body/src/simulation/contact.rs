//! Contacts of a simulated robot.

use nalgebra::{UnitVector3, Vector3, Vector6};

use crate::dynamics::external::ExternalWrench;
use crate::error::{Error, check_finite};
use crate::kinematics::jacobian::Axes;
use crate::robot::frame::FrameId;
use crate::state::moving::Moving;

/// A flat surface that pushes a point of the robot and may move: a wall, or a part of a person whom the robot hits.
///
/// The surface is the plane n · p = `position`, a mass behind a spring and a damper. The point is a frame's origin.
/// While it is behind the surface, δ = `position` − n · p > 0, the surface pushes it along n with F = max(0, k δ + d
/// δ̇). The surface is pushed back, m s̈ = −F, as in the two-mass model of ISO/TS 15066, Annex A. If a robot of
/// effective mass m_R hits a free surface at speed v, the force is at most v √(k μ), 1/μ = 1/m + 1/m_R. This holds
/// without damping.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// The point is the origin of this frame.
    pub frame: FrameId,
    /// n, in the world: the direction in which the robot is pushed.
    pub normal: UnitVector3<f64>,
    /// k \[N/m\].
    pub stiffness: f64,
    /// d \[N s/m\].
    pub damping: f64,
    /// m \[kg\]; infinite for a wall.
    pub mass: f64,
    /// Place of the surface along n \[m\].
    pub position: f64,
    /// Speed of the surface along n \[m/s\].
    pub velocity: f64,
    /// F at the end of the last step \[N\].
    pub force: f64,
    /// The largest F so far \[N\].
    pub peak_force: f64,
}

impl Contact {
    /// Creates a wall that pushes `frame` along `normal` where n · p is below `position` \[m\]. Its stiffness is 100
    /// N/mm, its damping 200 N s/m.
    pub fn wall(frame: FrameId, normal: UnitVector3<f64>, position: f64) -> Self {
        let (stiffness, damping) = (1e5, 200.0);
        let mass = f64::INFINITY;
        let (velocity, force, peak_force) = (0.0, 0.0, 0.0);
        Self { frame, normal, stiffness, damping, mass, position, velocity, force, peak_force }
    }

    /// Creates a free body of `mass` \[kg\] and `stiffness` \[N/m\], whose surface is at `position` \[m\] along
    /// `normal` and moves at `velocity` \[m/s\].
    pub fn body(
        frame: FrameId,
        normal: UnitVector3<f64>,
        [position, velocity]: [f64; 2],
        [mass, stiffness]: [f64; 2],
    ) -> Self {
        let damping = 0.0;
        Self { stiffness, damping, mass, velocity, ..Self::wall(frame, normal, position) }
    }

    pub(super) fn validate(&self) -> Result<(), Error> {
        for (what, value) in [
            ("the position of a contact [m]", self.position),
            ("the velocity of a contact [m/s]", self.velocity),
            ("the stiffness of a contact [N/m]", self.stiffness),
            ("the damping of a contact [N s/m]", self.damping),
        ] {
            check_finite(value, || what.to_owned())?;
        }
        if self.mass.is_nan() || self.mass <= 0.0 {
            let (what, value) = ("the mass of a contact [kg]", self.mass);
            return Err(Error::not_positive(what, value));
        }
        Ok(())
    }

    pub(super) fn force_on(
        &self,
        robot: &Moving<'_>,
        position: f64,
        velocity: f64,
    ) -> Result<f64, Error> {
        let point = robot.posed().world_from(self.frame)?.translation.vector;
        let depth = position - self.normal.dot(&point);
        if depth <= 0.0 {
            return Ok(0.0);
        }
        let twist = robot.twist(self.frame, Axes::World)?;
        let speed: Vector3<f64> = twist.fixed_rows::<3>(0).into_owned();
        let rate = velocity - self.normal.dot(&speed);
        Ok((self.stiffness * depth + self.damping * rate).max(0.0))
    }

    pub(super) fn wrench(&self, force: f64) -> ExternalWrench {
        let linear = force * self.normal.into_inner();
        let wrench = Vector6::new(linear.x, linear.y, linear.z, 0.0, 0.0, 0.0);
        ExternalWrench { frame: self.frame, wrench }
    }
}
