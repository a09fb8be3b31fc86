//! The networks by their names on the command line.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use vision_models::{
    NetworkKind,
    ResNetDepth::{self, Eighteen, Fifty, OneHundredFiftyTwo, OneHundredOne, ThirtyFour},
    ResNetForm, SimpleBaselineForm, SlowFastForm,
    SlowOnlyForm::{self, MmAction2, MmAction2Depth18, MmAction2Depth101, PyTorchVideo},
};

/// Names, and what they stand for.
type Choices<T> = Vec<(&'static str, T)>;

fn depths() -> Choices<ResNetDepth> {
    vec![
        ("18", Eighteen),
        ("34", ThirtyFour),
        ("50", Fifty),
        ("101", OneHundredOne),
        ("152", OneHundredFiftyTwo),
    ]
}

fn forms() -> Choices<SlowOnlyForm> {
    vec![
        ("slowonly_mm", MmAction2),
        ("slowonly_r18_mm", MmAction2Depth18),
        ("slowonly_r101_mm", MmAction2Depth101),
        ("slowonly_ptv", PyTorchVideo),
    ]
}

fn networks() -> Choices<NetworkKind> {
    let resnets = [
        ("resnet18", Eighteen.into()),
        ("resnet34", ThirtyFour.into()),
        ("resnet50", Fifty.into()),
        ("resnet101", OneHundredOne.into()),
        ("resnet152", OneHundredFiftyTwo.into()),
        ("resnext50_32x4d", ResNetForm::RESNEXT_50_32X4D),
        ("resnext101_32x8d", ResNetForm::RESNEXT_101_32X8D),
        ("resnext101_64x4d", ResNetForm::RESNEXT_101_64X4D),
        ("wide_resnet50_2", ResNetForm::WIDE_50_2),
        ("wide_resnet101_2", ResNetForm::WIDE_101_2),
    ];
    let slow_fasts = [
        ("slowfast_ptv", SlowFastForm::PyTorchVideo),
        ("slowfast_r50_8x8_mm", SlowFastForm::MmAction2EveryFourth(Fifty)),
        ("slowfast_r101_8x8_mm", SlowFastForm::MmAction2EveryFourth(OneHundredOne)),
        ("slowfast_r50_4x16_mm", SlowFastForm::MmAction2EveryEighth(Fifty)),
        ("slowfast_r101_4x16_mm", SlowFastForm::MmAction2EveryEighth(OneHundredOne)),
    ];
    let simple_baselines = [
        ("simple_baseline", SimpleBaselineForm::Microsoft),
        ("simple_baseline_mmpose0", SimpleBaselineForm::MmPose0),
        ("simple_baseline_mmpose1", SimpleBaselineForm::MmPose1),
    ];
    let simple_baselines =
        simple_baselines.map(|(name, form)| (name, NetworkKind::SimpleBaseline(form)));
    let resnets = resnets.map(|(name, form)| (name, NetworkKind::ResNet(form)));
    let slow_onlys = forms().into_iter().map(|(name, form)| (name, NetworkKind::SlowOnly(form)));
    let slow_fasts = slow_fasts.map(|(name, form)| (name, NetworkKind::SlowFast(form)));
    resnets.into_iter().chain(slow_onlys).chain(slow_fasts).chain(simple_baselines).collect()
}

/// Reads the depth of a ResNet: 18, 34, 50, 101 or 152.
pub fn depth() -> impl TypedValueParser<Value = ResNetDepth> {
    parser(depths(), |depth| NetworkKind::ResNet(depth.into()))
}

/// The depth of this many layers.
pub fn depth_of(layers: &str) -> Option<ResNetDepth> {
    depths().into_iter().find_map(|(name, depth)| (name == layers).then_some(depth))
}

/// Reads the form of a SlowOnly.
pub fn slow_only() -> impl TypedValueParser<Value = SlowOnlyForm> {
    parser(forms(), NetworkKind::SlowOnly)
}

/// Reads the name of a form of SlowOnly, as it is.
pub fn slow_only_name() -> impl TypedValueParser<Value = String> {
    let value =
        |(name, form)| PossibleValue::new(name).help(NetworkKind::SlowOnly(form).to_string());
    PossibleValuesParser::new(forms().into_iter().map(value))
}

/// The form of SlowOnly of this name.
pub fn slow_only_of(name: &str) -> Option<SlowOnlyForm> {
    forms().into_iter().find_map(|(own, form)| (own == name).then_some(form))
}

/// Reads the name of any network.
pub fn network() -> impl TypedValueParser<Value = NetworkKind> {
    parser(networks(), |kind| kind)
}

fn parser<T: Copy + Send + Sync + 'static>(
    choices: Choices<T>,
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
        let depth = depths()
            .into_iter()
            .find_map(|(name, depth)| (found == NetworkKind::ResNet(depth.into())).then_some(name));
        let known = networks().into_iter().find(|(_, kind)| *kind == found);
        let Some((model, _)) = known else { return "no program takes it by a name".into() };
        match (self, found, depth) {
            (Self::ResNets, _, Some(depth)) => format!("try --depth {depth}"),
            (Self::SlowOnlys, _, Some(depth)) => format!("try classify --depth {depth}"),
            (Self::All, ..) | (Self::SlowOnlys, NetworkKind::SlowOnly(_), _) => {
                format!("try --model {model}")
            }
            (_, NetworkKind::SlowOnly(_), _) => format!("try recognise --model {model}"),
            _ => format!("try infer --model {model}"),
        }
    }
}
