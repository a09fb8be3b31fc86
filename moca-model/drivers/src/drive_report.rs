//! Summary of a loop, for people and for programs.

use std::fmt;

use moca_model::whole_body::control_loop::{
    DeadlineStatistics, LoopEnding, StopCause, TimeHistogram,
};
use serde::Serialize;

use super::fault_log::{FaultLog, FaultReport};
use super::logbook::Logbook;

/// End of a loop, how well the deadlines were kept, and the faults.
#[derive(Debug, Serialize)]
pub struct DriveReport {
    /// Reason why the loop stopped.
    #[serde(skip)]
    pub cause: StopCause,
    ended: &'static str,
    /// `None` if this is unknown.
    at_rest: Option<bool>,
    ticks: u64,
    missed: u64,
    /// Number of ticks that were so late that others were missed.
    late: u64,
    unmeasured: u64,
    latency_us: Times,
    duration_us: Times,
    faults: Vec<FaultReport>,
    #[serde(flatten)]
    book: Option<Logbook>,
    /// First faults, as text for people.
    #[serde(skip)]
    first_faults: String,
}

/// Times in µs.
#[derive(Debug, Serialize)]
struct Times {
    p50: f64,
    p99: f64,
    p999: f64,
    max: f64,
}

impl DriveReport {
    /// Creates the report of a loop that ended, with its phases and safety states if they were kept.
    pub fn new(
        ending: LoopEnding,
        statistics: &DeadlineStatistics,
        faults: &FaultLog,
        book: Option<Logbook>,
    ) -> Self {
        let times = |histogram: &TimeHistogram| Times {
            p50: 1e6 * histogram.quantile(0.5),
            p99: 1e6 * histogram.quantile(0.99),
            p999: 1e6 * histogram.quantile(0.999),
            max: 1e6 * histogram.longest(),
        };
        Self {
            cause: ending.cause,
            ended: match ending.cause {
                StopCause::Requested => "requested",
                StopCause::RobotSilent => "robot silent",
                StopCause::PerceptionSilent => "perception silent",
                _ => "unknown",
            },
            at_rest: ending.at_rest,
            ticks: statistics.ticks,
            missed: statistics.missed,
            late: statistics.late,
            unmeasured: statistics.unmeasured,
            latency_us: times(&statistics.latency),
            duration_us: times(&statistics.duration),
            faults: faults.report(),
            book,
            first_faults: faults.to_string(),
        }
    }
}

impl fmt::Display for DriveReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { ended, latency_us, duration_us, .. } = self;
        let rest = match self.at_rest {
            Some(true) => "at rest",
            Some(false) => "moving",
            None => "nobody knows whether at rest",
        };
        writeln!(f, "{:30} {ended}, {rest}", "ended")?;
        for (what, count) in [
            ("ticks", self.ticks),
            ("ticks missed", self.missed),
            ("ticks late", self.late),
            ("ticks without measurement", self.unmeasured),
        ] {
            writeln!(f, "{what:30} {count:>10}")?;
        }
        if let Some(book) = &self.book {
            for (what, count) in [
                ("ticks of working together", book.ticks_together),
                ("protective stops", book.protective_stops),
                ("retreats from a person", book.retreats),
            ] {
                writeln!(f, "{what:30} {count:>10}")?;
            }
        }
        for (what, times) in [("late", latency_us), ("took", duration_us)] {
            let Times { p50, p99, p999, max } = times;
            let what = format!("{what} [µs] p50 p99 p99.9 max");
            writeln!(f, "{what:30} {p50:.0}, {p99:.0}, {p999:.0}, {max:.0}")?;
        }
        write!(f, "{:30} {}", "faults", self.first_faults)
    }
}
