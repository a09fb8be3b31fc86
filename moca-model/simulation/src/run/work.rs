//! The force of a person's tool on the robot.

use nalgebra::Vector3;

/// Mean force of a person who drills or polishes \[N\].
const MEAN: f64 = 20.0;
/// Amplitude \[N\] and angular frequency \[rad/s\] of the tool's oscillation.
const SWING: f64 = 5.0;
const RATE: f64 = 2.0 * std::f64::consts::PI * 30.0;
/// Rate at which the force begins and ends \[N/s\].
const RISE: f64 = 40.0;

/// The force with which a working person pushes the object, and so the tool, away from them.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct WorkForce {
    size: f64,
    time: f64,
    direction: Vector3<f64>,
}

impl WorkForce {
    /// The force for the next period \[N, world\]; `towards` is the way from the person to the tool, none
    /// while they do not work.
    pub(crate) fn advance(&mut self, towards: Option<Vector3<f64>>, period: f64) -> Vector3<f64> {
        if let Some(direction) = towards.and_then(|towards| towards.try_normalize(1e-6)) {
            self.direction = direction;
        }
        let goal = if towards.is_some() { MEAN } else { 0.0 };
        self.size += (goal - self.size).clamp(-RISE * period, RISE * period);
        self.time += period;
        let swing = 1.0 + SWING / MEAN * (RATE * self.time).sin();
        self.size * swing * self.direction
    }
}
