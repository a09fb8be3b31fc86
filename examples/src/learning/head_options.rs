//! Options of the training of a last layer.

use anyhow::Result;
use clap::Args;
use vision_models::{FeatureScaling, HeadSettings};

use crate::vision::choices::with_option;

/// How a new last layer is trained, by stochastic gradient descent.
#[derive(Args, Clone, Copy, Debug)]
pub struct HeadOptions {
    /// How often the last layer is shown all samples.
    #[arg(long, default_value_t = 100)]
    epochs: usize,
    /// The length of its steps.
    #[arg(long, default_value_t = 0.001, allow_negative_numbers = true)]
    learning_rate: f64,
    /// The probability that it is not shown a feature.
    #[arg(long, default_value_t = 0.5, allow_negative_numbers = true)]
    dropout: f64,
    /// Scale each feature to mean zero and variance one for the training: where a backbone's features differ in size,
    /// as random ones do, the steps then go further. The layer takes features as they are all the same.
    #[arg(long)]
    standardise: bool,
}

impl HeadOptions {
    /// The settings, checked.
    ///
    /// # Errors
    /// With the option that is out of its range.
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
