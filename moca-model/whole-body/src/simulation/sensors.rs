//! What a robot's sensors say of it.

use super::rigid_body::RigidBodySimulation;
use super::transmission::Transmission;
use crate::error::{Error, check_size};
use crate::robot::model::Model;

/// Random numbers of the caller's choice; with the same ones everything happens again.
pub trait RandomSource {
    /// Normally distributed, of mean 0 and standard deviation 1.
    fn normal(&mut self) -> f64;

    /// Evenly distributed from 0 to 1.
    fn uniform(&mut self) -> f64;
}

/// How well joints are measured. Standard deviations, one an entry of q̇.
#[derive(Debug, Clone, PartialEq)]
pub struct SensorSettings {
    /// \[rad or m\]
    pub position_noise: Vec<f64>,
    /// \[rad/s or m/s\]
    pub velocity_noise: Vec<f64>,
    /// \[Nm or N\]
    pub torque_noise: Vec<f64>,
    /// How many ticks a measurement is late.
    pub delay: usize,
    /// The share of measurements that are lost: the last one is then measured again.
    pub loss: f64,
}

impl SensorSettings {
    /// Exact, at once, always.
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

/// Measures a simulated robot: with noise, late, and now and then not at all.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensors {
    settings: SensorSettings,
    line: Transmission,
    packet: Vec<f64>,
}

impl Sensors {
    /// For a robot without a floating base, at rest at `position` at first.
    ///
    /// # Errors
    /// [`Error::WrongSize`]; [`Error::Value`] for noise that is negative or not finite, and a share
    /// that is none.
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

    /// Measures the robot as it is now. Allocates nothing.
    ///
    /// # Errors
    /// [`Error::WrongSize`] for another robot.
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
        // Lines that lose nothing draw nothing.
        let draw = if self.settings.loss > 0.0 { random.uniform() } else { 1.0 };
        self.line.pass(&self.packet, draw)?;
        Ok(())
    }

    /// q as measured last \[rad or m\].
    pub fn position(&self) -> &[f64] {
        self.part(0)
    }

    /// q̇ as measured last \[rad/s or m/s\].
    pub fn velocity(&self) -> &[f64] {
        self.part(1)
    }

    /// The torques as measured last; see [`RigidBodySimulation::torque`] \[Nm or N\].
    pub fn torque(&self) -> &[f64] {
        self.part(2)
    }

    fn part(&self, index: usize) -> &[f64] {
        let size = self.settings.position_noise.len();
        self.line.received().get(index * size..(index + 1) * size).unwrap_or_default()
    }
}
