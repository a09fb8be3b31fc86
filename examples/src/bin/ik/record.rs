//! The record of a run.

use std::fmt;

use nalgebra::Vector3;
use serde::Serialize;

/// The data of a run for its table and its picture.
#[derive(Clone, Debug, Default)]
pub(crate) struct Record {
    /// Names of the entries of q̇ except those of a floating base.
    pub(crate) joints: Vec<String>,
    /// Position limits of these joints.
    pub(crate) ranges: Vec<(f64, f64)>,
    /// The ticks.
    pub(crate) ticks: Vec<Tick>,
    /// Joints that a position limit stopped in the last tick.
    pub(crate) stopped: Vec<String>,
    /// Places of the joints from the root to the frame, at some times.
    pub(crate) poses: Vec<Vec<Vector3<f64>>>,
}

/// A tick.
#[derive(Clone, Debug)]
pub(crate) struct Tick {
    /// Time \[s\].
    pub(crate) time: f64,
    /// Positions of the joints with ranges.
    pub(crate) positions: Vec<f64>,
    /// Target of the frame \[m\].
    pub(crate) target: Vector3<f64>,
    /// Place of the frame \[m\].
    pub(crate) actual: Vector3<f64>,
    /// Position error \[m\].
    pub(crate) position_error: f64,
    /// Orientation error \[rad\].
    pub(crate) orientation_error: f64,
    /// Number of joints that a limit stopped.
    pub(crate) limited: usize,
    /// Time of the step \[µs\].
    pub(crate) duration: f64,
}

/// Summary of a run.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct Summary {
    /// Number of control periods.
    pub(crate) ticks: usize,
    /// Number of position, velocity, acceleration and jerk limits that a joint exceeded in a tick.
    pub(crate) limit_violations: usize,
    /// Number of ticks without a solution.
    pub(crate) infeasible: usize,
    /// Root mean square position error \[mm\].
    pub(crate) position_rms_mm: f64,
    /// Distance of the frame from its target in the last tick \[mm\].
    pub(crate) position_end_mm: f64,
    /// Root mean square orientation error \[rad\].
    pub(crate) orientation_rms_rad: f64,
    /// Median time of a step \[µs\].
    pub(crate) tick_us_p50: f64,
    /// 99.9 % quantile of the time of a step \[µs\].
    pub(crate) tick_us_p999: f64,
}

/// Distance from its target above which a frame has not reached it \[mm\].
const LARGEST_END: f64 = 1.0;

impl Record {
    /// The message for a frame that ends farther than a millimetre from its target; `None` if it does not.
    pub(crate) fn shortfall(&self) -> Option<String> {
        let off = 1e3 * self.ticks.last()?.position_error;
        if off <= LARGEST_END {
            return None;
        }
        let reason = if self.stopped.is_empty() {
            "no joint is at the end of its range: the place is out of reach, or cannot be reached from here"
                .to_owned()
        } else {
            format!("at the ends of their ranges: {}", self.stopped.join(", "))
        };
        Some(format!("the frame ends {off:.1} mm off its path; {reason}"))
    }

    /// Summarises a run.
    pub(crate) fn summary(&self, limit_violations: usize, infeasible: usize) -> Summary {
        let count = self.ticks.len().max(1) as f64;
        let rms = |error: fn(&Tick) -> f64| {
            (self.ticks.iter().map(|tick| error(tick).powi(2)).sum::<f64>() / count).sqrt()
        };
        let mut durations: Vec<f64> = self.ticks.iter().map(|tick| tick.duration).collect();
        durations.sort_by(f64::total_cmp);
        let quantile = |thousandths: usize| {
            let rank = durations.len() * thousandths / 1000;
            durations.get(rank.min(durations.len().saturating_sub(1))).copied().unwrap_or(0.0)
        };
        Summary {
            ticks: self.ticks.len(),
            limit_violations,
            infeasible,
            position_rms_mm: 1e3 * rms(|tick| tick.position_error),
            position_end_mm: 1e3 * self.ticks.last().map_or(0.0, |tick| tick.position_error),
            orientation_rms_rad: rms(|tick| tick.orientation_error),
            tick_us_p50: quantile(500),
            tick_us_p999: quantile(999),
        }
    }
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "ticks              {}", self.ticks)?;
        writeln!(f, "limit violations   {}", self.limit_violations)?;
        writeln!(f, "infeasible         {}", self.infeasible)?;
        let (rms, end) = (self.position_rms_mm, self.position_end_mm);
        writeln!(f, "position error     {rms:.4} mm rms, {end:.4} mm at the end")?;
        writeln!(f, "orientation error  {:.2e} rad rms", self.orientation_rms_rad)?;
        write!(
            f,
            "a step             {:.1} µs, 99.9 %: {:.1} µs",
            self.tick_us_p50, self.tick_us_p999
        )
    }
}
