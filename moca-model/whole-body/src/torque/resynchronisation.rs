//! Resynchronisation of a desired position with the measured one.

use crate::error::{Error, check_size};
use crate::robot::joint::JointKind;
use crate::robot::model::Model;

/// Relation of a robot to its desired position.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Following {
    /// The robot follows.
    Follows,
    /// The end of the following-error limit was reached in this tick.
    Reached,
    /// The desired position restarted from the measured one in this tick. The robot does not follow or was told to
    /// yield, and has not been allowed to go on.
    Resynchronising,
}

/// The largest following errors: how far commanded and measured state may be apart.
///
/// A robot that follows late by a time T is behind by T times its speed; an arm under impedance
/// control gives way by the torque over its stiffness. The following-error limit must leave room for both.
///
/// ```
/// use whole_body::torque::FollowingErrorSettings;
///
/// assert!(FollowingErrorSettings::default().validate().is_ok());
/// assert!(FollowingErrorSettings { revolute: f64::NAN, ..FollowingErrorSettings::default() }.validate().is_err());
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct FollowingErrorSettings {
    /// |q* − q| of joints that slide \[m\]. Default 0.2.
    pub prismatic: f64,
    /// |q* − q| of joints that turn \[rad\]. Default 0.1.
    pub revolute: f64,
}

impl Default for FollowingErrorSettings {
    fn default() -> Self {
        Self { prismatic: 0.2, revolute: 0.1 }
    }
}

impl FollowingErrorSettings {
    /// Checks the ranges.
    ///
    /// # Errors
    /// [`Error::Value`] names the first that is out of its range.
    pub fn validate(&self) -> Result<(), Error> {
        let lengths = [
            ("following_error.prismatic", self.prismatic),
            ("following_error.revolute", self.revolute),
        ];
        match lengths.into_iter().find(|(_, length)| !(*length > 0.0 && length.is_finite())) {
            Some((what, length)) => Err(Error::value(what, length, "positive and finite")),
            None => Ok(()),
        }
    }
}

/// Keeps a desired position q* near the measured position q.
///
/// Within the following-error limit q* is the caller's. If a joint is farther from it than its following-error limit,
/// all of q* restarts from q in every tick. The caller ends this once its desired velocities have come to rest. Then no
/// difference q* − q is left that a spring could release. A robot that was held does not jump when it is released.
///
/// ```
/// use whole_body::torque::{Following, Resynchronisation};
///
/// let mut held = Resynchronisation::new(vec![0.1])?;
/// let mut desired = [0.3];
/// held.clamp(&mut desired, &[0.25], false)?; // the first tick starts from what is measured
/// assert_eq!(desired, [0.25]);
/// desired[0] += 0.05;
/// assert_eq!(held.clamp(&mut desired, &[0.25], false)?, Following::Follows);
/// desired[0] += 0.06; // the robot is held
/// assert_eq!(held.clamp(&mut desired, &[0.25], false)?, Following::Reached);
/// assert_eq!(desired, [0.25]);
/// # Ok::<(), whole_body::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Resynchronisation {
    /// Following-error limit of each entry of q \[rad or m\].
    lengths: Vec<f64>,
    state: State,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    /// Before the first measurement.
    Unknown,
    Following,
    Resynchronising,
    /// Restarting for one tick.
    Restarting,
}

impl Resynchronisation {
    /// Creates a resynchronisation with the largest following error of each entry of q \[rad or m\]; infinite for no
    /// limit.
    ///
    /// # Errors
    /// [`Error::Value`] for a length that is not positive.
    pub fn new(lengths: Vec<f64>) -> Result<Self, Error> {
        if let Some(&value) = lengths.iter().find(|length| length.is_nan() || **length <= 0.0) {
            let (what, expected) = ("a following-error limit", "positive, or infinite for none");
            return Err(Error::value(what, value, expected));
        }
        Ok(Self { lengths, state: State::Unknown })
    }

    /// Creates a resynchronisation for all joints of a robot, each with the limit of its kind. A floating base has no
    /// limit, since it is estimated.
    ///
    /// # Errors
    /// [`Error::Value`] for a length that is not positive.
    pub fn of_model(model: &Model, settings: FollowingErrorSettings) -> Result<Self, Error> {
        let mut lengths = vec![f64::INFINITY; model.position_count()];
        for joint in model.joints() {
            let length = match joint.kind {
                JointKind::Floating => continue,
                JointKind::Prismatic => settings.prismatic,
                JointKind::Revolute | JointKind::Continuous => settings.revolute,
            };
            if let Some(own) = lengths.get_mut(joint.position_index) {
                *own = length;
            }
        }
        Self::new(lengths)
    }

    /// The largest following error of each entry of q \[rad or m\].
    pub fn lengths(&self) -> &[f64] {
        &self.lengths
    }

    /// Keeps `desired` near `measured`, both q \[rad or m\]. `may_go_on` ends the resynchronisation, unless the
    /// following-error limit is reached. Allocates nothing.
    ///
    /// # Errors
    /// [`Error::Size`]; nothing is then changed.
    pub fn clamp(
        &mut self,
        desired: &mut [f64],
        measured: &[f64],
        may_go_on: bool,
    ) -> Result<Following, Error> {
        check_size("the desired position", desired.len(), self.lengths.len())?;
        check_size("the measured position", measured.len(), self.lengths.len())?;
        let is_new = self.state == State::Unknown;
        let starts = is_new || self.state == State::Restarting;
        let reached = !starts && self.is_reached(desired, measured);
        if self.state == State::Following && !reached {
            return Ok(Following::Follows);
        }
        desired.copy_from_slice(measured);
        if starts || (may_go_on && !reached) {
            self.state = State::Following;
            return Ok(if is_new { Following::Follows } else { Following::Resynchronising });
        }
        self.state = State::Resynchronising;
        Ok(if reached { Following::Reached } else { Following::Resynchronising })
    }

    /// Sets the desired position to the measured one from the next tick until it may go on. The robot then yields.
    pub fn resynchronise(&mut self) {
        self.state = State::Resynchronising;
    }

    /// Restarts the desired position from the measured one in the next tick and goes on at once. Use it when the robot
    /// follows but did something else meanwhile. Returns false for a robot that is being resynchronised, which
    /// goes on.
    pub fn restart(&mut self) -> bool {
        let restarts = self.state != State::Resynchronising;
        if restarts {
            self.state = State::Restarting;
        }
        restarts
    }

    /// Returns whether the following-error limit is reached. NaN counts as reached.
    fn is_reached(&self, desired: &[f64], measured: &[f64]) -> bool {
        let apart = desired.iter().zip(measured).map(|(desired, measured)| desired - measured);
        let within = apart.zip(&self.lengths).all(|(apart, length)| apart.abs() <= *length);
        !within
    }
}
