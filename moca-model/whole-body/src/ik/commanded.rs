//! Commands that a real robot can follow, with a limited following error.

use ahqp_core::Status;

use super::differential::{Ik, check_period};
use super::following_error::{FollowingErrorIntervals, FollowingErrorLimit};
use crate::error::Error;

/// The commanded state of a robot. Tasks are computed at it, and it stays near the measured state.
///
/// - Commands obey the position, velocity, acceleration and jerk limits whatever the tasks ask and whatever is
///   measured. A joint that starts outside its limits returns.
/// - The command of a held joint is at most the [`FollowingErrorLimit`] away from the measured position. The distance
///   never exceeds [`FollowingErrorLimit::bound`], which adds the overrun of a robot that stops suddenly at full speed.
/// - A tick that cannot be computed brakes every joint within acceleration and jerk, and reports the fault.
///
/// ```
/// use whole_body::ik::{Commanded, FollowingErrorLimit};
/// use whole_body::tasks::PostureTask;
/// use whole_body::Ik;
/// # use whole_body::{Description, Model};
/// # let model = Model::from_urdf(r#"<robot name="one"><link name="base"/><link name="tip"/>
/// #   <joint name="hinge" type="revolute"><parent link="base"/><child link="tip"/><axis xyz="0 0 1"/>
/// #   <limit lower="-1" upper="1" velocity="1" effort="1"/></joint></robot>"#, &Description::default())?;
/// let mut builder = Ik::builder(&model);
/// let posture = builder.push("posture", PostureTask::new());
/// let mut measured = vec![0.2];
/// let mut robot = Commanded::new(builder.build()?, &measured, FollowingErrorLimit::default())?;
/// robot.ik_mut().task_mut(posture)?.set_target(&[0.5])?;
/// for _ in 0..1000 {
///     let command = robot.step(&measured, 1e-3);
///     assert!(command.fault.is_none());
///     // Send command.position and command.velocity. This robot is held:
///     measured = vec![0.2];
/// }
/// assert!((robot.position()[0] - 0.3).abs() < 1e-9);
/// # Ok::<(), whole_body::Error>(())
/// ```
#[derive(Debug)]
pub struct Commanded {
    ik: Ik,
    position: Vec<f64>,
    following_error: FollowingErrorIntervals,
    fault: Option<Error>,
    status: Status,
}

/// A command for the next period.
#[derive(Debug, Clone, Copy)]
pub struct Command<'a> {
    /// q at the end of the period.
    pub position: &'a [f64],
    /// q̇ for the period \[rad/s, m/s\].
    pub velocity: &'a [f64],
    /// q̈ for the period \[rad/s², m/s²\].
    pub acceleration: &'a [f64],
    /// How the last solve ended; in case of a fault, the solve before it.
    pub status: Status,
    /// Why the robot brakes, if it does.
    pub fault: Option<&'a Error>,
}

impl Commanded {
    /// Creates a robot at rest at the `measured` configuration.
    ///
    /// # Errors
    /// [`Error::Value`] for a following-error limit out of range; those of
    /// [`Model::integrate`](crate::Model::integrate) on the configuration.
    pub fn new(
        mut ik: Ik,
        measured: &[f64],
        following_error: FollowingErrorLimit,
    ) -> Result<Self, Error> {
        ik.model().check_configuration(measured)?;
        let rest = vec![0.0; ik.model().velocity_count()];
        ik.reset(&rest)?;
        let following_error = FollowingErrorIntervals::new(following_error, ik.model(), measured)?;
        Ok(Self {
            ik,
            position: measured.to_vec(),
            following_error,
            fault: None,
            status: Status::Solved,
        })
    }

    /// Computes the command for the next `period` \[s\], with the robot at the `measured` configuration. Allocates
    /// nothing, unless there is a fault.
    ///
    /// The period is the time until the next command is sent. If the next command comes later, a robot that takes
    /// velocities moves on by the delay times its velocity, even beyond a position limit. A robot that takes positions
    /// stays within its limits.
    ///
    /// A [fault](Command::fault) is a measurement or a period that cannot be used, or an error of [`Ik::step`]. The
    /// robot then brakes. If the period is not a positive number, nothing moves.
    pub fn step(&mut self, measured: &[f64], period: f64) -> Command<'_> {
        match self.advance(measured, period) {
            Ok(status) => {
                self.status = status;
                self.fault = None;
            }
            Err(error) => {
                self.halt(period);
                self.fault = Some(Error::Braking { source: Box::new(error) });
            }
        }
        Command {
            position: &self.position,
            velocity: self.ik.velocity(),
            acceleration: self.ik.acceleration(),
            status: self.status,
            fault: self.fault.as_ref(),
        }
    }

    fn advance(&mut self, measured: &[f64], period: f64) -> Result<Status, Error> {
        check_period(period)?;
        self.ik.model().check_configuration(measured)?;
        self.following_error.update(&self.position, &self.ik, measured, period)?;
        let step = self.ik.step_within(&self.position, period, &self.following_error.intervals)?;
        step.integrate(&mut self.position)?;
        Ok(step.status())
    }

    /// Brakes. If that cannot be computed, the position stays.
    fn halt(&mut self, period: f64) {
        if self.ik.brake(period).is_ok() {
            // The position belongs to the model and the displacement is finite, so no error is possible.
            let _ = self.ik.model().integrate(&mut self.position, &self.ik.displacement);
        }
    }

    /// The commanded configuration.
    pub fn position(&self) -> &[f64] {
        &self.position
    }

    /// The inverse kinematics, to read what the last step was like.
    pub fn ik(&self) -> &Ik {
        &self.ik
    }

    /// The inverse kinematics, to set targets and change the stack.
    pub fn ik_mut(&mut self) -> &mut Ik {
        &mut self.ik
    }
}
