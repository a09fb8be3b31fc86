//! Comparison of runs with and without ergonomics.

use std::fmt;

use moca_replay::page::{ResultRow, Results};
use moca_replay::recorded::ReplayError;
use serde::{Serialize, Serializer};

use super::summary::Summary;
use crate::error::Error;
use crate::judges::{Calmness, Following};

/// Results with and without ergonomics.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// True if distances from people are kept.
    pub separation: bool,
    /// Result with ergonomics on the third level.
    pub on: Summary,
    /// Result with the benchmark min ‖ẋ_d‖² there; `None` if it was not played.
    pub off: Option<Summary>,
}

/// Both results as one object.
#[derive(Debug, Serialize)]
struct Line {
    score_mean_on: f64,
    score_mean_off: Option<f64>,
    /// Part of these because the person's frame is held.
    score_of_hold_on: f64,
    score_of_hold_off: Option<f64>,
    reba_max_on: u8,
    reba_max_off: Option<u8>,
    /// REBA of the recorded posture, which is the same in both runs.
    reba_measured_mean: Option<f64>,
    reba_measured_max: Option<u8>,
    separation: bool,
    /// Time of working together in the longer run.
    together_s: f64,
    outside_s_on: f64,
    outside_s_off: Option<f64>,
    separation_violations: u64,
    /// True if distances are judged by the truth.
    truth: bool,
    contact_speed_p999: Option<f64>,
    tracking_error_rms_mm: f64,
    /// Calmness with ergonomics; empty if the person's true motion is not known.
    calmness: Calmness,
    limit_violations: u64,
    jerk_violations: u64,
    /// `None` for a robot without torques.
    torque_violations: Option<u64>,
    protective_stops: u64,
    retreats: u64,
    solver_failures: u64,
    tick_us_p50: f64,
    tick_us_p99: f64,
    tick_us_max: f64,
    speedup: f64,
    duration_s: f64,
}

impl Comparison {
    /// Returns true if both runs came to their end.
    pub fn is_complete(&self) -> bool {
        self.on.is_complete && self.off.as_ref().is_some_and(|off| off.is_complete)
    }

    /// Returns true if a run had a control period \[s\] without a solution.
    pub fn unsolved(&self, period: f64) -> bool {
        let is_unsolved = |run: &Summary| {
            run.solver_failures > 0 && run.solver_failures as f64 * period >= 0.999 * run.duration
        };
        self.runs().any(is_unsolved)
    }

    /// Simulated seconds in a second of wall time, over all runs.
    pub fn speedup(&self) -> f64 {
        let sum = |of: fn(&Summary) -> f64| self.runs().map(of).sum::<f64>();
        sum(|run| run.duration) / sum(|run| run.wall)
    }

    /// The rows of the table: label, digits, and a number of each run; `None` if there is no such number.
    pub fn rows(&self) -> impl Iterator<Item = (&'static str, usize, Vec<Option<f64>>)> {
        ROWS.iter().map(|(name, digits, of)| {
            // Adding zero removes the sign of a zero that comes from rounding.
            let rounded = self.runs().map(|run| (of(run) * 1e9).round() / 1e9 + 0.0);
            let known = rounded.map(|value| (!value.is_nan()).then_some(value));
            (*name, *digits, known.collect())
        })
    }

    /// The results for a page, with a table of further runs, which may be empty.
    ///
    /// # Errors
    /// Never, for numbers that JSON can represent.
    pub fn results(&self, text: &str) -> Result<Results, Error> {
        let rows = self.rows().map(|(name, digits, values)| ResultRow {
            name: name.to_owned(),
            digits,
            values,
        });
        let summary = serde_json::to_value(self).map_err(ReplayError::Json)?;
        Ok(Results { rows: rows.collect(), summary, text: text.to_owned() })
    }

    fn runs(&self) -> impl Iterator<Item = &Summary> {
        std::iter::once(&self.on).chain(&self.off)
    }
}

/// Serialises both as one object. Keys without a variant for each run have the worst of all runs.
impl Serialize for Comparison {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let worst = |of: fn(&Summary) -> f64| self.runs().map(of).fold(0.0, f64::max);
        let sum = |of: fn(&Summary) -> u64| self.runs().map(of).sum();
        let line = Line {
            score_mean_on: self.on.score_mean,
            score_mean_off: self.off.as_ref().map(|off| off.score_mean),
            score_of_hold_on: self.on.score_of_hold,
            score_of_hold_off: self.off.as_ref().map(|off| off.score_of_hold),
            reba_max_on: self.on.reba_max,
            reba_max_off: self.off.as_ref().map(|off| off.reba_max),
            reba_measured_mean: self.on.reba_measured.map(|measured| measured.mean),
            reba_measured_max: self.on.reba_measured.map(|measured| measured.max),
            separation: self.separation,
            together_s: worst(|run| run.together),
            outside_s_on: self.on.outside,
            outside_s_off: self.off.as_ref().map(|off| off.outside),
            separation_violations: sum(|run| run.separation_violations),
            truth: self.on.truth,
            contact_speed_p999: self.runs().filter_map(|run| run.contact_speed).reduce(f64::max),
            tracking_error_rms_mm: worst(|run| run.tracking_error_rms_mm),
            calmness: self.on.calmness,
            limit_violations: sum(|run| run.limit_violations),
            jerk_violations: sum(|run| run.jerk_violations),
            torque_violations: self.runs().map(|run| run.torque_violations).sum(),
            protective_stops: sum(|run| run.protective_stops),
            retreats: sum(|run| run.retreats),
            solver_failures: sum(|run| run.solver_failures),
            tick_us_p50: worst(|run| run.tick_us[0]),
            tick_us_p99: worst(|run| run.tick_us[1]),
            tick_us_max: worst(|run| run.tick_us[2]),
            speedup: self.speedup(),
            duration_s: worst(|run| run.duration),
        };
        line.serialize(serializer)
    }
}

/// A row of the table: its label, its digits, and the source of the number.
type Row = (&'static str, usize, fn(&Summary) -> f64);

const ROWS: [Row; 34] = [
    ("e_s mean (0 good, 4.25 bad)", 2, |run| run.score_mean),
    ("  of it because the frame is held", 3, |run| run.score_of_hold),
    ("e_s maximum", 2, |run| run.score_max),
    ("REBA predicted, mean (1 good, 15 bad)", 1, |run| run.reba_mean),
    ("REBA predicted, maximum", 0, |run| f64::from(run.reba_max)),
    ("REBA measured, mean", 1, |run| run.reba_measured.map_or(f64::NAN, |measured| measured.mean)),
    ("REBA measured, maximum", 0, |run| {
        run.reba_measured.map_or(f64::NAN, |measured| f64::from(measured.max))
    }),
    ("tracking error, root mean square [mm]", 3, |run| run.tracking_error_rms_mm),
    ("working together [s]", 1, |run| run.together),
    ("  of it outside the shared workspace [s]", 1, |run| run.outside),
    ("  of it tool out of reach [s]", 1, |run| run.out_of_reach),
    ("standing: workpiece, root mean square [mm/s]", 1, |run| {
        run.calmness.standing.map_or(f64::NAN, |motion| 1e3 * motion.workpiece)
    }),
    ("  workpiece, 99 % [mm/s]", 1, |run| {
        run.calmness.standing.map_or(f64::NAN, |motion| 1e3 * motion.workpiece_p99)
    }),
    ("  base at rest [%]", 1, |run| {
        run.calmness.standing.map_or(f64::NAN, |motion| 1e2 * motion.base_at_rest)
    }),
    ("  base at its acceleration limit [%]", 1, |run| {
        run.calmness.standing.map_or(f64::NAN, |motion| 1e2 * motion.base_at_limit)
    }),
    ("walking: workpiece, 99 % [mm/s]", 1, |run| {
        run.calmness.walking.map_or(f64::NAN, |motion| 1e3 * motion.workpiece_p99)
    }),
    ("  base at its acceleration limit [%]", 1, |run| {
        run.calmness.walking.map_or(f64::NAN, |motion| 1e2 * motion.base_at_limit)
    }),
    ("  begins to follow after them, mean [s]", 2, |run| following(run, |of| of.onset)),
    ("  the same, worst [s]", 2, |run| following(run, |of| of.onset_worst)),
    ("  lag behind its place [mm]", 0, |run| 1e3 * following(run, |of| of.lag)),
    ("worst position margin [%]", 1, |run| 100.0 * run.margins.position),
    ("worst velocity margin [%]", 1, |run| 100.0 * run.margins.velocity),
    ("worst acceleration margin [%]", 1, |run| 100.0 * run.margins.acceleration),
    ("worst jerk margin [%]", 1, |run| 100.0 * run.margins.jerk),
    ("ticks with a violated limit", 0, |run| run.limit_violations as f64),
    ("ticks with a violated torque limit", 0, |run| {
        run.torque_violations.map_or(f64::NAN, |violations| violations as f64)
    }),
    ("ticks too near to the person", 0, |run| run.separation_violations as f64),
    ("approach within 5 cm, 99.9 % [m/s]", 2, |run| run.contact_speed.unwrap_or(f64::NAN)),
    ("retreats from the person", 0, |run| run.retreats as f64),
    ("protective stops", 0, |run| run.protective_stops as f64),
    ("ticks not solved", 0, |run| run.solver_failures as f64),
    ("tick, median [µs]", 1, |run| run.tick_us[0]),
    ("tick, 99th percentile [µs]", 1, |run| run.tick_us[1]),
    ("tick, maximum [µs]", 1, |run| run.tick_us[2]),
];

/// A measure of following; NaN if it is not known.
fn following(run: &Summary, of: fn(&Following) -> Option<f64>) -> f64 {
    run.calmness.following.as_ref().and_then(of).unwrap_or(f64::NAN)
}

impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.separation {
            writeln!(f, "NO SEPARATION: people are kept at no distance")?;
        }
        write!(f, "{:<44}{:>12}", "ergonomics", "on")?;
        writeln!(f, "{:>12}", if self.off.is_some() { "off" } else { "" })?;
        for (name, digits, values) in self.rows() {
            write!(f, "{name:<44}")?;
            for value in values {
                match value {
                    Some(value) => write!(f, "{value:>12.digits$}")?,
                    None => write!(f, "{:>12}", "-")?,
                }
            }
            writeln!(f)?;
        }
        if self.separation && !self.on.truth {
            writeln!(
                f,
                "distances are judged by what was seen: nobody knows where the person was"
            )?;
        }
        write!(f, "{:.0} simulated seconds a wall second", self.speedup())
    }
}
