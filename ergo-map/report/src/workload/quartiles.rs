//! Values of a box in a box plot.

use serde::Serialize;

/// Median and quartiles of numbers, interpolated linearly between the ordered numbers (Hyndman &
/// Fan's definition 7, the default of NumPy and R).
///
/// ```
/// use ergo_report::workload::Quartiles;
///
/// let quartiles = Quartiles::of(&[4.0, 1.0, 3.0, 2.0]);
/// assert_eq!((quartiles.lower, quartiles.median, quartiles.upper), (1.75, 2.5, 3.25));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Quartiles {
    /// Lower quartile.
    pub lower: f64,
    /// Median.
    pub median: f64,
    /// Upper quartile.
    pub upper: f64,
}

impl Quartiles {
    /// Computes the quartiles. They are NaN if there is no number.
    pub fn of(numbers: &[f64]) -> Self {
        let mut ordered = numbers.to_vec();
        ordered.sort_by(f64::total_cmp);
        let [lower, median, upper] = [0.25, 0.5, 0.75].map(|share| between(&ordered, share));
        Self { lower, median, upper }
    }

    /// Returns the interquartile range.
    pub fn range(&self) -> f64 {
        self.upper - self.lower
    }
}

/// Returns the number below which this share of the ordered numbers lies.
fn between(ordered: &[f64], share: f64) -> f64 {
    let Some(last) = ordered.len().checked_sub(1) else { return f64::NAN };
    let place = share * last as f64;
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // From 0 to the last.
    let below = place.floor() as usize;
    let (low, high) = (ordered[below], ordered[(below + 1).min(last)]);
    low + (high - low) * place.fract()
}
