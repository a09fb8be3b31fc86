//! Checks of training data: samples, their classes and the classes' names.

use std::collections::BTreeMap;

use ndarray::ArrayView2;

use crate::error::Error;
use crate::excerpt::Excerpt;

/// Checks samples × features. `labels` are the samples' classes as indices into `classes`. Each
/// class must have a sample, and there may be at most `most` samples.
pub(crate) fn check_samples(
    samples: &ArrayView2<'_, f32>,
    labels: &[usize],
    classes: &[String],
    most: usize,
) -> Result<(), Error> {
    check_classes(classes)?;
    let (count, features) = samples.dim();
    let refuse = |problem| Err(misfit(problem));
    if labels.len() != count || features == 0 || count > most {
        return refuse(format!(
            "{count} samples of {features} features have {} labels: give one label each, at least \
             one feature and at most {most} samples",
            labels.len()
        ));
    }
    check_labels(labels, classes)?;
    if let Some(class) = (0..classes.len()).find(|class| !labels.contains(class)) {
        return refuse(format!("class {class} (\"{}\") has no sample", classes[class]));
    }
    check_finite(samples)
}

/// Checks that each label is the index of a class.
pub(crate) fn check_labels(labels: &[usize], classes: &[String]) -> Result<(), Error> {
    match labels.iter().enumerate().find(|(_, label)| **label >= classes.len()) {
        Some((sample, label)) => {
            let classes = classes.len();
            let problem = format!("sample {sample} is of class {label}, of {classes} from zero");
            Err(misfit(problem))
        }
        None => Ok(()),
    }
}

/// Checks that there are at least two classes, each with a name of its own in one line.
pub(crate) fn check_classes(classes: &[String]) -> Result<(), Error> {
    let refuse = |problem| Err(misfit(problem));
    if classes.len() < 2 {
        return refuse(format!("{} classes: give at least two", classes.len()));
    }
    let mut seen = BTreeMap::new();
    for (class, name) in classes.iter().enumerate() {
        let shown = Excerpt(name);
        if name.is_empty() {
            return refuse(format!("class {class} has no name: give each class one"));
        }
        if name.trim() != name || name.contains(['\n', '\r']) {
            return refuse(format!("the class name \"{shown}\" has spaces around it or two lines"));
        }
        if let Some(other) = seen.insert(name, class) {
            return refuse(format!(
                "classes {other} and {class} are both named \"{shown}\": give each its own name"
            ));
        }
    }
    Ok(())
}

/// Checks that no feature is NaN or infinite.
pub(crate) fn check_finite(samples: &ArrayView2<'_, f32>) -> Result<(), Error> {
    match samples.indexed_iter().find(|(_, value)| !value.is_finite()) {
        Some(((row, column), &value)) => Err(not_finite(row, column, value.into())),
        None => Ok(()),
    }
}

/// Returns the error for samples, labels, classes and weights of a linear classifier that do not
/// fit together.
pub(crate) fn misfit(problem: impl Into<String>) -> Error {
    Error::malformed("linear classifier", problem)
}

/// Returns the error for a feature, weight or bias that is NaN or infinite. The bias of a plane
/// comes after its weights.
pub(crate) fn not_finite(row: usize, column: usize, value: f64) -> Error {
    Error::value(&format!("row {row}, column {column}"), value, "finite numbers")
}
