//! Times of an inference and of loading: `cargo bench -p vision-models --bench networks`.
//!
//! Weights and inputs are random. `peers/run.sh` beside this file compares with other engines.
#![allow(clippy::unwrap_used, missing_docs)]

#[path = "../tests/it/support.rs"]
mod support;

use divan::Bencher;
use ndarray::{Array4, Array5, s};
use support::{input, weights};
use vision_models::{
    Options, ResNet, ResNetDepth, SlowFast, SlowFastForm, SlowOnly, SlowOnlyForm, SlowOnlyStream,
};

const THREADS: [usize; 2] = [1, 2];
const CLIP: [usize; 3] = [8, 256, 256];

fn main() {
    divan::main();
}

fn options(threads: usize) -> Options {
    Options { threads, ..Options::default() }
}

fn resnet(bencher: Bencher, depth: ResNetDepth, threads: usize) {
    let tensors = weights(ResNet::parameters(depth, 1000));
    let mut network = ResNet::load(depth, tensors, [224, 224], options(threads)).unwrap();
    let image: Array4<f32> = input((1, 3, 224, 224));
    bencher.bench_local(|| network.infer(image.view()).unwrap().logits[[0, 0]]);
}

#[divan::bench(args = THREADS)]
fn resnet50(bencher: Bencher, threads: usize) {
    resnet(bencher, ResNetDepth::Fifty, threads);
}

#[divan::bench(args = THREADS)]
fn resnet152(bencher: Bencher, threads: usize) {
    resnet(bencher, ResNetDepth::OneHundredFiftyTwo, threads);
}

#[divan::bench(sample_count = 10)]
fn resnet50_load(bencher: Bencher) {
    let tensors = weights(ResNet::parameters(ResNetDepth::Fifty, 1000));
    bencher.with_inputs(|| tensors.clone()).bench_local_values(|tensors| {
        ResNet::load(ResNetDepth::Fifty, tensors, [224; 2], options(1))
    });
}

fn slow_only(threads: usize) -> SlowOnly {
    let form = SlowOnlyForm::MmAction2;
    SlowOnly::load(form, weights(SlowOnly::parameters(form, 30)), CLIP, options(threads)).unwrap()
}

#[divan::bench(args = THREADS, sample_count = 5)]
fn slow_only_clip(bencher: Bencher, threads: usize) {
    let mut network = slow_only(threads);
    let [frames, height, width] = CLIP;
    let clip: Array5<f32> = input((1, 3, frames, height, width));
    bencher.bench_local(|| network.infer(clip.view()).unwrap().logits[[0, 0]]);
}

#[divan::bench(args = THREADS, sample_count = 5)]
fn slow_only_new_frame(bencher: Bencher, threads: usize) {
    let mut stream = SlowOnlyStream::new(slow_only(threads), CLIP).unwrap();
    let [frames, height, width] = CLIP;
    let clip: Array5<f32> = input((1, 3, frames, height, width));
    let mut frame = (0..frames).cycle();
    let mut push = || {
        let at = frame.next().unwrap_or(0);
        stream.push(clip.slice(s![0, .., at, .., ..])).unwrap().map(|scores| scores.logits[[0, 0]])
    };
    for _ in 0..frames {
        push();
    }
    bencher.bench_local(push);
}

#[divan::bench(args = THREADS, sample_count = 5)]
fn slow_fast(bencher: Bencher, threads: usize) {
    let form = SlowFastForm::PyTorchVideo;
    let tensors = weights(SlowFast::parameters(form, 400));
    let mut network = SlowFast::load(form, tensors, [32, 224, 224], options(threads)).unwrap();
    let clip: Array5<f32> = input((1, 3, 32, 224, 224));
    bencher.bench_local(|| network.infer(clip.view()).unwrap().logits[[0, 0]]);
}
