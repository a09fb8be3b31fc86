//! A control loop for real robots: commands that the robot can follow, and that wait for it.

use ahqp_core::Status;

use super::differential::{Ik, check_period};
use super::leash::{Leash, LeashIntervals};
use crate::error::Error;

/// The commanded state of a robot: tasks are computed at it, and it is held to the measured one.
///
/// - Commands obey the position, velocity, acceleration and jerk limits whatever the tasks ask,
///   and whatever is measured; a joint that starts outside its limits returns.
/// - No joint's command is farther from the measured position than the [`Leash`] once the robot is
///   held, and never farther than [`Leash::bound`], which adds what a robot that stops suddenly at
///   full speed is overrun by.
/// - A tick that cannot be computed brakes every joint within acceleration and jerk, and says why.
///
/// ```
/// use whole_body::ik::{Commanded, Leash};
/// use whole_body::tasks::PostureTask;
/// use whole_body::Ik;
/// # use whole_body::{Description, Model};
/// # let model = Model::from_urdf(r#"<robot name="one"><link name="base"/><link name="tip"/>
/// #   <joint name="hinge" type="revolute"><parent link="base"/><child link="tip"/><axis xyz="0 0 1"/>
/// #   <limit lower="-1" upper="1" velocity="1" effort="1"/></joint></robot>"#, &Description::default())?;
/// let mut builder = Ik::builder(&model);
/// let posture = builder.push("posture", PostureTask::new());
/// let mut measured = vec![0.2];
/// let mut robot = Commanded::new(builder.build()?, &measured, Leash::default())?;
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
    leash: LeashIntervals,
    fault: Option<Error>,
    status: Status,
}

/// What the robot is to do in the next period.
#[derive(Debug, Clone, Copy)]
pub struct Command<'a> {
    /// Where it is to be at the end of the period, a whole q.
    pub position: &'a [f64],
    /// q̇ for the period \[rad/s, m/s\].
    pub velocity: &'a [f64],
    /// \[rad/s², m/s²\]
    pub acceleration: &'a [f64],
    /// How the solve ended; that of the last solve, where there is a fault.
    pub status: Status,
    /// Why the robot brakes, if it does.
    pub fault: Option<&'a Error>,
}

impl Commanded {
    /// A robot at rest at the `measured` configuration.
    ///
    /// # Errors
    /// [`Error::Value`] for a leash out of range; those of [`Model::integrate`](crate::Model::integrate)
    /// on the configuration.
    pub fn new(mut ik: Ik, measured: &[f64], leash: Leash) -> Result<Self, Error> {
        ik.model().check_configuration(measured)?;
        let rest = vec![0.0; ik.model().velocity_count()];
        ik.reset(&rest)?;
        let leash = LeashIntervals::new(leash, ik.model(), measured)?;
        Ok(Self { ik, position: measured.to_vec(), leash, fault: None, status: Status::Solved })
    }

    /// The command for the next `period` \[s\], with the robot at the `measured` configuration.
    /// Allocates nothing, unless there is a fault.
    ///
    /// The period is how long the command lasts: the time until the next one is sent, in a slow loop that of the slow
    /// loop. A robot that takes velocities and gets the next command later than that goes on by the difference
    /// times its velocity, beyond a position limit too; positions stay within their limits.
    ///
    /// A measurement or a period that cannot be used, and every error of [`Ik::step`], is a
    /// [fault](Command::fault): the robot then brakes. With a period that is no positive number
    /// nothing moves.
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
        self.leash.update(&self.position, &self.ik, measured, period)?;
        let step = self.ik.step_within(&self.position, period, &self.leash.intervals)?;
        step.integrate(&mut self.position)?;
        Ok(step.status())
    }

    /// Brakes; what cannot be computed leaves the position where it is.
    fn halt(&mut self, period: f64) {
        if self.ik.brake(period).is_ok() {
            // The position is one of the model's and the displacement finite: no error is possible.
            let _ = self.ik.model().integrate(&mut self.position, &self.ik.displacement);
        }
    }

    /// The commanded configuration.
    pub fn position(&self) -> &[f64] {
        &self.position
    }

    /// The inverse kinematics: what the last step was like.
    pub fn ik(&self) -> &Ik {
        &self.ik
    }

    /// The same, to set targets and change the stack.
    pub fn ik_mut(&mut self) -> &mut Ik {
        &mut self.ik
    }
}
