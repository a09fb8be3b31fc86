//! The parameters of following several people.

use nalgebra::Point2;

use crate::error::Error;

/// The parameters of [`People`](crate::People).
///
/// ```
/// use vision_models::PeopleSettings;
///
/// let settings = PeopleSettings { release: 5.0, ..PeopleSettings::default() };
/// assert!(settings.validate().is_ok());
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PeopleSettings {
    /// Workplace on the floor (m). Default (0.8, 0): in front of MOCA's first place.
    pub place: Point2<f64>,
    /// Largest distance from the workplace at which a person can engage (m). Default 3.
    pub radius: f64,
    /// Largest angle between the person's heading and the workplace for engaging (rad). Default
    /// 1.2.
    pub facing: f64,
    /// Time for which a person must be near and face the workplace to engage (s). Default 0.3.
    pub dwell: f64,
    /// Distance beyond which an engaged person is released (m). Default 6.
    pub release: f64,
    /// Time for which an unseen engaged person is kept, unless another person engages (s).
    /// Default 2.
    pub keep: f64,
    /// Largest movement of a person between two frames (m). Default 0.6.
    pub reach: f64,
    /// Distance below which two bodies count as one person (m). Default 0.25.
    pub separate: f64,
    /// Largest number of people who are followed. Default 8.
    pub most: usize,
}

impl Default for PeopleSettings {
    fn default() -> Self {
        Self {
            place: Point2::new(0.8, 0.0),
            radius: 3.0,
            facing: 1.2,
            dwell: 0.3,
            release: 6.0,
            keep: 2.0,
            reach: 0.6,
            separate: 0.25,
            most: 8,
        }
    }
}

impl PeopleSettings {
    /// Returns the settings for [`People::identify`](crate::People::identify), with a reach of
    /// 0.2 m: 1.6 m/s, the speed of walking of ISO 13855, for 0.05 s, and 0.12 m of noise. A person
    /// who appears farther away from where another one is expected is somebody new.
    #[must_use]
    pub fn untracked() -> Self {
        Self { reach: 0.2, ..Self::default() }
    }

    /// Checks every field.
    ///
    /// # Errors
    /// [`Error::Value`] names the first field that is NaN or outside its range.
    pub fn validate(&self) -> Result<(), Error> {
        let within = |name, value: f64, low: f64, high: f64, expected| {
            if value >= low && value <= high {
                Ok(())
            } else {
                Err(Error::value(name, value, expected))
            }
        };
        for coordinate in self.place.iter() {
            within("place", *coordinate, -1e3, 1e3, "a place within 1000 m")?;
        }
        within("radius", self.radius, 0.1, 1e3, "a distance in [0.1, 1000] m")?;
        within("facing", self.facing, 0.0, 4.0, "an angle in [0, 4] rad")?;
        within("dwell", self.dwell, 0.0, 60.0, "a time in [0, 60] s")?;
        within("release", self.release, self.radius, 1e3, "a distance from radius to 1000 m")?;
        within("keep", self.keep, 0.0, 60.0, "a time in [0, 60] s")?;
        within("reach", self.reach, 1e-2, 10.0, "a distance in [0.01, 10] m")?;
        within("separate", self.separate, 0.0, 10.0, "a distance in [0, 10] m")?;
        within("most", self.most as f64, 1.0, 64.0, "1 to 64 people")
    }
}
