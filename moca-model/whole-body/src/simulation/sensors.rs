//! Sensors of a simulated robot.

use super::rigid_body::RigidBodySimulation;
use super::transmission::Transmission;
use crate::error::{Error, check_size};
use crate::robot::model::Model;

/// A source of random numbers. The same numbers give the same simulation.
pub trait RandomSource {
    /// Returns a normally distributed number of mean 0 and standard deviation 1.
    fn normal(&mut self) -> f64;

    /// Returns a number that is uniformly distributed from 0 to 1.
    fn uniform(&mut self) -> f64;
}

/// Quality of joint sensors. Standard deviations have one element for each entry of q̇.
#[derive(Debug, Clone, PartialEq)]
pub struct SensorSettings {
    /// \[rad or m\]
    pub position_noise: Vec<f64>,
    /// \[rad/s or m/s\]
    pub velocity_noise: Vec<f64>,
    /// \[Nm or N\]
    pub torque_noise: Vec<f64>,
    /// Delay of measurements in ticks.
    pub delay: usize,
    /// Share of measurements that are lost. The last one is then read again.
    pub loss: f64,
}

impl SensorSettings {
    /// Creates sensors without noise, delay and loss.
    pub fn ideal(model: &Model) -> Self {
        let none = vec![0.0; model.velocity_count()];
        Self {
            position_noise: none.clone(),
            velocity_noise: none.clone(),
            torque_noise: none,
            delay: 0,
            loss: 0.0,
        }
    }
}

/// Sensors of a simulated robot with noise, delay and losses.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensors {
    settings: SensorSettings,
    line: Transmission,
    packet: Vec<f64>,
}

impl Sensors {
    /// Creates sensors of a robot without a floating base, which is at rest at `position` at first.
    ///
    /// # Errors
    /// [`Error::Size`]; [`Error::Value`] for noise that is negative or not finite, and for a share out of range.
    pub fn new(settings: SensorSettings, position: &[f64]) -> Result<Self, Error> {
        let n = position.len();
        for (what, noise) in [
            ("the list of position noises", &settings.position_noise),
            ("the list of velocity noises", &settings.velocity_noise),
            ("the list of torque noises", &settings.torque_noise),
        ] {
            check_size(what, noise.len(), n)?;
            if let Some(&value) = noise.iter().find(|noise| !(**noise >= 0.0 && noise.is_finite()))
            {
                let (what, expected) = ("the noise of a sensor", "finite and not negative");
                return Err(Error::value(what, value, expected));
            }
        }
        let mut packet = position.to_vec();
        packet.resize(3 * n, 0.0);
        let line = Transmission::new(settings.delay, settings.loss, &packet)?;
        Ok(Self { settings, line, packet })
    }

    /// Measures the present state of the robot. Allocates nothing.
    ///
    /// # Errors
    /// [`Error::Size`] for another robot.
    pub fn measure(
        &mut self,
        robot: &RigidBodySimulation,
        random: &mut impl RandomSource,
    ) -> Result<(), Error> {
        let noise = &self.settings;
        let noise = [&noise.position_noise, &noise.velocity_noise, &noise.torque_noise];
        let truth = [robot.position(), robot.velocity(), robot.torque()];
        check_size("the robot's q̇", robot.velocity().len(), noise[0].len())?;
        let numbers = truth.into_iter().flatten().zip(noise.into_iter().flatten());
        for (out, (truth, noise)) in self.packet.iter_mut().zip(numbers) {
            *out = if *noise > 0.0 { truth + noise * random.normal() } else { *truth };
        }
        // A line without losses draws no random number.
        let draw = if self.settings.loss > 0.0 { random.uniform() } else { 1.0 };
        self.line.pass(&self.packet, draw)?;
        Ok(())
    }

    /// The measured q \[rad or m\].
    pub fn position(&self) -> &[f64] {
        self.part(0)
    }

    /// The measured q̇ \[rad/s or m/s\].
    pub fn velocity(&self) -> &[f64] {
        self.part(1)
    }

    /// The measured torques \[Nm or N\]; see [`RigidBodySimulation::torque`].
    pub fn torque(&self) -> &[f64] {
        self.part(2)
    }

    fn part(&self, index: usize) -> &[f64] {
        let size = self.settings.position_noise.len();
        self.line.received().get(index * size..(index + 1) * size).unwrap_or_default()
    }
}
