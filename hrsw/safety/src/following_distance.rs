//! Distance by which a shared workspace falls behind a person who walks away from the robot.

use crate::error::{Error, check_all, not_negative, positive};
use crate::separation::SeparationSettings;

/// Distance that a robot keeps behind a person whom it follows, beyond the place where it works
/// with them.
///
/// At speed v the robot needs the distance S_p(v) in front of it, to stop in time if the person
/// stands still. At its place of work it has the distance `clearance`. The rest is the following
/// distance h.
///
/// The robot may learn the person's position late by up to T_r. A person who walks away then seems
/// nearer by up to v T_r. The robot follows no faster than S_p allows at the distance that it sees:
/// dh/dt = v − v_r with S_p(v_r) = `clearance` + h − v T_r.
///
/// A workspace that is moved out by h therefore never demands a motion away from the person. Behind
/// a person who walks at a constant speed it never demands a speed that S_p forbids.
///
/// ```
/// use hrsw_safety::{FollowingDistance, SeparationSettings};
///
/// let separation = SeparationSettings { deceleration: 0.5, ..SeparationSettings::default() };
/// let mut following = FollowingDistance::new(separation, 0.3)?;
/// for _tick in 0..10_000 {
///     following.advance(1.0, 1e-3)?;
/// }
/// let seen_late = 1.0 * separation.reaction_time;
/// let expected = separation.protective_distance(0.0, 1.0) + seen_late - 0.3;
/// assert!((following.distance() - expected).abs() < 1e-2);
/// # Ok::<(), hrsw_safety::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FollowingDistance {
    separation: SeparationSettings,
    clearance: f64,
    distance: f64,
}

impl FollowingDistance {
    /// Creates a following distance of zero. If the robot has a base, the braking of the base
    /// counts, since the base follows. `clearance` is the distance from the robot at its place of
    /// work to the nearest part that it may not touch \[m\].
    ///
    /// # Errors
    /// [`Error::Value`] if a term is out of range.
    pub fn new(separation: SeparationSettings, clearance: f64) -> Result<Self, Error> {
        separation.validate()?;
        not_negative("the clearance of a following distance", clearance)?;
        let separation = match separation.base {
            Some(base) => SeparationSettings { deceleration: base.deceleration, ..separation },
            None => separation,
        };
        Ok(Self { separation, clearance, distance: 0.0 })
    }

    /// Advances by `period` \[s\] while the person moves away from the robot at `speed` \[m/s\].
    /// Approaching counts as standing. Allocates nothing.
    ///
    /// # Errors
    /// [`Error::Value`] if the speed is not finite or the period is not positive. The following
    /// distance is then unchanged.
    pub fn advance(&mut self, speed: f64, period: f64) -> Result<(), Error> {
        check_all("the speed of a person", [&speed].into_iter())?;
        positive("the period", period)?;
        let speed = speed.max(0.0);
        let settled = self.at(speed);
        let seen = self.clearance + self.distance - self.seen_nearer(speed);
        let follows = self.separation.approach_limit(seen, 0.0);
        let next = self.distance + (speed - follows) * period;
        // The following distance settles where robot and person are equally fast, however long the
        // period.
        self.distance = if self.distance < settled { next.min(settled) } else { next.max(settled) };
        Ok(())
    }

    /// Returns the following distance, the distance that the robot stays behind beyond its place of
    /// work \[m\].
    pub fn distance(&self) -> f64 {
        self.distance
    }

    /// Returns the following distance behind a person who moves away at `speed` \[m/s\] all the
    /// time \[m\].
    pub fn at(&self, speed: f64) -> f64 {
        let needed = self.separation.protective_distance(0.0, speed) + self.seen_nearer(speed);
        (needed - self.clearance).max(0.0)
    }

    /// Returns how much nearer a person who moves away at `speed` may seem than they are \[m\].
    fn seen_nearer(&self, speed: f64) -> f64 {
        speed.max(0.0) * self.separation.reaction_time
    }
}
