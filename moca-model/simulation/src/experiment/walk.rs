//! What the robot sees of a simulated person, and where the person truly is.

use ergo_map::{ErgonomicsMap, FitOptions, Person};
use human_perception::random;
use moca_model::MOCA_HOME;
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use vision_models::{Body, Percept};

use super::sight::{FilmedPerson, Sight};
use crate::Error;
use crate::people::{Transport, Truth, Walker, WalkerSettings};
use crate::plant::Drive;
use crate::run::{Scenario, TrueMotion};

/// How maps are fitted: by good postures alone. The default weighs poorer ones, too, and then the optimum
/// lies above the best node of the map, for a person of 1.76 m by 0.16 m. The average map would be better
/// for tall people than their own.
pub(super) const FIT: FitOptions =
    FitOptions { region: None, temperature: 0.05, min_curvature: 1e-3 };

/// How fast people move their arms at most \[m/s\]: no faster than the robot assumes of somebody of whom it measures
/// no speed.
pub(super) const ARM_SPEED: f64 = 1.5;

/// The stream of the way from the camera to the controller.
const TRANSPORT: u64 = 200;

/// The walk of a person: camera frames, and the truth beside them.
#[derive(Clone, Debug, PartialEq)]
pub struct Walk {
    /// Camera frames in the order of their times.
    pub percepts: Vec<Percept>,
    /// The people beside the person, frame by frame; none where the list ends.
    pub others: Vec<Vec<Body>>,
    /// When each arrives \[s\].
    pub arrivals: Vec<f64>,
    /// The truth, at every time at which a camera frame was due.
    pub truth: Vec<Truth>,
    /// Where the joints truly are; none where that is not known.
    pub motion: Option<TrueMotion>,
}

impl Walk {
    /// The walk of these settings, with percepts from this source. Frames arrive 20 to 90 ms late.
    ///
    /// # Errors
    /// Settings that make no walk.
    pub fn new(settings: WalkerSettings, sight: Sight) -> Result<Self, Error> {
        let mut film = match sight {
            Sight::Modelled => None,
            Sight::Pixels => Some(FilmedPerson::new(&settings)?),
        };
        let mut transport = Transport::new(random::generator(settings.seed, TRANSPORT));
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
            // None overtakes another on the way.
            if percept.is_some() {
                others.push(film.as_ref().map(FilmedPerson::others).unwrap_or_default());
            }
            transport.send(percept, 0.0);
        }
        for (at, percept) in transport {
            arrivals.push(at);
            percepts.push(percept);
        }
        // The robot begins when the first frame is there.
        if let (Some(arrival), Some(first)) = (arrivals.first_mut(), percepts.first()) {
            *arrival = first.time;
        }
        Ok(Self { percepts, others, arrivals, truth, motion: Some(motion) })
    }

    /// The robot somewhere near home, and this walk; the person has this map.
    ///
    /// # Errors
    /// A map that cannot be fitted.
    pub fn scenario(
        &self,
        map: &ErgonomicsMap,
        drive: Drive,
        draw: &mut ChaCha8Rng,
    ) -> Result<Scenario, Error> {
        let person = Person::new(map.stature())?;
        let mut scenario = Scenario::new(self.percepts.clone(), &person, map.clone())?;
        scenario.others.clone_from(&self.others);
        scenario.arrivals.clone_from(&self.arrivals);
        scenario.truth.clone_from(&self.motion);
        (scenario.comfort, _) = map.fit(&FIT)?;
        scenario.drive = drive;
        scenario.start = start(draw);
        Ok(scenario)
    }
}

/// The home configuration, a little different, and the base a little aside and turned.
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
