//! A person who acts out the paper's Experiments 3 and 4, as the camera reports them.

use std::sync::Arc;

use nalgebra::{Point2, Vector2};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use vision_models::{Action, Percept, PersonId, Tool};

use super::activity::Activity;
use super::camera::CameraSettings;
use super::joints::Joints;
use super::motion::Gait;
use super::path::{TOWARDS_ROBOT, WalkingPath};
use super::perception::{FRAME_RATE, Perception};
use super::person::Person;
use super::script::{self, Script};
use super::settings::{Occupation, WalkerSettings};
use crate::error::Error;
use percept_recording::Header;

/// The simulated person and camera: an iterator over the camera's percepts.
#[derive(Clone, Debug)]
pub struct Walker {
    settings: WalkerSettings,
    script: Script,
    person: Person,
    perception: Perception,
    frame: u32,
    /// Places of the joints since the last frame, and their times \[s, m\].
    motion: Vec<(f64, Joints)>,
    movements: ChaCha8Rng,
    /// Time from which on the next movement may begin \[s\].
    next_movement: f64,
}

/// Number of samples of the joints between two frames.
const BETWEEN: u32 = 5;
/// Time from the end of a movement to the next one \[s\].
const PAUSE: std::ops::Range<f64> = 1.0..3.0;
/// Speed below which the person stands \[m/s\].
const STANDING: f64 = 0.05;

/// The true place and action of the person of a [`Walker`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Truth {
    /// Time \[s\].
    pub time: f64,
    /// The point on the floor below the pelvis, as [`Person::floor`], in the world \[m\].
    pub floor: Point2<f64>,
    /// The yaw of the forward direction \[rad\].
    pub heading: f64,
    /// Velocity of that point, in the world \[m/s\].
    pub velocity: Vector2<f64>,
    /// The person's action.
    pub action: Action,
}

impl Walker {
    /// Creates a person before the first frame. The same settings give the same percepts.
    ///
    /// # Errors
    /// [`Error::Value`] names the field that is wrong.
    pub fn new(settings: WalkerSettings) -> Result<Self, Error> {
        settings.validate()?;
        Ok(Self::at_pace(settings, 1.0))
    }

    /// Creates a person of random stature on a random path for 15 s, seen by a bad camera, as a controller must
    /// tolerate it. There is more noise than usual and more joints are missing. The person vanishes at least once and
    /// jumps two metres at least once.
    pub fn random(seed: u64) -> Self {
        let mut draw = generator(seed, Stream::Settings);
        let settings = WalkerSettings {
            stature: draw.random_range(1.5..2.0),
            path: WalkingPath::Random,
            tool: if draw.random_bool(0.5) { Tool::Drill } else { Tool::Polisher },
            occupation: Occupation::Working,
            offer: 3.0,
            speed: None,
            arm_speed: None,
            movement: None,
            motion: None,
            sway: 1.0,
            duration: 15.0,
            seed,
            camera: CameraSettings {
                noise: draw.random_range(0.0..2.0),
                drop: draw.random_range(0.0..0.3),
                jumps: draw.random_range(1..4),
                vanishings: draw.random_range(1..3),
                lasting: CameraSettings::LASTING,
                ..CameraSettings::default()
            },
        };
        Self::at_pace(settings, 0.5)
    }

    /// Creates a person whose step times are scaled by `pace`.
    fn at_pace(mut settings: WalkerSettings, pace: f64) -> Self {
        let mut draw = generator(settings.seed, Stream::Path);
        let eyes = [Stream::Camera, Stream::Recogniser];
        let eyes = eyes.map(|stream| generator(settings.seed, stream));
        let activity = match settings.occupation {
            Occupation::Working => Activity::CarryObject,
            Occupation::Walking => Activity::Walk,
        };
        let gait = Gait {
            arm_speed: settings.arm_speed.unwrap_or(f64::INFINITY),
            sway: settings.sway,
            ..Gait::NATURAL
        };
        let person = match &settings.motion {
            Some(motion) => Person::performing(Arc::clone(motion), activity),
            None => {
                Person::standing(settings.stature, script::START, TOWARDS_ROBOT, gait, activity)
            }
        };
        settings.stature = person.stature();
        Self {
            script: Script::new(&settings, pace, &mut draw),
            person,
            perception: Perception::new(
                PersonId::new(0),
                settings.camera,
                settings.duration,
                settings.tool,
                eyes,
            ),
            movements: generator(settings.seed, Stream::Movements),
            next_movement: 0.0,
            motion: Vec::new(),
            settings,
            frame: 0,
        }
    }

    /// The header of a recording of this person.
    pub fn header(&self) -> Header {
        Header { rate: FRAME_RATE, stature: Some(self.settings.stature), ..Header::default() }
    }

    /// The header of a recording of the true joints.
    pub fn true_header(&self) -> Header {
        Header { rate: FRAME_RATE * f64::from(BETWEEN), ..self.header() }
    }

    /// The settings.
    pub fn settings(&self) -> &WalkerSettings {
        &self.settings
    }

    /// The person in the last frame.
    pub fn person(&self) -> &Person {
        &self.person
    }

    /// The number of frames of the camera, with lost ones.
    pub fn expected_frames(&self) -> u64 {
        // The duration is between 0 and an hour.
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "as above")]
        let frames = (self.settings.duration * FRAME_RATE) as u64;
        frames + 1
    }

    /// Returns the true next frame and its report. `None` in place of a percept stands for a frame that the camera
    /// lost, `None` in place of both for the end.
    pub fn next_frame(&mut self) -> Option<(Truth, Option<Percept>)> {
        let time = f64::from(self.frame) / FRAME_RATE;
        if time > self.settings.duration {
            return None;
        }
        self.frame += 1;
        let interval = 1.0 / FRAME_RATE;
        let (goal, activity) = self.script.advance(&self.person, time);
        self.move_on_the_spot(time);
        self.motion.clear();
        let (mut between, part) = (self.person.clone(), interval / f64::from(BETWEEN));
        for step in (1..BETWEEN).rev().filter(|_| time > 0.0) {
            between.advance(&goal, activity, part);
            self.motion.push((time - f64::from(step) * part, between.joints()));
        }
        let person = &mut self.person;
        person.advance(&goal, activity, interval);
        self.motion.push((time, person.joints()));
        let truth = Truth {
            time,
            floor: person.floor(),
            heading: person.heading(),
            velocity: person.velocity(),
            action: person.action(),
        };
        Some((truth, self.perception.look(time, person, true)))
    }

    /// The true motion of the joints at 100 Hz between the last two frames, with times \[s, m\].
    pub fn motion(&self) -> &[(f64, Joints)] {
        &self.motion
    }

    /// Starts the movement of the settings where the person stands and works.
    fn move_on_the_spot(&mut self, time: f64) {
        let Some(movement) = self.settings.movement else { return };
        if self.person.is_busy() {
            self.next_movement = time + self.movements.random_range(PAUSE);
        } else if self.script.is_leading()
            && self.person.velocity().norm() < STANDING
            && time >= self.next_movement
        {
            self.person.begin(movement, &mut self.movements);
        }
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

/// The purpose of a generator. Each purpose has its own, so that more noise does not change the path.
#[derive(Clone, Copy)]
enum Stream {
    Settings,
    Path,
    Camera,
    Recogniser,
    Movements,
}

fn generator(seed: u64, stream: Stream) -> ChaCha8Rng {
    crate::generator::generator(seed, stream as u64)
}
