//! Training of a network's last layer.

use ndarray::{Array1, Array2, ArrayView2, Axis};
use proptest::prelude::*;
use serde::Deserialize;
use vision_models::{Epoch, Error, FeatureScaling, HeadSettings, HeadTrainer, LinearHead};

/// PyTorch's training (`tests/data/heads.py`).
#[derive(Deserialize)]
struct Golden {
    samples: Vec<Vec<f32>>,
    labels: Vec<usize>,
    start: Layer,
    momentum: f64,
    weight_decay: f64,
    learning_rate: f64,
    batches: Vec<Vec<usize>>,
    losses: Vec<f64>,
    #[serde(flatten)]
    end: Layer,
}

#[derive(Deserialize)]
struct Layer {
    weights: Vec<Vec<f32>>,
    biases: Vec<f32>,
}

fn matrix(rows: &[Vec<f32>]) -> Array2<f32> {
    let flat = rows.iter().flatten().copied().collect();
    Array2::from_shape_vec((rows.len(), rows[0].len()), flat).unwrap()
}

fn names(count: usize) -> Vec<String> {
    (0..count).map(|class| format!("class {class}")).collect()
}

#[test]
fn the_same_batches_give_pytorch_s_weights() {
    let cases: Vec<Golden> = serde_json::from_str(include_str!("../data/heads.json")).unwrap();
    assert_eq!(cases.len(), 3);
    for golden in cases {
        let Layer { weights, biases } = golden.start;
        let start = LinearHead::new(names(biases.len()), matrix(&weights), Array1::from(biases));
        let settings = HeadSettings {
            learning_rate: golden.learning_rate,
            momentum: golden.momentum,
            weight_decay: golden.weight_decay,
            dropout: 0.0,
            ..HeadSettings::default()
        };
        let mut trainer = HeadTrainer::new(&start.unwrap(), settings).unwrap();
        let samples = matrix(&golden.samples);
        for (batch, theirs) in golden.batches.iter().zip(&golden.losses) {
            let labels: Vec<usize> = batch.iter().map(|&sample| golden.labels[sample]).collect();
            let loss = trainer.step(samples.select(Axis(0), batch).view(), &labels).unwrap();
            assert!((loss - theirs).abs() < 1e-5, "{loss} {theirs}");
        }
        let head = trainer.head();
        let ours = head.weights().into_iter().copied().chain(head.biases().to_vec());
        let theirs = golden.end.weights.into_iter().flatten().chain(golden.end.biases);
        for (ours, theirs) in ours.zip(theirs) {
            assert!((ours - theirs).abs() < 1e-5, "{ours} {theirs}");
        }
    }
}

/// Returns two clouds around (±2, 0, …), which the first feature distinguishes.
fn clouds(count: usize, features: usize) -> (Array2<f32>, Vec<usize>) {
    let noise = |row: usize, column: usize| ((row * 31 + column * 17) % 13) as f32 / 13.0 - 0.5;
    let side = |row: usize| if row.is_multiple_of(2) { -2.0 } else { 2.0 };
    let samples = Array2::from_shape_fn((count, features), |(row, column)| {
        noise(row, column) + if column == 0 { side(row) } else { 0.0 }
    });
    (samples, (0..count).map(|row| row % 2).collect())
}

fn train(settings: &HeadSettings) -> (LinearHead, Vec<Epoch>) {
    let (samples, labels) = clouds(40, 6);
    let mut epochs = Vec::new();
    let head = LinearHead::train(samples.view(), &labels, names(2), settings, |epoch| {
        epochs.push(epoch);
        true
    });
    (head.unwrap(), epochs)
}

#[test]
fn the_seed_determines_the_head() {
    let settings = HeadSettings { epochs: 5, ..HeadSettings::default() };
    assert_eq!(train(&settings), train(&settings));
    let other = HeadSettings { seed: 2, ..settings };
    assert_ne!(train(&settings).0, train(&other).0);
    assert_eq!(train(&settings).1.len(), 5);
}

#[test]
fn a_trained_head_tells_the_classes_apart() {
    // Samples without the distinguishing feature cannot be classified.
    for (dropout, loss) in [(0.0, 0.05), (0.5, 0.5)] {
        let settings =
            HeadSettings { learning_rate: 0.05, epochs: 40, dropout, ..HeadSettings::default() };
        let (head, epochs) = train(&settings);
        let (samples, labels) = clouds(200, 6);
        for (sample, label) in samples.outer_iter().zip(labels) {
            assert_eq!(head.classify(sample).unwrap(), label);
        }
        assert!(epochs[39].loss < loss, "{epochs:?}");
    }
}

/// Another unit of the features does not change the scores of a head of standardised features.
#[test]
fn standardised_features_may_have_any_unit() {
    let scaling = FeatureScaling::Standardised;
    let settings =
        HeadSettings { learning_rate: 0.05, epochs: 10, scaling, ..HeadSettings::default() };
    let scores = |scale: f32, offset: f32| {
        let (mut samples, labels) = clouds(40, 6);
        for (column, mut feature) in samples.axis_iter_mut(Axis(1)).enumerate() {
            let scale = scale * (1 + column) as f32;
            feature.mapv_inplace(|value| scale * value + offset);
        }
        // A constant feature has no influence.
        samples.column_mut(5).fill(0.3);
        let head =
            LinearHead::train(samples.view(), &labels, names(2), &settings, |_| true).unwrap();
        assert!(head.weights().column(5).iter().all(|weight| *weight == 0.0));
        let scores = |sample| head.scores(sample).unwrap();
        let scores: Vec<_> = samples.outer_iter().flat_map(scores).collect();
        (scores, labels)
    };
    let (plain, labels) = scores(1.0, 0.0);
    for (scale, offset) in [(1e-4, 0.0), (30.0, -7.0)] {
        for (one, other) in plain.iter().zip(scores(scale, offset).0) {
            assert!((one - other).abs() < 1e-3, "{one} {other}");
        }
    }
    for (scores, label) in plain.chunks(2).zip(labels) {
        assert!((scores[1] > scores[0]) == (label == 1), "{scores:?}");
    }
}

#[test]
fn training_ends_when_it_is_told() {
    let (samples, labels) = clouds(10, 2);
    let mut seen = 0;
    let go_on = |epoch: Epoch| {
        seen = epoch.number;
        epoch.number < 3
    };
    let settings = HeadSettings::default();
    LinearHead::train(samples.view(), &labels, names(2), &settings, go_on).unwrap();
    assert_eq!(seen, 3);
}

/// The learning rate is so small that the weights stay. The mean step over many samples of the
/// dropout is then the step without dropout, if the scores vary little. The other features
/// compensate for those that are left out.
#[test]
fn dropout_keeps_the_mean_of_the_features() {
    let classes = 2;
    let features = 4000;
    let head = LinearHead::new(
        names(classes),
        Array2::from_elem((classes, features), 1e-4),
        Array1::zeros(classes),
    );
    let head = head.unwrap();
    let samples = Array2::from_elem((1, features), 1.0_f32);
    let moved = |dropout: f64| {
        let settings =
            HeadSettings { learning_rate: 1.0, momentum: 0.0, dropout, ..HeadSettings::default() };
        let mut trainer = HeadTrainer::new(&head, settings).unwrap();
        trainer.step(samples.view(), &[0]).unwrap();
        let trained = trainer.head();
        (&trained.weights() - &head.weights()).row(0).to_vec()
    };
    let whole = moved(0.0);
    let dropped = moved(0.75);
    let kept = dropped.iter().filter(|step| **step != 0.0).count();
    // Four standard deviations of a quarter of 4,000 are 110.
    assert!((890..1110).contains(&kept), "{kept}");
    let mean = |steps: &[f32]| steps.iter().sum::<f32>() / steps.len() as f32;
    assert!((mean(&dropped) / mean(&whole) - 1.0).abs() < 0.11);
    assert!(dropped.iter().all(|step| *step == 0.0 || (step / whole[0] - 4.0).abs() < 0.01));
}

#[test]
fn a_saved_head_is_read_again() {
    let (head, _) = train(&HeadSettings { epochs: 2, ..HeadSettings::default() });
    let mut file = tempfile::NamedTempFile::new().unwrap();
    head.tensors("fc").unwrap().write_safetensors(&mut file).unwrap();
    let mut checkpoint = vision_models::Checkpoint::open(file.path()).unwrap();
    assert_eq!(LinearHead::read(&mut checkpoint, "fc", names(2)).unwrap(), head);
    let mut checkpoint = vision_models::Checkpoint::open(file.path()).unwrap();
    let other = LinearHead::read(&mut checkpoint, "head", names(2));
    assert!(matches!(other, Err(Error::Name { what: "tensor", got, .. }) if got == "head.weight"));
    let mut checkpoint = vision_models::Checkpoint::open(file.path()).unwrap();
    let more = LinearHead::read(&mut checkpoint, "fc", names(3));
    assert!(more.unwrap_err().to_string().contains("3 classes have 2 rows of 6 weights"));
}

fn refused(samples: ArrayView2<'_, f32>, labels: &[usize], classes: usize) -> String {
    let settings = HeadSettings::default();
    let trained = LinearHead::train(samples, labels, names(classes), &settings, |_| true);
    trained.unwrap_err().to_string()
}

#[test]
fn samples_that_cannot_be_trained_with_are_refused() {
    let (samples, labels) = clouds(4, 2);
    let view = samples.view();
    for (message, says) in [
        (refused(view, &labels[..3], 2), "4 samples of 2 features have 3 labels"),
        (refused(view, &[0, 0, 1, 2], 2), "sample 3 is of class 2, of 2 from zero"),
        (refused(view, &[0, 0, 0, 0], 2), "class 1 (\"class 1\") has no sample"),
        (refused(view, &[0, 0, 0, 0], 1), "1 classes: give at least two"),
        (refused(view.slice(ndarray::s![..0, ..]), &[], 2), "has no sample"),
        (refused(view.slice(ndarray::s![.., ..0]), &labels, 2), "at least one feature"),
    ] {
        assert!(message.contains(says), "{message}");
    }
    let mut holed = samples.clone();
    holed[(2, 1)] = f32::NAN;
    assert!(refused(holed.view(), &labels, 2).contains("row 2, column 1 is NaN"));
    let far = samples.mapv(|x| x * 1e37);
    let fast = HeadSettings { learning_rate: 1e3, ..HeadSettings::default() };
    let trained = LinearHead::train(far.view(), &labels, names(2), &fast, |_| true);
    let message = trained.unwrap_err().to_string();
    assert!(message.contains("give a smaller one, or smaller features"), "{message}");
    for settings in [
        HeadSettings { learning_rate: 0.0, ..HeadSettings::default() },
        HeadSettings { learning_rate: f64::NAN, ..HeadSettings::default() },
        HeadSettings { momentum: 1.0, ..HeadSettings::default() },
        HeadSettings { weight_decay: -1.0, ..HeadSettings::default() },
        HeadSettings { dropout: 1.0, ..HeadSettings::default() },
        HeadSettings { batch: 0, ..HeadSettings::default() },
        HeadSettings { epochs: 0, ..HeadSettings::default() },
    ] {
        assert!(matches!(settings.validate(), Err(Error::Value { .. })), "{settings:?}");
    }
}

proptest! {
    /// A step with any numbers ends with finite weights, or with an error and the unchanged head.
    #[test]
    fn a_step_never_spoils_the_head(
        values in prop::collection::vec(prop::num::f32::ANY, 6), rate in 1e-6..1e6_f64,
    ) {
        let head = LinearHead::random(names(3), 2, 4).unwrap();
        let settings = HeadSettings { learning_rate: rate, ..HeadSettings::default() };
        let mut trainer = HeadTrainer::new(&head, settings).unwrap();
        let samples = Array2::from_shape_vec((3, 2), values).unwrap();
        let stepped = trainer.step(samples.view(), &[0, 1, 2]);
        prop_assert!(trainer.head().weights().iter().all(|weight| weight.is_finite()));
        if let Ok(loss) = stepped {
            prop_assert!(loss.is_finite() && loss >= 0.0);
        } else {
            prop_assert_eq!(trainer.head(), head);
        }
    }
}
