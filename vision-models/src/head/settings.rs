//! Settings for training a head.

use crate::error::Error;
use crate::head::scaling::FeatureScaling;

/// Settings of stochastic gradient descent.
///
/// ```
/// use vision_models::HeadSettings;
///
/// let settings = HeadSettings { epochs: 20, ..HeadSettings::default() };
/// assert_eq!(settings.learning_rate, 0.001);
/// assert!(settings.validate().is_ok());
/// assert!(HeadSettings { dropout: 1.0, ..settings }.validate().is_err());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeadSettings {
    /// Learning rate. Default 0.001 (paper, Sec. "Experiment 1").
    pub learning_rate: f64,
    /// Momentum: share of the previous step that is added again. Default 0.9.
    pub momentum: f64,
    /// Weight of ½|w|² beside the mean cross-entropy. Default 0.
    pub weight_decay: f64,
    /// Probability that a feature of a sample is left out of a step. Default 0.5. The others are
    /// scaled up, so that nothing changes when the head is used.
    pub dropout: f64,
    /// Number of samples per step. Default 32.
    pub batch: usize,
    /// Number of passes through all samples. Default 100.
    pub epochs: usize,
    /// Scaling of the features in [`LinearHead::train`](super::LinearHead::train). Default none.
    pub scaling: FeatureScaling,
    /// Seed of the initial weights, the order of the samples and the dropout.
    pub seed: u64,
}

impl Default for HeadSettings {
    fn default() -> Self {
        Self {
            learning_rate: 0.001,
            momentum: 0.9,
            weight_decay: 0.0,
            dropout: 0.5,
            batch: 32,
            epochs: 100,
            scaling: FeatureScaling::None,
            seed: 1,
        }
    }
}

impl HeadSettings {
    /// Checks every setting.
    ///
    /// # Errors
    /// [`Error::Value`].
    pub fn validate(&self) -> Result<(), Error> {
        let within = |value: f64, least: f64, below: f64| (least..below).contains(&value);
        let checks = [
            (
                "learning_rate",
                self.learning_rate,
                self.learning_rate > 0.0 && self.learning_rate.is_finite(),
                "a positive finite number",
            ),
            ("momentum", self.momentum, within(self.momentum, 0.0, 1.0), "from 0 to below 1"),
            (
                "weight_decay",
                self.weight_decay,
                within(self.weight_decay, 0.0, f64::INFINITY),
                "a finite number from 0",
            ),
            ("dropout", self.dropout, within(self.dropout, 0.0, 1.0), "from 0 to below 1"),
            ("batch", self.batch as f64, self.batch > 0, "at least one"),
            ("epochs", self.epochs as f64, self.epochs > 0, "at least one"),
        ];
        match checks.into_iter().find(|(_, _, right, _)| !right) {
            Some((name, value, _, expected)) => Err(Error::value(name, value, expected)),
            None => Ok(()),
        }
    }
}
