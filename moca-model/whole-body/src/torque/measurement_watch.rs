//! Measurements that stop, and measurements that only seem to come.

use super::impedance::JointState;

/// Without anything new for this long a robot is not measured \[s\]; or for twice as long as it usually takes, which is no
/// more than the period of 250 Hz.
const MISSING: f64 = 6e-3;
const SELDOM: f64 = 4e-3;
/// Time by which a measurement may come later than usual before the robot is braked \[s\]. A robot is told of a fault later.
const AWAITED: f64 = 2e-3;
/// Measurements at first by which is judged whether every one differs from the one before, as noise makes it.
const JUDGED: u32 = 20;
/// So many equal measurements in a row are no lost packets that were measured again.
const EQUAL: u32 = 6;
/// Commanded motion by which a measured position must change \[rad or m\]: several steps of an encoder of 16 bit.
const MOTION: f64 = 3e-4;
/// The same of one joint alone, while others are measured \[rad or m\]: joints may stick for a while.
const MOTION_OF_ONE: f64 = 5e-2;

/// What is wrong with the measurements of a robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum MeasurementFault {
    /// None came for 6 ms, or for twice as long as it usually takes.
    Missing,
    /// They came, but all of them, or those of one joint, were the same while the robot was to move, or while noise
    /// had changed every one before.
    Frozen,
}

/// How old what is known of a robot really is.
///
/// A measurement whose bits are those of the one before says nothing new where the robot was to move meanwhile, or
/// where each of the first measurements differed from the one before, at rest, because of noise. Its age then counts
/// from the first of them.
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
    /// By how far each joint was to move since its measurement changed \[rad or m\].
    motion: Vec<f64>,
    /// Measurements so far, as far as they are judged.
    seen: u32,
    /// Whether each of these was another.
    differs: bool,
    /// The longest time between the first measurements that differed, and how many there were of these \[s\].
    usual: f64,
    changes: u32,
    /// Measurements in a row that were the same, and since when \[s\].
    equal: u32,
    since: f64,
    age: f64,
    /// The age in the last tick as it was told, and that of the newest measurement when it came \[s\].
    told: f64,
    fresh: f64,
    frozen: bool,
}

impl MeasurementWatch {
    /// For a robot of so many joints, before its first measurement.
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

    /// Takes what was measured last, `age` \[s\] ago, and q̇* of the `period` \[s\] that ends now; returns how old what is
    /// known of the robot is \[s\]. Allocates nothing.
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
        let (mut equal, mut moved) = (true, 0.0_f64);
        let last = self.position.iter_mut().zip(&mut self.velocity).zip(&mut self.motion);
        let new = measured.position.iter().zip(measured.velocity);
        for (((position, velocity), motion), (new, new_velocity)) in last.zip(new) {
            let is_same = new.to_bits() == position.to_bits();
            if is_same && new_velocity.to_bits() == velocity.to_bits() {
                moved = moved.max(*motion);
            } else {
                equal = false;
                *motion = 0.0;
                (*position, *velocity) = (*new, *new_velocity);
            }
        }
        if self.seen < JUDGED {
            self.differs &= !equal;
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

    /// From which age on a measurement is missing \[s\].
    fn longest(&self) -> f64 {
        MISSING.max(2.0 * self.usual) - 1e-6
    }

    /// How old what is known of the robot is \[s\].
    pub fn age(&self) -> f64 {
        self.age
    }

    /// Age up to which the next measurement is awaited \[s\]: 2 ms more than usual. Joints that accelerate are braked
    /// from then on.
    pub fn awaited(&self) -> f64 {
        self.fresh + self.usual + AWAITED + 1e-6
    }

    /// What is wrong with the measurements now.
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
