//! Options for the recognition of actions.

use std::path::PathBuf;

use anyhow::Result;
use clap::Args;
use human_perception::Watch;
use human_perception::percepts::{ActionNetwork, ActionSettings};
use vision_models::SlowOnlyForm;

use super::choices::{self, with_option};

/// Recognition of the action in the colour images.
#[derive(Args, Debug)]
pub struct ActionOptions {
    /// The folder that `actions train` has made, whose model recognises the action over its windows.
    #[arg(long, value_name = "FOLDER")]
    action_model: Option<PathBuf>,
    /// The weights of the SlowOnly that the model was trained with, unless they are random. If there is no model, the
    /// weights of a SlowOnly with its own last layer.
    #[arg(long, value_name = "FILE")]
    action_weights: Option<PathBuf>,
    #[command(flatten)]
    own: OwnActionOptions,
}

/// Options for a SlowOnly with its own last layer. A trained model contains them.
#[derive(Args, Debug)]
#[expect(clippy::struct_field_names, reason = "they are the options' names")]
pub struct OwnActionOptions {
    /// The form of the network.
    #[arg(long, default_value = "slowonly_mm", value_parser = choices::slow_only(), requires = "action_weights", conflicts_with = "action_model")]
    action_network: SlowOnlyForm,
    /// The names of the classes, actions of HRI30, one a line; all thirty if left out.
    #[arg(long, value_name = "FILE", requires = "action_weights", conflicts_with = "action_model")]
    action_names: Option<PathBuf>,
    /// Frames of a clip.
    #[arg(
        long,
        value_name = "FRAMES",
        default_value_t = 8,
        requires = "action_weights",
        conflicts_with = "action_model"
    )]
    action_length: usize,
    /// Number of camera frames between two of a clip.
    #[arg(
        long,
        value_name = "FRAMES",
        default_value_t = 4,
        requires = "action_weights",
        conflicts_with = "action_model"
    )]
    action_interval: u64,
}

impl ActionOptions {
    /// The network of the options.
    ///
    /// # Errors
    /// Weights that cannot be read, or that do not fit the options.
    pub fn network(&self, threads: usize, watch: &mut Watch<'_>) -> Result<Option<ActionNetwork>> {
        let with_option = |error| with_option(error, "--action-weights FILE");
        let own = &self.own;
        Ok(match (&self.action_model, &self.action_weights) {
            (Some(folder), weights) => {
                let network = ActionNetwork::of_model(folder, weights.clone(), threads, watch);
                Some(network.map_err(with_option)?)
            }
            (None, Some(weights)) => {
                let settings = ActionSettings {
                    weights,
                    form: own.action_network,
                    names: own.action_names.as_deref(),
                    length: own.action_length,
                    interval: own.action_interval,
                };
                Some(ActionNetwork::load(&settings, threads, watch).map_err(with_option)?)
            }
            (None, None) => None,
        })
    }
}
