//! When faults began and how long they lasted.

use hrsw_safety::Fault;
use serde::Serialize;

/// Largest number of faults that are listed; further ones are only counted.
const MOST: usize = 1000;

/// Fault without interruption.
#[derive(Clone, Debug, PartialEq)]
struct Episode {
    fault: Fault,
    /// First and last tick with the fault \[s since the first tick\].
    begin: f64,
    end: f64,
}

/// Faults of a loop in the order of time.
///
/// ```
/// use moca_drivers::FaultLog;
/// use hrsw_safety::Fault;
///
/// let mut log = FaultLog::default();
/// for (now, fault) in [(5.0, None), (5.001, Some(Fault::LateTick)), (5.002, None)] {
///     log.push(now, fault);
/// }
/// assert_eq!(log.to_string(), "tick late from 0.001 to 0.001 s");
/// log.push(6.0, Some(Fault::StopRequested));
/// assert_eq!(log.to_string(), "tick late from 0.001 to 0.001 s; 1 × stop requested");
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct FaultLog {
    /// The time of the first tick \[s\].
    first: Option<f64>,
    /// True if the last tick had the last fault.
    goes_on: bool,
    episodes: Vec<Episode>,
    left_out: u64,
}

impl Default for FaultLog {
    fn default() -> Self {
        let episodes = Vec::with_capacity(MOST);
        Self { first: None, goes_on: false, episodes, left_out: 0 }
    }
}

impl FaultLog {
    /// Adds the worst fault of a tick, if it has one. Allocates nothing.
    pub fn push(&mut self, now: f64, fault: Option<Fault>) {
        let time = now - *self.first.get_or_insert(now);
        let Some(fault) = fault else {
            self.goes_on = false;
            return;
        };
        let has_room = self.episodes.len() < MOST;
        match self.episodes.last_mut() {
            Some(last) if self.goes_on && last.fault == fault => last.end = time,
            _ if has_room => {
                self.episodes.push(Episode { fault, begin: time, end: time });
            }
            _ => self.left_out += 1,
        }
        self.goes_on = true;
    }

    pub(super) fn report(&self) -> Vec<FaultReport> {
        let report = |episode: &Episode| FaultReport {
            fault: episode.fault.to_string(),
            begin: episode.begin,
            end: episode.end,
        };
        self.episodes.iter().map(report).collect()
    }
}

impl std::fmt::Display for FaultLog {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Some((first, others)) = self.episodes.split_first() else { return write!(f, "none") };
        let Episode { fault, begin, end } = first;
        write!(f, "{fault} from {begin:.3} to {end:.3} s")?;
        let mut counts: Vec<(Fault, u64)> = Vec::new();
        for Episode { fault, .. } in others {
            match counts.iter_mut().find(|(known, _)| known == fault) {
                Some((_, count)) => *count += 1,
                None => counts.push((*fault, 1)),
            }
        }
        for (fault, count) in counts {
            write!(f, "; {count} × {fault}")?;
        }
        match self.left_out {
            0 => Ok(()),
            more => write!(f, "; {more} not listed"),
        }
    }
}

/// Fault without interruption, for programs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct FaultReport {
    fault: String,
    /// First and last tick with the fault \[s since the first tick\].
    begin: f64,
    end: f64,
}
