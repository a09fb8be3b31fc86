//! What the controller sends each tick.

use ahqp_core::Status;
use hrsw_safety::{Fault, SafetyState};
use nalgebra::{Isometry3, Vector6};
use vision_models::Intention;

use crate::interaction::{Phase, Transition};

/// How a tick went.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Outcome {
    /// The hierarchy was solved.
    Solved(Status),
    /// There was no solution, or no tick could be computed; the robot brakes within its limits.
    Braking,
}

impl Outcome {
    /// Whether every level is at its optimum.
    pub fn is_optimal(self) -> bool {
        self == Self::Solved(Status::Solved)
    }
}

/// What the base does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BaseMotion {
    /// It stands, or comes to rest: the arm alone keeps the tool.
    Stands,
    /// It moves as the stack asks for.
    Drives(DriveReason),
}

/// Why the base drives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DriveReason {
    /// The shared workspace moves, the object turns, or nobody is there whom the base stands for.
    PersonMoves,
    /// The tool is too far from its place at the posture, or the arm alone too near to a singular configuration.
    Reach,
    /// Somebody is nearer than they may be.
    Separation,
}

/// The command of one tick (χ* of the paper's Sec. III-E), and what led to it.
#[derive(Debug, Clone, PartialEq)]
pub struct Command {
    /// q̇* of all joints \[m/s or rad/s\].
    pub joint_velocity: Vec<f64>,
    /// q* of all joints, the integral of q̇*, but within the leash of the measured configuration
    /// \[m or rad\]; the arm's part goes to the joint impedance.
    pub joint_position: Vec<f64>,
    /// The base's velocity in its own frame, (ẋ, ẏ, θ̇) \[m/s, rad/s\]; zero for a robot
    /// without a base.
    pub base_twist: [f64; 3],
    /// Whether the base stands, or why it does not.
    pub base_motion: BaseMotion,
    /// x_d.
    pub desired: Isometry3<f64>,
    /// ẋ_d: linear then angular, world axes \[m/s, rad/s\].
    pub desired_twist: Vector6<f64>,
    /// The slack of the workspace's coordinates \[m, rad\].
    pub slack: Vector6<f64>,
    /// What the person wants.
    pub intention: Intention,
    /// What robot and person are at.
    pub phase: Phase,
    /// How that changed in this tick, if it did.
    pub transition: Option<Transition>,
    /// The share of ergonomics in the third level, 0 to 1.
    pub activation: f64,
    /// How much the robot may do.
    pub safety: SafetyState,
    /// How the tick went.
    pub outcome: Outcome,
    /// What went wrong since the command before; of several faults the one that asks for the worst
    /// state.
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
