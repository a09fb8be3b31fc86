//! Times at which the parts of a percept were seen and known.

use serde::{Deserialize, Serialize};
use vision_models::Percept;

/// The times at which one part of a percept was seen and known, on the clock of the recording.
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
    /// Time at which the camera took the newest image that was used (s). The frame's time if
    /// missing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub captured: Option<f64>,
    /// Time at which the result was available (s), if it is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub arrived: Option<f64>,
}

/// The times at which the parts of a percept were seen and known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Timing {
    /// Time at which the body was available (s), if it is known. It was seen at the frame's time.
    pub arrived: Option<f64>,
    /// Times of the action.
    pub action: Stamp,
    /// Times of the surface.
    pub surface: Stamp,
}

impl Timing {
    /// Returns the time at which all parts of a percept of this time (s) are available (s).
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

/// Returns the times at which all parts of each percept are available \[s\]. None is before that of
/// an earlier percept.
pub fn arrivals(percepts: &[Percept], timings: &[Timing]) -> Vec<f64> {
    let mut latest = f64::NEG_INFINITY;
    let both = percepts.iter().zip(timings);
    both.map(|(percept, timing)| {
        latest = timing.available(percept.time).max(latest);
        latest
    })
    .collect()
}
