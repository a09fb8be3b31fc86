//! Position, velocity and acceleration limits as one velocity interval that is never empty.

mod braking;
mod jerk;

pub use jerk::{AcceleratedState, JerkLimits};

use crate::error::Error;

/// Limits of one coordinate. [`with_jerk`](Self::with_jerk) adds a jerk limit.
///
/// Position, velocity and acceleration limits bound the next velocity, and such bounds can
/// contradict each other. Here the position limits leave room to brake: at a distance d the
/// velocity v towards the limit obeys vΔt + v²/(2a) ≤ d. From a state that obeys all limits there
/// is then always a velocity that leads to such a state again, see
/// [`velocity_interval`](Self::velocity_interval). If commands may come late,
/// [`holding`](Self::holding) sets how long a velocity may last.
///
/// ```
/// use ahqp_core::{Limits, MotionState};
///
/// let limits = Limits::new(-1.0, 1.0, 2.0, 10.0)?;
/// let at_limit = MotionState { position: 1.0, velocity: 0.0 };
/// let interval = limits.velocity_interval(at_limit, 1e-3);
/// assert_eq!(interval.upper, 0.0);
/// assert_eq!(interval.lower, -0.01);
/// # Ok::<(), ahqp_core::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    lower: f64,
    upper: f64,
    velocity: f64,
    acceleration: f64,
    /// Longest time that a velocity may last. Zero for the period.
    hold: f64,
}

/// Position and velocity of one coordinate, in its own unit, such as rad or m, and that per second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionState {
    /// The position \[rad or m\].
    pub position: f64,
    /// The velocity commanded last \[rad/s or m/s\].
    pub velocity: f64,
}

/// Interval of the velocities that may be commanded next, `lower ≤ v ≤ upper`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VelocityInterval {
    /// Smallest velocity \[rad/s or m/s\].
    pub lower: f64,
    /// Largest velocity \[rad/s or m/s\].
    pub upper: f64,
}

impl VelocityInterval {
    /// Interval for invalid input. [`Solver::solve`](crate::Solver::solve) refuses it as bounds of
    /// a variable.
    const UNKNOWN: Self = Self { lower: f64::NAN, upper: f64::NAN };
}

/// Rounding of a motion, relative to its size.
const ROUNDING: f64 = 1e-12;

impl Limits {
    /// Creates limits with the position range `lower` to `upper` (either may be infinite), the
    /// velocity limit and the acceleration limit, in consistent units.
    ///
    /// # Errors
    /// [`Error::Value`] if a number is NaN, the range is empty, or a limit is not positive and
    /// finite.
    pub fn new(lower: f64, upper: f64, velocity: f64, acceleration: f64) -> Result<Self, Error> {
        if lower.is_nan() || lower == f64::INFINITY {
            let expected = "a number, or negative infinity";
            return Err(Error::value("the lower position limit", lower, expected));
        }
        if upper.is_nan() || upper < lower || upper == f64::NEG_INFINITY {
            let expected = "not below the lower limit";
            return Err(Error::value("the upper position limit", upper, expected));
        }
        for (name, value) in
            [("the velocity limit", velocity), ("the acceleration limit", acceleration)]
        {
            if !(value > 0.0 && value.is_finite()) {
                return Err(Error::value(name, value, "positive and finite"));
            }
        }
        Ok(Self { lower, upper, velocity, acceleration, hold: 0.0 })
    }

    /// Adds a jerk limit \[rad/s³ or m/s³\], positive, or infinite for none.
    ///
    /// # Errors
    /// [`Error::Value`] if the jerk limit is not positive.
    pub fn with_jerk(self, jerk: f64) -> Result<JerkLimits, Error> {
        JerkLimits::new(self, jerk)
    }

    /// The lower position limit \[rad or m\].
    pub fn lower(&self) -> f64 {
        self.lower
    }

    /// The upper position limit \[rad or m\].
    pub fn upper(&self) -> f64 {
        self.upper
    }

    /// The velocity limit \[rad/s or m/s\].
    pub fn velocity(&self) -> f64 {
        self.velocity
    }

    /// The acceleration limit \[rad/s² or m/s²\].
    pub fn acceleration(&self) -> f64 {
        self.acceleration
    }

    /// Sets the longest time that a velocity may last before the next command comes \[s\]. The
    /// period counts if that is longer.
    ///
    /// Position limits then leave room for a late command: v·time + v²/(2a) ≤ d. NaN and negative
    /// times count as zero.
    ///
    /// The position limits hold in two cases:
    /// - The period given to [`velocity_interval`](Self::velocity_interval) is always the time
    ///   since the last command, and no velocity lasts longer than `time`.
    /// - Every velocity lasts for the given period, except one that lasts for up to `time`.
    ///
    /// ```
    /// use ahqp_core::{Limits, MotionState};
    ///
    /// let limits = Limits::new(-1.0, 1.0, 2.0, 10.0)?.holding(0.06);
    /// let near = MotionState { position: 0.9, velocity: 0.85 };
    /// let fastest = limits.velocity_interval(near, 1e-3).upper;
    /// assert!(near.position + fastest * 0.06 + fastest * fastest / 20.0 <= 1.0 + 1e-12);
    /// # Ok::<(), ahqp_core::Error>(())
    /// ```
    #[must_use]
    pub fn holding(mut self, time: f64) -> Self {
        self.hold = time.max(0.0);
        self
    }

    /// Multiplies the velocity limit by the factor `scale`, clamped to [0, 1] with NaN as 0. The
    /// interval then shrinks as fast as the acceleration limit allows.
    #[must_use]
    pub fn slowed(mut self, scale: f64) -> Self {
        self.velocity *= if scale > 0.0 { scale.min(1.0) } else { 0.0 };
        self
    }

    /// Returns true if `state` obeys the limits, up to rounding, and can continue to obey them.
    pub fn admits(&self, state: MotionState) -> bool {
        let MotionState { position, velocity } = state;
        let stop = velocity * velocity / (2.0 * self.acceleration) * (1.0 - ROUNDING);
        let fits = |overrun: f64, distance: f64, limit: f64| {
            let rounding = 4.0 * f64::EPSILON * (position.abs() + limit.abs());
            overrun <= distance + rounding
        };
        velocity.abs() <= self.velocity
            && fits(if velocity > 0.0 { stop } else { 0.0 }, self.upper - position, self.upper)
            && fits(if velocity < 0.0 { stop } else { 0.0 }, position - self.lower, self.lower)
    }

    /// Returns the velocities for the next `period` seconds. If [`holding`](Self::holding) is used,
    /// `period` is the time since the last command.
    ///
    /// The acceleration limit always holds. The velocity limit holds, or the velocity returns to it
    /// at full acceleration. Position limits hold whenever possible. From an admitted state every
    /// velocity of the interval leads to an admitted state. From outside, the interval leads back
    /// as fast as velocity and acceleration allow.
    ///
    /// The interval is never empty. Both ends are NaN if the state contains NaN or the period is
    /// not positive.
    pub fn velocity_interval(&self, state: MotionState, period: f64) -> VelocityInterval {
        if state.position.is_nan() || state.velocity.is_nan() || !is_positive(period) {
            return VelocityInterval::UNKNOWN;
        }
        let change = self.acceleration * period;
        let slowest = (state.velocity - change).max(-self.velocity);
        let fastest = (state.velocity + change).min(self.velocity);
        // If the velocity exceeds its limit, brake at full acceleration.
        let (slowest, fastest) = if slowest <= fastest {
            (slowest, fastest)
        } else if state.velocity > 0.0 {
            (state.velocity - change, state.velocity - change)
        } else {
            (state.velocity + change, state.velocity + change)
        };
        let towards_upper = self.approach(self.upper - state.position, period);
        let towards_lower = -self.approach(state.position - self.lower, period);
        let mut upper = fastest.min(towards_upper.max(slowest));
        let mut lower = slowest.max(towards_lower.min(fastest));
        if lower > upper {
            // If the state is outside one limit and must brake before the other, braking wins.
            if state.position > self.upper {
                upper = lower;
            } else {
                lower = upper;
            }
        }
        VelocityInterval { lower, upper }
    }

    /// Returns the largest v with vT + v²/(2a) ≤ d, where T is how long it may last. Beyond the
    /// limit, returns the velocity that is back at the limit after one period.
    fn approach(&self, distance: f64, period: f64) -> f64 {
        if distance >= 0.0 {
            if distance.is_infinite() {
                return f64::INFINITY;
            }
            let hold = self.hold.max(period);
            let root = (hold * hold + 2.0 * distance / self.acceleration).sqrt();
            2.0 * distance / (hold + root)
        } else {
            distance / period
        }
    }
}

fn is_positive(period: f64) -> bool {
    period > 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const PERIOD: f64 = 1e-3;

    fn limits() -> impl Strategy<Value = Limits> {
        (-3.0..3.0_f64, 0.0..5.0_f64, 0.05..5.0_f64, 0.1..30.0_f64)
            .prop_map(|(lower, width, v, a)| Limits::new(lower, lower + width, v, a).unwrap())
    }

    /// Advances by one tick. Only the rounding of positions may add up over a run.
    fn step(limits: &Limits, state: MotionState, choice: f64) -> (VelocityInterval, MotionState) {
        let interval = limits.velocity_interval(state, PERIOD);
        let velocity = (interval.lower + choice * (interval.upper - interval.lower))
            .clamp(interval.lower, interval.upper);
        (interval, MotionState { position: state.position + velocity * PERIOD, velocity })
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 100, ..ProptestConfig::default() })]

        #[test]
        fn an_admitted_state_leads_only_to_admitted_states(
            limits in limits(), start in 0.0..1.0_f64, speed in -1.0..1.0_f64,
            runs in prop::collection::vec(
                (prop_oneof![Just(0.0), Just(1.0), 0.0..1.0_f64], 1..2000_usize), 60),
        ) {
            let position = limits.lower + start * (limits.upper - limits.lower);
            let mut state = MotionState { position, velocity: speed * limits.velocity };
            if !limits.admits(state) {
                // The fastest velocity that can still stop.
                let room = if speed > 0.0 { limits.upper - position } else { position - limits.lower };
                let fastest = (2.0 * limits.acceleration * room).sqrt();
                state.velocity = fastest.min(limits.velocity).copysign(speed);
            }
            prop_assert!(limits.admits(state), "{state:?}");
            // Repeating a choice drives the state to its limits.
            let choices = runs.iter().flat_map(|&(choice, ticks)| std::iter::repeat_n(choice, ticks));
            for choice in choices.cycle().take(100_000) {
                let (interval, next) = step(&limits, state, choice);
                prop_assert!(interval.lower <= interval.upper);
                prop_assert!((next.velocity - state.velocity).abs()
                    <= limits.acceleration * PERIOD * (1.0 + 1e-9));
                prop_assert!(limits.admits(next), "{next:?} from {state:?}");
                state = next;
            }
        }

        #[test]
        fn running_into_a_limit_stops_at_it(limits in limits(), up in any::<bool>()) {
            let middle = 0.5 * (limits.lower + limits.upper);
            let mut state = MotionState { position: middle, velocity: 0.0 };
            let time = (limits.upper - limits.lower) / limits.velocity
                + limits.velocity / limits.acceleration + 1.0;
            let mut elapsed = 0.0;
            while elapsed < (2.0 * time).min(40.0) {
                elapsed += PERIOD;
                state = step(&limits, state, f64::from(u8::from(up))).1;
                prop_assert!((limits.lower - 1e-12..=limits.upper + 1e-12).contains(&state.position));
            }
        }

        #[test]
        fn from_outside_it_returns_within_velocity_and_acceleration(
            limits in limits(), beyond in 0.001..2.0_f64, velocity in -1.0..1.0_f64,
        ) {
            let velocity = velocity * limits.velocity;
            let mut state = MotionState { position: limits.upper + beyond, velocity };
            // Time to brake the outward motion, to accelerate inward, and to travel.
            let travel = beyond + velocity.powi(2) / (2.0 * limits.acceleration);
            let time = 2.0 * limits.velocity / limits.acceleration + travel / limits.velocity + 0.1;
            let mut ticks = 0.0;
            while state.position > limits.upper + 1e-9 {
                let (interval, next) = step(&limits, state, 1.0);
                prop_assert!(interval.lower <= interval.upper);
                prop_assert!((next.velocity - state.velocity).abs()
                    <= limits.acceleration * PERIOD * (1.0 + 1e-9));
                ticks += 1.0;
                prop_assert!(ticks * PERIOD < time * 1.5 + 1.0, "{state:?}");
                state = next;
            }
        }

        #[test]
        fn admits_is_what_the_interval_preserves(
            limits in limits(), start in 0.0..1.0_f64, speed in -1.0..1.0_f64, choice in 0.0..1.0_f64,
        ) {
            let position = limits.lower + start * (limits.upper - limits.lower);
            let state = MotionState { position, velocity: speed * limits.velocity };
            prop_assume!(limits.admits(state));
            let (_, next) = step(&limits, state, choice);
            let stop = next.velocity.powi(2) / (2.0 * limits.acceleration);
            let end = next.position + stop.copysign(next.velocity);
            prop_assert!(end <= limits.upper + 1e-12 && end >= limits.lower - 1e-12);
        }
    }

    #[test]
    fn bad_limits_are_named() {
        for (lower, upper, v, a, word) in [
            (f64::NAN, 1.0, 1.0, 1.0, "lower"),
            (2.0, 1.0, 1.0, 1.0, "upper"),
            (0.0, f64::NAN, 1.0, 1.0, "upper"),
            (0.0, 1.0, 0.0, 1.0, "velocity"),
            (0.0, 1.0, 1.0, f64::INFINITY, "acceleration"),
        ] {
            let error = Limits::new(lower, upper, v, a).unwrap_err();
            assert!(error.to_string().contains(word), "{error}");
        }
    }
}
