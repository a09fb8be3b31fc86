//! Networks by their names on the command line.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use human_perception::{Error, networks::names};
use vision_models::{NetworkKind, ResNetDepth, SlowOnlyForm};

/// Reads the depth of a ResNet: 18, 34, 50, 101 or 152.
pub fn depth() -> impl TypedValueParser<Value = ResNetDepth> {
    parser(names::depths().into(), |depth| NetworkKind::ResNet(depth.into()))
}

/// Reads the form of a SlowOnly.
pub fn slow_only() -> impl TypedValueParser<Value = SlowOnlyForm> {
    parser(names::forms().into(), NetworkKind::SlowOnly)
}

/// Reads the name of a form of SlowOnly without conversion.
pub fn slow_only_name() -> impl TypedValueParser<Value = String> {
    let value =
        |(name, form)| PossibleValue::new(name).help(NetworkKind::SlowOnly(form).to_string());
    PossibleValuesParser::new(names::forms().map(value))
}

fn parser<T: Copy + Send + Sync + 'static>(
    choices: Vec<(&'static str, T)>,
    kind: fn(T) -> NetworkKind,
) -> impl TypedValueParser<Value = T> {
    let values: Vec<_> = choices
        .iter()
        .map(|&(name, value)| PossibleValue::new(name).help(kind(value).to_string()))
        .collect();
    PossibleValuesParser::new(values).try_map(move |given| {
        let choice = choices.iter().find(|(name, _)| *name == given);
        choice.map(|&(_, value)| value).ok_or("no such network")
    })
}

/// Adds the option that would be right to an error.
pub fn with_option(error: Error, option: &str) -> anyhow::Error {
    match error {
        Error::OtherNetwork { found, .. } => {
            let hint = match names::name_of(found) {
                Some(name) => format!("try --model {name}"),
                None => "no program takes it by a name".to_owned(),
            };
            anyhow::anyhow!("{error}: {hint}")
        }
        Error::NoWeights { .. } => anyhow::anyhow!("give the model's weights: {option}"),
        Error::Vision(vision_models::Error::Value { what, got, wanted }) => {
            anyhow::anyhow!("--{what} {got}: give {wanted}")
        }
        error => error.into(),
    }
}
