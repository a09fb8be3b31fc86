//! Statistics of a loop's deadlines.

/// Width of a bin \[s\].
const WIDTH: f64 = 1e-6;
/// Number of bins. The last one counts all times of ten milliseconds and more.
const BINS: usize = 10_001;

/// A histogram of times with bins of a microsecond. Its memory does not grow.
///
/// ```
/// use whole_body::control_loop::TimeHistogram;
///
/// let mut times = TimeHistogram::default();
/// [1e-3, 2e-3, 3e-3].into_iter().for_each(|time| times.push(time));
/// assert!((times.quantile(0.5) - 2e-3).abs() < 1e-6);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct TimeHistogram {
    bins: Vec<u64>,
    count: u64,
    longest: f64,
}

/// Creates an empty histogram.
impl Default for TimeHistogram {
    fn default() -> Self {
        Self { bins: vec![0; BINS], count: 0, longest: 0.0 }
    }
}

impl TimeHistogram {
    /// Counts a time \[s\]. Times above ten milliseconds count as ten milliseconds.
    pub fn push(&mut self, time: f64) {
        // Negative times and NaN count as 0, long ones in the last bin.
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "as above")]
        let bin = ((time / WIDTH) as usize).min(BINS - 1);
        if let Some(bin) = self.bins.get_mut(bin) {
            *bin += 1;
        }
        self.count += 1;
        self.longest = self.longest.max(time);
    }

    /// The number of times that were counted.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// The longest time \[s\].
    pub fn longest(&self) -> f64 {
        self.longest
    }

    /// The quantile at `share`, 0 to 1, of the counted times \[s\], to a microsecond. Zero if nothing was counted.
    pub fn quantile(&self, share: f64) -> f64 {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share")]
        let rank = (share.clamp(0.0, 1.0) * self.count as f64).ceil().max(1.0) as u64;
        let mut counted = 0;
        for (bin, count) in self.bins.iter().enumerate() {
            counted += count;
            if counted >= rank {
                return WIDTH * bin as f64;
            }
        }
        0.0
    }
}

/// Statistics of how well a loop keeps its deadlines.
#[derive(Debug, Clone, PartialEq)]
pub struct DeadlineStatistics {
    /// Times from when a tick is due until it begins.
    pub latency: TimeHistogram,
    /// Times from when a tick begins until its command is sent.
    pub duration: TimeHistogram,
    /// Ticks that ran.
    pub ticks: u64,
    /// Ticks that did not run, because the one before had not ended or the system had not woken the loop.
    pub missed: u64,
    /// Ticks that ran so late that others were missed.
    pub late: u64,
    /// Ticks without a new measurement.
    pub unmeasured: u64,
}

impl DeadlineStatistics {
    pub(crate) fn new() -> Self {
        let none = TimeHistogram::default();
        Self { latency: none.clone(), duration: none, ticks: 0, missed: 0, late: 0, unmeasured: 0 }
    }
}
