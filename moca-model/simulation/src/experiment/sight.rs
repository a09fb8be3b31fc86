//! Perception of a simulated person.

use human_perception::percepts::{Perceiver, PerceiverSettings};
use serde::{Deserialize, Serialize};
use simulated_people::WalkerSettings;
use vision_models::{Body, Percept};

use crate::error::Error;
use crate::rendering::{Film, Viewpoint};

/// Width and height of the frames.
const SIZE: [usize; 2] = [640, 480];

/// The way in which the robot perceives a simulated person's joints.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Sight {
    /// A model of camera and pose network reports them.
    #[default]
    Modelled,
    /// Rendered frames are processed as by the program `perceive`.
    Pixels,
}

/// Films a person and finds their joints in the frames as `perceive` does. A simulated pose network gives the joints in
/// the image. They are lifted by the measured depth and tracked from frame to frame.
#[derive(Debug)]
pub(super) struct FilmedPerson {
    film: Film,
    perceiver: Perceiver,
}

impl FilmedPerson {
    /// Creates a person before the first frame, seen from the front.
    pub(super) fn new(settings: &WalkerSettings) -> Result<Self, Error> {
        let perception = PerceiverSettings::default();
        let pixel_sigma = perception.lifting.pixel_sigma;
        let film = Film::new(settings.clone(), Viewpoint::Facing, SIZE, pixel_sigma)?;
        let perceiver = Perceiver::new(*film.camera(), perception)?;
        Ok(Self { film, perceiver })
    }

    /// Films the next frame and returns `percept` with the joints that were found in it as its body. `None` stands for
    /// a frame that the camera lost.
    pub(super) fn see(&mut self, percept: Option<Percept>) -> Result<Option<Percept>, Error> {
        let (Some(shot), Some(percept)) = (self.film.next().transpose()?, percept) else {
            return Ok(None);
        };
        let people: Vec<_> = shot.skeleton.into_iter().collect();
        self.perceiver.see(shot.entry.time, &people, &shot.depth)?;
        Ok(Some(Percept { body: self.perceiver.body().cloned(), ..percept }))
    }

    /// The other people in that frame. Before the person engages, they are one of them.
    pub(super) fn others(&self) -> Vec<Body> {
        self.perceiver.others().cloned().collect()
    }
}
