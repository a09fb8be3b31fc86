//! What is recorded of a run.

use std::fmt;

use nalgebra::Vector3;
use serde::Serialize;

/// Everything of a run that its table and its picture show.
#[derive(Clone, Debug, Default)]
pub(crate) struct Record {
    /// Names of the entries of q̇ that are no floating base's.
    pub(crate) joints: Vec<String>,
    /// Their limits of position.
    pub(crate) ranges: Vec<(f64, f64)>,
    /// One a tick.
    pub(crate) ticks: Vec<Tick>,
    /// Joints that a limit of position stopped in the last tick.
    pub(crate) stopped: Vec<String>,
    /// Places of the joints on the way to the frame, from the root, at some times.
    pub(crate) poses: Vec<Vec<Vector3<f64>>>,
}

/// One tick.
#[derive(Clone, Debug)]
pub(crate) struct Tick {
    /// (s)
    pub(crate) time: f64,
    /// Of the joints that have ranges.
    pub(crate) positions: Vec<f64>,
    /// Where the frame was to be (m).
    pub(crate) target: Vector3<f64>,
    /// Where it was (m).
    pub(crate) actual: Vector3<f64>,
    /// (m)
    pub(crate) position_error: f64,
    /// (rad)
    pub(crate) orientation_error: f64,
    /// How many joints a limit stopped.
    pub(crate) limited: usize,
    /// How long the step took (µs).
    pub(crate) duration: f64,
}

/// How it went.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct Summary {
    /// Control periods.
    pub(crate) ticks: usize,
    /// Limits of position, velocity, acceleration and jerk that a joint exceeded in a tick.
    pub(crate) limit_violations: usize,
    /// Ticks without a solution.
    pub(crate) infeasible: usize,
    /// (mm)
    pub(crate) position_rms_mm: f64,
    /// How far the frame is from its place in the last tick (mm).
    pub(crate) position_end_mm: f64,
    /// (rad)
    pub(crate) orientation_rms_rad: f64,
    /// Half the steps took no longer (µs).
    pub(crate) tick_us_p50: f64,
    /// 999 of 1000 steps took no longer (µs).
    pub(crate) tick_us_p999: f64,
}

/// A frame that ends farther from its place has not got there (mm).
const LARGEST_END: f64 = 1.0;

impl Record {
    /// What to say of a frame that ends farther than a millimetre from its place; nothing if it does not.
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

    /// Sums a run up.
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
