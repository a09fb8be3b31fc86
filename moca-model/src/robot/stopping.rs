//! Way of a joint from its velocity to rest.

use whole_body::robot::JointLimits;

/// Share of the limits of acceleration and jerk that a planned stop uses. The remainder corrects what the plan leaves
/// out.
const USED: f64 = 0.9;
/// Share of the largest change of velocity in a period, over which the plan is made linear.
const CHANGED: f64 = 0.5;

/// The fastest stop of one joint within its limits of acceleration and jerk, after one more period of motion.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stopping {
    velocity: f64,
    period: f64,
    stop: Stop,
    /// A change of the velocity of the next period \[rad/s or m/s\], and the stop after it.
    changed: (f64, Stop),
}

/// A stop in three phases: the deceleration grows to its peak, stays, and ends.
#[derive(Debug, Clone, Copy)]
struct Stop {
    velocity: f64,
    /// Duration \[s\], first acceleration \[rad/s² or m/s²\] and jerk of each phase.
    phases: [(f64, f64, f64); 3],
}

impl Stop {
    /// Plans the stop from a velocity v and an acceleration α. Both change their signs for a joint that will move
    /// backwards, v + α|α|/(2j) < 0.
    ///
    /// The peak of the deceleration is p = √(j v + α²/2), at which the three phases end at rest, or the limit.
    fn new(limits: &JointLimits, velocity: f64, acceleration: f64) -> Self {
        let (limit, jerk) = (USED * limits.acceleration, USED * limits.jerk);
        if limit.is_infinite() {
            return Self { velocity: 0.0, phases: [(0.0, 0.0, 0.0); 3] };
        }
        if jerk.is_infinite() {
            let slowing = -limit.copysign(velocity);
            return Self {
                velocity,
                phases: [(0.0, 0.0, 0.0), (velocity.abs() / limit, slowing, 0.0), (0.0, 0.0, 0.0)],
            };
        }
        let sign = 1.0_f64.copysign(velocity + acceleration * acceleration.abs() / (2.0 * jerk));
        let (v, a) = (sign * velocity, sign * acceleration);
        let peak = (jerk * v + 0.5 * a * a).max(0.0).sqrt().min(limit).max(-a);
        let holds = (v + (0.5 * a * a - peak * peak) / jerk).max(0.0) / limit;
        let phases = [
            ((a + peak) / jerk, acceleration, -sign * jerk),
            (holds, -sign * peak, 0.0),
            (peak / jerk, -sign * peak, sign * jerk),
        ];
        Self { velocity, phases }
    }

    fn time(&self) -> f64 {
        self.phases.iter().map(|phase| phase.0).sum()
    }

    /// The way in a time \[rad or m\].
    fn way(&self, mut time: f64) -> f64 {
        let (mut way, mut v) = (0.0, self.velocity);
        for (duration, a, jerk) in self.phases {
            let t = time.min(duration);
            way += t * (v + t * (a / 2.0 + t * jerk / 6.0));
            v += t * (a + t * jerk / 2.0);
            time -= t;
        }
        way
    }
}

impl Stopping {
    /// Plans the stop of a joint that moves at `velocity` \[rad/s or m/s\] after `before` one tick ago. Commands hold
    /// for `period` \[s\].
    pub(crate) fn new(limits: &JointLimits, velocity: f64, before: f64, period: f64) -> Self {
        let (mut next, mut acceleration) = (velocity, 0.0);
        let mut change = limits.acceleration.min(limits.velocity / period) * period;
        if limits.jerk.is_finite() && limits.acceleration.is_finite() {
            let limit = limits.acceleration;
            acceleration = ((velocity - before) / period).clamp(-limit, limit);
            next += acceleration * period;
            change = change.min(limits.jerk * period * period);
        }
        let change = if change.is_finite() { CHANGED * change } else { period };
        let stop = Stop::new(limits, next, acceleration);
        let other = Stop::new(limits, next + change, acceleration + change / period);
        Self { velocity: next, period, stop, changed: (change, other) }
    }

    /// The velocity of the next period at which the plan is made linear \[rad/s or m/s\].
    pub(crate) fn velocity(&self) -> f64 {
        self.velocity
    }

    /// The time from the end of the period to rest \[s\].
    pub(crate) fn time(&self) -> f64 {
        self.stop.time()
    }

    /// The way in the period and a `time` after it \[rad or m\].
    pub(crate) fn way(&self, time: f64) -> f64 {
        self.velocity * self.period + self.stop.way(time)
    }

    /// The change of [`way`](Self::way) with the velocity of the next period \[s\].
    pub(crate) fn lever(&self, time: f64) -> f64 {
        let (change, other) = &self.changed;
        self.period + (other.way(time) - self.stop.way(time)) / change
    }
}
