//! Paths through waypoints.

use ahqp_core::{integrate_pose, pose_error};
use nalgebra::{Isometry3, Vector6};

use crate::error::{Error, check_pose, positive};

/// Length that one radian of turning counts as \[m/rad\].
const LEVER: f64 = 0.3;

/// A path of straight lines between waypoints, with uniform turning, at one speed.
///
/// ```
/// use hrsw::Path;
/// use nalgebra::Isometry3;
///
/// let waypoints = [Isometry3::identity(), Isometry3::translation(1.0, 0.0, 0.0)];
/// let path = Path::new(&waypoints, 0.25)?;
/// let (pose, twist) = path.at(2.0);
/// assert!((pose.translation.x - 0.5).abs() < 1e-12 && (twist.x - 0.25).abs() < 1e-12);
/// # Ok::<(), hrsw::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Path {
    legs: Vec<Leg>,
    end: Isometry3<f64>,
}

#[derive(Debug, Clone, PartialEq)]
struct Leg {
    start: Isometry3<f64>,
    begins: f64,
    duration: f64,
    twist: Vector6<f64>,
}

impl Path {
    /// Creates a path through `waypoints` at `speed` \[m/s\]. One radian counts as 0.3 m, so that
    /// pure turns take time too.
    ///
    /// # Errors
    /// [`Error::Value`] if a waypoint or the speed is invalid, or if there is no waypoint.
    pub fn new(waypoints: &[Isometry3<f64>], speed: f64) -> Result<Self, Error> {
        positive("the speed along a path", speed)?;
        waypoints.iter().try_for_each(check_pose)?;
        let Some(&end) = waypoints.last() else {
            let (name, expected) = ("the number of waypoints", "at least one");
            return Err(Error::Value { what: name, got: 0.0, wanted: expected });
        };
        let mut legs = Vec::new();
        let mut begins = 0.0;
        for pair in waypoints.windows(2) {
            let way = pose_error(&pair[1], &pair[0]);
            let length = way.fixed_rows::<3>(0).norm().hypot(LEVER * way.fixed_rows::<3>(3).norm());
            if length > 0.0 {
                let duration = length / speed;
                legs.push(Leg { start: pair[0], begins, duration, twist: way / duration });
                begins += duration;
            }
        }
        Ok(Self { legs, end })
    }

    /// Returns the duration of the path \[s\].
    pub fn duration(&self) -> f64 {
        self.legs.last().map_or(0.0, |leg| leg.begins + leg.duration)
    }

    /// Returns pose and twist, linear then angular in world axes, `time` \[s\] after the start. The
    /// pose is at rest before the start and after the end.
    pub fn at(&self, time: f64) -> (Isometry3<f64>, Vector6<f64>) {
        let next = self.legs.partition_point(|leg| leg.begins + leg.duration <= time);
        match self.legs.get(next) {
            None => (self.end, Vector6::zeros()),
            Some(leg) if time < leg.begins => (leg.start, Vector6::zeros()),
            Some(leg) => (integrate_pose(&leg.start, &leg.twist, time - leg.begins), leg.twist),
        }
    }
}
