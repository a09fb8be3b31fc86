//! A simulated robot that follows velocities.

use whole_body::Model;

use crate::error::{Error, check_finite, check_plain, check_positive, check_size};

/// A robot whose joints, the base's included, follow commanded velocities.
///
/// Each joint's velocity approaches its command with its own time constant T: T q̈ + q̇ = q̇*, solved exactly over each
/// step. T = 0, the default, follows at once. No limit is enforced, so that errors of a controller stay visible.
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
    time_constants: Vec<f64>,
}

impl SimulatedRobot {
    /// Creates a robot at rest at `position`, n \[rad or m\], that follows at once.
    ///
    /// # Errors
    /// [`Error::FloatingBase`], [`Error::WrongSize`] and [`Error::NotFinite`].
    pub fn new(model: &Model, position: &[f64]) -> Result<Self, Error> {
        let n = check_plain(model)?;
        check_size("the position", position, n)?;
        check_all_finite("the position", position)?;
        Ok(Self {
            position: position.to_vec(),
            velocity: vec![0.0; n],
            time_constants: vec![0.0; n],
        })
    }

    /// Sets the time constants T, n \[s\].
    ///
    /// # Errors
    /// [`Error::WrongSize`], [`Error::NotFinite`], [`Error::Negative`].
    pub fn with_time_constants(mut self, time_constants: &[f64]) -> Result<Self, Error> {
        let what = "the time constant";
        check_size(what, time_constants, self.position.len())?;
        check_all_finite(what, time_constants)?;
        if let Some((joint, &value)) =
            time_constants.iter().enumerate().find(|(_, value)| **value < 0.0)
        {
            return Err(Error::Negative { what: format!("{what} of joint {}", joint + 1), value });
        }
        self.time_constants.copy_from_slice(time_constants);
        Ok(self)
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
    /// [`Error::WrongSize`], [`Error::NotFinite`], [`Error::NotPositive`] on dt. The robot is then unchanged.
    pub fn step(&mut self, command: &[f64], dt: f64) -> Result<(), Error> {
        check_size("the velocity command", command, self.position.len())?;
        check_all_finite("the velocity command", command)?;
        check_finite(dt, || "the time step [s]".to_owned())?;
        check_positive(dt, "the time step [s]")?;
        let state = self.position.iter_mut().zip(&mut self.velocity);
        for ((state, constant), target) in state.zip(&self.time_constants).zip(command) {
            let (position, velocity) = state;
            let lag = *velocity - target;
            // 1 − exp(−Δt/T), accurate for small steps; 1 for T = 0.
            let caught_up = if *constant > 0.0 { -(-dt / constant).exp_m1() } else { 1.0 };
            *position += target * dt + lag * constant * caught_up;
            *velocity = target + lag * (1.0 - caught_up);
        }
        Ok(())
    }
}

fn check_all_finite(what: &str, values: &[f64]) -> Result<(), Error> {
    values.iter().enumerate().try_for_each(|(joint, &value)| {
        check_finite(value, || format!("{what} of joint {}", joint + 1))
    })
}
