//! Limits of joints and desired pose for the next tick.

use ahqp_core::{AcceleratedState, JerkLimits, VelocityInterval};
use hrsw_safety::LoopClock;

/// Time for which a single command may last without moving a joint beyond its position limits \[s\]. It is three times
/// the 20 ms after which a robot brakes by itself, and covers pauses of a desktop's scheduler.
const LONGEST_STALL: f64 = 0.06;
/// Time for which every command may last without moving a joint beyond its position limits \[s\].
const SLOWEST: f64 = 0.02;

/// The times of a tick \[s\].
#[derive(Debug, Clone, Copy)]
pub(crate) struct TickTimes {
    /// Time since the last tick, for which the last velocities were applied.
    pub(crate) elapsed: f64,
    /// Time for which velocities change.
    pub(crate) step: f64,
}

impl TickTimes {
    /// Computes the times of a tick. The tick before came `before` \[s\] after its predecessor. Velocities change for
    /// the period, or for the elapsed time if that is shorter. After two late ticks they change for the shorter of both
    /// times. So a slow loop brakes as fast as a fast one, and a single late tick causes no jump.
    pub(crate) fn new(elapsed: f64, before: f64, period: f64) -> Self {
        let shorter = elapsed.min(before);
        let is_late = shorter > (1.0 + LoopClock::TOLERANCE) * period;
        let step = if is_late { shorter } else { elapsed.min(period) };
        Self { elapsed, step }
    }

    /// The accelerations after a velocity changed by `change`, with the acceleration `before`. It may have changed for
    /// the whole elapsed time, or for less. The first is the smallest that the jerk limit reaches. It counts for motion,
    /// since a larger one would take longer to fade, and lead beyond the velocity limit. The second is that of a change
    /// within the step, from which a robot may brake.
    pub(crate) fn accelerations(self, limits: &JerkLimits, change: f64, before: f64) -> [f64; 2] {
        let (most, jerk) = (limits.limits().acceleration(), limits.jerk() * self.elapsed);
        let over = |time: f64| (change / time).clamp(-most, most);
        let (slow, fast) = (over(self.elapsed), over(self.step));
        let reached = slow.max(before - jerk).min(before + jerk);
        [reached.max(slow.min(fast)).min(slow.max(fast)), fast]
    }

    /// The velocities that a coordinate may take at a share of its speed, whenever the next tick comes.
    ///
    /// Position limits leave room for one stall of [`LONGEST_STALL`]. Irregular ticks may need more: velocities then
    /// change for all the elapsed time, as far as ticks that are [`SLOWEST`] apart need it.
    pub(crate) fn interval(
        self,
        limits: &JerkLimits,
        state: AcceleratedState,
        share: f64,
    ) -> VelocityInterval {
        let stalled = limits.slowed(share).holding(LONGEST_STALL);
        let VelocityInterval { lower, upper } = stalled.velocity_interval(state, self.step);
        if self.elapsed <= self.step {
            return VelocityInterval { lower, upper };
        }
        let needed = limits.holding(SLOWEST).velocity_interval(state, self.elapsed);
        let within = |end: f64| end.max(needed.lower).min(needed.upper);
        VelocityInterval { lower: within(lower), upper: within(upper) }
    }
}

/// Time for which an arm may hold its acceleration, because commands or measurements are missing \[s\]. A robot bridges
/// 20 ms of lost commands. The rest is a margin, since springs and dampers accelerate joints beyond their commands.
pub(crate) const HELD: f64 = 0.03;
/// The same time for an emergency stop, which spends the margin \[s\].
pub(crate) const HELD_IN_STOP: f64 = 0.02;
/// Largest speed after that time: this multiple of the speed at its beginning, and this much more \[rad/s\].
const FASTER: (f64, f64) = (1.2, 0.1);

/// Narrows the intervals so that a joint that holds its acceleration for the time `held` \[s\] does not run away. It then
/// moves at most [`FASTER`] in either direction, whether it moves as `commanded` or as `measured`. Where limits ask for
/// more, they win.
pub(crate) fn bound_held_acceleration(
    [commanded, measured]: [&[f64]; 2],
    held: f64,
    step: f64,
    intervals: &mut [VelocityInterval],
) {
    let joints = intervals.iter_mut().zip(commanded).zip(measured);
    for ((interval, &commanded), &measured) in joints {
        for velocity in [commanded, measured] {
            let fastest = FASTER.0 * velocity.abs() + FASTER.1;
            let towards = |end: f64| commanded + (end - velocity) * step / held;
            let within = |end: f64| end.max(interval.lower).min(interval.upper);
            let (lower, upper) = (within(towards(-fastest)), within(towards(fastest)));
            *interval = VelocityInterval { lower, upper };
        }
    }
}

/// Moves each velocity to the nearest one of its interval.
pub(crate) fn clamp(velocity: &mut [f64], intervals: &[VelocityInterval]) {
    for (velocity, interval) in velocity.iter_mut().zip(intervals) {
        *velocity = velocity.max(interval.lower).min(interval.upper);
    }
}

#[cfg(test)]
mod tests {
    use ahqp_core::Limits;

    use super::*;
    use crate::settings::ControllerSettings;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn held_accelerations_make_no_joint_run_away(
            commanded in -2.0..2.0_f64, apart in -0.2..0.2_f64,
            share in 0.0..1.0_f64, lower in -3.0..0.0_f64,
        ) {
            let step = 1e-3;
            let mut own = [VelocityInterval { lower, upper: lower + 3.0 }];
            let whole = own[0];
            bound_held_acceleration([&[commanded], &[commanded + apart]], HELD, step, &mut own);
            let [VelocityInterval { lower, upper }] = own;
            prop_assert!(whole.lower <= lower && lower <= upper && upper <= whole.upper);
            let next = lower + share * (upper - lower);
            if (whole.lower..=whole.upper).contains(&commanded) {
                for velocity in [commanded, commanded + apart] {
                    let held = velocity + (next - commanded) / step * 0.02;
                    prop_assert!(held.abs() <= 1.2 * velocity.abs() + 0.1 + 1e-9, "{held}");
                }
            }
        }

        #[test]
        fn irregular_ticks_keep_velocity_and_position(
            late in prop::collection::vec(prop_oneof![Just(1e-3), 1e-4..0.02_f64], 500),
            ends in prop::collection::vec(any::<bool>(), 5), share in prop::collection::vec(0.0..1.0_f64, 500),
        ) {
            // Joint 5 of a Panda. It goes to one end of its interval for some ticks, then to the other.
            let limits = Limits::new(-2.8, 2.8, 2.61, 15.0).unwrap().with_jerk(7500.0).unwrap();
            let period = ControllerSettings::default().period;
            let (mut position, mut velocity, mut acceleration) = (0.0, 0.0, 0.0);
            let mut before = period;
            let ends = ends.into_iter().flat_map(|up| [up; 100]);
            for ((elapsed, share), up) in late.iter().zip(share).zip(ends) {
                position += velocity * elapsed;
                let times = TickTimes::new(*elapsed, before, period);
                before = *elapsed;
                let state = AcceleratedState { position, velocity, acceleration };
                let VelocityInterval { lower, upper } = times.interval(&limits, state, 1.0);
                let share = if up { 1.0 - 0.3 * share * share } else { 0.3 * share * share };
                let next = lower + share * (upper - lower);
                [acceleration, _] = times.accelerations(&limits, next - velocity, acceleration);
                velocity = next;
                prop_assert!(velocity.abs() <= 2.61 * (1.0 + 1e-9), "{velocity} rad/s");
                prop_assert!(position.abs() <= 2.8 + 1e-9, "{position} rad");
            }
        }
    }
}
