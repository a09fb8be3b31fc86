//! Turns of a reference along a geodesic at a limited rate, up to half a turn and beyond.

use nalgebra::{Isometry3, Unit, UnitQuaternion, Vector3, Vector6};

use crate::error::{Error, check_rotation};
use crate::motion::FrameFollower;

/// Angle by which the target of a turn leads \[rad\]. It is well below half a turn, at which the
/// way back would be as short.
const AHEAD: f64 = std::f64::consts::FRAC_PI_2;

/// An orientation that turns to its goals with limited angular velocity and acceleration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Reorientation {
    follower: FrameFollower,
    start: UnitQuaternion<f64>,
    axis: Unit<Vector3<f64>>,
    angle: f64,
    ahead: f64,
}

impl Reorientation {
    pub(crate) fn new(rotation: UnitQuaternion<f64>) -> Result<Self, Error> {
        let follower = FrameFollower::new(as_pose(rotation))?;
        let axis = Vector3::z_axis();
        Ok(Self { follower, start: rotation, axis, angle: 0.0, ahead: 0.0 })
    }

    pub(crate) fn rotation(&self) -> &UnitQuaternion<f64> {
        &self.follower.pose().rotation
    }

    /// Returns the angular velocity, in the axes in which the rotation is given.
    pub(crate) fn rate(&self) -> Vector3<f64> {
        self.follower.twist().fixed_rows::<3>(3).into_owned()
    }

    pub(crate) fn goal(&self) -> UnitQuaternion<f64> {
        self.start * UnitQuaternion::from_axis_angle(&self.axis, self.angle)
    }

    /// Turns to `goal` by the shortest way. Near half a turn both ways are equally short. It then
    /// turns in the sense of `axis`, in the axes of the rotation itself.
    pub(crate) fn turn_to(
        &mut self,
        goal: UnitQuaternion<f64>,
        axis: &Unit<Vector3<f64>>,
    ) -> Result<(), Error> {
        check_rotation("the goal of a turn", &goal)?;
        if self.goal().angle_to(&goal) < 1e-9 {
            return Ok(());
        }
        let start = *self.rotation();
        let way = start.inverse() * goal;
        let Some((shortest, angle)) = way.axis_angle() else {
            (self.start, self.angle, self.ahead) = (start, 0.0, 0.0);
            return Ok(());
        };
        let near_half_turn = angle > std::f64::consts::PI - 1e-3;
        let other_way = near_half_turn && shortest.dot(axis) < 0.0;
        self.start = start;
        self.ahead = 0.0;
        (self.axis, self.angle) =
            if other_way { (-shortest, std::f64::consts::TAU - angle) } else { (shortest, angle) };
        Ok(())
    }

    pub(crate) fn advance(&mut self, period: f64) -> Result<(), Error> {
        let target = self.target();
        let gap = self.rotation().angle_to(&target);
        self.ahead = (self.ahead + (AHEAD - gap).max(0.0)).min(self.angle);
        self.follower.retarget(as_pose(self.target()), Vector6::zeros())?;
        self.follower.advance(period);
        Ok(())
    }

    fn target(&self) -> UnitQuaternion<f64> {
        self.start * UnitQuaternion::from_axis_angle(&self.axis, self.ahead)
    }
}

fn as_pose(rotation: UnitQuaternion<f64>) -> Isometry3<f64> {
    Isometry3::from_parts(Vector3::zeros().into(), rotation)
}
