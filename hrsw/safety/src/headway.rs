//! How far a shared workspace falls behind somebody who walks away from the robot.

use crate::error::{Error, check_all, not_negative, positive};
use crate::separation::SeparationSettings;

/// How far a robot that follows somebody stays behind, beyond where it works with them.
///
/// At speed v it needs S_p(v) in front of it, to stop in time if they stand still. As much of that as is not there
/// where it works, its `clearance`, it keeps as headway h. The robot may learn T_r late where the person is, so that
/// who walks away seems to be nearer by up to v T_r. It follows no faster than S_p allows at the distance that it
/// sees: dh/dt = v − v_r with S_p(v_r) = `clearance` + h − v T_r. So a workspace that is moved out by h never asks for
/// a motion away from the person, nor, behind somebody with an even pace, for a speed that S_p forbids.
///
/// ```
/// use hrsw_safety::{Headway, SeparationSettings};
///
/// let separation = SeparationSettings { deceleration: 0.5, ..SeparationSettings::default() };
/// let mut headway = Headway::new(separation, 0.3)?;
/// for _tick in 0..10_000 {
///     headway.advance(1.0, 1e-3)?;
/// }
/// let seen_late = 1.0 * separation.reaction_time;
/// let expected = separation.protective_distance(0.0, 1.0) + seen_late - 0.3;
/// assert!((headway.distance() - expected).abs() < 1e-2);
/// # Ok::<(), hrsw_safety::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Headway {
    separation: SeparationSettings,
    clearance: f64,
    distance: f64,
}

impl Headway {
    /// None yet. The first joints of a robot with a base are what follows, so that their braking counts.
    /// `clearance` is how far the robot, where it works, is from the nearest part that it may not touch \[m\].
    ///
    /// # Errors
    /// [`Error::Value`] for terms out of range.
    pub fn new(separation: SeparationSettings, clearance: f64) -> Result<Self, Error> {
        separation.validate()?;
        not_negative("the clearance of a headway", clearance)?;
        let separation = match separation.base {
            Some(base) => SeparationSettings { deceleration: base.deceleration, ..separation },
            None => separation,
        };
        Ok(Self { separation, clearance, distance: 0.0 })
    }

    /// Goes on by `period` \[s\], with the person going away from the robot at `speed` \[m/s\]; coming nearer
    /// counts as standing. Allocates nothing.
    ///
    /// # Errors
    /// [`Error::Value`] for a speed that is not finite or a period that is not positive; the headway then stays.
    pub fn advance(&mut self, speed: f64, period: f64) -> Result<(), Error> {
        check_all("the speed of a person", [&speed].into_iter())?;
        positive("the period", period)?;
        let speed = speed.max(0.0);
        let settled = self.at(speed);
        let seen = self.clearance + self.distance - self.seen_nearer(speed);
        let follows = self.separation.approach_limit(seen, 0.0);
        let next = self.distance + (speed - follows) * period;
        // It comes to rest where the two are as fast as each other, however long the period.
        self.distance = if self.distance < settled { next.min(settled) } else { next.max(settled) };
        Ok(())
    }

    /// How far the robot stays behind, beyond where it works \[m\].
    pub fn distance(&self) -> f64 {
        self.distance
    }

    /// The same behind somebody who goes away at `speed` \[m/s\] all the time \[m\].
    pub fn at(&self, speed: f64) -> f64 {
        let needed = self.separation.protective_distance(0.0, speed) + self.seen_nearer(speed);
        (needed - self.clearance).max(0.0)
    }

    /// How much nearer somebody who goes away at `speed` may seem to be than they are \[m\].
    fn seen_nearer(&self, speed: f64) -> f64 {
        speed.max(0.0) * self.separation.reaction_time
    }
}
