//! A simulated robot that follows velocities.

use whole_body::Model;

use crate::error::{Error, check_plain, check_size};

/// A robot whose joints, the base's included, follow commanded velocities at once.
///
/// No limit is enforced, so that errors of a controller stay visible.
///
/// ```
/// use moca_model::{MOCA_HOME, SimulatedRobot, moca};
///
/// let mut robot = SimulatedRobot::new(&moca()?, &MOCA_HOME)?;
/// let mut command = [0.0; 10];
/// command[0] = 0.5; // m/s along the world's x
/// for _ in 0..1000 {
///     robot.step(&command, 0.001)?;
/// }
/// assert!((robot.position()[0] - 0.5).abs() < 1e-9);
/// # Ok::<(), moca_model::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct SimulatedRobot {
    position: Vec<f64>,
    velocity: Vec<f64>,
}

impl SimulatedRobot {
    /// Creates a robot at rest at `position`, n \[rad or m\].
    ///
    /// # Errors
    /// [`Error::FloatingBase`], [`Error::Size`] and [`Error::Value`].
    pub fn new(model: &Model, position: &[f64]) -> Result<Self, Error> {
        let n = check_plain(model)?;
        check_size("the position", position, n)?;
        check_finite("the position", position)?;
        Ok(Self { position: position.to_vec(), velocity: vec![0.0; n] })
    }

    /// q, n \[rad or m\].
    pub fn position(&self) -> &[f64] {
        &self.position
    }

    /// q̇, n \[rad/s or m/s\]; the base's x and y in the world's axes.
    pub fn velocity(&self) -> &[f64] {
        &self.velocity
    }

    /// Moves the robot for `dt` \[s\] under the constant command q̇*, n \[rad/s or m/s\].
    ///
    /// # Errors
    /// [`Error::Size`], [`Error::Value`]. The robot is then unchanged.
    pub fn step(&mut self, command: &[f64], dt: f64) -> Result<(), Error> {
        check_size("the velocity command", command, self.position.len())?;
        check_finite("the velocity command", command)?;
        if !(dt > 0.0 && dt.is_finite()) {
            let (what, wanted) = ("the time step [s]".to_owned(), "positive and finite");
            return Err(Error::Value { what, got: dt, wanted });
        }
        for (position, velocity) in self.position.iter_mut().zip(command) {
            *position += velocity * dt;
        }
        self.velocity.copy_from_slice(command);
        Ok(())
    }
}

/// Returns an error unless all values are finite.
fn check_finite(what: &str, values: &[f64]) -> Result<(), Error> {
    let bad = values.iter().enumerate().find(|(_, value)| !value.is_finite());
    bad.map_or(Ok(()), |(joint, value)| {
        let what = format!("{what} of joint {}", joint + 1);
        Err(Error::Value { what, got: *value, wanted: "finite" })
    })
}
