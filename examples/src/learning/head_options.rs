//! Options of the training of a last layer.

use anyhow::Result;
use clap::Args;
use vision_models::{FeatureScaling, HeadSettings};

use crate::vision::choices::with_option;

/// Training of a new last layer by stochastic gradient descent.
#[derive(Args, Clone, Copy, Debug)]
pub struct HeadOptions {
    /// Number of times that the last layer sees all samples.
    #[arg(long, default_value_t = 100)]
    epochs: usize,
    /// Learning rate: the length of the steps.
    #[arg(long, default_value_t = 0.001, allow_negative_numbers = true)]
    learning_rate: f64,
    /// Dropout: the probability that a feature is left out.
    #[arg(long, default_value_t = 0.5, allow_negative_numbers = true)]
    dropout: f64,
    /// Scale each feature to mean zero and variance one for the training. Steps then go further if a backbone's
    /// features differ in size, as random ones do. The trained layer takes unscaled features.
    #[arg(long)]
    standardise: bool,
}

impl HeadOptions {
    /// The checked settings.
    ///
    /// # Errors
    /// The option that is out of its range.
    pub fn settings(self, seed: u64) -> Result<HeadSettings> {
        let Self { epochs, learning_rate, dropout, standardise } = self;
        let scaling = if standardise { FeatureScaling::Standardised } else { FeatureScaling::None };
        let settings = HeadSettings {
            learning_rate,
            dropout,
            epochs,
            scaling,
            seed,
            ..HeadSettings::default()
        };
        settings.validate().map_err(|error| with_option(error.into(), ""))?;
        Ok(settings)
    }
}
