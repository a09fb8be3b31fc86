//! The networks by their names on the command line.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use vision_models::{
    NetworkKind,
    ResNetDepth::{self, Eighteen, Fifty, OneHundredFiftyTwo, OneHundredOne, ThirtyFour},
    SlowOnlyForm::{self, MmAction2, MmAction2Depth18, PyTorchVideo},
};

/// Names, and what they stand for.
type Choices<T> = &'static [(&'static str, T)];

const DEPTHS: Choices<ResNetDepth> = &[
    ("18", Eighteen),
    ("34", ThirtyFour),
    ("50", Fifty),
    ("101", OneHundredOne),
    ("152", OneHundredFiftyTwo),
];

const FORMS: Choices<SlowOnlyForm> = &[
    ("slowonly_mm", MmAction2),
    ("slowonly_r18_mm", MmAction2Depth18),
    ("slowonly_ptv", PyTorchVideo),
];

const NETWORKS: Choices<NetworkKind> = &[
    ("resnet18", NetworkKind::ResNet(Eighteen)),
    ("resnet34", NetworkKind::ResNet(ThirtyFour)),
    ("resnet50", NetworkKind::ResNet(Fifty)),
    ("resnet101", NetworkKind::ResNet(OneHundredOne)),
    ("resnet152", NetworkKind::ResNet(OneHundredFiftyTwo)),
    ("slowonly_mm", NetworkKind::SlowOnly(MmAction2)),
    ("slowonly_r18_mm", NetworkKind::SlowOnly(MmAction2Depth18)),
    ("slowonly_ptv", NetworkKind::SlowOnly(PyTorchVideo)),
    ("slowfast_ptv", NetworkKind::SlowFast),
];

/// Reads the depth of a ResNet: 18, 34, 50, 101 or 152.
pub fn depth() -> impl TypedValueParser<Value = ResNetDepth> {
    parser(DEPTHS, NetworkKind::ResNet)
}

/// Reads the form of a SlowOnly.
pub fn slow_only() -> impl TypedValueParser<Value = SlowOnlyForm> {
    parser(FORMS, NetworkKind::SlowOnly)
}

/// Reads the name of any network.
pub fn network() -> impl TypedValueParser<Value = NetworkKind> {
    parser(NETWORKS, |kind| kind)
}

fn parser<T: Copy + Send + Sync>(
    choices: Choices<T>,
    kind: fn(T) -> NetworkKind,
) -> impl TypedValueParser<Value = T> {
    let values =
        choices.iter().map(|&(name, value)| PossibleValue::new(name).help(kind(value).to_string()));
    PossibleValuesParser::new(values).try_map(move |given| {
        let choice = choices.iter().find(|(name, _)| *name == given);
        choice.map(|&(_, value)| value).ok_or("no such network")
    })
}

/// The networks that a program takes, and the option that chooses among them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Accepted {
    /// `classify --depth`.
    ResNets,
    /// `recognise --model`.
    SlowOnlys,
    /// `infer --model`.
    All,
}

impl Accepted {
    /// What to try with a checkpoint of this network.
    pub fn hint(self, found: NetworkKind) -> String {
        let option = match found {
            NetworkKind::ResNet(depth) if self != Self::All => {
                format!("--depth {}", name(DEPTHS, depth))
            }
            _ => format!("--model {}", name(NETWORKS, found)),
        };
        match (self, found) {
            (Self::ResNets, NetworkKind::ResNet(_))
            | (Self::SlowOnlys, NetworkKind::SlowOnly(_))
            | (Self::All, _) => format!("try {option}"),
            (_, NetworkKind::ResNet(_)) => format!("try classify {option}"),
            (_, NetworkKind::SlowOnly(_)) => format!("try recognise {option}"),
            (_, NetworkKind::SlowFast) => format!("try infer {option}"),
        }
    }
}

fn name<T: Copy + PartialEq>(choices: Choices<T>, value: T) -> &'static str {
    choices.iter().find(|(_, own)| *own == value).map_or("", |&(name, _)| name)
}
