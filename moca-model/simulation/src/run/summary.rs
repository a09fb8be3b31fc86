//! Summary of a run.

use serde::{Deserialize, Serialize};

use crate::judges::{Calmness, Margins};

/// The results of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// True if the scenario was played to its end.
    pub is_complete: bool,
    /// Simulated time \[s\].
    pub duration: f64,
    /// Time in which person and robot worked together \[s\].
    pub together: f64,
    /// Mean of e_s while working together \[-\].
    pub score_mean: f64,
    /// Part of this mean that is due to the frame that the robot holds: e_s, less e_s with the tool moved as if that
    /// frame were where the person is seen \[-\].
    pub score_of_hold: f64,
    /// Greatest e_s while working together \[-\].
    pub score_max: f64,
    /// Mean of the integer REBA while working together \[-\].
    pub reba_mean: f64,
    /// Greatest integer REBA while working together \[-\].
    pub reba_max: u8,
    /// REBA of the person's posture from the recorded joints while working together; `None` if it was not seen.
    pub reba_measured: Option<MeasuredReba>,
    /// Root mean square of the distance from the actual to the desired position \[mm\].
    pub tracking_error_rms_mm: f64,
    /// Time of working together with x_d outside the shared workspace by over a millimetre or milliradian \[s\].
    pub outside: f64,
    /// Time of working together in which the person's hand could not reach the tool \[s\].
    pub out_of_reach: f64,
    /// The worst margins.
    pub margins: Margins,
    /// Ticks with a violated limit or a command that was not finite.
    pub limit_violations: u64,
    /// Those of these ticks with too large a joint jerk.
    pub jerk_violations: u64,
    /// Ticks with too large a torque or torque rate; `None` for a robot without torques.
    pub torque_violations: Option<u64>,
    /// Number of protective stops.
    pub protective_stops: u64,
    /// Number of retreats from a person who was too close.
    pub retreats: u64,
    /// True if the person's true motion is known, so that it judges distances.
    pub truth: bool,
    /// Ticks in which the robot approached a part of the person within the protective distance, unless it may touch it.
    /// The truth judges this, or the camera if the truth is not known.
    pub separation_violations: u64,
    /// 99.9 % quantile of the robot's own approach speed to touchable parts within 5 cm \[m/s\]; `None` without such
    /// ticks, or without the truth.
    pub contact_speed: Option<f64>,
    /// Stillness of the robot while the person stood, and its smoothness while they walked. Empty if their true motion
    /// is not known.
    pub calmness: Calmness,
    /// Ticks whose hierarchy was not solved to its optimum.
    pub solver_failures: u64,
    /// Median, 99th percentile and maximum of the controller's time in a tick \[µs\].
    pub tick_us: [f64; 3],
    /// Wall time of the loop \[s\].
    pub wall: f64,
}

/// REBA of a measured posture.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MeasuredReba {
    /// Mean over time.
    pub mean: f64,
    /// The worst value.
    pub max: u8,
}
