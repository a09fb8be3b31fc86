//! Durations of ticks, in memory that does not grow with their number.

use std::collections::BTreeMap;
use std::ops::AddAssign;

use serde::{Deserialize, Serialize};

/// Width of a bin (µs), the last digit that is printed.
const WIDTH: f64 = 0.1;
/// Ticks that take ten milliseconds or more count as ten.
const BINS: usize = 100_000;

/// A histogram of times.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(try_from = "BTreeMap<usize, u64>", into = "BTreeMap<usize, u64>")]
pub struct TickTimes {
    bins: Vec<u64>,
    count: u64,
}

/// The bins that are not empty, in files of shards.
impl From<TickTimes> for BTreeMap<usize, u64> {
    fn from(times: TickTimes) -> Self {
        times.bins.into_iter().enumerate().filter(|(_, count)| *count > 0).collect()
    }
}

impl TryFrom<BTreeMap<usize, u64>> for TickTimes {
    type Error = String;

    fn try_from(filled: BTreeMap<usize, u64>) -> Result<Self, String> {
        let mut times = Self::default();
        for (bin, count) in filled {
            let place = times.bins.get_mut(bin);
            *place.ok_or_else(|| format!("bin {bin} of the times, expected up to {BINS}"))? = count;
            times.count = times.count.saturating_add(count);
        }
        Ok(times)
    }
}

impl AddAssign<&TickTimes> for TickTimes {
    fn add_assign(&mut self, other: &Self) {
        for (own, count) in self.bins.iter_mut().zip(&other.bins) {
            *own = own.saturating_add(*count);
        }
        self.count = self.count.saturating_add(other.count);
    }
}

/// Starts with no tick.
impl Default for TickTimes {
    fn default() -> Self {
        Self { bins: vec![0; BINS + 1], count: 0 }
    }
}

impl TickTimes {
    /// Adds a time (µs).
    pub(super) fn push(&mut self, time: f64) {
        // Negative and NaN become 0, and what is too large the last bin.
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "as above")]
        let bin = ((time / WIDTH) as usize).min(BINS);
        self.bins[bin] += 1;
        self.count += 1;
    }

    /// The time that so many thousandths of the ticks do not exceed (µs), to the width of a bin.
    pub(super) fn quantile(&self, thousandths: u64) -> f64 {
        let rank = (self.count * thousandths / 1000).min(self.count.saturating_sub(1));
        let mut before = 0;
        for (bin, count) in self.bins.iter().enumerate() {
            before += count;
            if before > rank {
                return WIDTH * bin as f64;
            }
        }
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::TickTimes;

    #[test]
    fn quantiles_are_those_of_the_sorted_times() {
        let mut times = TickTimes::default();
        assert_eq!(times.quantile(500), 0.0);
        for time in (0..1000_u32).rev() {
            times.push(f64::from(time) + 0.05);
        }
        times.push(1e9);
        assert!((times.quantile(500) - 500.0).abs() < 1e-9);
        assert!((times.quantile(999) - 999.0).abs() < 1e-9);
        assert!((times.quantile(1000) - 10_000.0).abs() < 1e-9);
    }
}
