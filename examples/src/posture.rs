//! Options for a person's posture besides their joints.

use clap::Args;
use human_perception::percepts::PostureSettings;

/// Options for a person's posture besides their joints.
#[derive(Args, Clone, Copy, Debug, Default, PartialEq)]
pub struct PostureOptions {
    /// Score the person as seated. Default: a seat is found by balance.
    #[arg(long)]
    pub sitting: bool,
    /// Score the person's arm as supported.
    #[arg(long)]
    pub arm_supported: bool,
    /// Time for which the person stands upright and looks ahead after being seen first (s). Their angles count from
    /// that posture. Zero takes an average.
    #[arg(long, value_name = "SECONDS", default_value_t = 0.0)]
    pub upright: f64,
}

impl PostureOptions {
    /// The checked settings.
    ///
    /// # Errors
    /// A time that is negative, over ten minutes or not finite.
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
