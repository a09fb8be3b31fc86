//! The names of networks in files and on command lines.

use vision_models::{
    NetworkKind,
    ResNetDepth::{self, Eighteen, Fifty, OneHundredFiftyTwo, OneHundredOne, ThirtyFour},
    ResNetForm, SimpleBaselineForm, SlowFastForm,
    SlowOnlyForm::{self, MmAction2, MmAction2Depth18, MmAction2Depth101, PyTorchVideo},
};

/// Returns the depths of ResNets with their numbers of layers.
pub fn depths() -> [(&'static str, ResNetDepth); 5] {
    [
        ("18", Eighteen),
        ("34", ThirtyFour),
        ("50", Fifty),
        ("101", OneHundredOne),
        ("152", OneHundredFiftyTwo),
    ]
}

/// Returns the forms of SlowOnly with their names.
pub fn forms() -> [(&'static str, SlowOnlyForm); 4] {
    [
        ("slowonly_mm", MmAction2),
        ("slowonly_r18_mm", MmAction2Depth18),
        ("slowonly_r101_mm", MmAction2Depth101),
        ("slowonly_ptv", PyTorchVideo),
    ]
}

/// Returns every network that runs on one array.
pub fn networks() -> Vec<(&'static str, NetworkKind)> {
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

/// Returns the depth with this many layers.
pub fn depth_of(layers: &str) -> Option<ResNetDepth> {
    depths().into_iter().find_map(|(name, depth)| (name == layers).then_some(depth))
}

/// Returns the form of SlowOnly with this name.
pub(crate) fn form_of(name: &str) -> Option<SlowOnlyForm> {
    forms().into_iter().find_map(|(own, form)| (own == name).then_some(form))
}

/// Returns the name of a network.
pub fn name_of(kind: NetworkKind) -> Option<&'static str> {
    networks().into_iter().find_map(|(name, own)| (own == kind).then_some(name))
}
