//! Velocity intervals of joints from limits of position, velocity, acceleration and jerk.

pub(crate) mod heading;

use ahqp_core::{AcceleratedState, JerkLimits, Limits, VelocityInterval};

use super::limit_kind::{End, LimitKind};
use crate::error::Error;
use crate::robot::limits::JointLimits;
use crate::robot::model::Model;

/// The interval of an entry without limits.
const FREE: VelocityInterval = VelocityInterval { lower: f64::NEG_INFINITY, upper: f64::INFINITY };
/// Value that stands for a missing velocity limit \[rad/s or m/s\].
const FREE_VELOCITY: f64 = 1e9;
/// Value that stands for a missing acceleration limit \[rad/s² or m/s²\].
const FREE_ACCELERATION: f64 = 1e14;

/// The velocity intervals of all entries of q̇, which are never empty: see [`Limits`] and [`JerkLimits`].
#[derive(Debug, Clone)]
pub struct JointIntervals {
    joints: Vec<Joint>,
    /// Interval of each entry of q̇ for the next period. They are without limits at first.
    pub now: Vec<VelocityInterval>,
}

#[derive(Debug, Clone, Copy)]
struct Joint {
    limits: Option<JerkLimits>,
    /// The same limits without those of the position.
    braking: Option<JerkLimits>,
    /// Index in q; `None` for an entry without a position, whose position limits do not count.
    position: Option<usize>,
}

impl Joint {
    /// The inverse of the acceleration limit; zero without a limit.
    fn slowness(&self) -> f64 {
        self.limits.map_or(0.0, |limits| limits.limits().acceleration().recip())
    }

    /// The acceleration limit; infinite if there is none.
    fn acceleration(&self) -> f64 {
        let limit = self.limits.map_or(f64::INFINITY, |limits| limits.limits().acceleration());
        if limit < FREE_ACCELERATION { limit } else { f64::INFINITY }
    }

    /// The velocity limit; infinite if there is none.
    fn velocity(&self) -> f64 {
        let limit = self.limits.map_or(f64::INFINITY, |limits| limits.limits().velocity());
        if limit < FREE_VELOCITY { limit } else { f64::INFINITY }
    }

    /// True if its position has a limit at this end.
    fn has_end(&self, end: End) -> bool {
        let (Some(limits), Some(_)) = (self.limits, self.position) else { return false };
        match end {
            End::Lower => limits.limits().lower().is_finite(),
            End::Upper => limits.limits().upper().is_finite(),
        }
    }

    /// The velocity after braking for a period from this motion.
    fn braked(&self, velocity: f64, acceleration: f64, period: f64) -> f64 {
        let state = AcceleratedState { position: 0.0, velocity, acceleration };
        let interval = |braking: JerkLimits| braking.slowed(0.0).velocity_interval(state, period);
        self.braking.map_or(0.0, |braking| nearest_to_rest(&interval(braking)))
    }

    /// The distances to the lower and upper limit after this period at `velocity`; infinite without limits.
    fn room(&self, q: &[f64], velocity: f64, period: f64) -> [f64; 2] {
        let (Some(limits), Some(index)) = (self.limits, self.position) else {
            return [f64::INFINITY; 2];
        };
        let Some(position) = q.get(index) else { return [f64::INFINITY; 2] };
        let limits = limits.limits();
        let (down, up) = (position - limits.lower(), limits.upper() - position);
        [down + velocity.min(0.0) * period, up - velocity.max(0.0) * period]
    }
}

impl JointIntervals {
    /// Creates the intervals of a robot's joints.
    ///
    /// # Errors
    /// [`Error::Hierarchy`] for limits that are not positive.
    pub fn new(model: &Model) -> Result<Self, Error> {
        let mut own = Self::of_limits(model.limits())?;
        for joint in model.joints().iter().filter(|joint| joint.kind.velocities() == 1) {
            own.joints[joint.velocity_index].position = Some(joint.position_index);
        }
        Ok(own)
    }

    /// Creates the intervals of coordinates that have no positions. Position limits do not count.
    ///
    /// # Errors
    /// [`Error::Hierarchy`] for limits that are not positive.
    pub fn of_limits(limits: &[JointLimits]) -> Result<Self, Error> {
        let (lower, upper) = (f64::NEG_INFINITY, f64::INFINITY);
        let joints = limits.iter().map(|limits| {
            let braking = accelerated_limits(&JointLimits { lower, upper, ..*limits })?;
            Ok(Joint { limits: accelerated_limits(limits)?, braking, position: None })
        });
        Ok(Self { now: vec![FREE; limits.len()], joints: joints.collect::<Result<_, Error>>()? })
    }

    /// Computes the intervals for the configuration q and the last commanded velocity and acceleration.
    pub(crate) fn update(&mut self, q: &[f64], v: &[f64], a: &[f64], period: f64) {
        self.update_by(q, v, a, |limits, state| limits.velocity_interval(state, period));
    }

    /// Computes the intervals for the configuration q and the last commanded velocity and acceleration, each by a rule
    /// such as [`JerkLimits::velocity_interval`]. Entries without limits stay free. Those without a position in q have no
    /// position limits.
    pub fn update_by(
        &mut self,
        q: &[f64],
        v: &[f64],
        a: &[f64],
        rule: impl Fn(&JerkLimits, AcceleratedState) -> VelocityInterval,
    ) {
        let motion = v.iter().zip(a);
        for ((joint, (&velocity, &acceleration)), now) in
            self.joints.iter().zip(motion).zip(&mut self.now)
        {
            let position = joint.position.and_then(|index| q.get(index));
            let limits = if position.is_some() { joint.limits } else { joint.braking };
            let state = AcceleratedState {
                position: position.copied().unwrap_or_default(),
                velocity,
                acceleration,
            };
            *now = limits.map_or(FREE, |limits| opened(rule(&limits, state)));
        }
    }

    /// Lets joints outside their position limits wait. If the limits force such a joint back, its interval is widened to
    /// admit braking for `period` \[s\], and the forced interval goes to `returns`. Other joints are free there.
    pub fn admit_braking(
        &mut self,
        q: &[f64],
        v: &[f64],
        a: &[f64],
        period: f64,
        returns: &mut [VelocityInterval],
    ) {
        let motion = v.iter().zip(a);
        for ((joint, (&velocity, &acceleration)), (now, forced)) in
            self.joints.iter().zip(motion).zip(self.now.iter_mut().zip(returns))
        {
            *forced = FREE;
            if joint.room(q, 0.0, period).iter().any(|room| *room < 0.0) {
                let braked = joint.braked(velocity, acceleration, period);
                *forced = *now;
                *now =
                    VelocityInterval { lower: now.lower.min(braked), upper: now.upper.max(braked) };
            }
        }
    }

    /// Narrows the intervals so that the robot can stop evenly, in a straight line of velocities.
    ///
    /// In an even stop q̇ shrinks linearly to zero in the time T = max |q̇ᵢ|/aᵢ, and no joint meets a position limit.
    /// Values that are linear in q̇ then shrink evenly too. If joints braked independently, limits on sums of fast
    /// joints that cancel each other would be violated.
    ///
    /// The condition holds now if q̇ᵢ T/2 is within each joint's room. It must also hold in the next period. So T may
    /// only grow as far as the rooms allow for joints that shrink evenly, and at most to `longest` \[s\].
    ///
    /// A base that moves along its heading needs `base` \[s\] to stop; other bases give `None`. Its path is left to
    /// [`keep_heading`](Self::keep_heading). Returns T of the next period.
    pub(crate) fn keep_even_stop(
        &mut self,
        q: &[f64],
        v: &[f64],
        longest: f64,
        base: Option<f64>,
        period: f64,
    ) -> f64 {
        let first = if base.is_some() { 2 } else { 0 };
        let joints = &self.joints[first..];
        let (v, own) = (&v[first..], &mut self.now[first..]);
        let stopping = joints.iter().zip(v).map(|(joint, v)| v.abs() * joint.slowness());
        let now = stopping.fold(base.unwrap_or_default(), f64::max);
        let share = (1.0 - period / now.max(period)).max(0.0);
        let mut next = longest.min(now + period);
        for (joint, &velocity) in joints.iter().zip(v) {
            let [below, above] = joint.room(q, velocity, period);
            let room = if velocity > 0.0 { above } else { below };
            let slower = velocity.abs() * share;
            if room > 0.0 && slower > 0.0 {
                next = next.min(2.0 * room / slower);
            }
        }
        let next = next.max(now - period).max(period);
        for ((joint, own), &velocity) in joints.iter().zip(own).zip(v) {
            let [below, above] = joint.room(q, velocity, period);
            let fastest = next / joint.slowness();
            let end = |room: f64| if room > 0.0 { fastest.min(2.0 * room / next) } else { fastest };
            let within = |velocity: f64| velocity.max(own.lower).min(own.upper);
            *own = VelocityInterval { lower: within(-end(below)), upper: within(end(above)) };
        }
        next
    }

    /// Intersects with `intervals`. Where nothing is common, the nearest velocity remains.
    pub(crate) fn narrow(&mut self, intervals: &[VelocityInterval]) {
        for (own, other) in self.now.iter_mut().zip(intervals) {
            let within = |velocity: f64| velocity.max(own.lower).min(own.upper);
            *own = VelocityInterval { lower: within(other.lower), upper: within(other.upper) };
        }
    }

    /// Brakes velocities for `period` \[s\] within the limits of acceleration and jerk, whatever the positions. Each
    /// brakes from that of its accelerations that leads nearer to rest. Nothing changes unless the period is positive.
    pub fn brake(
        &self,
        accelerations: impl IntoIterator<Item = [f64; 2]>,
        period: f64,
        v: &mut [f64],
    ) {
        if period.is_nan() || period <= 0.0 {
            return;
        }
        for ((joint, accelerations), v) in self.joints.iter().zip(accelerations).zip(v) {
            let [first, second] = accelerations.map(|from| joint.braked(*v, from, period));
            *v = if second.abs() < first.abs() { second } else { first };
        }
    }

    /// The limits of each entry of q̇; `None` without limits. A missing limit of velocity or acceleration is a very large
    /// number.
    pub fn limits(&self) -> impl Iterator<Item = Option<&JerkLimits>> {
        self.joints.iter().map(|joint| joint.limits.as_ref())
    }

    /// The jerk limit of an entry of q̇; infinite if there is none.
    pub(crate) fn jerk(&self, entry: usize) -> f64 {
        let joint = self.joints.get(entry);
        joint.and_then(|joint| joint.limits).map_or(f64::INFINITY, |limits| limits.jerk())
    }

    /// The kind of the limit that sets this end of an entry's interval.
    pub(crate) fn kind(&self, entry: usize, end: End, last: Last, period: f64) -> LimitKind {
        let Some(limits) = self.joints[entry].limits else { return LimitKind::Caller };
        let velocity = end.of(&self.now[entry]);
        let acceleration = (velocity - last.velocity) / period;
        let near = |value: f64, limit: f64| {
            limit.is_finite() && (value.abs() - limit).abs() <= 1e-9 * limit
        };
        if near(velocity, limits.limits().velocity()) {
            LimitKind::Velocity
        } else if near(acceleration, limits.limits().acceleration()) {
            LimitKind::Acceleration
        } else if near((acceleration - last.acceleration) / period, limits.jerk()) {
            LimitKind::Jerk
        } else if self.joints[entry].has_end(end) {
            LimitKind::Position
        } else {
            LimitKind::Caller
        }
    }
}

/// The last command of one entry of q̇.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Last {
    pub(crate) velocity: f64,
    pub(crate) acceleration: f64,
}

/// The limits in the form of ahqp-core; `None` if there are none.
fn accelerated_limits(limits: &JointLimits) -> Result<Option<JerkLimits>, Error> {
    let JointLimits { lower, upper, velocity, acceleration, jerk, .. } = *limits;
    if lower.is_infinite() && upper.is_infinite() && velocity.min(acceleration).is_infinite() {
        return Ok(None);
    }
    let finite = Limits::new(
        lower,
        upper,
        velocity.min(FREE_VELOCITY),
        acceleration.min(FREE_ACCELERATION),
    )?;
    Ok(Some(finite.with_jerk(jerk)?))
}

/// The interval with infinite ends in place of those that stand for a missing limit.
fn opened(interval: VelocityInterval) -> VelocityInterval {
    let VelocityInterval { lower, upper } = interval;
    VelocityInterval {
        lower: if lower <= -0.1 * FREE_VELOCITY { f64::NEG_INFINITY } else { lower },
        upper: if upper >= 0.1 * FREE_VELOCITY { f64::INFINITY } else { upper },
    }
}

/// The velocity of the interval with the least magnitude \[rad/s or m/s\].
pub fn nearest_to_rest(interval: &VelocityInterval) -> f64 {
    0.0_f64.max(interval.lower).min(interval.upper)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn intervals() -> JointIntervals {
        let limits = JointLimits {
            lower: -0.1,
            upper: 0.1,
            velocity: 1.0,
            acceleration: 2.0,
            ..JointLimits::UNLIMITED
        };
        JointIntervals::of_limits(&[limits]).unwrap()
    }

    #[test]
    fn entries_without_a_position_have_no_ends() {
        let mut coordinates = intervals();
        let mut joints = intervals();
        joints.joints[0].position = Some(0);
        for own in [&mut coordinates, &mut joints] {
            own.update(&[], &[1.0], &[0.0], 0.1);
            assert!((own.now[0].lower - 0.8).abs() < 1e-12, "{:?}", own.now);
            assert!((own.now[0].upper - 1.0).abs() < 1e-12, "{:?}", own.now);
        }
        // At the end of its way the joint may only go back.
        joints.update(&[0.1], &[0.0], &[0.0], 0.1);
        assert!(joints.now[0].upper.abs() < 1e-12, "{:?}", joints.now);
    }

    #[test]
    fn no_time_brakes_nothing() {
        for period in [0.0, -1.0, f64::NAN] {
            let mut velocity = [0.5];
            intervals().brake([[0.0; 2]], period, &mut velocity);
            assert_eq!(velocity, [0.5]);
        }
    }
}
