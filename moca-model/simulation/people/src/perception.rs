//! Perception of a person by camera and recogniser.

use rand_chacha::ChaCha8Rng;
use vision_models::{Percept, PersonId, Tool};

use super::camera::{Camera, CameraSettings};
use super::person::Person;
use super::recogniser::Recogniser;

/// Camera frames a second.
pub const FRAME_RATE: f64 = 20.0;

/// A camera with its networks, and a tracker that never loses the person. The same draws give the
/// same percepts.
#[derive(Clone, Debug)]
pub struct Perception {
    id: PersonId,
    camera: Camera,
    recogniser: Recogniser,
}

impl Perception {
    /// Creates a camera that looks for `duration` \[s\], over which its jumps and vanishings are spread. The person has
    /// this id. `tool` is the one for the surface that faces the on-board camera.
    pub fn new(
        id: PersonId,
        settings: CameraSettings,
        duration: f64,
        tool: Tool,
        [camera, recogniser]: [ChaCha8Rng; 2],
    ) -> Self {
        Self {
            id,
            camera: Camera::new(settings, duration, camera),
            recogniser: Recogniser::new(tool, recogniser),
        }
    }

    /// The camera sees as these settings say from now on; jumps and vanishings stay as they are.
    pub fn set_camera(&mut self, settings: CameraSettings) {
        self.camera.set(settings);
    }

    /// The frame at `time` (s) of a person who is in view or not; `None` if it is lost. To be
    /// called at each frame, in the order of time.
    pub fn look(&mut self, time: f64, person: &Person, in_view: bool) -> Option<Percept> {
        // The random numbers are always drawn, so that later ones do not depend on what is seen.
        let body = self.camera.see(time, &person.joints()).filter(|_| in_view);
        let body = body.map(|body| body.with_id(self.id));
        let (action, surface) = self.recogniser.recognise(person.action(), body.is_some());
        let percept = Percept { time, body, action, surface };
        (!self.camera.loses_frame()).then_some(percept)
    }
}
