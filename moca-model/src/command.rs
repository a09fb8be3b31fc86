//! The command of a tick.

use ahqp_core::Status;
use hrsw_safety::{Fault, SafetyState};
use nalgebra::{Isometry3, Vector6};
use vision_models::Intention;

use crate::interaction::{Phase, Transition};

/// The outcome of a tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Outcome {
    /// The hierarchy was solved.
    Solved(Status),
    /// The tick had no solution or could not be computed. The robot brakes within its limits.
    Braking,
}

impl Outcome {
    /// True if every level is at its optimum.
    pub fn is_optimal(self) -> bool {
        self == Self::Solved(Status::Solved)
    }
}

/// The motion of the base.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BaseMotion {
    /// The base stands or comes to rest. The arm alone holds the tool's place.
    Stands,
    /// The base moves as the stack asks.
    Drives(DriveReason),
}

/// The reason why the base drives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DriveReason {
    /// The shared workspace moves, the object turns, or nobody works with the robot.
    PersonMoves,
    /// The tool is too far from its place at the posture, or the arm alone is too near to a singular configuration.
    Reach,
    /// A person is nearer than allowed.
    Separation,
}

/// The command of one tick (χ* of the paper's Sec. III-E) and the state that led to it.
#[derive(Debug, Clone, PartialEq)]
pub struct Command {
    /// q̇* of all joints \[m/s or rad/s\].
    pub joint_velocity: Vec<f64>,
    /// q* of all joints, the integral of q̇*, within the following-error limit of the measured configuration \[m or
    /// rad\]. The arm's part goes to the joint impedance.
    pub joint_position: Vec<f64>,
    /// The base's velocity in its own frame, (ẋ, ẏ, θ̇) \[m/s, rad/s\]; zero for a robot
    /// without a base.
    pub base_twist: [f64; 3],
    /// Motion of the base: standing, or the reason why it drives.
    pub base_motion: BaseMotion,
    /// x_d, the desired pose of the tool in the world \[m\].
    pub desired: Isometry3<f64>,
    /// ẋ_d, linear, then angular, in world axes \[m/s, rad/s\].
    pub desired_twist: Vector6<f64>,
    /// The slack of the workspace's coordinates \[m, rad\].
    pub slack: Vector6<f64>,
    /// The person's intention.
    pub intention: Intention,
    /// The phase of the interaction.
    pub phase: Phase,
    /// The change of the phase in this tick, if there was one.
    pub transition: Option<Transition>,
    /// The share of ergonomics in the third level, 0 to 1.
    pub activation: f64,
    /// The safety state.
    pub safety: SafetyState,
    /// The outcome of the tick.
    pub outcome: Outcome,
    /// The fault since the last command, if there was one. The fault with the strictest safety state counts.
    pub fault: Option<Fault>,
}

impl Command {
    pub(crate) fn at_rest(configuration: &[f64], desired: Isometry3<f64>) -> Self {
        Self {
            joint_velocity: vec![0.0; configuration.len()],
            joint_position: configuration.to_vec(),
            base_twist: [0.0; 3],
            base_motion: BaseMotion::Drives(DriveReason::PersonMoves),
            desired,
            desired_twist: Vector6::zeros(),
            slack: Vector6::zeros(),
            intention: Intention::Apart,
            phase: Phase::Apart,
            transition: None,
            activation: 0.0,
            safety: SafetyState::Normal,
            outcome: Outcome::Solved(Status::Solved),
            fault: None,
        }
    }
}
