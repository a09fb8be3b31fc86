//! Data of a run for figures, in bounded memory.

use super::TickRow;

/// Largest number of intervals: more than a figure has columns of pixels.
const MOST: usize = 800;

/// Run as a figure shows it: intervals of equally many ticks with the extremes of every curve, so that no peak is lost.
/// When there are too many, neighbours are merged.
///
/// ```
/// use moca_replay::report::{RunLog, TickRow};
///
/// let mut log = RunLog::new("Ergonomics on");
/// for tick in 0..60_000 {
///     log.push(&TickRow { time: 1e-3 * f64::from(tick), score: 0.2, ..TickRow::default() });
/// }
/// assert_eq!(log.title(), "Ergonomics on");
/// ```
#[derive(Clone, Debug)]
pub struct RunLog {
    title: String,
    pub(super) intervals: Vec<Interval>,
    /// Ticks per interval.
    stride: usize,
    pub(super) collaboration: Collaboration,
}

/// Mean score of the ticks in which the person works with the robot.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Collaboration {
    ticks: u32,
    score_sum: f64,
    pub(super) reba_max: u8,
}

/// Consecutive ticks.
#[derive(Clone, Copy, Debug)]
pub(super) struct Interval {
    ticks: usize,
    /// Begin and end \[s\].
    pub(super) begin: f64,
    pub(super) end: f64,
    pub(super) desired: [Span; 3],
    pub(super) actual: [Span; 3],
    /// Bounds of the workspace \[m\].
    pub(super) workspace_min: [Span; 3],
    pub(super) workspace_max: [Span; 3],
    pub(super) score: Span,
    /// Worst measured score.
    pub(super) reba_measured: Option<u8>,
    pub(super) collaborating: bool,
}

/// Values of a curve in an interval. NaN is left out unless there is nothing else.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Span {
    first: f64,
    last: f64,
    pub(super) low: f64,
    pub(super) high: f64,
}

impl Span {
    fn of(value: f64) -> Self {
        Self { first: value, last: value, low: value, high: value }
    }

    /// Merges this span and a later one.
    fn and(self, later: Self) -> Self {
        Self {
            first: if self.first.is_nan() { later.first } else { self.first },
            last: if later.last.is_nan() { self.last } else { later.last },
            low: self.low.min(later.low),
            high: self.high.max(later.high),
        }
    }

    /// Returns both extremes in the order in which a monotone curve has them.
    pub(super) fn in_order(&self) -> [f64; 2] {
        if self.first <= self.last { [self.low, self.high] } else { [self.high, self.low] }
    }
}

impl Interval {
    fn of(row: &TickRow) -> Self {
        Self {
            ticks: 1,
            begin: row.time,
            end: row.time,
            desired: row.desired.map(Span::of),
            actual: row.actual.map(Span::of),
            workspace_min: row.workspace_min.map(Span::of),
            workspace_max: row.workspace_max.map(Span::of),
            score: Span::of(row.score),
            reba_measured: row.reba_measured,
            collaborating: row.collaborating,
        }
    }

    /// Merges this interval and the next.
    fn and(self, next: Self) -> Self {
        let each = |these: [Span; 3], those: [Span; 3]| {
            let [x, y, z] = these;
            let [next_x, next_y, next_z] = those;
            [x.and(next_x), y.and(next_y), z.and(next_z)]
        };
        Self {
            ticks: self.ticks + next.ticks,
            begin: self.begin,
            end: next.end,
            desired: each(self.desired, next.desired),
            actual: each(self.actual, next.actual),
            workspace_min: each(self.workspace_min, next.workspace_min),
            workspace_max: each(self.workspace_max, next.workspace_max),
            score: self.score.and(next.score),
            reba_measured: self.reba_measured.max(next.reba_measured),
            collaborating: self.collaborating || next.collaborating,
        }
    }
}

impl Collaboration {
    /// Returns the mean of the score; `None` if there was no such tick.
    pub(super) fn score_mean(&self) -> Option<f64> {
        (self.ticks > 0).then(|| self.score_sum / f64::from(self.ticks))
    }
}

impl RunLog {
    /// Creates a log without ticks. The title stands above its column of the figure.
    pub fn new(title: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            intervals: Vec::with_capacity(MOST),
            stride: 1,
            collaboration: Collaboration::default(),
        }
    }

    /// Returns the title.
    pub fn title(&self) -> &str {
        &self.title
    }

    /// Adds a tick; ticks must come in the order of time.
    pub fn push(&mut self, row: &TickRow) {
        if row.collaborating && row.score.is_finite() {
            let of = &mut self.collaboration;
            of.ticks = of.ticks.saturating_add(1);
            of.score_sum += row.score;
            of.reba_max = of.reba_max.max(row.reba);
        }
        let tick = Interval::of(row);
        match self.intervals.last_mut() {
            Some(last) if last.ticks < self.stride => *last = last.and(tick),
            _ => {
                if self.intervals.len() == MOST {
                    self.halve();
                }
                self.intervals.push(tick);
            }
        }
    }

    /// Merges each two neighbours.
    fn halve(&mut self) {
        self.stride *= 2;
        self.intervals = self
            .intervals
            .chunks(2)
            .filter_map(|pair| pair.iter().copied().reduce(Interval::and))
            .collect();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_is_bounded_and_no_peak_is_lost() {
        let mut log = RunLog::new("run");
        for tick in 0..123_456_u32 {
            let score = if tick == 77_777 { 4.0 } else { 0.5 };
            let time = 1e-3 * f64::from(tick);
            let collaborating = tick >= 60_000;
            log.push(&TickRow { time, score, collaborating, reba: 2, ..TickRow::default() });
            assert!(log.intervals.len() <= MOST);
        }
        assert!(log.intervals.len() > MOST / 3);
        let peak = |interval: &&Interval| interval.score.high > 3.9;
        let peak = log.intervals.iter().find(peak).map(|interval| (interval.begin, interval.end));
        assert!(peak.is_some_and(|(begin, end)| begin <= 77.777 && 77.777 <= end));
        let ticks: usize = log.intervals.iter().map(|interval| interval.ticks).sum();
        assert_eq!(ticks, 123_456);
        assert!(log.intervals.windows(2).all(|pair| pair[0].end < pair[1].begin));
        let mean = log.collaboration.score_mean();
        assert!(mean.is_some_and(|mean| (mean - (0.5 + 3.5 / 63_456.0)).abs() < 1e-9));
    }

    #[test]
    fn spans_keep_order_and_leave_nan_out() {
        let rising = Span::of(1.0).and(Span::of(f64::NAN)).and(Span::of(3.0));
        assert_eq!(rising.in_order().map(f64::to_bits), [1.0_f64, 3.0].map(f64::to_bits));
        let falling = Span::of(3.0).and(Span::of(4.0)).and(Span::of(1.0));
        assert_eq!(falling.in_order().map(f64::to_bits), [4.0_f64, 1.0].map(f64::to_bits));
    }
}
