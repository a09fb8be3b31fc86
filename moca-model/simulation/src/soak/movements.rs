//! People who lean, sit, reach and turn beside the robot: each movement of many people, judged by their true joints.

use std::fmt;
use std::ops::ControlFlow;

use moca_model::moca;
use rand::RngCore;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use serde::Serialize;
use simulated_people::Movement;

use super::episode::Episode;
use crate::error::Error;
use crate::plant::PlantSettings;
use crate::quantile::quantile;

/// Ticks with each person.
const TICKS: u64 = 8_000;

/// Settings of a run in which people make each movement. The same seed gives the same ticks.
#[derive(Clone, Debug)]
pub struct Movements {
    /// Seed of everything random.
    pub seed: u64,
    /// Number of people who make each movement; every other one works with the robot.
    pub people: u64,
    /// The robot.
    pub robot: PlantSettings,
}

/// Result of a movement.
#[derive(Clone, Debug, Serialize)]
pub struct MovementResult {
    /// Name of the movement.
    pub movement: &'static str,
    /// Number of people who made it.
    pub people: u64,
    /// Ticks run.
    pub ticks: u64,
    /// Ticks too near, and the robot to blame.
    pub too_near: u64,
    /// Ticks too near by the person's own motion.
    pub person_caused: u64,
    /// Ticks nearer than the protective distance to a part that may be touched.
    pub contact: u64,
    /// Ticks with anything else wrong.
    pub wrong: u64,
    /// Ticks with a part within 5 cm that may be touched.
    pub within: u64,
    /// Speed of the robot's own approach to it, at most in 99.9 % of those ticks \[m/s\].
    pub contact_speed: Option<f64>,
}

/// Results of all movements.
#[derive(Clone, Debug, Serialize)]
pub struct MovementResults {
    /// Result of each movement.
    pub movements: Vec<MovementResult>,
    /// Speed that 99.9 % of all contacts do not exceed \[m/s\].
    pub contact_speed: Option<f64>,
    /// The first tick with something wrong of each person, in words.
    pub findings: Vec<String>,
}

impl Movements {
    /// Ticks in all.
    pub fn ticks(&self) -> u64 {
        self.people * TICKS * Movement::ALL.len() as u64
    }

    /// Runs them, people by people; `each` is told how many ticks are done, and may end it there.
    ///
    /// # Errors
    /// A controller that refuses its settings or what it measures.
    pub fn run(
        &self,
        mut each: impl FnMut(u64) -> ControlFlow<()>,
    ) -> Result<MovementResults, Error> {
        let model = moca()?;
        let mut draw = ChaCha8Rng::seed_from_u64(self.seed);
        let mut results = Movement::ALL.map(|movement| (MovementResult::new(movement), Vec::new()));
        let (mut done, mut findings, mut flow) = (0, Vec::new(), ControlFlow::Continue(()));
        for person in 0..self.people {
            for (movement, (result, speeds)) in Movement::ALL.into_iter().zip(&mut results) {
                let (seed, together) = (draw.next_u64(), person % 2 == 0);
                if flow.is_break() {
                    break;
                }
                let what = (movement, together);
                let mut episode = Episode::repeating(&model, seed, what, &self.robot)?;
                for _ in 0..TICKS {
                    episode.step()?;
                    if let Some(finding) = episode.first_wrong() {
                        let name = movement.name();
                        findings.push(format!("person {} of {name}, {finding}", person + 1));
                    }
                }
                done += TICKS;
                flow = each(done);
                result.add(&episode);
                speeds.append(&mut episode.monitor.contact_speeds);
            }
        }
        let mut all = Vec::new();
        let movements = results.into_iter().map(|(result, mut speeds)| {
            let contact_speed = quantile(&mut speeds, 999);
            all.append(&mut speeds);
            MovementResult { contact_speed, ..result }
        });
        let movements = movements.collect();
        Ok(MovementResults { movements, contact_speed: quantile(&mut all, 999), findings })
    }
}

impl MovementResult {
    fn new(movement: Movement) -> Self {
        Self {
            movement: movement.name(),
            people: 0,
            ticks: 0,
            too_near: 0,
            person_caused: 0,
            contact: 0,
            wrong: 0,
            within: 0,
            contact_speed: None,
        }
    }

    fn add(&mut self, episode: &Episode) {
        let counts = &episode.monitor.counts;
        self.people += 1;
        self.ticks += TICKS;
        self.too_near += counts.separation_violations;
        self.person_caused += counts.person_caused;
        self.contact += counts.contact;
        self.wrong += counts.wrong() - counts.separation_violations;
        self.within += episode.monitor.contact_speeds.len() as u64;
    }
}

impl MovementResults {
    /// Ticks with something wrong.
    pub fn wrong(&self) -> u64 {
        self.movements.iter().map(|result| result.too_near + result.wrong).sum()
    }
}

impl fmt::Display for MovementResults {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{:<15}{:>7}{:>10}{:>10}{:>10}{:>9}{:>7}{:>10}{:>13}",
            "movement",
            "people",
            "ticks",
            "too near",
            "person's",
            "contact",
            "wrong",
            "in 5 cm",
            "99.9 % [m/s]"
        )?;
        for result in &self.movements {
            write!(f, "{:<15}{:>7}{:>10}", result.movement, result.people, result.ticks)?;
            write!(f, "{:>10}{:>10}", result.too_near, result.person_caused)?;
            write!(f, "{:>9}{:>7}{:>10}", result.contact, result.wrong, result.within)?;
            match result.contact_speed {
                Some(speed) => writeln!(f, "{speed:>13.3}")?,
                None => writeln!(f, "{:>13}", "-")?,
            }
        }
        match self.contact_speed {
            Some(speed) => write!(f, "approach within 5 cm, 99.9 % of the ticks: {speed:.3} m/s"),
            None => write!(f, "nobody came within 5 cm"),
        }
    }
}
