//! Decision when the base moves, with gentle accelerations.

use ahqp_core::{Limits, MotionState, VelocityInterval};
use nalgebra::{Matrix6, Matrix6xX, Rotation2, Vector2};
use whole_body::limits::nearest_to_rest;
use whole_body::robot::JointLimits;

use crate::command::{BaseMotion, DriveReason};
use crate::error::Error;
use crate::robot::kinematics::Kinematics;

/// Share of its acceleration limits that the base uses unless safety needs more. The rest is reserved for braking.
const GENTLE: f64 = 0.75;
/// Distance of the tool from its place at the posture, over the floor, within which the base stops \[m\].
const STOPS_WITHIN: f64 = 0.38;
/// Distance beyond which the base drives again \[m\]. Between the two it keeps its state.
const DRIVES_BEYOND: f64 = 0.45;
/// Manipulability below which a posture counts as singular; it is then rounding.
const SINGULAR: f64 = 1e-6;
/// Share of the manipulability at the posture below which the arm alone does not hold the tool's place.
const REACHES: f64 = 0.4;

/// Prefers the arm to the base. The base stands while the person stands and the arm alone can hold the tool's place.
#[derive(Debug, Clone)]
pub(super) struct BaseDrive {
    limits: Vec<Limits>,
    /// Manipulability of the arm alone at the posture.
    usual: f64,
    /// Place of the tool at the posture, in the axes of the base \[m\].
    nominal: Vector2<f64>,
    motion: BaseMotion,
}

impl BaseDrive {
    /// Creates the decision for a robot at its posture. The base never stands if the arm alone is singular there.
    ///
    /// # Errors
    /// Never, for limits of a robot.
    pub(super) fn new(base: usize, robot: &Kinematics, posture: &[f64]) -> Result<Self, Error> {
        let gentle = |limits: &JointLimits| {
            let (lower, upper) = (f64::NEG_INFINITY, f64::INFINITY);
            Ok(Limits::new(lower, upper, limits.velocity, GENTLE * limits.acceleration)?)
        };
        Ok(Self {
            limits: robot
                .model()
                .limits()
                .iter()
                .take(base)
                .map(gentle)
                .collect::<Result<_, Error>>()?,
            usual: manipulability_behind(robot.jacobian(), base),
            nominal: place(robot, posture),
            motion: BaseMotion::Drives(DriveReason::PersonMoves),
        })
    }

    pub(super) fn motion(&self) -> BaseMotion {
        self.motion
    }

    /// Decides for a tick. `at_rest` says whether the workspace rests, `hindered` whether separation needs more than
    /// the robot does.
    pub(super) fn decide(&mut self, robot: &Kinematics, q: &[f64], at_rest: bool, hindered: bool) {
        let stands = self.motion == BaseMotion::Stands;
        let farthest = if stands { DRIVES_BEYOND } else { STOPS_WITHIN };
        let reaches = self.usual > SINGULAR
            && (place(robot, q) - self.nominal).norm() <= farthest
            && manipulability_behind(robot.jacobian(), self.limits.len()) >= REACHES * self.usual;
        self.motion = if hindered {
            BaseMotion::Drives(DriveReason::Separation)
        } else if !at_rest {
            BaseMotion::Drives(DriveReason::PersonMoves)
        } else if reaches {
            BaseMotion::Stands
        } else {
            BaseMotion::Drives(DriveReason::Reach)
        };
    }

    /// Writes the base's velocities while safety does not need more to `gentle`. If the base stands and can rest, its
    /// `intervals` are set to rest.
    pub(super) fn write(
        &self,
        velocity: &[f64],
        step: f64,
        intervals: &mut [VelocityInterval],
        gentle: &mut [VelocityInterval],
    ) {
        let axes = self.limits.iter().zip(velocity).zip(intervals).zip(gentle);
        for (((limits, velocity), interval), gentle) in axes {
            let state = MotionState { position: 0.0, velocity: *velocity };
            *gentle = limits.velocity_interval(state, step);
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
    fn dependent_or_unknown_rows_have_no_manipulability() {
        // The rows depend on each other, or contain numbers that are not finite.
        let mut jacobian = Matrix6xX::repeat(7, 1.0);
        assert!(manipulability_behind(&jacobian, 0) < 1e-12);
        jacobian[(0, 0)] = f64::NAN;
        assert_eq!(manipulability_behind(&jacobian, 0), 0.0);
    }
}
