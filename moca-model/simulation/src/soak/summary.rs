//! Findings of a soak.

use std::collections::BTreeMap;
use std::fmt;

use serde::{Serialize, Serializer};

use super::disturbance::Endings;
use super::episode_result::EpisodeResult;
use super::monitor::Counts;
use super::tick_times::TickTimes;
use crate::judges::Stillness;

/// Result of a soak.
#[derive(Clone, Debug)]
pub struct Summary {
    /// Ticks run.
    pub ticks: u64,
    /// Episodes begun.
    pub episodes: u64,
    /// Ticks with something wrong.
    pub counts: Counts,
    /// Endings of disturbances.
    pub ended: Endings,
    /// The first of them in each episode, in words.
    pub findings: Vec<String>,
    /// Ticks in which the robot moves.
    pub moving: u64,
    /// Stillness while the person stands.
    pub standing: Stillness,
    /// Duration of the controller's step: median, and 99.9th percentile \[µs\].
    pub tick_us: [f64; 2],
}

/// The last line of the program's output.
#[derive(Serialize)]
struct Line {
    ticks: u64,
    infeasible: u64,
    not_finite: u64,
    limit_violations: u64,
    acceleration_violations: u64,
    jerk_violations: u64,
    torque_violations: u64,
    separation_violations: u64,
    discontinuities: u64,
    tick_us_p50: f64,
    tick_us_p999: f64,
    self_collisions: u64,
    person_caused: u64,
    contact: u64,
    moving: u64,
    standing_ticks: u64,
    standing_workpiece_mm_s: Option<f64>,
    standing_base_at_rest: Option<f64>,
    episodes: u64,
    wrong_states: u64,
    disturbances: Endings,
}

impl Summary {
    /// Sums up episodes by their numbers, from 0, and the times of their ticks.
    pub fn of(episodes: &BTreeMap<u64, EpisodeResult>, times: &TickTimes) -> Self {
        let mut summary = Self {
            ticks: 0,
            episodes: 0,
            counts: Counts::default(),
            ended: Endings::default(),
            findings: Vec::new(),
            moving: 0,
            standing: Stillness::default(),
            tick_us: [500, 999].map(|thousandths| times.quantile(thousandths)),
        };
        for (number, episode) in episodes {
            summary.ticks += episode.ticks;
            summary.episodes += 1;
            summary.counts += episode.counts;
            summary.ended += &episode.ended;
            summary.moving += episode.moving;
            summary.standing += episode.standing;
            let finding = |what: &String| format!("episode {}, {what}", number + 1);
            summary.findings.extend(episode.finding.as_ref().map(finding));
        }
        summary
    }
}

/// Serialises as one object with the names of the book.
impl Serialize for Summary {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let counts = &self.counts;
        let line = Line {
            ticks: self.ticks,
            infeasible: counts.infeasible,
            not_finite: counts.not_finite,
            limit_violations: counts.limit_violations,
            acceleration_violations: counts.acceleration_violations,
            jerk_violations: counts.jerk_violations,
            torque_violations: counts.torque_violations,
            separation_violations: counts.separation_violations,
            discontinuities: counts.discontinuities,
            tick_us_p50: self.tick_us[0],
            tick_us_p999: self.tick_us[1],
            self_collisions: counts.self_collisions,
            person_caused: counts.person_caused,
            contact: counts.contact,
            moving: self.moving,
            standing_ticks: self.standing.ticks,
            standing_workpiece_mm_s: self.standing.workpiece_rms(),
            standing_base_at_rest: self.standing.base_at_rest(),
            episodes: self.episodes,
            wrong_states: counts.wrong_states,
            disturbances: self.ended.clone(),
        };
        line.serialize(serializer)
    }
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let counts = &self.counts;
        for (what, count) in [
            ("ticks", self.ticks),
            ("  of them with the robot moving", self.moving),
            ("episodes", self.episodes),
            ("problems not solved", counts.infeasible),
            ("commands not finite", counts.not_finite),
            ("limits of position or velocity violated", counts.limit_violations),
            ("limits of acceleration violated", counts.acceleration_violations),
            ("limits of jerk violated", counts.jerk_violations),
            ("limits of torque violated", counts.torque_violations),
            ("protective distance violated by the robot", counts.separation_violations),
            ("jumps of the desired velocity", counts.discontinuities),
            ("self-collisions", counts.self_collisions),
            ("disturbed, and in a state that is not enough", counts.wrong_states),
            ("protective distance violated by the person", counts.person_caused),
            ("coming nearer to arms in collaboration", counts.contact),
        ] {
            writeln!(f, "{what:46} {count:>10}")?;
        }
        let still = &self.standing;
        writeln!(f, "{:46} {:>10}", "working together, and the person stands", still.ticks)?;
        if let (Some(speed), Some(rest)) = (still.workpiece_rms(), still.base_at_rest()) {
            writeln!(f, "{:46} {speed:>10.1}", "  workpiece then, root mean square [mm/s]")?;
            writeln!(f, "{:46} {:>10.1}", "  base at rest then [%]", 1e2 * rest)?;
        }
        let [median, worst] = self.tick_us;
        writeln!(f, "{:46} {median:>10.1}", "tick, median [µs]")?;
        write!(f, "{:46} {worst:>10.1}", "tick, 99.9th percentile [µs]")
    }
}
