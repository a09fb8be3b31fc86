//! A simulated robot that follows velocities.

use whole_body::Model;

use crate::error::{Error, check_plain, check_size};

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
    /// [`Error::FloatingBase`], [`Error::WrongSize`] and [`Error::Value`].
    pub fn new(model: &Model, position: &[f64]) -> Result<Self, Error> {
        let n = check_plain(model)?;
        check_size("the position", position, n)?;
        check_all("the position", position, FINITE)?;
        Ok(Self {
            position: position.to_vec(),
            velocity: vec![0.0; n],
            time_constants: vec![0.0; n],
        })
    }

    /// Sets the time constants T, n \[s\].
    ///
    /// # Errors
    /// [`Error::WrongSize`], [`Error::Value`].
    pub fn with_time_constants(mut self, time_constants: &[f64]) -> Result<Self, Error> {
        let what = "the time constant";
        check_size(what, time_constants, self.position.len())?;
        check_all(what, time_constants, (0.0, "finite and not negative"))?;
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
    /// [`Error::WrongSize`], [`Error::Value`]. The robot is then unchanged.
    pub fn step(&mut self, command: &[f64], dt: f64) -> Result<(), Error> {
        check_size("the velocity command", command, self.position.len())?;
        check_all("the velocity command", command, FINITE)?;
        if !(dt > 0.0 && dt.is_finite()) {
            let (what, expected) = ("the time step [s]".to_owned(), "positive and finite");
            return Err(Error::Value { what, value: dt, expected });
        }
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

/// The least value, and the words for it, of numbers that only have to be finite.
const FINITE: (f64, &str) = (f64::MIN, "finite");

/// Returns an error unless all values are finite and at least `least`.
fn check_all(
    what: &str,
    values: &[f64],
    (least, expected): (f64, &'static str),
) -> Result<(), Error> {
    let bad = values.iter().position(|value| !(*value >= least && value.is_finite()));
    bad.map_or(Ok(()), |joint| {
        let (what, value) = (format!("{what} of joint {}", joint + 1), values[joint]);
        Err(Error::Value { what, value, expected })
    })
}
