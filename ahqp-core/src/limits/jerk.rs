//! Velocity interval with a jerk limit.

use super::braking::Braking;
use super::{Limits, MotionState, VelocityInterval, is_positive};
use crate::error::Error;

/// Rounding of a state, relative to the limits.
const ROUNDING: f64 = 1e-9;
/// Largest number of rounds of the search for an end of the interval. Three or four are needed.
const ROUNDS: usize = 30;

/// Limits of one coordinate with a jerk limit, made by [`Limits::with_jerk`].
///
/// The acceleration is the change of velocity over the period. Between two ticks it changes by at
/// most jerk times period. Near a position limit the coordinate can still be brought to rest in
/// front of the limit within acceleration and jerk, without bouncing back.
///
/// ```
/// use ahqp_core::{AcceleratedState, Limits};
///
/// let limits = Limits::new(-1.0, 1.0, 2.0, 10.0)?.with_jerk(5000.0)?;
/// let mut state = AcceleratedState::at_rest(0.0);
/// for _ in 0..2000 {
///     let fastest = limits.velocity_interval(state, 1e-3).upper;
///     state = state.after(fastest, 1e-3);
///     assert!(limits.admits(state));
/// }
/// assert!(state.velocity.abs() < 1e-9 && (state.position - 1.0).abs() < 1e-9);
/// # Ok::<(), ahqp_core::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JerkLimits {
    limits: Limits,
    jerk: f64,
    /// Upper bound of the braking distance from any velocity and acceleration within the limits.
    longest: f64,
}

/// Position, velocity and acceleration of one coordinate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AcceleratedState {
    /// The position \[rad or m\].
    pub position: f64,
    /// The velocity commanded last \[rad/s or m/s\].
    pub velocity: f64,
    /// Change of the commanded velocity at the last command, divided by the period \[rad/s² or m/s²\].
    pub acceleration: f64,
}

impl AcceleratedState {
    /// Creates a state at rest at `position` \[rad or m\].
    pub fn at_rest(position: f64) -> Self {
        Self { position, velocity: 0.0, acceleration: 0.0 }
    }

    /// Returns the state after `period` seconds at `velocity`.
    #[must_use]
    pub fn after(self, velocity: f64, period: f64) -> Self {
        Self {
            position: self.position + velocity * period,
            velocity,
            acceleration: (velocity - self.velocity) / period,
        }
    }
}

impl JerkLimits {
    pub(super) fn new(limits: Limits, jerk: f64) -> Result<Self, Error> {
        if jerk > 0.0 {
            let longest = Braking::new(limits.acceleration, jerk).longest(limits.velocity);
            Ok(Self { limits, jerk, longest })
        } else {
            let expected = "positive, or infinite for none";
            Err(Error::value("the jerk limit", jerk, expected))
        }
    }

    /// The limits of position, velocity and acceleration.
    pub fn limits(&self) -> Limits {
        self.limits
    }

    /// The jerk limit \[rad/s³ or m/s³\], infinite for none.
    pub fn jerk(&self) -> f64 {
        self.jerk
    }

    /// Sets the longest time that a velocity may last \[s\], see [`Limits::holding`].
    #[must_use]
    pub fn holding(self, time: f64) -> Self {
        Self { limits: self.limits.holding(time), ..self }
    }

    /// Multiplies the velocity limit by the factor `scale`, clamped to [0, 1] with NaN as 0. The
    /// interval then shrinks as fast as acceleration and jerk allow. A `scale` of zero means
    /// braking.
    #[must_use]
    pub fn slowed(self, scale: f64) -> Self {
        Self { limits: self.limits.slowed(scale), ..self }
    }

    /// Returns true if `state` obeys the limits, up to rounding, and can continue to obey them.
    pub fn admits(&self, state: AcceleratedState) -> bool {
        let AcceleratedState { position, velocity, acceleration } = state;
        let Limits { lower, upper, velocity: fastest, acceleration: strongest, .. } = self.limits;
        if acceleration.abs() > strongest * (1.0 + ROUNDING) {
            return false;
        }
        if self.jerk.is_infinite() {
            return self.limits.admits(MotionState { position, velocity });
        }
        // Velocity at the time at which the acceleration has been brought to zero.
        let coming = velocity + acceleration * acceleration.abs() / (2.0 * self.jerk);
        let braking = Braking::new(strongest, self.jerk);
        let fits = |velocity: f64, acceleration: f64, distance: f64, limit: f64| {
            let rounding = f64::EPSILON * (position.abs() + limit.abs());
            let overrun = braking.overrun(velocity, acceleration).distance;
            overrun * (1.0 - ROUNDING) <= distance + 4.0 * rounding
        };
        velocity.abs().max(coming.abs()) <= fastest * (1.0 + ROUNDING)
            && fits(velocity, acceleration, upper - position, upper)
            && fits(-velocity, -acceleration, position - lower, lower)
    }

    /// Returns the velocities for the next `period` seconds. If [`holding`](Self::holding) is used,
    /// `period` is the time since the last command.
    ///
    /// Acceleration and jerk limits always hold. An acceleration beyond its limit returns to it at
    /// the jerk limit. The velocity limit holds, or the velocity returns to it within these two
    /// limits. From an admitted state every velocity of the interval leads to an admitted state,
    /// whatever the periods.
    ///
    /// From outside the position limits, the interval leads back as fast as the other limits allow.
    /// From inside, but too fast to stop, it brakes. The interval is never empty. Both ends are NaN
    /// if the state contains NaN or the period is not positive.
    pub fn velocity_interval(&self, state: AcceleratedState, period: f64) -> VelocityInterval {
        let AcceleratedState { position, velocity, acceleration } = state;
        let any_nan = position.is_nan() || velocity.is_nan() || acceleration.is_nan();
        if any_nan || !is_positive(period) {
            return VelocityInterval::UNKNOWN;
        }
        if self.jerk.is_infinite() {
            return self.limits.velocity_interval(MotionState { position, velocity }, period);
        }
        let Limits { lower, upper, velocity: fastest, acceleration: strongest, hold } = self.limits;
        let braking = Braking::new(strongest, self.jerk);
        let change = self.jerk * period;
        let mut least = (acceleration - change).max(-strongest);
        let mut greatest = (acceleration + change).min(strongest);
        if least > greatest {
            // Beyond the acceleration limit the acceleration returns towards it.
            least = acceleration - change.copysign(acceleration);
            greatest = least;
        }
        let reach = |wanted: f64| wanted.min(greatest).max(least);
        let slowest = reach(-braking.onset(velocity + fastest, period));
        let quickest = reach(braking.onset(fastest - velocity, period));
        let interval = |down: f64, up: f64| VelocityInterval {
            lower: velocity + down * period,
            upper: velocity + up * period,
        };
        // Position limits are usually too far away to matter.
        let distance = (upper - position).min(position - lower);
        let free = interval(slowest, quickest);
        // While the acceleration fades, the velocity may exceed its limit by the second term.
        let top = fastest + strongest * strongest / (2.0 * self.jerk);
        if distance >= self.longest + top * hold.max(period)
            && free.upper <= fastest
            && free.lower >= -fastest
            && quickest <= strongest
            && slowest >= -strongest
        {
            return free;
        }
        let to_upper = Approach::new(position, velocity, upper, [period, hold]);
        let to_lower = Approach::new(-position, -velocity, -lower, [period, hold]);
        // This brings the velocity to rest, and is always allowed within the position limits.
        let brake = reach(-braking.onset(velocity, period));
        let (down, up) = if to_upper.distance < 0.0 {
            let down = -to_lower.strongest(&braking, -brake, -slowest);
            (down, to_upper.strongest(&braking, down, quickest))
        } else {
            let up = to_upper.strongest(&braking, brake, quickest);
            let most = if to_lower.distance < 0.0 { up } else { brake };
            (-to_lower.strongest(&braking, -most, -slowest), up)
        };
        interval(down, up)
    }
}

/// Motion of the next tick towards an upper limit. A lower limit is its mirror image.
struct Approach {
    velocity: f64,
    /// Distance to the limit, negative beyond it.
    distance: f64,
    /// Rounding of the distance.
    rounding: f64,
    period: f64,
    /// Longest time that the velocity may last, if it may exceed the period.
    hold: Option<f64>,
}

impl Approach {
    fn new(position: f64, velocity: f64, limit: f64, [period, hold]: [f64; 2]) -> Self {
        let rounding = f64::EPSILON * (limit.abs() + position.abs());
        let hold = (hold > 0.0).then_some(hold.max(period));
        Self { velocity, distance: limit - position, rounding, period, hold }
    }

    /// Returns the distance covered before the next command, and its derivative with respect to the
    /// acceleration.
    ///
    /// If a velocity may last, the distance is at least that of the largest velocity while the
    /// acceleration fades. Braking then never makes it longer.
    fn travel(&self, braking: &Braking, velocity: f64, acceleration: f64) -> (f64, f64) {
        let along = (velocity * self.period, self.period * self.period);
        let Some(hold) = self.hold else { return along };
        let rising = acceleration.max(0.0) / braking.jerk;
        let top = velocity + 0.5 * acceleration.max(0.0) * rising;
        if top * hold > along.0 { (top * hold, hold * (self.period + rising)) } else { along }
    }

    /// Returns the strongest acceleration between `least` and `greatest` with which the coordinate
    /// still comes to rest in front of the limit. Otherwise returns `least`.
    ///
    /// The distance of the tick and of the braking after it grows with the acceleration, and is
    /// convex. Newton's method therefore converges to the root from above.
    fn strongest(&self, braking: &Braking, least: f64, greatest: f64) -> f64 {
        let mut acceleration = greatest;
        for _ in 0..ROUNDS {
            let velocity = self.velocity + acceleration * self.period;
            let overrun = braking.overrun(velocity, acceleration);
            let (travel, by_travel) = self.travel(braking, velocity, acceleration);
            let excess = travel + overrun.distance - self.distance;
            let slope = by_travel + self.period * overrun.by_velocity + overrun.by_acceleration;
            let correction = excess / slope;
            // The second condition matters where the limit is so near zero that the rounding of the
            // sum is larger.
            if excess <= self.rounding || correction <= 4.0 * f64::EPSILON * acceleration.abs() {
                return acceleration;
            }
            acceleration -= correction;
            if acceleration.is_nan() || acceleration <= least {
                break;
            }
        }
        least
    }
}
