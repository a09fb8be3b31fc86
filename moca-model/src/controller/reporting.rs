//! What the supervisor hears of.

use hrsw_safety::Fault;

use super::Controller;

impl Controller {
    /// Takes the force from outside that was measured for the coming tick \[N\]. One that is too large stops
    /// the robot, and while it is to give way the commanded state follows the measured one, within the speed and
    /// the travel of [`LeashSettings`](crate::LeashSettings).
    ///
    /// A robot that does not feel keeps its distance from everybody: the person it works with may come
    /// into contact with it only in ticks for which this was called.
    pub fn feel(&mut self, force: f64) {
        self.feels = true;
        let supervisor = self.safety.supervisor_mut();
        let (fault, gives_way) = (supervisor.feel(force), supervisor.gives_way());
        if let Some(fault) = fault {
            self.note(fault);
        }
        self.leash.give_way(gives_way);
    }

    /// Asks the robot to stop: from the next tick on it brakes as fast as it can within its limits, and stands
    /// until somebody acknowledges.
    pub fn request_stop(&mut self) {
        self.report(Fault::StopRequested);
    }

    /// Tells the controller that the robot takes no commands in the coming tick, because it stopped by itself. The
    /// commanded state then starts anew from the measured one, at rest, so that nothing is made up for afterwards, and
    /// the robot stands until somebody acknowledges.
    pub fn robot_stopped(&mut self) {
        self.leash.resynchronise();
        self.command.joint_velocity.fill(0.0);
        self.command.desired_twist.fill(0.0);
        self.acceleration.fill(0.0);
        self.report(Fault::RobotStopped);
    }

    /// The commanded state starts anew from where the robot is in the coming tick. Its springs hold on while it brakes: the
    /// arm would drift without them.
    pub(crate) fn restart(&mut self) {
        self.leash.restart();
    }

    /// Tells the supervisor what went wrong.
    pub(crate) fn report(&mut self, fault: Fault) {
        self.safety.report(fault);
        self.note(fault);
    }

    /// Keeps the worst that went wrong, for the next command.
    fn note(&mut self, fault: Fault) {
        let worse = |known: Fault| fault.state() > known.state();
        if self.fault.is_none_or(worse) {
            self.fault = Some(fault);
        }
    }
}
