//! Quantiles of durations.

use std::time::Duration;

use serde::Serialize;

/// Median, 99th percentile and maximum of durations (µs).
///
/// ```
/// use std::time::Duration;
///
/// use human_perception::percepts::Quantiles;
///
/// let times = [3, 1, 2].map(Duration::from_micros);
/// let quantiles = Quantiles::of(times.into());
/// assert_eq!((quantiles.median_us, quantiles.max_us), (2.0, 3.0));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Quantiles {
    /// Median \[µs\].
    pub median_us: f64,
    /// 99th percentile \[µs\].
    pub p99_us: f64,
    /// Maximum \[µs\].
    pub max_us: f64,
}

impl Quantiles {
    /// Computes the quantiles of these durations. They are zero if there are none.
    pub fn of(mut times: Vec<Duration>) -> Self {
        times.sort_unstable();
        let at = |percent: usize| {
            let index = (times.len() * percent / 100).min(times.len().saturating_sub(1));
            times.get(index).map_or(0.0, |time| time.as_secs_f64() * 1e6)
        };
        Self { median_us: at(50), p99_us: at(99), max_us: at(100) }
    }
}
