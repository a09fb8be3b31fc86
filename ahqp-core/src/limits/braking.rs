//! Braking to rest within an acceleration and a jerk limit.
//!
//! Time-optimal braking from v > 0 has up to three phases. The deceleration grows at the jerk
//! limit, stays at the acceleration limit, and fades at the jerk limit along α² = 2jv. Velocity and
//! acceleration then reach zero together.

/// An acceleration limit a and a jerk limit j.
#[derive(Debug, Clone, Copy)]
pub(super) struct Braking {
    acceleration: f64,
    pub(super) jerk: f64,
}

/// Distance that a motion still covers, and its derivatives.
#[derive(Debug, Clone, Copy)]
pub(super) struct Overrun {
    pub(super) distance: f64,
    pub(super) by_velocity: f64,
    pub(super) by_acceleration: f64,
}

impl Overrun {
    const NONE: Self = Self { distance: 0.0, by_velocity: 0.0, by_acceleration: 0.0 };
}

impl Braking {
    pub(super) fn new(acceleration: f64, jerk: f64) -> Self {
        Self { acceleration, jerk }
    }

    /// Returns the acceleration α that brings `excess` velocity onto the curve α² = 2jv within a
    /// period. It solves αΔt + α²/(2j) = excess, and is odd in `excess`.
    pub(super) fn onset(&self, excess: f64, period: f64) -> f64 {
        let size = excess.abs();
        let root = (period * period + 2.0 * size / self.jerk).sqrt();
        (2.0 * size / (period + root)).copysign(excess)
    }

    /// Returns an upper bound of [`overrun`](Self::overrun) for velocities up to `fastest` and
    /// accelerations up to the limit. Each term is at its largest.
    pub(super) fn longest(&self, fastest: f64) -> f64 {
        let Self { acceleration, jerk } = *self;
        let square = acceleration * acceleration / (2.0 * jerk);
        let top = fastest + square;
        let held = 0.5 * top / acceleration;
        top * (2.0 * acceleration / jerk + held) + square * acceleration / (3.0 * jerk)
    }

    /// Returns the distance that a motion at `velocity` and `acceleration` covers in the positive
    /// direction before it rests or turns back.
    ///
    /// If the deceleration is beyond the curve, the motion turns back. The distance is then the one
    /// along the curve.
    pub(super) fn overrun(&self, velocity: f64, acceleration: f64) -> Overrun {
        let Self { acceleration: strongest, jerk } = *self;
        let square = acceleration * acceleration / (2.0 * jerk);
        if acceleration <= 0.0 {
            if velocity <= 0.0 {
                return Overrun::NONE;
            }
            if velocity <= square {
                let by_velocity = (velocity / (2.0 * jerk)).sqrt();
                let distance = velocity * by_velocity / 1.5;
                return Overrun { distance, by_velocity, by_acceleration: 0.0 };
            }
        }
        // The velocity at which the acceleration passes zero.
        let top = velocity + square;
        if top <= 0.0 {
            return Overrun::NONE;
        }
        // The deceleration grows to the curve, or to the limit and stays there.
        let peak = (jerk * top).sqrt();
        let held = top - strongest * strongest / jerk;
        let (peak, hold, hold_by_top) = if held > 0.0 {
            (strongest, top * held / (2.0 * strongest), (top + held) / (2.0 * strongest))
        } else {
            (peak, 0.0, 0.5 * peak / jerk)
        };
        let rise = (peak + acceleration) / jerk;
        let distance = top * rise - square * acceleration / (3.0 * jerk) + hold;
        if distance <= 0.0 {
            return Overrun::NONE;
        }
        let by_velocity = rise + hold_by_top;
        let by_acceleration = (by_velocity * acceleration + velocity) / jerk;
        Overrun { distance, by_velocity, by_acceleration }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        #[test]
        fn the_derivatives_are_those_of_the_distance(
            velocity in -1.0..1.0_f64, acceleration in -3.0..3.0_f64, jerk in 0.5..50.0_f64,
        ) {
            const STEP: f64 = 1e-6;
            let braking = Braking::new(3.0, jerk);
            let distance = |dv: f64, da: f64| {
                braking.overrun(velocity + dv * STEP, acceleration + da * STEP).distance
            };
            let overrun = braking.overrun(velocity, acceleration);
            let by_velocity = (distance(1.0, 0.0) - distance(-1.0, 0.0)) / (2.0 * STEP);
            let by_acceleration = (distance(0.0, 1.0) - distance(0.0, -1.0)) / (2.0 * STEP);
            // The distance has kinks where it becomes zero.
            prop_assume!(overrun.distance > 1e-4 || distance(1.0, 1.0) == 0.0);
            let size = 1.0 + overrun.by_velocity + overrun.by_acceleration;
            prop_assert!((overrun.by_velocity - by_velocity).abs() < 1e-4 * size);
            prop_assert!((overrun.by_acceleration - by_acceleration).abs() < 1e-4 * size);
        }

        #[test]
        fn no_overrun_is_longer_than_the_longest(
            fastest in 0.01..3.0_f64, share in -1.0..1.0_f64, acceleration in -3.0..3.0_f64,
            jerk in 0.5..50.0_f64,
        ) {
            let braking = Braking::new(3.0, jerk);
            let overrun = braking.overrun(share * fastest, acceleration).distance;
            prop_assert!(overrun <= braking.longest(fastest));
        }

        #[test]
        fn faster_or_less_decelerated_goes_farther(
            velocity in -1.0..1.0_f64, acceleration in -3.0..3.0_f64, jerk in 0.5..50.0_f64,
            more in 0.0..1.0_f64,
        ) {
            let braking = Braking::new(3.0, jerk);
            let distance = |v: f64, a: f64| braking.overrun(v, a).distance;
            let least = distance(velocity, acceleration) - 1e-12;
            prop_assert!(distance(velocity + more, acceleration) >= least);
            prop_assert!(distance(velocity, (acceleration + more).min(3.0)) >= least);
        }
    }
}
