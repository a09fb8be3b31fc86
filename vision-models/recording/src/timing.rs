//! When what a percept says was seen and known.

use serde::{Deserialize, Serialize};
use vision_models::Percept;

/// When one part of a percept was seen and known, on the clock of the recording.
///
/// ```
/// use percept_recording::Stamp;
///
/// // Of a clip that ended at 7.2 s, known at 7.5 s: 0.3 s old when it came.
/// let stamp = Stamp { captured: Some(7.2), arrived: Some(7.5) };
/// assert_ne!(stamp, Stamp::default());
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Stamp {
    /// When the camera took the newest image that it was made of (s); that of the frame where it is not
    /// said.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub captured: Option<f64>,
    /// When it was there to be acted on (s), where it is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub arrived: Option<f64>,
}

/// When each part of a percept was seen and known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Timing {
    /// When the body was there to be acted on (s), where it is known; the frame's time is when it was seen.
    pub arrived: Option<f64>,
    /// Of the action.
    pub action: Stamp,
    /// Of the surface.
    pub surface: Stamp,
}

impl Timing {
    /// When all of a percept of this time (s) is there to be acted on (s).
    ///
    /// ```
    /// use percept_recording::Timing;
    ///
    /// assert_eq!(Timing::default().available(1.0), 1.0);
    /// assert_eq!(Timing { arrived: Some(1.08), ..Timing::default() }.available(1.0), 1.08);
    /// ```
    pub fn available(&self, time: f64) -> f64 {
        let arrivals = [self.arrived, self.action.arrived, self.surface.arrived];
        arrivals.into_iter().flatten().fold(time, f64::max)
    }
}

/// When all of each percept is there to be acted on \[s\]: none before one that was seen earlier.
pub fn arrivals(percepts: &[Percept], timings: &[Timing]) -> Vec<f64> {
    let mut latest = f64::NEG_INFINITY;
    let both = percepts.iter().zip(timings);
    both.map(|(percept, timing)| {
        latest = timing.available(percept.time).max(latest);
        latest
    })
    .collect()
}
