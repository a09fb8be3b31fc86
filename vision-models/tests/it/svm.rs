//! The linear SVM finds the optimum, and its file restores every number.

use ndarray::{Array1, Array2, array};
use proptest::prelude::*;
use serde_json::Value;
use vision_models::{Bias, ClassWeights, Error, LinearSvm, Loss, SvmSettings};

fn names(count: usize) -> Vec<String> {
    (0..count).map(|class| format!("class {class}")).collect()
}

fn floats(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect()
}

#[test]
fn planes_are_those_of_scikit_learn() {
    let cases: Value = serde_json::from_str(include_str!("../data/svm.json")).unwrap();
    for case in cases.as_array().unwrap() {
        let points: Vec<Vec<f64>> = case["points"].as_array().unwrap().iter().map(floats).collect();
        #[allow(clippy::cast_possible_truncation)] // three decimals
        let points = Array2::from_shape_fn((points.len(), points[0].len()), |(row, column)| {
            points[row][column] as f32
        });
        let labels: Vec<usize> = case["labels"]
            .as_array()
            .unwrap()
            .iter()
            .map(|label| label.as_u64().unwrap().try_into().unwrap())
            .collect();
        let classes = usize::try_from(case["classes"].as_u64().unwrap()).unwrap();
        for machine in case["machines"].as_array().unwrap() {
            let settings = SvmSettings {
                loss: if machine["loss"] == "hinge" { Loss::Hinge } else { Loss::SquaredHinge },
                bias: machine["scaling"]
                    .as_f64()
                    .map_or(Bias::Free, |scaling| Bias::Regularised { scaling }),
                cost: case["cost"].as_f64().unwrap(),
                class_weights: match &case["weights"] {
                    Value::Null => ClassWeights::Equal,
                    weights => ClassWeights::Given(floats(weights)),
                },
                tolerance: 1e-11,
                ..SvmSettings::default()
            };
            let (svm, trainings) =
                LinearSvm::train(points.view(), &labels, names(classes), &settings).unwrap();
            for training in trainings {
                assert!(training.converged, "{settings:?}: {training:?}");
                assert!(training.gap() <= 1e-11, "{settings:?}: {training:?}");
            }
            for (plane, expected) in machine["planes"].as_array().unwrap().iter().enumerate() {
                let expected = floats(expected);
                let given: Vec<f64> = std::iter::once(svm.biases()[plane])
                    .chain(svm.weights().row(plane).iter().copied())
                    .collect();
                let largest = expected.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
                for (given, expected) in given.iter().zip(&expected) {
                    let error = (given - expected).abs() / largest;
                    assert!(error < 2e-5, "{settings:?}: {given} for {expected}");
                }
            }
        }
    }
}

/// Features of a random network are large and differ little between images. The differences of the
/// samples are lost if their products are rounded to f32.
#[test]
fn large_samples_that_are_nearly_parallel() {
    let points = Array2::from_shape_fn((40, 64), |(sample, feature)| {
        let noise = (37 * sample + 101 * feature + sample * feature) % 97;
        3000.0 + f32::from(u8::try_from(noise).unwrap()) / 97.0
    });
    let labels: Vec<usize> = (0..40).map(|sample| sample % 2).collect();
    let (_, trainings) =
        LinearSvm::train(points.view(), &labels, names(2), &SvmSettings::default()).unwrap();
    assert!(trainings.iter().all(|training| training.converged), "{trainings:?}");
}

/// Two points: the plane is in the middle, and the margin is their distance.
#[test]
fn two_points() {
    for loss in [Loss::Hinge, Loss::SquaredHinge] {
        let settings = SvmSettings { loss, cost: 1e6, ..SvmSettings::default() };
        let points = array![[1.0_f32, 0.0], [3.0, 0.0]];
        let (svm, _) = LinearSvm::train(points.view(), &[0, 1], names(2), &settings).unwrap();
        assert!((svm.weights()[[0, 0]] - 1.0).abs() < 1e-5);
        assert!(svm.weights()[[0, 1]].abs() < 1e-9);
        assert!((svm.biases()[0] + 2.0).abs() < 1e-5);
        assert_eq!(svm.classify(array![1.9_f32, 5.0].view()).unwrap(), 0);
        assert_eq!(svm.classify(array![2.1_f32, 5.0].view()).unwrap(), 1);
    }
}

#[test]
fn an_unfinished_training_says_so() {
    let points = Array2::from_shape_fn((40, 3), |(row, column)| (row * 7 % 11 + column) as f32);
    let labels: Vec<usize> = (0..40).map(|row| row / 3 % 2).collect();
    let settings = SvmSettings { max_iterations: 0, ..SvmSettings::default() };
    let (_, training) = LinearSvm::train(points.view(), &labels, names(2), &settings).unwrap();
    assert!(!training[0].converged && training[0].gap() > settings.tolerance);
    assert_eq!(training[0].iterations, 0);
    assert!(training[0].objective > training[0].bound);
}

/// Too many samples for a matrix of their products, few features, and classes that no plane
/// separates. The gap closes in tens of steps.
#[test]
fn many_samples_that_no_plane_separates() {
    let points = Array2::from_shape_fn((20_000, 3), |(row, column)| {
        ((row * (37 + 12 * column) + row * row / 7) % 1009) as f32 / 504.5 - 1.0
    });
    let labels: Vec<usize> = points
        .outer_iter()
        .enumerate()
        .map(|(row, point)| usize::from(point[0] > 0.0) ^ (row / 3 % 2))
        .collect();
    for loss in [Loss::Hinge, Loss::SquaredHinge] {
        for bias in [Bias::Free, Bias::Regularised { scaling: 1.0 }] {
            let settings = SvmSettings { loss, bias, ..SvmSettings::default() };
            let (_, training) =
                LinearSvm::train(points.view(), &labels, names(2), &settings).unwrap();
            assert!(training[0].converged, "{settings:?}: {:?}", training[0]);
            assert!(training[0].iterations < 100, "{settings:?}: {:?}", training[0]);
        }
    }
}

/// A sample that counts twice is equivalent to two samples.
#[test]
fn weights_are_repetitions() {
    let points = array![[0.0_f32, 1.0], [1.0, 0.3], [2.0, 1.0], [0.5, 0.2], [1.5, 2.0]];
    let labels = [0, 0, 1, 1, 1];
    let twice = points.select(ndarray::Axis(0), &[0, 1, 2, 3, 4, 2, 3, 4]);
    for loss in [Loss::Hinge, Loss::SquaredHinge] {
        let settings = SvmSettings { loss, tolerance: 1e-12, ..SvmSettings::default() };
        let class_weights = ClassWeights::Given(vec![1.0, 2.0]);
        let weighted = SvmSettings { class_weights, ..settings.clone() };
        let train = |points: &Array2<f32>, labels: &[usize], settings| {
            LinearSvm::train(points.view(), labels, names(2), settings).unwrap().0
        };
        let one = train(&points, &labels, &weighted);
        let other = train(&twice, &[0, 0, 1, 1, 1, 1, 1, 1], &settings);
        for (one, other) in one.weights().iter().zip(other.weights()) {
            assert!((one - other).abs() < 1e-6, "{loss:?}: {one} for {other}");
        }
        // Two samples of one class and three of the other.
        let balanced = SvmSettings { class_weights: ClassWeights::Balanced, ..settings.clone() };
        let class_weights = ClassWeights::Given(vec![5.0 / 4.0, 5.0 / 6.0]);
        let given = SvmSettings { class_weights, ..settings };
        assert_eq!(train(&points, &labels, &balanced), train(&points, &labels, &given));
    }
}

#[test]
fn what_is_refused() {
    let points = array![[1.0_f32, 0.0], [3.0, 0.0]];
    let train = |points: &Array2<f32>, labels: &[usize], classes| {
        LinearSvm::train(points.view(), labels, classes, &SvmSettings::default()).map(|_| ())
    };
    let is_samples = |result| matches!(result, Err(Error::Malformed { .. }));
    assert!(is_samples(train(&points, &[0], names(2))));
    assert!(is_samples(train(&points, &[0, 2], names(2))));
    assert!(is_samples(train(&points, &[0, 0], names(2))));
    assert!(is_samples(train(&points, &[0, 0], names(1))));
    assert!(is_samples(train(&points, &[0, 1], vec!["a\nb".into(), "c".into()])));
    assert!(is_samples(train(&Array2::zeros((0, 2)), &[], names(2))));
    assert!(is_samples(train(&Array2::zeros((2, 0)), &[0, 1], names(2))));
    let nan = train(&array![[1.0, 0.0], [3.0, f32::NAN]], &[0, 1], names(2));
    assert!(matches!(nan, Err(Error::Value { what, .. }) if what == "row 1, column 1"));
    for settings in [
        SvmSettings { cost: 0.0, ..SvmSettings::default() },
        SvmSettings { tolerance: f64::NAN, ..SvmSettings::default() },
        SvmSettings { bias: Bias::Regularised { scaling: -1.0 }, ..SvmSettings::default() },
        SvmSettings {
            class_weights: ClassWeights::Given(vec![1.0, -1.0]),
            ..SvmSettings::default()
        },
    ] {
        let result = LinearSvm::train(points.view(), &[0, 1], names(2), &settings);
        assert!(matches!(result, Err(Error::Value { .. })));
    }
    let class_weights = ClassWeights::Given(vec![1.0]);
    let one = SvmSettings { class_weights, ..SvmSettings::default() };
    let result = LinearSvm::train(points.view(), &[0, 1], names(2), &one).map(|_| ());
    assert!(is_samples(result));
    let svm = LinearSvm::new(names(2), array![[1.0, 2.0]], array![0.5]).unwrap();
    assert!(is_samples(svm.decide(array![1.0_f32].view()).map(|_| ())));
    assert!(svm.decide(array![1.0_f32, f32::INFINITY].view()).is_err());
    assert!(LinearSvm::new(names(2), array![[1.0, f64::NAN]], array![0.5]).is_err());
    assert!(LinearSvm::new(names(3), array![[1.0, 2.0]], array![0.5]).is_err());
}

#[test]
fn files_that_are_refused() {
    let svm = LinearSvm::new(names(2), array![[1.0, -2.5e-300]], array![0.1]).unwrap();
    let text = svm.to_string();
    assert_eq!(
        text,
        "linear-svm 1\nclasses 2\nclass 0\nclass 1\nplanes 1 features 2\n1e-1 1e0 -2.5e-300\n"
    );
    for (from, to, line) in [
        ("linear-svm 1", "linear-svm 2", 1),
        ("classes 2", "classes -2", 2),
        ("classes 2", "classes 18446744073709551615", 2),
        ("planes 1 features 2", "planes 1", 5),
        ("planes 1", "planes 99999999999", 5),
        ("planes 1", "planes 2", 7),
        ("features 2", "features 3", 6),
        ("features 2", "features 1", 6),
        ("1e0", "one", 6),
        ("1e0 ", "", 6),
        ("-2.5e-300\n", "-2.5e-300\nmore\n", 7),
    ] {
        let changed = text.replacen(from, to, 1);
        assert_ne!(changed, text);
        match changed.parse::<LinearSvm>() {
            Err(Error::Malformed { what, .. }) => {
                assert_eq!(what, format!("linear SVM file, line {line}"), "{to:?}");
            }
            other => panic!("{other:?} for {to:?}"),
        }
    }
    assert!(matches!(text.replace("1e0", "NaN").parse::<LinearSvm>(), Err(Error::Value { .. })));
    // No truncated file reads as complete, even if it is cut within the last number.
    for end in 0..text.len() {
        let cut = &text[..end];
        let error = cut.parse::<LinearSvm>().unwrap_err().to_string();
        assert!(error.starts_with("linear SVM file, line"), "{cut:?}: {error}");
    }
    assert_eq!(text.parse::<LinearSvm>().unwrap(), svm);
}

#[test]
fn files_may_have_byte_order_marks_and_crlf() {
    let svm = LinearSvm::new(names(2), array![[1.0, -2.5e-300]], array![0.1]).unwrap();
    let text = svm.to_string();
    assert_eq!(format!("\u{feff}{text}").parse::<LinearSvm>().unwrap(), svm);
    let windows = text.replace('\n', "\r\n");
    assert_eq!(windows.parse::<LinearSvm>().unwrap(), svm);

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("svm.txt");
    std::fs::write(&path, &text).unwrap();
    assert_eq!(LinearSvm::read(&path).unwrap(), svm);
    let none = LinearSvm::read(folder.path().join("none"));
    assert!(matches!(none, Err(Error::File { path, .. }) if path.ends_with("none")));
}

fn samples() -> impl Strategy<Value = (Array2<f32>, Vec<usize>)> {
    (2..12_usize, 1..5_usize).prop_flat_map(|(count, features)| {
        (
            prop::collection::vec(-3.0..3.0_f32, count * features),
            prop::collection::vec(0..2_usize, count),
        )
            .prop_map(move |(values, mut labels)| {
                (labels[0], labels[1]) = (0, 1);
                (Array2::from_shape_vec((count, features), values).unwrap(), labels)
            })
    })
}

#[test]
fn empty_and_repeated_class_names_are_refused() {
    let planes = || (array![[1.0, 2.0]], array![0.5]);
    for (classes, said) in [
        (["smooth", "smooth"], "classes 0 and 1 are both named \"smooth\""),
        (["", "drilled"], "class 0 has no name"),
        (["smooth", ""], "class 1 has no name"),
    ] {
        let file = format!(
            "linear-svm 1\nclasses 2\n{}\n{}\nplanes 1 features 2\n0.5 1 2\n",
            classes[0], classes[1]
        );
        let (weights, biases) = planes();
        let names = || classes.map(str::to_owned).to_vec();
        let samples = array![[0.0_f32, 1.0], [1.0, 0.0]];
        for refused in [
            file.parse::<LinearSvm>(),
            LinearSvm::new(names(), weights, biases),
            LinearSvm::train(samples.view(), &[0, 1], names(), &SvmSettings::default())
                .map(|(svm, _)| svm),
        ] {
            let Err(Error::Malformed { problem, .. }) = refused else { panic!("{refused:?}") };
            assert!(problem.starts_with(said), "{problem}");
        }
    }
}

proptest! {
    /// The primal and dual objectives agree for any samples, and no other plane is better.
    #[test]
    fn the_optimum_is_reached(
        (points, labels) in samples(),
        hinge: bool,
        regularised: bool,
        cost in 0.01..10.0_f64,
        direction in prop::collection::vec(-1.0..1.0_f64, 5),
    ) {
        let settings = SvmSettings {
            loss: if hinge { Loss::Hinge } else { Loss::SquaredHinge },
            bias: if regularised { Bias::Regularised { scaling: 2.0 } } else { Bias::Free },
            cost,
            ..SvmSettings::default()
        };
        let (svm, trainings) =
            LinearSvm::train(points.view(), &labels, names(2), &settings).unwrap();
        let training = trainings[0];
        prop_assert!(training.converged);
        let objective = |weights: &Array1<f64>, bias: f64| {
            let losses = points.outer_iter().zip(&labels).map(|(point, &label)| {
                let side = if label == 1 { 1.0 } else { -1.0 };
                let short =
                    (1.0 - side * (weights.dot(&point.mapv(f64::from)) + bias)).max(0.0);
                if hinge { short } else { short * short }
            });
            let bias = if regularised { bias / 2.0 } else { 0.0 };
            0.5 * (weights.dot(weights) + bias * bias) + cost * losses.sum::<f64>()
        };
        let weights = svm.weights().row(0).to_owned();
        let bias = svm.biases()[0];
        let best = objective(&weights, bias);
        let scale = best.max(1e-3);
        prop_assert!((best - training.objective).abs() < 1e-6 * scale);
        prop_assert!(training.bound <= training.objective * (1.0 + 1e-12));
        for step in [1e-2, 1.0] {
            let other = Array1::from_shape_fn(weights.len(), |i| weights[i] + step * direction[i]);
            prop_assert!(objective(&other, bias + step * direction[4]) >= best - 1e-5 * scale);
        }
    }

    #[test]
    fn files_bring_every_number_back(
        weights in prop::collection::vec(prop::num::f64::NORMAL | prop::num::f64::ZERO | prop::num::f64::SUBNORMAL, 6),
        biases in prop::collection::vec(prop::num::f64::NORMAL, 3),
    ) {
        let weights = Array2::from_shape_vec((3, 2), weights).unwrap();
        let svm = LinearSvm::new(names(3), weights, Array1::from_vec(biases)).unwrap();
        prop_assert_eq!(svm.to_string().parse::<LinearSvm>().unwrap(), svm);
    }

    /// A file with some characters changed is read as the machine that it then describes, or
    /// rejected.
    #[test]
    fn any_text_is_read_or_refused(
        changes in prop::collection::vec(
            (any::<prop::sample::Index>(), prop::sample::select(b"0129 -.e\nax".to_vec())),
            0..4,
        ),
    ) {
        let weights = array![[1.0, -2.5e-3], [0.0, 4.0], [0.25, 1e10]];
        let svm = LinearSvm::new(names(3), weights, array![0.1, 2.0, -3.0]).unwrap();
        let mut text = svm.to_string().into_bytes();
        for (place, byte) in &changes {
            let place = place.index(text.len());
            text[place] = *byte;
        }
        let text = String::from_utf8(text).unwrap();
        match text.parse::<LinearSvm>() {
            Ok(read) => {
                // The machine contains exactly the names and numbers of the file.
                let again = read.to_string();
                prop_assert_eq!(again.parse::<LinearSvm>().unwrap(), read);
                let words = |text: &str| -> Vec<Result<f64, String>> {
                    text.split_whitespace()
                        .map(|word| word.parse().map_err(|_| word.to_owned()))
                        .collect()
                };
                prop_assert_eq!(words(&again), words(&text));
            }
            Err(Error::Malformed { what, .. }) if what.starts_with("linear SVM file, line ") => {
                let line: usize = what["linear SVM file, line ".len()..].parse().unwrap();
                prop_assert!((1..=text.lines().count() + 1).contains(&line));
            }
            Err(error) => prop_assert!(
                matches!(error, Error::Malformed { .. } | Error::Value { .. }), "{error}"
            ),
        }
        if changes.is_empty() {
            prop_assert_eq!(text.parse::<LinearSvm>().unwrap(), svm);
        }
    }
}
