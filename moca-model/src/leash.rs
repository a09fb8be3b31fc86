//! How far the commanded state may run ahead of the measured one.

use ahqp_core::rotation_log;
use hrsw::SafetyState;
use nalgebra::{Isometry3, UnitQuaternion};
use whole_body::{Following, JointKind, Model, Resynchronisation};

use crate::command::Command;
use crate::error::Error;

/// The largest following errors: how far commanded and measured state may be apart.
///
/// A robot that follows late by a time T is behind by T times its speed; an arm under impedance
/// control gives way by the torque over its stiffness. The leash must leave room for both.
///
/// ```
/// use moca_model::LeashSettings;
///
/// assert!(LeashSettings::default().validate().is_ok());
/// assert!(LeashSettings { revolute: f64::NAN, ..LeashSettings::default() }.validate().is_err());
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct LeashSettings {
    /// |q* − q| of joints that slide \[m\]. Default 0.2.
    pub prismatic: f64,
    /// |q* − q| of joints that turn \[rad\]. Default 0.1.
    pub revolute: f64,
    /// ‖p_d − p_a‖ \[m\]. Default 0.1.
    pub position: f64,
    /// The angle of R_d R_aᵀ \[rad\], below half a turn. Default 0.3.
    pub rotation: f64,
}

impl Default for LeashSettings {
    fn default() -> Self {
        Self { prismatic: 0.2, revolute: 0.1, position: 0.1, rotation: 0.3 }
    }
}

impl LeashSettings {
    /// Checks the ranges.
    ///
    /// # Errors
    /// [`Error::Setting`] names the first that is out of its range.
    pub fn validate(&self) -> Result<(), Error> {
        for (name, value) in [
            ("leash.prismatic", self.prismatic),
            ("leash.revolute", self.revolute),
            ("leash.position", self.position),
        ] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(Error::Setting { name, value, expected: "positive and finite" });
            }
        }
        if !(self.rotation > 0.0 && self.rotation < std::f64::consts::PI) {
            let (name, value) = ("leash.rotation", self.rotation);
            return Err(Error::Setting { name, value, expected: "above 0 and below half a turn" });
        }
        Ok(())
    }
}

/// Holds q* to q, and x_d to x_a.
///
/// Within the leash q* is the integral of q̇*. Once it is reached the commanded state starts anew
/// from the measured one, tick by tick until the robot is at rest, while the velocities brake within
/// their limits: so nothing is left that could be released. Of a robot with joints that follow positions
/// these have to rest: without their springs the arm would sag for as long as the base brakes.
#[derive(Debug, Clone)]
pub(crate) struct Leash {
    settings: LeashSettings,
    joints: Resynchronisation,
}

impl Leash {
    pub(crate) fn new(settings: LeashSettings, model: &Model) -> Result<Self, Error> {
        let length = |kind: JointKind| match kind {
            JointKind::Prismatic => settings.prismatic,
            JointKind::Revolute | JointKind::Continuous | JointKind::Floating => settings.revolute,
        };
        let lengths = model.joints().iter().map(|joint| length(joint.kind)).collect();
        Ok(Self { settings, joints: Resynchronisation::new(lengths)? })
    }

    /// Holds the commanded configuration to the measured one; `follow` says of each joint whether it follows
    /// positions.
    ///
    /// # Errors
    /// [`Error::Robot`] for a configuration of the wrong size.
    pub(crate) fn hold(
        &mut self,
        command: &mut Command,
        configuration: &[f64],
        follow: &[bool],
    ) -> Result<Following, Error> {
        let stops = command.safety == SafetyState::ProtectiveStop;
        let all = !follow.contains(&true);
        let mut velocities = command.joint_velocity.iter().zip(follow);
        let rests = velocities.all(|(&velocity, &follows)| velocity == 0.0 || !(all || follows));
        Ok(self.joints.hold(&mut command.joint_position, configuration, rests || !stops)?)
    }

    /// The commanded configuration is the measured one, from the next tick until the robot rests.
    pub(crate) fn resynchronise(&mut self) {
        self.joints.resynchronise();
    }

    /// Holds the desired pose to the tool's: at it while the joints are resynchronised, else within
    /// the leash.
    pub(crate) fn hold_pose(
        &self,
        desired: &mut Isometry3<f64>,
        actual: &Isometry3<f64>,
        following: Following,
    ) {
        match following {
            Following::Follows => self.pull(desired, actual),
            _ => *desired = *actual,
        }
    }

    /// Moves the desired pose to within the leash of the actual one.
    fn pull(&self, desired: &mut Isometry3<f64>, actual: &Isometry3<f64>) {
        let gap = desired.translation.vector - actual.translation.vector;
        let length = gap.norm();
        if length > self.settings.position {
            let near = gap * (self.settings.position / length);
            desired.translation.vector = actual.translation.vector + near;
        }
        let turn = rotation_log(&(desired.rotation * actual.rotation.inverse()));
        let angle = turn.norm();
        if angle > self.settings.rotation {
            let near = turn * (self.settings.rotation / angle);
            desired.rotation = UnitQuaternion::from_scaled_axis(near) * actual.rotation;
        }
    }
}
