//! What is known of a person beside their joints, on the command line.

use clap::Args;
use human_perception::percepts::PostureSettings;

/// What is known of a person beside their joints.
#[derive(Args, Clone, Copy, Debug, Default, PartialEq)]
pub struct PostureOptions {
    /// Score the person as seated; without it a seat is found by balance.
    #[arg(long)]
    pub sitting: bool,
    /// Score the person's arm as supported.
    #[arg(long)]
    pub arm_supported: bool,
    /// The person stands upright and looks ahead for so long after being seen first (s): their angles count
    /// from there. An average is taken with 0.
    #[arg(long, value_name = "SECONDS", default_value_t = 0.0)]
    pub upright: f64,
}

impl PostureOptions {
    /// The settings, checked.
    ///
    /// # Errors
    /// For a time that is negative, over ten minutes or not finite.
    pub fn settings(self) -> Result<PostureSettings, ergo_map::Error> {
        let Self { sitting, arm_supported, upright } = self;
        PostureSettings { sitting, arm_supported, upright }.checked().map_err(|error| match error {
            ergo_map::Error::Value { got, unit, wanted, .. } => {
                ergo_map::Error::Value { what: "--upright", got, unit, wanted }
            }
            error => error,
        })
    }
}
