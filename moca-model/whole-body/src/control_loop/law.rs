//! The controller as a loop sees it.

use super::robot_side::{JointCommand, JointMeasurement};

/// What a loop computes. No call but [`begin`](Self::begin) may allocate, wait or block.
pub trait ControlLaw {
    /// Misuse, so that the loop must end. What the law can handle it handles itself.
    type Error;

    /// Takes the first measurement, before the first step. It may allocate and tell people, for nothing moves yet.
    ///
    /// # Errors
    /// Why the law cannot move a robot that measures this; the loop then ends without a command.
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

    /// The longest time between measurements at which it can control the robot \[s\]; none if it needs no measurements.
    /// A loop refuses a robot that measures more seldom.
    fn longest_interval(&self) -> Option<f64> {
        None
    }

    /// How old what is known of the robot was at the last step \[s\]: that of the measurement, unless the law knows
    /// better.
    fn measurement_age(&self, measured: &JointMeasurement) -> f64 {
        measured.age
    }

    /// The age at the last step of the newest thing that was perceived \[s\], infinite before the first; none for a
    /// law that perceives nothing.
    fn perception_age(&self) -> Option<f64>;

    /// From the next step on it brings the robot to rest within its limits, and keeps it there.
    fn request_stop(&mut self);

    /// Whether the robot is at rest, as measured, and told to be; none if that is not known.
    fn is_at_rest(&self, measured: &JointMeasurement) -> Option<bool>;
}
