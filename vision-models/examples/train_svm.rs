//! Trains a linear SVM on features from a file. Prints the time and the quality.
//!
//! `train_svm FEATURES LABELS COUNT hinge|squared_hinge SCALING|free COST TOLERANCE`. The files
//! hold f32 and u8, as written by NumPy's `tofile`. `benches/peers/svm.py` compares with
//! scikit-learn.
#![allow(clippy::print_stdout)]

use std::{error::Error, fs, time::Instant};

use ndarray::Array2;
use vision_models::{Bias, LinearSvm, Loss, SvmSettings};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [features, labels, count, loss, bias, cost, tolerance] = arguments.as_slice() else {
        return Err("give FEATURES LABELS COUNT LOSS SCALING|free COST TOLERANCE".into());
    };
    let features = fs::read(features)?;
    let elements = features.as_chunks::<4>().0.iter().map(|&bytes| f32::from_le_bytes(bytes));
    let labels: Vec<usize> = fs::read(labels)?.into_iter().map(usize::from).collect();
    let samples = Array2::from_shape_vec((labels.len(), count.parse()?), elements.collect())?;
    let classes = labels.iter().max().map_or(0, |last| last + 1);
    let names = (0..classes).map(|class| format!("class {class}")).collect();
    let bias = match bias.as_str() {
        "free" => Bias::Free,
        scaling => Bias::Regularised { scaling: scaling.parse()? },
    };
    let settings = SvmSettings {
        loss: if loss == "hinge" { Loss::Hinge } else { Loss::SquaredHinge },
        bias,
        cost: cost.parse()?,
        tolerance: tolerance.parse()?,
        ..SvmSettings::default()
    };
    let start = Instant::now();
    let (_, trainings) = LinearSvm::train(samples.view(), &labels, names, &settings)?;
    let seconds = start.elapsed().as_secs_f64();
    for training in trainings {
        println!(
            "{seconds} {:.17e} {:e} {} {}",
            training.objective,
            training.gap(),
            training.iterations,
            training.converged
        );
    }
    Ok(())
}
