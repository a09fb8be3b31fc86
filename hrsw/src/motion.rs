//! Motion of a workspace: its frame follows a target with limited rates.

use ahqp_core::rotation_log;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3, Vector6};

use crate::error::{Error, check_all, check_pose, positive};

/// Rate at which a small distance decays \[1/s\].
const GAIN: f64 = 5.0;
/// A slow approach closes at `ARRIVING` \[m/s\], or faster if the time would exceed `ARRIVES_OVER` \[s\]. It has arrived
/// within `ARRIVED` \[m\]. A tool inside a workspace follows no faster beside a person.
const ARRIVING: f64 = 0.35;
const ARRIVES_OVER: f64 = 2.0;
const ARRIVED: f64 = 0.05;

/// A frame that follows a moving target smoothly. Whatever the target does, velocity and
/// acceleration of the frame stay limited. The frame comes to rest on a resting target.
///
/// ```
/// use hrsw::FrameFollower;
/// use nalgebra::{Isometry3, Vector6};
///
/// let mut frame = FrameFollower::new(Isometry3::identity())?;
/// frame.retarget(Isometry3::translation(2.0, 0.0, 0.0), Vector6::zeros())?;
/// for _ in 0..5000 {
///     frame.advance(1e-3);
/// }
/// assert!((frame.pose().translation.x - 2.0).abs() < 1e-3);
/// # Ok::<(), hrsw::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameFollower {
    /// Largest speed \[m/s\].
    speed: f64,
    /// Largest angular speed \[rad/s\] and acceleration \[rad/s²\].
    turning: [f64; 2],
    pose: Isometry3<f64>,
    linear: Vector3<f64>,
    angular: Vector3<f64>,
    target: Isometry3<f64>,
    target_linear: Vector3<f64>,
    target_angular: Vector3<f64>,
    /// Largest speed towards the target \[m/s\].
    closing: f64,
}

impl FrameFollower {
    /// Largest speed, unless [`with_speed`](Self::with_speed) sets another one \[m/s\].
    pub const SPEED: f64 = 1.0;
    /// Largest acceleration \[m/s²\].
    pub const ACCELERATION: f64 = 3.0;
    /// Largest angular speed, unless [`with_turning`](Self::with_turning) sets another one \[rad/s\].
    pub const ANGULAR_SPEED: f64 = 1.5;
    /// Largest angular acceleration, unless [`with_turning`](Self::with_turning) sets another one \[rad/s²\].
    pub const ANGULAR_ACCELERATION: f64 = 3.0;

    /// Creates a frame at rest at `pose` \[m\].
    ///
    /// # Errors
    /// [`Error::Value`] if the pose is invalid.
    pub fn new(pose: Isometry3<f64>) -> Result<Self, Error> {
        check_pose(&pose)?;
        Ok(Self {
            speed: Self::SPEED,
            turning: [Self::ANGULAR_SPEED, Self::ANGULAR_ACCELERATION],
            pose,
            linear: Vector3::zeros(),
            angular: Vector3::zeros(),
            target: pose,
            target_linear: Vector3::zeros(),
            target_angular: Vector3::zeros(),
            closing: f64::INFINITY,
        })
    }

    /// Sets the largest speed \[m/s\].
    ///
    /// # Errors
    /// [`Error::Value`] if the speed is not positive and finite.
    pub fn with_speed(self, speed: f64) -> Result<Self, Error> {
        Ok(Self { speed: positive("the follower's speed", speed)?, ..self })
    }

    /// Sets the largest angular speed \[rad/s\] and the largest angular acceleration \[rad/s²\].
    ///
    /// # Errors
    /// [`Error::Value`] if one of them is not positive and finite.
    pub fn with_turning(self, speed: f64, acceleration: f64) -> Result<Self, Error> {
        let speed = positive("the follower's angular speed", speed)?;
        let acceleration = positive("the follower's angular acceleration", acceleration)?;
        Ok(Self { turning: [speed, acceleration], ..self })
    }

    /// Returns the pose of the frame \[m\].
    pub fn pose(&self) -> &Isometry3<f64> {
        &self.pose
    }

    /// Returns the velocity of the frame \[m/s, rad/s\]: linear at its origin, then angular, in world
    /// axes.
    pub fn twist(&self) -> Vector6<f64> {
        let (v, w) = (self.linear, self.angular);
        Vector6::new(v.x, v.y, v.z, w.x, w.y, w.z)
    }

    /// Sets the target's current pose \[m\] and its velocity \[m/s, rad/s\]: linear at its origin,
    /// then angular, in world axes. The target is assumed to move on at that velocity.
    ///
    /// # Errors
    /// [`Error::Value`] if a number is invalid. The target is then unchanged.
    pub fn retarget(&mut self, pose: Isometry3<f64>, twist: Vector6<f64>) -> Result<(), Error> {
        check_pose(&pose)?;
        check_all("the twist of the target", twist.iter())?;
        self.target = pose;
        self.target_linear = twist.fixed_rows::<3>(0).into_owned();
        self.target_angular = twist.fixed_rows::<3>(3).into_owned();
        Ok(())
    }

    /// Approaches the target slowly until it is reached: at 0.35 m/s, or within 2 s from afar, in
    /// addition to the target's own motion. This is for a new target.
    pub fn approach_slowly(&mut self) {
        self.closing = ARRIVING.max(self.distance() / ARRIVES_OVER);
    }

    /// Returns the distance from the frame to the target \[m\].
    pub fn distance(&self) -> f64 {
        (self.target.translation.vector - self.pose.translation.vector).norm()
    }

    /// Brings the frame to rest where it can stop.
    pub fn hold(&mut self) {
        self.target = self.stopping_pose();
        self.target_linear = Vector3::zeros();
        self.target_angular = Vector3::zeros();
    }

    /// Returns the pose at which the frame stops if it brakes now \[m\].
    pub fn stopping_pose(&self) -> Isometry3<f64> {
        let [_, angular_acceleration] = self.turning;
        let brake = |v: Vector3<f64>, limit: f64| v * (0.5 * v.norm() / limit);
        moved(
            &self.pose,
            &brake(self.linear, Self::ACCELERATION),
            &brake(self.angular, angular_acceleration),
        )
    }

    /// Jumps to `pose` \[m\], at rest. This is for the first sight of a target, not for a moving one.
    ///
    /// # Errors
    /// [`Error::Value`] if the pose is invalid. The frame is then unchanged.
    pub fn reset(&mut self, pose: Isometry3<f64>) -> Result<(), Error> {
        let Self { speed, turning, .. } = *self;
        *self = Self { speed, turning, ..Self::new(pose)? };
        Ok(())
    }

    /// Advances by `period` \[s\]. A period that is not positive and finite has no effect.
    pub fn advance(&mut self, period: f64) {
        if !is_period(period) {
            return;
        }
        self.target =
            moved(&self.target, &(self.target_linear * period), &(self.target_angular * period));
        let gap = self.target.translation.vector - self.pose.translation.vector;
        if gap.norm() <= ARRIVED {
            self.closing = f64::INFINITY;
        }
        let turn = rotation_log(&(self.target.rotation * self.pose.rotation.inverse()));
        let approach = |gap: &Vector3<f64>, speed: f64, acceleration: f64| {
            let distance = gap.norm();
            // A target whose distance overflows has no direction.
            if distance == 0.0 || !distance.is_finite() {
                return Vector3::zeros();
            }
            // The speed allows stopping in time: by the gain near the target, by the brake far from
            // it.
            let brake = (acceleration * distance).sqrt();
            gap * ((GAIN * distance).min(brake).min(speed) / distance)
        };
        let [angular_speed, angular_acceleration] = self.turning;
        let linear =
            self.target_linear + approach(&gap, self.speed.min(self.closing), Self::ACCELERATION);
        let angular = self.target_angular + approach(&turn, angular_speed, angular_acceleration);
        let linear = limited(&linear, self.speed);
        let angular = limited(&angular, angular_speed);
        self.linear += limited(&(linear - self.linear), Self::ACCELERATION * period);
        self.angular += limited(&(angular - self.angular), angular_acceleration * period);
        self.pose = moved(&self.pose, &(self.linear * period), &(self.angular * period));
    }
}

/// Returns true if the period is positive and finite.
pub(crate) fn is_period(period: f64) -> bool {
    period > 0.0 && period.is_finite()
}

fn limited(v: &Vector3<f64>, limit: f64) -> Vector3<f64> {
    let size = v.norm();
    if size > limit { v * (limit / size) } else { *v }
}

pub(crate) fn moved(
    pose: &Isometry3<f64>,
    by: &Vector3<f64>,
    turn: &Vector3<f64>,
) -> Isometry3<f64> {
    let mut rotation = UnitQuaternion::from_scaled_axis(*turn) * pose.rotation;
    rotation.renormalize_fast();
    Isometry3::from_parts(Translation3::from(pose.translation.vector + by), rotation)
}
