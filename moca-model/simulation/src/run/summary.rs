//! A run in a few numbers.

use serde::{Deserialize, Serialize};

use crate::judges::{Calmness, Margins};

/// What a run came to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Whether the scenario was played to its end.
    pub is_complete: bool,
    /// Simulated time \[s\].
    pub duration: f64,
    /// Time in which person and robot worked together \[s\].
    pub together: f64,
    /// Mean of e_s while working together \[-\].
    pub score_mean: f64,
    /// Greatest e_s while working together \[-\].
    pub score_max: f64,
    /// Mean of the integer REBA while working together \[-\].
    pub reba_mean: f64,
    /// Greatest integer REBA while working together \[-\].
    pub reba_max: u8,
    /// REBA of the person's posture as the joints in the recording measure it, while working together;
    /// none if it was not seen.
    pub reba_measured: Option<MeasuredReba>,
    /// Root mean square of the distance from the actual to the desired position \[mm\].
    pub tracking_error_rms_mm: f64,
    /// Time of working together with x_d out of the shared workspace by over a millimetre or
    /// milliradian \[s\].
    pub outside: f64,
    /// Time of working together in which the person's hand could not reach the tool \[s\].
    pub out_of_reach: f64,
    /// The worst margins.
    pub margins: Margins,
    /// Ticks with a violated limit or a command that was not finite.
    pub limit_violations: u64,
    /// Ticks of these in which a joint's jerk was too large.
    pub jerk_violations: u64,
    /// Ticks in which a torque, or its change, was too large; none for a robot without torques.
    pub torque_violations: Option<u64>,
    /// How often a protective stop began.
    pub protective_stops: u64,
    /// How often a retreat from somebody who was too close began.
    pub retreats: u64,
    /// Whether it is known where the person truly is, so that distances are judged by that.
    pub truth: bool,
    /// Ticks in which the robot came nearer to a part of the person than the protective distance, unless it may
    /// touch it: by the truth, or where that is not known as the camera showed it.
    pub separation_violations: u64,
    /// How fast the robot itself comes nearer to parts within 5 cm that it may touch, at most in 99.9 % of the ticks
    /// with such a part \[m/s\]; none without one, or without the truth.
    pub contact_speed: Option<f64>,
    /// How still the robot was while the person stood, and how smooth while they walked; empty where nobody knows where
    /// they truly were.
    pub calmness: Calmness,
    /// Ticks whose hierarchy was not solved to its optimum.
    pub solver_failures: u64,
    /// Median, 99th percentile and maximum of the controller's time a tick \[µs\].
    pub tick_us: [f64; 3],
    /// Time that the loop took \[s\].
    pub wall: f64,
}

/// REBA of a posture that was measured.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MeasuredReba {
    /// Over the time.
    pub mean: f64,
    /// The worst.
    pub max: u8,
}
