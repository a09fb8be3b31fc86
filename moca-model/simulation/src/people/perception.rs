//! What perception reports of a person: camera and recogniser together.

use rand_chacha::ChaCha8Rng;
use vision_models::{Percept, Tool};

use super::camera::{Camera, CameraSettings};
use super::person::Person;
use super::recogniser::Recogniser;

/// Frames a second.
pub const FRAME_RATE: f64 = 20.0;

/// A camera with the networks behind it. The same draws give the same percepts.
#[derive(Clone, Debug)]
pub struct Perception {
    camera: Camera,
    recogniser: Recogniser,
}

impl Perception {
    /// Looks on for `duration` (s), over which the camera's jumps and vanishings are spread.
    /// `tool` is the one that the surface facing the on-board camera is for.
    pub fn new(
        settings: CameraSettings,
        duration: f64,
        tool: Tool,
        [camera, recogniser]: [ChaCha8Rng; 2],
    ) -> Self {
        Self {
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
        // Drawn in any case, so that what follows does not depend on what is seen.
        let body = self.camera.see(time, &person.joints()).filter(|_| in_view);
        let (action, surface) = self.recogniser.recognise(person.action(), body.is_some());
        let percept = Percept { time, body, action, surface };
        (!self.camera.loses_frame()).then_some(percept)
    }
}
