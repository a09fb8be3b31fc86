//! Detection of missing and frozen measurements.

use super::impedance::JointState;

/// Time without a new measurement after which it is missing \[s\]. Twice the usual interval applies if that is longer.
/// The usual interval is at most the period of 250 Hz.
const MISSING: f64 = 6e-3;
const SELDOM: f64 = 4e-3;
/// Time beyond the usual interval for which a measurement is awaited before the robot brakes \[s\]. A fault comes
/// later.
const AWAITED: f64 = 2e-3;
/// Number of first measurements that decide whether noise makes each one differ from the one before. A change of at most
/// twice the commanded motion may be motion.
const JUDGED: u32 = 20;
/// Number of equal measurements in a row that cannot be explained by repeated ones for lost packets.
const EQUAL: u32 = 6;
/// Commanded motion by which a measured position must change \[rad or m\]; several steps of a 16-bit encoder.
const MOTION: f64 = 3e-4;
/// Commanded motion of one joint alone by which its position must change \[rad or m\], since joints may stick.
const MOTION_OF_ONE: f64 = 5e-2;

/// A fault of the measurements of a robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum MeasurementFault {
    /// No measurement came for 6 ms, or for twice the usual interval.
    Missing,
    /// Measurements came, but all of them or those of one joint stayed the same. Meanwhile the robot was to move, or
    /// noise had changed every earlier measurement.
    Frozen,
}

/// Determines the true age of a robot's measured state.
///
/// A measurement with the same bits as the one before may say nothing new. That is so if the robot was to move
/// meanwhile, or if noise made each of the first measurements differ from the one before. Its age then counts from the
/// first of the equal measurements.
///
/// ```
/// use whole_body::torque::{JointState, MeasurementFault, MeasurementWatch};
///
/// let mut watch = MeasurementWatch::new(1);
/// let frozen = JointState { position: &[0.3], velocity: &[1.0] };
/// let mut fault = None;
/// for _ in 0..10 {
///     // Each millisecond, at 1 rad/s
///     watch.update(frozen, &[1.0], 0.0, 1e-3);
///     fault = watch.fault();
/// }
/// assert_eq!(fault, Some(MeasurementFault::Frozen));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct MeasurementWatch {
    position: Vec<f64>,
    velocity: Vec<f64>,
    /// Distance that each joint was to move since its measurement changed \[rad or m\].
    motion: Vec<f64>,
    /// Number of measurements so far, up to those that are judged.
    seen: u32,
    /// True if noise made each of these differ from the one before.
    differs: bool,
    /// Longest interval between the first measurements that differed \[s\], and their number.
    usual: f64,
    changes: u32,
    /// Number of equal measurements in a row, and the time since the first of them \[s\].
    equal: u32,
    since: f64,
    age: f64,
    /// Age given in the last tick, and the age of the newest measurement when it came \[s\].
    told: f64,
    fresh: f64,
    frozen: bool,
}

impl MeasurementWatch {
    /// Creates a watch for a robot of `joints` joints before its first measurement.
    pub fn new(joints: usize) -> Self {
        Self {
            position: vec![f64::NAN; joints],
            velocity: vec![f64::NAN; joints],
            motion: vec![0.0; joints],
            seen: 0,
            differs: true,
            usual: 0.0,
            changes: 0,
            equal: 0,
            since: 0.0,
            age: 0.0,
            told: f64::INFINITY,
            fresh: 0.0,
            frozen: false,
        }
    }

    /// Takes the last measurement, `age` \[s\] old, and q̇* of the `period` \[s\] that ends now. Returns the true age
    /// of the measured state \[s\]. Allocates nothing.
    pub fn update(
        &mut self,
        measured: JointState<'_>,
        commanded: &[f64],
        age: f64,
        period: f64,
    ) -> f64 {
        for (motion, commanded) in self.motion.iter_mut().zip(commanded) {
            *motion += commanded.abs() * period;
        }
        self.since += period;
        self.age = age.max(0.0);
        if age <= self.told + 0.5 * period {
            self.fresh = self.age;
        }
        self.told = age;
        if age < 0.5 * period {
            self.take(measured);
        }
        self.age
    }

    /// Takes a measurement that has just come.
    fn take(&mut self, measured: JointState<'_>) {
        let (mut equal, mut noisy, mut moved) = (true, false, 0.0_f64);
        let last = self.position.iter_mut().zip(&mut self.velocity).zip(&mut self.motion);
        let new = measured.position.iter().zip(measured.velocity);
        for (((position, velocity), motion), (new, new_velocity)) in last.zip(new) {
            let is_same = new.to_bits() == position.to_bits();
            if is_same && new_velocity.to_bits() == velocity.to_bits() {
                moved = moved.max(*motion);
            } else {
                equal = false;
                let moves = *motion > 0.0 && (new - *position).abs() <= 2.0 * *motion;
                noisy |= !moves;
                *motion = 0.0;
                (*position, *velocity) = (*new, *new_velocity);
            }
        }
        if self.seen < JUDGED {
            self.differs &= noisy;
            self.seen += 1;
        }
        let is_old = equal && ((self.differs && self.seen == JUDGED) || moved > MOTION);
        if equal {
            self.equal = self.equal.saturating_add(1);
        } else {
            if (1..JUDGED).contains(&self.changes) {
                self.usual = self.usual.max(self.since.min(SELDOM));
            }
            self.changes = self.changes.saturating_add(1);
            (self.equal, self.since) = (0, 0.0);
        }
        if is_old {
            self.age = self.since;
        }
        let is_long = self.equal >= EQUAL && self.since >= self.longest();
        self.frozen = (is_old && is_long) || moved > MOTION_OF_ONE;
    }

    /// The age from which on a measurement is missing \[s\].
    fn longest(&self) -> f64 {
        MISSING.max(2.0 * self.usual) - 1e-6
    }

    /// The true age of the measured state \[s\].
    pub fn age(&self) -> f64 {
        self.age
    }

    /// The age up to which the next measurement is awaited \[s\], 2 ms more than usual. Beyond it, accelerating joints
    /// are braked.
    pub fn awaited(&self) -> f64 {
        self.fresh + self.usual + AWAITED + 1e-6
    }

    /// The present fault of the measurements.
    pub fn fault(&self) -> Option<MeasurementFault> {
        if self.frozen {
            Some(MeasurementFault::Frozen)
        } else if self.age >= self.longest() {
            Some(MeasurementFault::Missing)
        } else {
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const PERIOD: f64 = 1e-3;

    /// Watches a robot for so many periods: its command [rad/s] and its measured position [rad] in each.
    fn watch(ticks: u32, mut robot: impl FnMut(u32) -> (f64, f64)) -> Option<MeasurementFault> {
        let mut watch = MeasurementWatch::new(1);
        let (mut commanded, mut last) = (0.0, None);
        for tick in 0..ticks {
            let (next, position) = robot(tick);
            let velocity = last.map_or(0.0, |last| (position - last) / PERIOD);
            let measured = JointState { position: &[position], velocity: &[velocity] };
            watch.update(measured, &[commanded], 0.0, PERIOD);
            (commanded, last) = (next, Some(position));
            if watch.fault().is_some() {
                break;
            }
        }
        watch.fault()
    }

    proptest! {
        /// A simulated robot without noise that moves from its first tick on may rest.
        #[test]
        fn a_robot_without_noise_may_rest(
            speed in 1e-4..2.0_f64, moves in 60..400_u32, lag in prop::option::of(2e-3..0.05_f64),
        ) {
            let (mut wanted, mut position) = (0.3, 0.3);
            let fault = watch(2 * moves + 600, |tick| {
                let share = lag.map_or(1.0, |lag| PERIOD / (lag + PERIOD));
                position += (wanted - position) * share;
                // It speeds up within 50 ms, moves, and stands.
                let command = if tick < moves { speed * f64::from((tick + 1).min(50)) / 50.0 } else { 0.0 };
                wanted += command * PERIOD;
                (command, position)
            });
            prop_assert_eq!(fault, None);
        }

        /// Noise shows that measurements freeze, also of a robot that creeps at first.
        #[test]
        fn noise_tells_frozen_from_still(
            speed in 0.0..1e-3_f64, noise in 1e-5..1e-4_f64, frozen in 30..200_u32,
        ) {
            let mut shown = 0.0;
            let fault = watch(frozen + 20, |tick| {
                if tick < frozen {
                    let sign = if tick % 2 == 0 { noise } else { -noise };
                    shown = speed * PERIOD * f64::from(tick) + sign;
                }
                (if tick < frozen { speed } else { 0.0 }, shown)
            });
            prop_assert_eq!(fault, Some(MeasurementFault::Frozen));
        }
    }
}
