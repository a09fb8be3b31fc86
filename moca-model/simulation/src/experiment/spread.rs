//! Statistics of many numbers.

use serde::Serialize;

/// Mean, deviation and worst of numbers of which less is better.
///
/// ```
/// use moca_simulation::experiment::Spread;
///
/// let spread = Spread::of([1.0, 2.0, 6.0]);
/// assert_eq!((spread.mean, spread.worst), (3.0, 6.0));
/// assert!((spread.deviation - 7.0_f64.sqrt()).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spread {
    /// Arithmetic mean; NaN without numbers.
    pub mean: f64,
    /// Standard deviation of the sample, with n − 1; 0 for fewer than two numbers.
    pub deviation: f64,
    /// The largest; NaN without numbers.
    pub worst: f64,
}

impl Spread {
    /// Computes the statistics of these numbers.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Self {
        let values: Vec<f64> = values.into_iter().collect();
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
        let deviation = if count < 2.0 { 0.0 } else { (squares / (count - 1.0)).sqrt() };
        Self { mean, deviation, worst: values.into_iter().fold(f64::NAN, f64::max) }
    }
}

/// Comparison of two numbers case by case, where less is better.
///
/// ```
/// use moca_simulation::experiment::Duel;
///
/// let duel = Duel::of([(1.0, 3.0), (2.0, 1.0)]);
/// assert_eq!((duel.ratio_mean, duel.ratio_least, duel.wins), (1.75, 0.5, 0.5));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Duel {
    /// Mean over the cases of the second number over the first.
    pub ratio_mean: f64,
    /// The least of these ratios: the case in which the first does worst.
    pub ratio_least: f64,
    /// Share of the cases in which the first is less.
    pub wins: f64,
}

impl Duel {
    /// Computes the comparison of these pairs.
    pub fn of(pairs: impl IntoIterator<Item = (f64, f64)>) -> Self {
        let pairs: Vec<(f64, f64)> = pairs.into_iter().collect();
        let ratios = pairs.iter().map(|(first, second)| second / first);
        let ratio = Spread::of(ratios.clone());
        let wins = pairs.iter().filter(|(first, second)| first < second).count();
        Self {
            ratio_mean: ratio.mean,
            ratio_least: ratios.fold(f64::NAN, f64::min),
            wins: wins as f64 / pairs.len() as f64,
        }
    }
}
