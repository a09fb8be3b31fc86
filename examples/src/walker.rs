//! A simulated person, as a simulated camera reports them: what the `record` command writes down.
//!
//! The person acts out the paper's Experiments 3 and 4: comes with the object, delivers it to the
//! robot, picks a tool up, works, leads the robot along a path while working, lays the tool down
//! and leaves. The camera adds noise and loses joints and frames; the recogniser is late and
//! sometimes wrong.
//!
//! ```
//! use examples::walker::{Walker, WalkerSettings};
//!
//! let settings = WalkerSettings { duration: 10.0, ..WalkerSettings::default() };
//! let percepts: Vec<_> = Walker::new(settings)?.collect();
//! assert!(percepts.iter().any(|percept| percept.action.is_some_and(|seen| seen.action.is_collaborative())));
//! # Ok::<(), examples::walker::WalkerError>(())
//! ```

mod camera;
mod error;
mod motion;
mod path;
mod recogniser;
mod script;
mod settings;
mod skeleton;

use std::io::Write;

use nalgebra::{Point2, Vector2};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use vision_models::{Action, Percept, Tool};

pub use camera::CameraSettings;
pub use error::WalkerError;
pub use path::{WalkingPath, Waypoint};
pub use settings::WalkerSettings;

use crate::random;
use crate::recording::{Header, RecordingError, Writer};
use camera::Camera;
use motion::Motion;
use recogniser::Recogniser;
use script::Script;

/// Frames a second.
const RATE: f64 = 20.0;

/// The simulated person and camera: an iterator over the camera's percepts.
#[derive(Clone, Debug)]
pub struct Walker {
    settings: WalkerSettings,
    script: Script,
    motion: Motion,
    camera: Camera,
    recogniser: Recogniser,
    frame: u32,
}

/// Where the person of a [`Walker`] truly is and what the person does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Truth {
    /// When (s).
    pub time: f64,
    /// The floor below the pelvis, in the world (m).
    pub floor: Point2<f64>,
    /// The yaw of the forward direction (rad).
    pub heading: f64,
    /// Over the floor, in the world (m/s).
    pub velocity: Vector2<f64>,
    /// What the person does.
    pub action: Action,
}

impl Walker {
    /// A person before the first frame. The same settings give the same percepts.
    ///
    /// # Errors
    /// [`WalkerError::Setting`] names the field that is wrong.
    pub fn new(settings: WalkerSettings) -> Result<Self, WalkerError> {
        settings.validate()?;
        Ok(Self::at_pace(settings, 1.0))
    }

    /// A person of random stature on a random path for 15 s, seen by a bad camera: everything that
    /// a controller must bear. There is more noise than usual and more joints are missing, the
    /// person vanishes at least once and jumps two metres at least once.
    pub fn random(seed: u64) -> Self {
        let mut draw = generator(seed, Stream::Settings);
        let settings = WalkerSettings {
            stature: draw.random_range(1.5..2.0),
            path: WalkingPath::Random,
            tool: if draw.random_bool(0.5) { Tool::Drill } else { Tool::Polisher },
            duration: 15.0,
            seed,
            camera: CameraSettings {
                noise: draw.random_range(0.0..2.0),
                drop: draw.random_range(0.0..0.3),
                jumps: draw.random_range(1..4),
                vanishings: draw.random_range(1..3),
            },
        };
        Self::at_pace(settings, 0.5)
    }

    /// `pace` scales the time that the person takes over each step.
    fn at_pace(settings: WalkerSettings, pace: f64) -> Self {
        let mut draw = generator(settings.seed, Stream::Path);
        let camera = generator(settings.seed, Stream::Camera);
        let recogniser = generator(settings.seed, Stream::Recogniser);
        Self {
            script: Script::new(&settings, pace, &mut draw),
            motion: Motion::starting_at(script::START, script::TOWARDS_ROBOT),
            camera: Camera::new(&settings, camera),
            recogniser: Recogniser::new(settings.tool, recogniser),
            settings,
            frame: 0,
        }
    }

    /// The header of a recording of this person.
    pub fn header(&self) -> Header {
        Header { rate: RATE, stature: Some(self.settings.stature), ..Header::default() }
    }

    /// The settings.
    pub fn settings(&self) -> &WalkerSettings {
        &self.settings
    }

    /// How many frames the camera takes, lost ones included.
    pub fn expected_frames(&self) -> u64 {
        // The duration lies between 0 and an hour.
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "as above")]
        let frames = (self.settings.duration * RATE) as u64;
        frames + 1
    }

    /// Writes the rest of the walk as a recording; the number of its frames.
    ///
    /// # Errors
    /// [`RecordingError::Io`] if `output` fails.
    pub fn record<W: Write>(self, output: W) -> Result<usize, RecordingError> {
        let mut writer = Writer::new(output, &self.header())?;
        let mut frames = 0;
        for percept in self {
            writer.write(&percept)?;
            frames += 1;
        }
        writer.finish()?;
        Ok(frames)
    }

    /// The next frame as it truly is and as it is reported. `None` in place of a percept stands for
    /// a frame that the camera lost; `None` in place of both for the end.
    pub fn next_frame(&mut self) -> Option<(Truth, Option<Percept>)> {
        let time = f64::from(self.frame) / RATE;
        if time > self.settings.duration {
            return None;
        }
        self.frame += 1;
        let activity = self.script.advance(&mut self.motion, time, 1.0 / RATE);
        let action = activity.action(self.motion.velocity_in_person());
        let body = skeleton::body(self.settings.stature, &self.motion);
        let body = self.camera.see(time, &body);
        let (action_seen, surface) = self.recogniser.recognise(action, body.is_some());
        let percept = Percept { time, body, action: action_seen, surface };
        let truth = Truth {
            time,
            floor: self.motion.floor,
            heading: self.motion.heading,
            velocity: self.motion.velocity,
            action,
        };
        Some((truth, Some(percept).filter(|_| !self.camera.loses_frame())))
    }
}

impl Iterator for Walker {
    type Item = Percept;

    fn next(&mut self) -> Option<Percept> {
        loop {
            if let (_, Some(percept)) = self.next_frame()? {
                return Some(percept);
            }
        }
    }
}

/// What a generator is for. Each has its own, so that more noise does not change the path.
#[derive(Clone, Copy)]
enum Stream {
    Settings,
    Path,
    Camera,
    Recogniser,
}

fn generator(seed: u64, stream: Stream) -> ChaCha8Rng {
    random::generator(seed, stream as u64)
}
