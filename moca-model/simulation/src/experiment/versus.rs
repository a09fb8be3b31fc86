//! Comparison of ergonomics with the benchmark over many cases.

use std::fmt;

use serde::{Serialize, Serializer};

use super::spread::{Duel, Spread};
use crate::run::Summary;

/// Pairs of runs of each case: ergonomics on the third level, and the benchmark min ‖ẋ_d‖² there.
#[derive(Clone, Debug, Default)]
pub struct Versus {
    pairs: Vec<[Summary; 2]>,
    apart: usize,
}

/// The results as one JSON object: first of each run, then of both together.
#[derive(Clone, Debug, Serialize)]
pub struct VersusLine {
    /// Cases in which person and robot worked together in both runs.
    cases: usize,
    /// Cases in which they did not, which no other number includes.
    apart: usize,
    score_on: Spread,
    score_off: Spread,
    score: Duel,
    score_max_on: Spread,
    score_max_off: Spread,
    reba_on: Spread,
    reba_off: Spread,
    outside_s_on: Spread,
    outside_s_off: Spread,
    out_of_reach_s_on: Spread,
    out_of_reach_s_off: Spread,
    workpiece_mm_s_on: Spread,
    workpiece_mm_s_off: Spread,
    base_at_rest_on: Spread,
    base_at_rest_off: Spread,
    limit_violations: u64,
    torque_violations: u64,
    separation_violations: u64,
    protective_stops: u64,
    retreats: u64,
    solver_failures: u64,
}

/// A row of the table: its label, its digits, and the source of the number.
type Row = (&'static str, usize, fn(&Summary) -> f64);

const ROWS: [Row; 10] = [
    ("e_s mean (0 good, 4.25 bad)", 2, |run| run.score_mean),
    ("e_s maximum", 2, |run| run.score_max),
    ("REBA predicted, mean (1 good, 15 bad)", 1, |run| run.reba_mean),
    ("working together [s]", 1, |run| run.together),
    ("  of it outside the shared workspace [s]", 2, |run| run.outside),
    ("  of it hand out of reach [s]", 2, |run| run.out_of_reach),
    ("tracking error, root mean square [mm]", 2, |run| run.tracking_error_rms_mm),
    ("workpiece while they stand, rms [mm/s]", 0, workpiece_mm_s),
    ("  base at rest then [%]", 0, base_at_rest),
    ("ticks not solved", 1, |run| run.solver_failures as f64),
];

/// Root mean square speed of the workpiece while the person stands \[mm/s\]; NaN if they never did.
fn workpiece_mm_s(run: &Summary) -> f64 {
    run.calmness.standing.map_or(f64::NAN, |motion| 1e3 * motion.workpiece)
}

/// Share of time with the base at rest while the person stands \[%\]; NaN if they never did.
fn base_at_rest(run: &Summary) -> f64 {
    run.calmness.standing.map_or(f64::NAN, |motion| 1e2 * motion.base_at_rest)
}

/// The name of a count and its source.
type Count = (&'static str, fn(&Summary) -> u64);

/// Events that must not happen in either run.
const COUNTS: [Count; 6] = [
    ("ticks with a violated limit", |run| run.limit_violations),
    ("ticks with a violated torque limit", |run| run.torque_violations.unwrap_or_default()),
    ("ticks too near to the person", |run| run.separation_violations),
    ("protective stops", |run| run.protective_stops),
    ("retreats from the person", |run| run.retreats),
    ("ticks not solved", |run| run.solver_failures),
];

impl Versus {
    /// Creates the comparison of runs with and without ergonomics.
    pub fn new(pairs: impl IntoIterator<Item = [Summary; 2]>) -> Self {
        let met = |pair: &[Summary; 2]| pair.iter().all(|run| run.together > 0.0);
        let (pairs, apart): (Vec<_>, Vec<_>) = pairs.into_iter().partition(met);
        Self { pairs, apart: apart.len() }
    }

    fn spread(&self, run: usize, of: fn(&Summary) -> f64) -> Spread {
        let values = self.pairs.iter().map(|pair| of(&pair[run]));
        // A case in which the person never stood does not count.
        Spread::of(values.filter(|value| !value.is_nan()))
    }

    fn sum(&self, of: fn(&Summary) -> u64) -> u64 {
        self.pairs.iter().flatten().map(of).sum()
    }

    /// e_s with ergonomics compared with e_s without.
    pub(crate) fn duel(&self) -> Duel {
        Duel::of(self.scores())
    }

    /// Mean e_s over time of each case with and without ergonomics.
    pub fn scores(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.pairs.iter().map(|[on, off]| (on.score_mean, off.score_mean))
    }

    /// The results as one JSON object.
    pub fn line(&self) -> VersusLine {
        VersusLine {
            cases: self.pairs.len(),
            apart: self.apart,
            score_on: self.spread(0, |run| run.score_mean),
            score_off: self.spread(1, |run| run.score_mean),
            score: self.duel(),
            score_max_on: self.spread(0, |run| run.score_max),
            score_max_off: self.spread(1, |run| run.score_max),
            reba_on: self.spread(0, |run| run.reba_mean),
            reba_off: self.spread(1, |run| run.reba_mean),
            outside_s_on: self.spread(0, |run| run.outside),
            outside_s_off: self.spread(1, |run| run.outside),
            out_of_reach_s_on: self.spread(0, |run| run.out_of_reach),
            out_of_reach_s_off: self.spread(1, |run| run.out_of_reach),
            workpiece_mm_s_on: self.spread(0, workpiece_mm_s),
            workpiece_mm_s_off: self.spread(1, workpiece_mm_s),
            base_at_rest_on: self.spread(0, base_at_rest),
            base_at_rest_off: self.spread(1, base_at_rest),
            limit_violations: self.sum(|run| run.limit_violations),
            torque_violations: self.sum(|run| run.torque_violations.unwrap_or_default()),
            separation_violations: self.sum(|run| run.separation_violations),
            protective_stops: self.sum(|run| run.protective_stops),
            retreats: self.sum(|run| run.retreats),
            solver_failures: self.sum(|run| run.solver_failures),
        }
    }
}

impl Serialize for Versus {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.line().serialize(serializer)
    }
}

impl fmt::Display for Versus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{} cases, in {} more they never met", self.pairs.len(), self.apart)?;
        writeln!(f, "{:<42}{:>27}{:>27}", "ergonomics", "on", "off")?;
        let columns = ["mean", "spread", "worst"].map(|name| format!("{name:>9}")).concat();
        writeln!(f, "{:<42}{columns}{columns}", "")?;
        for (name, digits, of) in ROWS {
            write!(f, "{name:<42}")?;
            for run in 0..2 {
                let Spread { mean, deviation, worst } = self.spread(run, of);
                write!(f, "{mean:>9.digits$}{deviation:>9.digits$}{worst:>9.digits$}")?;
            }
            writeln!(f)?;
        }
        for (name, of) in COUNTS {
            writeln!(f, "{name:<42}{:>9}", self.sum(of))?;
        }
        let Duel { ratio_mean, ratio_least, wins } = self.duel();
        writeln!(f, "e_s off / on: mean {ratio_mean:.2}, least {ratio_least:.2}")?;
        write!(f, "e_s is less with ergonomics in {:.1} % of the cases", 100.0 * wins)
    }
}
