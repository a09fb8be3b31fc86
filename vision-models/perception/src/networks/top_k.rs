//! The k most probable classes.

use std::{
    io::{self, Write},
    path::Path,
};

use serde::Serialize;
use vision_models::{ClassNames, top_k};

use crate::error::Error;

/// Number of classes that are shown.
const K: usize = 5;

/// A class with its probability.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ScoredClass {
    class: usize,
    name: Option<String>,
    probability: f32,
}

/// Returns the five most probable classes in falling order of probability, with their names if
/// there are names.
pub fn top_classes(probabilities: &[f32], names: Option<&ClassNames>) -> Vec<ScoredClass> {
    let name = |class| names.and_then(|names| names.label(class));
    let scored = |class: usize| {
        let probability = probabilities.get(class).copied().unwrap_or(f32::NAN);
        ScoredClass { class, name: name(class), probability }
    };
    top_k(probabilities, K).into_iter().map(scored).collect()
}

/// Writes a line for each class: rank, probability and name.
///
/// # Errors
/// The system's error.
pub fn write_top_classes(out: &mut dyn Write, classes: &[ScoredClass]) -> io::Result<()> {
    for (rank, ScoredClass { class, name, probability }) in (1..).zip(classes) {
        write!(out, "{rank}  {:6.2} %  ", 100.0 * probability)?;
        match name {
            Some(name) => writeln!(out, "{name}")?,
            None => writeln!(out, "class {class}")?,
        }
    }
    Ok(())
}

/// Checks that a label file has a name for each class of a network.
///
/// # Errors
/// Names both numbers.
pub fn check_names(file: &Path, names: &ClassNames, classes: usize) -> Result<(), Error> {
    let count = names.names().len();
    if count == classes {
        return Ok(());
    }
    let found = format!("{count} names, but the network has {classes} classes");
    Err(Error::at(file.display(), found))
}
