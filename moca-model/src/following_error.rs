//! Distance by which the commanded state may run ahead of the measured one.

use ahqp_core::rotation_log;
use hrsw_safety::SafetyState;
use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use whole_body::Model;
use whole_body::torque::{Following, FollowingErrorSettings, Resynchronisation};

use crate::command::Command;
use crate::error::Error;

/// Share of its following-error limit beyond which a joint counts as pressed against something, once the robot has come
/// to rest after a following error \[-\].
const PRESSED: f64 = 0.5;
/// Largest ‖p_d − p_a‖ \[m\] and angle of R_d R_aᵀ \[rad\]. The desired pose leads by its speed over K_p, at most a sixth
/// of them with the defaults.
const POSITION: f64 = 0.1;
const ROTATION: f64 = 0.3;
/// Speed at which joints yield to a force that is too large, as a share of their largest speeds \[-\]. A short force then
/// moves the arm little.
const GIVE_WAY_SPEED: f64 = 0.1;
/// Distance by which the tool gives way \[m\]; then the arm keeps its place.
const GIVE_WAY_TRAVEL: f64 = 0.2;

/// Holds q* to q, and x_d to x_a.
///
/// Within the following-error limit, q* is the integral of q̇*. When the following-error limit is reached, the
/// commanded state starts anew from the measured one. This is repeated in each tick until the robot is at rest, while
/// the velocities brake within their limits. So no difference is left that could be released.
///
/// Only joints that follow positions, if there are any, have to come to rest. The arm has no springs meanwhile and
/// would sag for as long as the base brakes. Once all joints are at rest, an arm that is pressed against something
/// starts anew once more.
///
/// A robot that gives way to a force lets q* follow q at a share of its joints' speeds. This ends when the tool has
/// travelled the allowed distance.
#[derive(Debug, Clone)]
pub(crate) struct FollowingErrorLimit {
    joints: Resynchronisation,
    /// Distance by which each joint may give way in a period \[m or rad\].
    steps: Vec<f64>,
    gives_way: bool,
    /// True if the following-error limit was reached, and the robot has not come to rest since.
    was_reached: bool,
    /// Place of the tool when it began to give way.
    begin: Option<Vector3<f64>>,
}

impl FollowingErrorLimit {
    pub(crate) fn new(
        settings: FollowingErrorSettings,
        model: &Model,
        period: f64,
    ) -> Result<Self, Error> {
        let limits = model.limits().iter();
        let step = GIVE_WAY_SPEED * period;
        let steps = limits.map(|limits| limits.velocity * step).collect();
        let joints = Resynchronisation::of_model(model, settings)?;
        Ok(Self { joints, steps, gives_way: false, was_reached: false, begin: None })
    }

    /// Holds the commanded configuration to the measured one; `follow` says of each joint whether it follows
    /// positions, and `tool` where the tool is \[m\].
    ///
    /// # Errors
    /// [`Error::Robot`] for a configuration of the wrong size.
    pub(crate) fn clamp(
        &mut self,
        command: &mut Command,
        configuration: &[f64],
        follow: &[bool],
        tool: &Vector3<f64>,
    ) -> Result<Following, Error> {
        if self.gives_way {
            self.yield_to(command, configuration, follow, tool);
            // What is left when the force has gone starts anew.
            self.joints.resynchronise();
            return Ok(Following::Resynchronising);
        }
        self.begin = None;
        let stops = command.safety == SafetyState::ProtectiveStop;
        let all = !follow.contains(&true);
        let mut velocities = command.joint_velocity.iter().zip(follow);
        let rests = velocities.all(|(&velocity, &follows)| velocity == 0.0 || !(all || follows));
        let comes_to_rest = stops && command.joint_velocity.iter().all(|&velocity| velocity == 0.0);
        if self.was_reached && comes_to_rest {
            // A base that braked longer than the arm may have pressed it against what holds it.
            let apart = command.joint_position.iter().zip(configuration).map(|(q, at)| q - at);
            let mut joints = apart.zip(self.joints.lengths());
            if joints.any(|(apart, following_error)| apart.abs() > PRESSED * following_error) {
                self.joints.restart();
            }
        }
        let following =
            self.joints.clamp(&mut command.joint_position, configuration, rests || !stops)?;
        self.was_reached &= !comes_to_rest;
        self.was_reached |= following == Following::Reached;
        Ok(following)
    }

    /// Sets whether the robot gives way to a force in the next tick.
    pub(crate) fn give_way(&mut self, gives_way: bool) {
        self.gives_way = gives_way;
    }

    /// Lets q* follow q within speed and travel. A joint that is pushed harder than its spring allows is followed at
    /// its following-error limit.
    fn yield_to(
        &mut self,
        command: &mut Command,
        configuration: &[f64],
        follow: &[bool],
        tool: &Vector3<f64>,
    ) {
        let begin = self.begin.get_or_insert(*tool);
        let ended = (tool - *begin).norm() >= GIVE_WAY_TRAVEL;
        let joints = command.joint_position.iter_mut().zip(configuration).zip(follow);
        let bounds = self.steps.iter().zip(self.joints.lengths());
        for (((desired, measured), follows), (step, length)) in joints.zip(bounds) {
            if !follows {
                *desired = *measured;
                continue;
            }
            let step = if ended { 0.0 } else { *step };
            *desired += (measured - *desired).clamp(-step, step);
            *desired = desired.clamp(measured - length, measured + length);
        }
    }

    /// Sets the commanded configuration to the measured one, from the next tick until the robot is at rest.
    pub(crate) fn resynchronise(&mut self) {
        self.joints.resynchronise();
    }

    /// Sets the commanded configuration to the measured one in the next tick, and continues from there.
    pub(crate) fn restart(&mut self) {
        self.joints.restart();
    }

    /// Holds the desired pose to the tool's: at it while the joints are resynchronised, else within
    /// the following-error limit.
    pub(crate) fn clamp_pose(
        desired: &mut Isometry3<f64>,
        actual: &Isometry3<f64>,
        following: Following,
    ) {
        match following {
            Following::Follows => Self::pull(desired, actual),
            _ => *desired = *actual,
        }
    }

    /// Moves the desired pose to within the following-error limit of the actual one.
    fn pull(desired: &mut Isometry3<f64>, actual: &Isometry3<f64>) {
        let gap = desired.translation.vector - actual.translation.vector;
        let length = gap.norm();
        if length > POSITION {
            let near = gap * (POSITION / length);
            desired.translation.vector = actual.translation.vector + near;
        }
        let turn = rotation_log(&(desired.rotation * actual.rotation.inverse()));
        let angle = turn.norm();
        if angle > ROTATION {
            let near = turn * (ROTATION / angle);
            desired.rotation = UnitQuaternion::from_scaled_axis(near) * actual.rotation;
        }
    }
}
