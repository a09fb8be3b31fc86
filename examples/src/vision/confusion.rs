//! Testing an SVM on images of known classes.

use std::io::{self, Write};

use anyhow::Result;
use ndarray::aview1;
use serde::Serialize;
use vision_models::{ConfusionMatrix, LinearSvm};

use super::{
    classifier::Classifier,
    folders::{LabelledImage, Unreadable},
};
use crate::program::{Ending, Session};

/// How well an SVM does.
#[derive(Clone, Debug, Serialize)]
pub struct TestReport {
    /// Images that were classified.
    pub images: usize,
    /// Images that could not be read.
    pub unreadable: usize,
    /// The share of images that were given their class; null without images.
    pub accuracy: Option<f64>,
    /// Counts: a row for each class, a column for each class that it was taken for.
    pub confusion: Vec<Vec<u64>>,
    #[serde(skip)]
    matrix: ConfusionMatrix,
}

/// Classifies images of known classes.
///
/// # Errors
/// As of [`Classifier::score_each`].
pub fn test(
    classifier: &mut Classifier,
    svm: &LinearSvm,
    images: &[LabelledImage],
    session: &Session,
    unreadable: &mut Unreadable,
) -> Result<(TestReport, Ending)> {
    let before = unreadable.count();
    let classes = svm.classes().len();
    let mut matrix = ConfusionMatrix::new(classes);
    let mut count = 0;
    let ending =
        classifier.score_each(session, "test images", images, unreadable, |label, scored| {
            count += 1;
            Ok(matrix.add(label, svm.classify(aview1(&scored.features))?)?)
        })?;
    let row = |truth| (0..classes).map(|given| matrix.count(truth, given)).collect();
    let report = TestReport {
        images: count,
        unreadable: unreadable.count() - before,
        accuracy: matrix.accuracy(),
        confusion: (0..classes).map(row).collect(),
        matrix,
    };
    Ok((report, ending))
}

impl TestReport {
    /// Writes the confusion matrix in percent, and the accuracy.
    ///
    /// # Errors
    /// What the system says.
    pub fn write(&self, out: &mut dyn Write, classes: &[String]) -> io::Result<()> {
        writeln!(out, "rows: the class, columns: what it was taken for, in percent of the row")?;
        for (truth, name) in classes.iter().enumerate() {
            write!(out, "{name:>20}")?;
            for given in 0..classes.len() {
                write!(out, " {:6.2}", self.matrix.percent(truth, given).unwrap_or(0.0))?;
            }
            writeln!(out)?;
        }
        match self.accuracy {
            Some(accuracy) => writeln!(out, "accuracy {:.2} %", 100.0 * accuracy),
            None => writeln!(out, "no images"),
        }
    }
}
