//! Reports to the supervisor.

use hrsw_safety::Fault;

use super::Controller;

/// What was reported since the last command.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Reports {
    /// The worst fault.
    pub(super) fault: Option<Fault>,
    /// Whether the external force was measured.
    pub(super) measures_force: bool,
}

impl Controller {
    /// Takes the external force measured for the coming tick \[N\]. Too large a force stops the robot. While the robot
    /// yields, the commanded state follows the measured one within the speed and travel of
    /// [`FollowingErrorSettings`](crate::FollowingErrorSettings).
    ///
    /// A robot without this measurement keeps its distance from everybody. The person who works with it may only touch
    /// it in ticks for which this was called.
    pub fn set_external_force(&mut self, force: f64) {
        self.reports.measures_force = true;
        let supervisor = self.safety.supervisor_mut();
        let (fault, gives_way) = (supervisor.set_external_force(force), supervisor.gives_way());
        if let Some(fault) = fault {
            self.note(fault);
        }
        self.motion.following_error.give_way(gives_way);
    }

    /// Asks the robot to stop. From the next tick on it brakes as fast as its limits allow, and stands until an
    /// acknowledgement.
    pub fn request_stop(&mut self) {
        self.report(Fault::StopRequested);
    }

    /// Reports that the robot stopped by itself and takes no command in the coming tick. The commanded state restarts
    /// at rest from the measured one, so that no missed motion is made up. The robot then stands until an
    /// acknowledgement.
    pub fn robot_stopped(&mut self) {
        self.motion.resynchronise();
        self.command.joint_velocity.fill(0.0);
        self.command.desired_twist.fill(0.0);
        self.report(Fault::RobotStopped);
    }

    /// Restarts the commanded state from the measured one in the coming tick. The springs stay active while the robot
    /// brakes, since the arm would drift without them.
    pub(crate) fn restart(&mut self) {
        self.motion.following_error.restart();
    }

    /// Reports a fault to the supervisor.
    pub(crate) fn report(&mut self, fault: Fault) {
        self.safety.report(fault);
        self.note(fault);
    }

    /// Keeps the worst fault for the next command.
    fn note(&mut self, fault: Fault) {
        let worse = |known: Fault| fault.state() > known.state();
        if self.reports.fault.is_none_or(worse) {
            self.reports.fault = Some(fault);
        }
    }
}
