//! The interface of a control law.

use super::robot_side::{JointCommand, JointMeasurement};

/// A control law, which turns measurements into commands. Only [`begin`](Self::begin) may allocate, wait or block.
pub trait ControlLaw {
    /// Misuse, after which the loop must end. The law handles everything else itself.
    type Error;

    /// Takes the first measurement, before the first step. It may allocate and print messages, for nothing moves yet.
    ///
    /// # Errors
    /// The law cannot move a robot that measures this. The loop then ends without a command.
    fn begin(&mut self, measured: &JointMeasurement) -> Result<(), Self::Error> {
        let _ = measured;
        Ok(())
    }

    /// Writes the command for the period that begins at `now` \[s\].
    ///
    /// # Errors
    /// Those of the law.
    fn step(
        &mut self,
        now: f64,
        measured: &JointMeasurement,
        command: &mut JointCommand,
    ) -> Result<(), Self::Error>;

    /// The longest time between measurements with which the law can control the robot \[s\]; `None` if it needs none. A
    /// loop refuses a robot that measures less often.
    fn longest_interval(&self) -> Option<f64> {
        None
    }

    /// The age of the robot's measured state at the last step \[s\]. The default is the age of the measurement.
    fn measurement_age(&self, measured: &JointMeasurement) -> f64 {
        measured.age
    }

    /// The age of the newest perception at the last step \[s\], infinite before the first one. `None` for a law that
    /// perceives nothing.
    fn perception_age(&self) -> Option<f64>;

    /// Asks the law to bring the robot to rest within its limits, from the next step on, and to keep it there.
    fn request_stop(&mut self);

    /// Returns whether the robot is measured at rest and commanded to stay there; `None` if that is not known.
    fn is_at_rest(&self, measured: &JointMeasurement) -> Option<bool>;
}
