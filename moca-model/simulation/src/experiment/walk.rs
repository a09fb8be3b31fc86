//! The percepts of a simulated person, and the person's true motion.

use ergo_map::{ErgonomicsMap, FitOptions, Person};
use moca_model::MOCA_HOME;
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use simulated_people::{Transport, Truth, Walker, WalkerSettings};
use vision_models::{Body, Percept};

use super::conditions::Conditions;
use super::sight::{FilmedPerson, Sight};
use crate::error::Error;
use crate::run::{Scenario, TrueMotion};

/// Options by which maps are fitted: only good postures count. The default also weighs poorer ones. The optimum then
/// lies above the best node of the map, and the average map would be better for tall people than their own.
pub(super) const FIT: FitOptions =
    FitOptions { region: None, temperature: 0.05, min_curvature: 1e-3 };

/// Largest speed of people's arms \[m/s\]. It does not exceed what the robot assumes for a person without a measured
/// speed.
pub(super) const ARM_SPEED: f64 = 1.5;

/// Random stream of the transport from the camera to the controller.
const TRANSPORT: u64 = 200;

/// The walk of a person: camera frames, and the truth.
#[derive(Clone, Debug, PartialEq)]
pub struct Walk {
    /// Camera frames in the order of their times.
    pub percepts: Vec<Percept>,
    /// The other people, frame by frame; nobody after the end of the list.
    pub others: Vec<Vec<Body>>,
    /// Arrival times \[s\].
    pub arrivals: Vec<f64>,
    /// The truth at every time at which a camera frame was due.
    pub truth: Vec<Truth>,
    /// The true motion of the joints; `None` if it is not known.
    pub motion: Option<TrueMotion>,
}

impl Walk {
    /// Creates the walk of these settings with percepts from this source. Frames arrive 20 to 90 ms late.
    ///
    /// # Errors
    /// Settings that make no walk.
    pub fn new(settings: WalkerSettings, sight: Sight) -> Result<Self, Error> {
        let mut film = match sight {
            Sight::Modelled => None,
            Sight::Pixels => Some(FilmedPerson::new(&settings)?),
        };
        let mut transport = Transport::new(simulated_people::generator(settings.seed, TRANSPORT));
        let mut walker = Walker::new(settings)?;
        let (mut percepts, mut others) = (Vec::new(), Vec::new());
        let (mut arrivals, mut truth) = (Vec::new(), Vec::new());
        let mut motion = TrueMotion::default();
        while let Some((person, percept)) = walker.next_frame() {
            truth.push(person);
            for &(time, joints) in walker.motion() {
                motion.push(time, joints);
            }
            let percept = match &mut film {
                Some(film) => film.see(percept)?,
                None => percept,
            };
            let others = film.as_ref().map(FilmedPerson::others).unwrap_or_default();
            transport.send(percept.map(|percept| (percept, others)), 0.0);
        }
        for (at, (percept, seen)) in transport {
            arrivals.push(at);
            percepts.push(percept);
            others.push(seen);
        }
        // The robot starts when the first frame has arrived.
        if let (Some(arrival), Some(first)) = (arrivals.first_mut(), percepts.first()) {
            *arrival = first.time;
        }
        Ok(Self { percepts, others, arrivals, truth, motion: Some(motion) })
    }

    /// Creates a scenario with the robot near home and this walk, under these conditions. The person has this map.
    ///
    /// # Errors
    /// A map that cannot be fitted.
    pub fn scenario(
        &self,
        map: &ErgonomicsMap,
        conditions: Conditions,
        draw: &mut ChaCha8Rng,
    ) -> Result<Scenario, Error> {
        let person = Person::new(map.stature())?;
        let mut scenario = Scenario::new(self.percepts.clone(), &person, map.clone())?
            .among(self.others.clone())?;
        scenario.arrivals.clone_from(&self.arrivals);
        scenario.truth.clone_from(&self.motion);
        (scenario.ergonomics, _) = map.fit(&FIT)?;
        scenario.drive = conditions.drive;
        scenario.start = start(draw);
        Ok(conditions.control(scenario))
    }
}

/// The home configuration with small random changes, and the base slightly displaced and rotated.
fn start(draw: &mut ChaCha8Rng) -> Vec<f64> {
    let mut start = MOCA_HOME.to_vec();
    for (joint, q) in start.iter_mut().enumerate() {
        let reach = match joint {
            0 | 1 => 0.25,
            2 => 0.4,
            _ => 0.2,
        };
        *q += draw.random_range(-reach..reach);
    }
    start
}
