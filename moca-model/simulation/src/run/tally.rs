//! Counts of a run, tick by tick.

use super::summary::{MeasuredReba, Summary};
use crate::judges::{Calmness, Margins};
use crate::quantile::quantile;

/// Sums over ticks.
#[derive(Debug, Default)]
pub(super) struct Tally {
    pub(super) ticks: u64,
    pub(super) together: u64,
    pub(super) score: f64,
    /// Part of the score that is due to the held frame.
    pub(super) score_of_hold: f64,
    pub(super) score_max: f64,
    pub(super) reba: f64,
    pub(super) reba_max: u8,
    /// Those of these ticks with a measured posture.
    pub(super) measured: u64,
    pub(super) reba_measured: f64,
    pub(super) reba_measured_max: u8,
    pub(super) error_squared: f64,
    pub(super) outside: u64,
    pub(super) out_of_reach: u64,
    pub(super) violations: u64,
    pub(super) jerk_violations: u64,
    /// `None` without torques.
    pub(super) torque_violations: Option<u64>,
    /// Numbers of protective stops and of retreats.
    pub(super) stops: u64,
    pub(super) retreats: u64,
    pub(super) separation_violations: u64,
    /// Speeds of ticks with a touchable part of the true person within 5 cm \[m/s\].
    pub(super) contact_speeds: Vec<f64>,
    pub(super) failures: u64,
    /// Time of the controller in each tick \[µs\].
    pub(super) ticks_us: Vec<f64>,
}

/// Facts about a run when it is over.
#[derive(Clone, Copy, Debug)]
pub(super) struct Played {
    /// True if it was played to its end.
    pub(super) is_complete: bool,
    /// Simulated time \[s\].
    pub(super) duration: f64,
    /// Wall time \[s\].
    pub(super) wall: f64,
    /// The control period \[s\].
    pub(super) period: f64,
    /// Margins of the limits.
    pub(super) margins: Margins,
    /// True if the person's true motion is known.
    pub(super) truth: bool,
    /// Calmness of the run.
    pub(super) calmness: Calmness,
}

impl Tally {
    /// The summary of the counts.
    pub(super) fn summary(mut self, played: &Played) -> Summary {
        let &Played { is_complete, duration, wall, period, margins, truth, calmness } = played;
        let contact_speed = quantile(&mut self.contact_speeds, 999);
        let tick_us = [500, 990, 1000]
            .map(|thousandths| quantile(&mut self.ticks_us, thousandths).unwrap_or_default());
        let tally = self;
        let share = |sum: f64, ticks: u64| if ticks == 0 { 0.0 } else { sum / ticks as f64 };
        let time = |ticks: u64| ticks as f64 * period;
        Summary {
            is_complete,
            duration,
            together: time(tally.together),
            score_mean: share(tally.score, tally.together),
            score_of_hold: share(tally.score_of_hold, tally.together),
            score_max: tally.score_max,
            reba_mean: share(tally.reba, tally.together),
            reba_max: tally.reba_max,
            reba_measured: (tally.measured > 0).then(|| MeasuredReba {
                mean: share(tally.reba_measured, tally.measured),
                max: tally.reba_measured_max,
            }),
            tracking_error_rms_mm: 1e3 * share(tally.error_squared, tally.ticks).sqrt(),
            outside: time(tally.outside),
            out_of_reach: time(tally.out_of_reach),
            margins,
            limit_violations: tally.violations,
            jerk_violations: tally.jerk_violations,
            torque_violations: tally.torque_violations,
            protective_stops: tally.stops,
            retreats: tally.retreats,
            truth,
            separation_violations: tally.separation_violations,
            contact_speed,
            calmness,
            solver_failures: tally.failures,
            tick_us,
            wall,
        }
    }
}
