//! Parts of a data set.

use rand::seq::SliceRandom;

use crate::{error::Error, random::generator};

/// The part of a data set to which a sample belongs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Samples for training.
    Training,
    /// Samples for choosing settings.
    Validation,
    /// Samples for the final measurement, used for nothing else.
    Test,
}

/// The shares of validation and test. The rest is for training.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shares {
    /// Share of validation.
    pub validation: f64,
    /// Share of the test.
    pub test: f64,
}

impl Shares {
    /// The shares 70/20/10 (paper, Sec. "Experiment 1").
    pub const SURFACE: Self = Self { validation: 0.2, test: 0.1 };
}

/// Assigns the samples of each class to parts at random. The same seed and labels give the same
/// parts. Each class has at least one sample in each part whose share is not zero.
///
/// ```
/// use human_perception::learning::split::{Part, Shares, split};
///
/// let classes = ["drilled".to_owned(), "smooth".to_owned()];
/// let parts = split(&[0, 0, 0, 1, 1, 1], &classes, Shares::SURFACE, 1)?;
/// assert_eq!(parts.iter().filter(|part| **part == Part::Test).count(), 2);
/// # Ok::<(), human_perception::Error>(())
/// ```
///
/// # Errors
/// Names the class if it has too few samples.
pub fn split(
    labels: &[usize],
    classes: &[String],
    shares: Shares,
    seed: u64,
) -> Result<Vec<Part>, Error> {
    let mut parts = vec![Part::Training; labels.len()];
    for (class, name) in classes.iter().enumerate() {
        let mut own: Vec<usize> = (0..labels.len()).filter(|&i| labels[i] == class).collect();
        own.shuffle(&mut generator(seed, class as u64));
        let of = |share: f64| {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share")]
            let count = (share * own.len() as f64).round() as usize;
            if share > 0.0 { count.max(1) } else { 0 }
        };
        let (test, validation) = (of(shares.test), of(shares.validation));
        let least = 1 + usize::from(test > 0) + usize::from(validation > 0);
        if own.len() < least || own.len() <= test + validation {
            return Err(Error::at(
                format_args!("class \"{name}\" has {} samples", own.len()),
                format_args!(
                    "give at least {least}, so that there is one for each part of the split"
                ),
            ));
        }
        let (of_test, rest) = own.split_at(test);
        for &sample in of_test {
            parts[sample] = Part::Test;
        }
        for &sample in &rest[..validation] {
            parts[sample] = Part::Validation;
        }
    }
    Ok(parts)
}
