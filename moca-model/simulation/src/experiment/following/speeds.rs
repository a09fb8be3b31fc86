//! People who walk straight at up to the robot's speed.

use std::fmt;

use ergo_map::ErgonomicsMap;
use moca_model::{DesiredMotion, Goal, MOCA_AXIS_SPEED, moca_safety};
use nalgebra::{Point2, Rotation2, Vector2};
use rand::Rng;
use serde::{Deserialize, Serialize};
use simulated_people::{CameraSettings, WalkerSettings, WalkingPath};

use crate::error::Error;
use crate::experiment::cases::generator;
use crate::experiment::conditions::Conditions;
use crate::experiment::distance::{DistanceError, DistanceMonitor, FollowingDistance};
use crate::experiment::job::Job;
use crate::experiment::player::Player;
use crate::experiment::spread::Spread;
use crate::experiment::walk::{ARM_SPEED, Walk};
use crate::run::{Scenario, Summary};

/// Speeds of the people \[m/s\]. The last one is the robot's own speed.
const SPEEDS: [f64; 8] = [0.2, 0.4, 0.6, 0.8, 1.0, 1.2, 1.35, MOCA_AXIS_SPEED];

/// Duration of the walk \[s\].
const WALK: f64 = 8.0;

/// Durations of what they do before, except for the approach to the workplace, and after \[s\].
const BEFORE: f64 = 12.5;
const AFTER: f64 = 8.0;

/// Distance from the walker's first place to the workplace \[m\].
const APPROACH: f64 = 1.8;

/// Distance between the cameras along their way \[m\]. They walk as far as 12 m, where the depth measured from the
/// workplace has a standard deviation of half a metre.
const CAMERAS: f64 = 3.0;

/// First case number, apart from those of the random paths.
const FIRST: u64 = 1 << 32;

/// The results at each speed.
#[derive(Clone, Debug, Default, Serialize)]
#[serde(transparent)]
pub struct Speeds {
    pub(super) rows: Vec<SpeedResult>,
}

/// The results at one speed.
#[derive(Clone, Debug, Serialize)]
pub struct SpeedResult {
    /// The speed \[m/s\].
    pub(super) speed: f64,
    /// True if distances from people are kept, which slows the robot near them.
    pub(super) separation: bool,
    cases: usize,
    /// Distance of the hand from its nominal place at this speed while the person walks evenly \[m\].
    pub(super) steady_m: Spread,
    /// Distance of the hand from its place beside the standing person meanwhile \[m\].
    pub(super) behind_m: Spread,
    /// Largest distance from the place beside the standing person on the way \[m\].
    pub(super) largest_m: Spread,
    /// Time outside of the workspace while working together \[s\].
    outside_s: Spread,
    /// S_p of a robot at this speed for v_h = 0 and the base's braking \[m\]. It lets the robot stop in time if the
    /// person stands still.
    protective_m: f64,
    limit_violations: u64,
    separation_violations: u64,
    protective_stops: u64,
    /// Number of times that the robot retreated from the person, or stood because they were too near.
    retreats: u64,
}

/// A person who walks straight.
#[derive(Clone, Debug)]
pub struct Stroll {
    seed: u64,
    number: u64,
    speed: f64,
    separation: bool,
}

/// The result of a straight walk.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct StrollTrial {
    speed: f64,
    separation: bool,
    summary: Summary,
    error: DistanceError,
}

/// Every speed, with and without separation.
fn runs() -> impl Iterator<Item = (f64, bool)> {
    SPEEDS.into_iter().flat_map(|speed| [(speed, true), (speed, false)])
}

/// The cases of a job: at each speed a tenth of the experiment's number, at least one. The paper's own controller has no
/// separation.
pub(super) fn cases(job: &Job) -> impl Iterator<Item = Stroll> {
    let (seed, each, paper) = (job.seed, job.cases.div_ceil(10), job.conditions.paper);
    runs().filter(move |(_, separation)| !(paper && *separation)).flat_map(
        move |(speed, separation)| {
            // The same people walk with and without separation.
            (FIRST..FIRST + each).map(move |number| Stroll { seed, number, speed, separation })
        },
    )
}

impl Stroll {
    /// Plays the walk with ergonomics.
    ///
    /// # Errors
    /// Settings that the controller refuses.
    pub fn play(
        &self,
        average: &ErgonomicsMap,
        conditions: Conditions,
        player: &mut Player<'_>,
    ) -> Result<StrollTrial, Error> {
        let Self { seed, number, speed, separation } = *self;
        let mut draw = generator(seed, number);
        let walk = Walk::new(walker(speed, &mut draw), conditions.sight)?;
        let stature = draw.random_range(1.58..=1.94);
        let map = average.for_stature(stature)?;
        let scenario = conditions.control(quick(walk.scenario(&map, conditions, &mut draw)?));
        let scenario = if separation { scenario } else { scenario.without_separation() };
        let mut monitor =
            DistanceMonitor::new(&walk.truth, FollowingDistance::new(&scenario.settings));
        let title = format!("{speed} m/s{}", if separation { "" } else { ", NO SEPARATION" });
        let summary = player.play(&title, &scenario, Goal::Ergonomics, |row, _| {
            monitor.push(row);
        })?;
        Ok(StrollTrial { speed, separation, summary, error: monitor.error() })
    }
}

impl Speeds {
    /// Creates the result of these trials.
    pub(super) fn new(trials: &[StrollTrial]) -> Self {
        let rows = runs().filter_map(|(speed, separation)| {
            let same =
                |trial: &&StrollTrial| (trial.speed, trial.separation) == (speed, separation);
            let trials: Vec<_> = trials.iter().filter(same).collect();
            (!trials.is_empty()).then(|| row(speed, separation, &trials))
        });
        Self { rows: rows.collect() }
    }
}

/// A person who works, then walks backwards, straight within a few degrees.
fn walker(speed: f64, draw: &mut impl Rng) -> WalkerSettings {
    let workplace = Point2::new(1.4, 0.0);
    let way = Rotation2::new(draw.random_range(-0.15..0.15)) * Vector2::x() * (speed * WALK);
    WalkerSettings {
        path: WalkingPath::Points(vec![workplace + way]),
        speed: Some(speed),
        duration: APPROACH / speed + BEFORE + WALK + AFTER,
        seed: draw.random(),
        arm_speed: Some(ARM_SPEED),
        camera: CameraSettings { spacing: Some(CAMERAS), ..CameraSettings::default() },
        ..WalkerSettings::default()
    }
}

/// Lets the desired pose and the workspace of a scenario be as fast as the robot.
fn quick(mut scenario: Scenario) -> Scenario {
    let settings = &mut scenario.settings;
    settings.desired = DesiredMotion { velocity: MOCA_AXIS_SPEED, ..settings.desired };
    // The horizon is the time of braking from there.
    settings.horizon = MOCA_AXIS_SPEED / (settings.desired.acceleration / 3.0_f64.sqrt());
    scenario
}

fn row(speed: f64, separation: bool, trials: &[&StrollTrial]) -> SpeedResult {
    let terms = moca_safety().separation.braking_by_parts(speed, 0.0);
    let sum = |of: fn(&Summary) -> u64| trials.iter().map(|trial| of(&trial.summary)).sum();
    SpeedResult {
        speed,
        separation,
        cases: trials.len(),
        steady_m: Spread::of(trials.iter().filter_map(|trial| trial.error.steady)),
        behind_m: Spread::of(trials.iter().filter_map(|trial| trial.error.behind)),
        largest_m: Spread::of(trials.iter().map(|trial| trial.error.largest)),
        outside_s: Spread::of(trials.iter().map(|trial| trial.summary.outside)),
        protective_m: terms.protective_distance(0.0, speed),
        limit_violations: sum(|summary| summary.limit_violations),
        separation_violations: sum(|summary| summary.separation_violations),
        protective_stops: sum(|summary| summary.protective_stops),
        retreats: sum(|summary| summary.retreats),
    }
}

impl fmt::Display for Speeds {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{:<12}{:<12}{:>6}{:>9}{:>26}{:>26}{:>26}{:>26}{:>8}{:>8}{:>8}{:>10}",
            "speed [m/s]",
            "separation",
            "cases",
            "S_p [m]",
            "steady error [m]",
            "behind [m]",
            "most behind [m]",
            "outside [s]",
            "limits",
            "near",
            "stops",
            "retreats",
        )?;
        for row in &self.rows {
            let separation = if row.separation { "on" } else { "OFF" };
            write!(f, "{:<12.2}{separation:<12}{:>6}", row.speed, row.cases)?;
            let protective =
                if row.separation { format!("{:.2}", row.protective_m) } else { "-".to_owned() };
            write!(f, "{protective:>9}")?;
            for Spread { mean, worst, .. } in
                [row.steady_m, row.behind_m, row.largest_m, row.outside_s]
            {
                write!(f, "{:>14}", format!("mean {mean:.3}"))?;
                write!(f, "{:>12}", format!("worst {worst:.3}"))?;
            }
            let SpeedResult { limit_violations, separation_violations, .. } = row;
            write!(f, "{limit_violations:>8}{separation_violations:>8}")?;
            writeln!(f, "{:>8}{:>10}", row.protective_stops, row.retreats)?;
        }
        Ok(())
    }
}
