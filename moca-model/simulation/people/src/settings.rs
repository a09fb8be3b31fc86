//! Settings of a walk.

use std::sync::Arc;

use vision_models::Tool;

use super::camera::CameraSettings;
use super::captured::CapturedMotion;
use super::movement::Movement;
use super::path::WalkingPath;
use crate::error::{Error, in_range};

/// The person's purpose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Occupation {
    /// Delivers the object, and works on it with the tool while leading the robot.
    Working,
    /// Walk along the path, with empty hands.
    Walking,
}

/// Settings of a walk: the person, the path and the camera. The defaults make the recording that the repository ships.
///
/// ```
/// use simulated_people::{Walker, WalkerSettings};
///
/// let settings = WalkerSettings { stature: -1.75, ..WalkerSettings::default() };
/// let error = Walker::new(settings).unwrap_err();
/// assert_eq!(error.to_string(), "stature = -1.75: give 1 to 2.3 m");
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct WalkerSettings {
    /// Stature of the person \[m\], unless there is a `motion`. Default 1.75.
    pub stature: f64,
    /// Path along which the person leads the robot. Default [`WalkingPath::Stations`].
    pub path: WalkingPath,
    /// Tool of the person. Default [`Tool::Drill`].
    pub tool: Tool,
    /// Purpose of the person. Default [`Occupation::Working`].
    pub occupation: Occupation,
    /// Time for which the person offers the object, before scaling by their random pace \[s\]. Default 3.
    pub offer: f64,
    /// Walking speed \[m/s\]. Default 0.8 to come and go and 0.3 to lead the robot.
    pub speed: Option<f64>,
    /// Largest speed of any part of the arms \[m/s\]. Default: no limit.
    pub arm_speed: Option<f64>,
    /// Movement on the spot that the person repeats where they stand and work. Default none.
    pub movement: Option<Movement>,
    /// Motion of a real person, in place of walking and working. Their actions are those of the occupation. Their stature
    /// is that of the motion. Default none.
    pub motion: Option<Arc<CapturedMotion>>,
    /// Motion of the pelvis about its mean place, as a share of that of real people ([`Gait::sway`](super::Gait::sway)).
    /// Default 0.
    pub sway: f64,
    /// Duration of the recording \[s\]. The person repeats the path until it is time to leave. Default 56.
    pub duration: f64,
    /// Seed of all random numbers. Default 1.
    pub seed: u64,
    /// Quality of the camera.
    pub camera: CameraSettings,
}

impl Default for WalkerSettings {
    fn default() -> Self {
        Self {
            stature: 1.75,
            path: WalkingPath::Stations,
            tool: Tool::Drill,
            occupation: Occupation::Working,
            offer: 3.0,
            speed: None,
            arm_speed: None,
            movement: None,
            motion: None,
            sway: 0.0,
            duration: 56.0,
            seed: 1,
            camera: CameraSettings::default(),
        }
    }
}

impl WalkerSettings {
    /// Checks every field.
    ///
    /// # Errors
    /// [`Error::Value`] names the field that is wrong, [`Error::Path`] the path.
    pub fn validate(&self) -> Result<(), Error> {
        let stature = self.motion.as_ref().map_or(self.stature, |motion| motion.stature());
        in_range("stature", stature, 1.0..=2.3, "1 to 2.3 m")?;
        if let Some(speed) = self.speed {
            in_range("speed", speed, 0.1..=2.0, "0.1 to 2 m/s")?;
        }
        if let Some(speed) = self.arm_speed {
            in_range("arm_speed", speed, 0.5..=f64::INFINITY, "0.5 m/s or more")?;
        }
        in_range("offer", self.offer, 0.0..=3600.0, "0 to 3600 s")?;
        in_range("duration", self.duration, 0.0..=3600.0, "0 to 3600 s")?;
        in_range("sway", self.sway, 0.0..=3.0, "a factor of 0 to 3")?;
        in_range("noise", self.camera.noise, 0.0..=10.0, "a factor of 0 to 10")?;
        in_range("lasting", self.camera.lasting, 0.0..=1.0, "a share of 0 to 1")?;
        let largest = self.camera.largest_error;
        in_range("largest_error", largest, 0.0..=f64::INFINITY, "0 m or more")?;
        if let Some(spacing) = self.camera.spacing {
            in_range("spacing", spacing, 0.1..=1000.0, "0.1 to 1000 m")?;
        }
        in_range("drop", self.camera.drop, 0.0..=1.0, "a probability of 0 to 1")?;
        in_range("jump", self.camera.jumps.into(), 0.0..=1000.0, "0 to 1000 jumps")?;
        in_range("vanish", self.camera.vanishings.into(), 0.0..=1000.0, "0 to 1000 times")?;
        self.path.validate()
    }
}
