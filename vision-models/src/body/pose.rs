//! The person's position and motion.

use nalgebra::{Isometry3, Matrix2, Point2, Translation3, UnitQuaternion, Vector2, Vector3};

use super::freshness::Freshness;

/// The person whom a [`BodyTracker`](crate::BodyTracker) follows: the pose on the floor of the
/// world, the motion, and the age of both.
///
/// ```
/// use nalgebra::{Matrix2, Point2, Point3, Vector2};
/// use vision_models::{Freshness, TrackedPerson};
///
/// let person = TrackedPerson {
///     floor: Point2::new(2.0, 0.0),
///     heading: std::f64::consts::PI,
///     velocity: Vector2::new(-0.5, 0.0),
///     heading_rate: 0.0,
///     floor_covariance: Matrix2::identity() * 0.02_f64.powi(2),
///     velocity_covariance: Matrix2::identity() * 0.1_f64.powi(2),
///     age: 0.02,
///     heading_age: 0.02,
///     freshness: Freshness::Tracked,
/// };
/// // Half a metre in front of the person is half a metre closer to the origin.
/// let hand = person.world_from_person() * Point3::new(0.5, 0.0, 1.0);
/// assert!((hand - Point3::new(1.5, 0.0, 1.0)).norm() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackedPerson {
    /// Floor position below the pelvis (m).
    pub floor: Point2<f64>,
    /// Yaw of the person's forward direction, unwrapped: it continues past ±π (rad).
    pub heading: f64,
    /// Velocity of the pelvis over the floor (m/s). Zero if the person no longer coasts.
    pub velocity: Vector2<f64>,
    /// Yaw rate (rad/s). Zero if the heading is held.
    pub heading_rate: f64,
    /// Covariance of `floor` (m²).
    pub floor_covariance: Matrix2<f64>,
    /// Covariance of `velocity` while the person is tracked or coasts (m²/s²).
    pub velocity_covariance: Matrix2<f64>,
    /// Time since the position was last measured (s).
    pub age: f64,
    /// Time since the heading was last measured (s).
    pub heading_age: f64,
    /// Freshness that follows from `age`.
    pub freshness: Freshness,
}

impl TrackedPerson {
    /// Returns the pose of the person's frame: origin on the floor below the pelvis, x forwards, y
    /// to the left, z up.
    pub fn world_from_person(&self) -> Isometry3<f64> {
        Isometry3::from_parts(
            Translation3::new(self.floor.x, self.floor.y, 0.0),
            UnitQuaternion::from_axis_angle(&Vector3::z_axis(), self.heading),
        )
    }
}
