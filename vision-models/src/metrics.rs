//! Accuracy of a classifier.

use crate::error::Error;

/// Counts of samples by true class (rows) and given class (columns).
///
/// ```
/// use vision_models::ConfusionMatrix;
///
/// let mut matrix = ConfusionMatrix::new(2);
/// for (truth, given) in [(0, 0), (0, 0), (0, 1), (1, 1)] {
///     matrix.add(truth, given)?;
/// }
/// assert_eq!(matrix.accuracy(), Some(0.75));
/// assert_eq!(matrix.percent(0, 1), Some(100.0 / 3.0));
/// # Ok::<(), vision_models::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ConfusionMatrix {
    classes: usize,
    counts: Vec<u64>,
}

impl ConfusionMatrix {
    /// Creates an empty matrix for this number of classes.
    pub fn new(classes: usize) -> Self {
        Self { classes, counts: vec![0; classes * classes] }
    }

    /// Counts a sample.
    ///
    /// # Errors
    /// [`Error::Value`] if a class does not exist.
    pub fn add(&mut self, truth: usize, given: usize) -> Result<(), Error> {
        let classes = self.classes;
        for class in [truth, given] {
            if class >= classes {
                return Err(Error::value("the class", class, &format!("an index below {classes}")));
            }
        }
        if let Some(count) = self.counts.get_mut(truth * classes + given) {
            *count += 1;
        }
        Ok(())
    }

    /// Returns how many samples of class `truth` were given class `given`. Zero if a class does not
    /// exist.
    pub fn count(&self, truth: usize, given: usize) -> u64 {
        self.row(truth).get(given).copied().unwrap_or(0)
    }

    /// Returns the share of samples of class `truth` that were given class `given`, in percent as
    /// in the paper. `None` if there are no samples of class `truth`.
    pub fn percent(&self, truth: usize, given: usize) -> Option<f64> {
        ratio(100 * self.count(truth, given), self.row(truth).iter().sum())
    }

    /// Returns the share of samples that were given their true class. `None` if there are no
    /// samples.
    pub fn accuracy(&self) -> Option<f64> {
        let right = (0..self.classes).map(|class| self.count(class, class)).sum();
        ratio(right, self.counts.iter().sum())
    }

    fn row(&self, truth: usize) -> &[u64] {
        let start = truth.saturating_mul(self.classes);
        self.counts.get(start..start.saturating_add(self.classes)).unwrap_or_default()
    }
}

fn ratio(part: u64, whole: u64) -> Option<f64> {
    (whole > 0).then(|| part as f64 / whole as f64)
}

/// Returns the classes of the k largest scores, the largest first. Equal classes are in the order
/// of their numbers.
pub fn top_k(scores: &[f32], k: usize) -> Vec<usize> {
    let mut classes: Vec<usize> = (0..scores.len()).collect();
    let score = |class: usize| scores.get(class).copied().unwrap_or(f32::NAN);
    classes.sort_by(|&one, &other| score(other).total_cmp(&score(one)));
    classes.truncate(k);
    classes
}

/// Returns probabilities from scores: exp(s_i) / Σ exp(s_j).
pub fn softmax(scores: &[f32]) -> Vec<f32> {
    let largest = scores.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    let powers: Vec<f32> = scores.iter().map(|score| (score - largest).exp()).collect();
    let sum: f32 = powers.iter().sum();
    powers.into_iter().map(|power| power / sum).collect()
}
