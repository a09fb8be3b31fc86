//! The table of the likeliest classes.

use anyhow::{Result, ensure};
use vision_models::{ClassNames, top_k};

/// Prints the five likeliest classes with their probabilities, by name if there are names.
///
/// # Errors
/// If there are other than one name for each class.
pub fn print_likeliest(probabilities: &[f32], names: Option<&ClassNames>) -> Result<()> {
    if let Some(names) = names {
        let (classes, names) = (probabilities.len(), names.names().len());
        ensure!(classes == names, "the network has {classes} classes, the file {names} names");
    }
    for (rank, class) in (1..).zip(top_k(probabilities, 5)) {
        let name = match names.and_then(|names| names.names().get(class)) {
            Some(name) => name.clone(),
            None => format!("class {class}"),
        };
        println!("{rank}  {:6.2} %  {name}", 100.0 * probabilities[class]);
    }
    Ok(())
}
