//! Decision when the base moves, with gentle accelerations.

use ahqp_core::{JerkLimits, VelocityInterval};
use nalgebra::{Matrix6, Matrix6xX, Rotation2, Vector2};
use whole_body::limits::{JointIntervals, nearest_to_rest};
use whole_body::robot::JointLimits;

use crate::command::{BaseMotion, DriveReason};
use crate::error::Error;
use crate::robot::kinematics::Kinematics;
use crate::robot::moca::MOCA_BASE_JOINTS;

/// Share of its acceleration limits that the base uses unless safety needs more. The rest is reserved for braking.
const GENTLE: f64 = 0.75;
/// Distance of the tool from its place at the posture, over the floor, within which the base stops \[m\].
const STOPS_WITHIN: f64 = 0.38;
/// Distance beyond which the base drives again \[m\]. Between the two it keeps its state.
const DRIVES_BEYOND: f64 = 0.45;
/// Time for which a base that stands waits before it moves for the sake of separation \[s\]. The arm acts at once, and what a
/// single camera frame asks for is over when the next one comes.
const WAITS: f64 = 0.05;
/// Manipulability below which a posture counts as singular; it is then rounding.
const SINGULAR: f64 = 1e-6;
/// Share of the manipulability at the posture below which the arm alone does not hold the tool's place.
const REACHES: f64 = 0.4;
/// Rate at which the base slows down while separation is at its limit and the workspace rests \[1/s\].
const SLOWS: f64 = 2.0;
/// Acceleration with which it may get faster again \[m/s² or rad/s²\].
const SPEEDS_UP: f64 = 0.1;
/// Speed below which it does not slow down \[m/s or rad/s\].
const SLOWEST: f64 = 0.05;

/// Prefers the arm to the base. The base stands while the person stands and the arm alone can hold the tool's place.
#[derive(Debug, Clone)]
pub(crate) struct BaseDrive {
    /// Velocities of the base while safety does not need more.
    pub(crate) gentle: JointIntervals,
    /// Manipulability of the arm alone at the posture.
    usual: f64,
    /// Place of the tool at the posture, in the axes of the base \[m\].
    nominal: Vector2<f64>,
    motion: BaseMotion,
    /// Time for which separation has needed more than the robot does \[s\].
    hindered: f64,
    /// Largest velocity of each joint of the base \[m/s or rad/s\].
    speed: f64,
}

/// What the decision depends on, beside the robot.
#[derive(Debug, Clone, Copy)]
pub(super) struct Conditions {
    /// The workspace rests.
    pub(super) rests: bool,
    /// Separation needs more than the robot does.
    pub(super) is_hindered: bool,
    /// The robot approaches a person at nearly the largest speed that separation allows.
    pub(super) is_at_limit: bool,
    /// Time since the last tick \[s\].
    pub(super) elapsed: f64,
}

impl BaseDrive {
    /// Creates the decision for a robot at its posture. The base never stands if the arm alone is singular there.
    ///
    /// # Errors
    /// Never, for limits of a robot.
    pub(super) fn new(base: usize, robot: &Kinematics, posture: &[f64]) -> Result<Self, Error> {
        let limits = robot.model().limits().iter().take(base).map(|limits| JointLimits {
            velocity: limits.velocity,
            acceleration: GENTLE * limits.acceleration,
            ..JointLimits::UNLIMITED
        });
        Ok(Self {
            gentle: JointIntervals::of_limits(&limits.collect::<Vec<_>>())?,
            usual: manipulability_behind(robot.jacobian(), base),
            nominal: place(robot, posture),
            motion: BaseMotion::Drives(DriveReason::PersonMoves),
            hindered: 0.0,
            speed: f64::INFINITY,
        })
    }

    pub(super) fn motion(&self) -> BaseMotion {
        self.motion
    }

    /// Decides for a tick of a robot at `q` that moves at `velocity`, each n.
    pub(super) fn decide(
        &mut self,
        robot: &Kinematics,
        [q, velocity]: [&[f64]; 2],
        conditions: &Conditions,
    ) {
        self.limit_speed(velocity, conditions);
        let stands = self.motion == BaseMotion::Stands;
        let farthest = if stands { DRIVES_BEYOND } else { STOPS_WITHIN };
        let reaches = self.usual > SINGULAR
            && (place(robot, q) - self.nominal).norm() <= farthest
            && manipulability_behind(robot.jacobian(), self.gentle.now.len())
                >= REACHES * self.usual;
        let Conditions { is_hindered, elapsed, .. } = *conditions;
        self.hindered = if is_hindered { self.hindered + elapsed } else { 0.0 };
        let waits = stands && self.hindered < WAITS;
        self.motion = if is_hindered && !waits {
            BaseMotion::Drives(DriveReason::Separation)
        } else if !conditions.rests {
            BaseMotion::Drives(DriveReason::PersonMoves)
        } else if reaches {
            BaseMotion::Stands
        } else {
            BaseMotion::Drives(DriveReason::Reach)
        };
    }

    /// Keeps the base below the speed that separation allows while the workspace rests. That speed changes with every
    /// camera frame, and a base at the limit would shake the tool.
    fn limit_speed(&mut self, velocity: &[f64], conditions: &Conditions) {
        if !conditions.rests {
            self.speed = f64::INFINITY;
        } else if conditions.is_at_limit {
            let axes = velocity.iter().take(self.gentle.now.len());
            let present = axes.fold(0.0, |most, axis| f64::max(most, axis.abs()));
            let slower = self.speed.min(present) * (-SLOWS * conditions.elapsed).exp();
            self.speed = slower.max(SLOWEST);
        } else {
            self.speed += SPEEDS_UP * conditions.elapsed;
        }
    }

    /// Computes the base's velocities while safety does not need more. If the base stands and can rest, its `intervals`
    /// are set to rest.
    pub(super) fn write(
        &mut self,
        velocity: &[f64],
        step: f64,
        intervals: &mut [VelocityInterval],
    ) {
        let rule = |limits: &JerkLimits, state| limits.velocity_interval(state, step);
        self.gentle.update_by(&[], velocity, &[0.0; MOCA_BASE_JOINTS], rule);
        for (gentle, interval) in self.gentle.now.iter_mut().zip(intervals) {
            gentle.upper = gentle.upper.min(self.speed).max(gentle.lower);
            gentle.lower = gentle.lower.max(-self.speed).min(gentle.upper);
            if self.motion != BaseMotion::Stands {
                continue;
            }
            let slower = nearest_to_rest(gentle);
            *gentle = VelocityInterval { lower: slower, upper: slower };
            if slower == 0.0 && interval.lower <= 0.0 && interval.upper >= 0.0 {
                *interval = *gentle;
            }
        }
    }
}

/// The place of the tool in the axes of the base, over the floor \[m\].
fn place(robot: &Kinematics, q: &[f64]) -> Vector2<f64> {
    let tool = robot.world_from_tool().translation.vector.xy();
    match q {
        [x, y, yaw, ..] => Rotation2::new(-yaw) * (tool - Vector2::new(*x, *y)),
        _ => tool,
    }
}

/// Yoshikawa's manipulability w = √det(J Jᵀ) of the joints behind the first ones, 0 in singular configurations up to
/// rounding (Int. J. Robotics Research 4(2), 1985).
///
/// The Jacobian is that of the tool for all joints, 6 × n, linear, then angular \[m/s, rad/s\].
fn manipulability_behind(jacobian: &Matrix6xX<f64>, first: usize) -> f64 {
    let mut gram = Matrix6::zeros();
    for column in jacobian.column_iter().skip(first) {
        gram.ger(1.0, &column, &column, 1.0);
    }
    gram.cholesky().map_or(0.0, |factor| factor.l_dirty().diagonal().product())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::moca::moca;
    use crate::settings::ControllerSettings;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn manipulability_is_the_product_of_the_singular_values(
            entries in prop::collection::vec(-1.0..1.0_f64, 60), shrunk in 0.0..1.0_f64,
            first in 0..4_usize,
        ) {
            let mut jacobian = Matrix6xX::from_vec(entries);
            jacobian.row_mut(3).scale_mut(shrunk);
            let behind = jacobian.columns(first, 10 - first).into_owned();
            let expected: f64 = behind.svd(false, false).singular_values.iter().product();
            prop_assert!((manipulability_behind(&jacobian, first) - expected).abs() < 1e-6);
        }
    }

    #[test]
    fn base_slows_down_at_limit_while_workspace_rests() {
        let settings = ControllerSettings::default();
        let posture = &settings.posture.configuration;
        let mut robot = Kinematics::new(moca().unwrap(), &settings.tool, &[], posture).unwrap();
        robot.update(posture).unwrap();
        let mut drive = BaseDrive::new(MOCA_BASE_JOINTS, &robot, posture).unwrap();
        let mut velocity = vec![0.0; posture.len()];
        velocity[0] = 0.4;
        // The fastest axis after so many milliseconds of wanting to be as fast as possible.
        let mut after = |ticks: u32, rests: bool, is_at_limit: bool| {
            let step = settings.period;
            for _tick in 0..ticks {
                let conditions =
                    Conditions { rests, is_hindered: false, is_at_limit, elapsed: step };
                drive.decide(&robot, [posture, &velocity], &conditions);
                drive.motion = BaseMotion::Drives(DriveReason::Reach);
                let mut intervals = [VelocityInterval { lower: -1.0, upper: 1.0 }; 3];
                drive.write(&velocity, step, &mut intervals);
                let gentle = &drive.gentle.now;
                assert!(gentle.iter().all(|interval| interval.lower <= interval.upper));
                velocity[0] = gentle[0].upper;
            }
            velocity[0]
        };
        assert!(after(1000, false, true) > 0.8, "a workspace that moves has no limit");
        let slower = after(700, true, true);
        assert!((0.2..0.6).contains(&slower), "{slower} m/s");
        assert!((after(2000, true, true) - SLOWEST).abs() < 1e-6, "the slowest after some seconds");
        let faster = after(1000, true, false);
        assert!((faster - SLOWEST - SPEEDS_UP).abs() < 1e-3, "{faster} m/s");
        assert!(after(1000, false, false) > faster + 0.2, "at once where the workspace moves");
    }

    #[test]
    fn base_that_stands_waits_before_it_gives_way() {
        let settings = ControllerSettings::default();
        let posture = &settings.posture.configuration;
        let robot = Kinematics::new(moca().unwrap(), &settings.tool, &[], posture).unwrap();
        let mut drive = BaseDrive::new(MOCA_BASE_JOINTS, &robot, posture).unwrap();
        let rest = vec![0.0; posture.len()];
        // Its motion after so many milliseconds.
        let mut after = |ticks: u32, rests: bool, is_hindered: bool| {
            for _tick in 0..ticks {
                let conditions =
                    Conditions { rests, is_hindered, is_at_limit: false, elapsed: settings.period };
                drive.decide(&robot, [posture, &rest], &conditions);
            }
            drive.motion()
        };
        let flees = BaseMotion::Drives(DriveReason::Separation);
        assert_eq!(after(1, true, true), flees, "a base that drives gives way at once");
        for _frame in 0..10 {
            assert_eq!(after(5, true, false), BaseMotion::Stands);
            assert_eq!(after(40, true, true), BaseMotion::Stands, "for 0.04 s");
        }
        assert_eq!(after(15, true, true), flees, "for 0.055 s");
        assert_eq!(after(5, true, false), BaseMotion::Stands);
        let follows = BaseMotion::Drives(DriveReason::PersonMoves);
        assert_eq!(after(1, false, true), follows, "the workspace moves");
        assert_eq!(after(1, false, true), flees);
    }

    #[test]
    fn dependent_or_unknown_rows_have_no_manipulability() {
        // The rows depend on each other, or contain numbers that are not finite.
        let mut jacobian = Matrix6xX::repeat(7, 1.0);
        assert!(manipulability_behind(&jacobian, 0) < 1e-12);
        jacobian[(0, 0)] = f64::NAN;
        assert_eq!(manipulability_behind(&jacobian, 0), 0.0);
    }
}
