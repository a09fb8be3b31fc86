//! The file format, a text from which every number is restored exactly.
//!
//! ```text
//! linear-svm 1
//! classes 2
//! smooth
//! drilled
//! planes 1 features 3
//! BIAS W1 W2 W3
//! ```
//!
//! The first line has the format's version. Each class name has a line. Then follows one line per
//! plane: one plane for two classes, else one per class. The last line ends with a line feed too,
//! so that a truncated file is never read as complete.

use std::{fmt, path::Path, str::FromStr};

use ndarray::{Array1, Array2};

use super::LinearSvm;
use crate::error::Error;
use crate::file::{in_file, read_text, without_byte_order_mark};
use crate::labels::MAX_CLASSES;

const FIRST_LINE: &str = "linear-svm 1";
/// Largest number of features. No network has more.
const MAX_FEATURES: usize = 1_000_000;
/// Largest file that is read (bytes): a thousand planes of ten thousand weights.
const MAX_BYTES: u64 = 256 << 20;

impl LinearSvm {
    /// Reads a file of at most 256 MiB that `to_string` has written.
    ///
    /// # Errors
    /// [`Error::File`] if it cannot be read, and those of `parse`.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, Error> {
        let path = path.as_ref();
        read_text(path, MAX_BYTES).map_err(in_file(path))?.parse()
    }
}

impl fmt::Display for LinearSvm {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(formatter, "{FIRST_LINE}\nclasses {}", self.classes.len())?;
        for name in &self.classes {
            writeln!(formatter, "{name}")?;
        }
        let (planes, features) = self.weights.dim();
        writeln!(formatter, "planes {planes} features {features}")?;
        for (bias, weights) in self.biases.iter().zip(self.weights.outer_iter()) {
            write!(formatter, "{bias:e}")?;
            for weight in weights {
                write!(formatter, " {weight:e}")?;
            }
            writeln!(formatter)?;
        }
        Ok(())
    }
}

impl FromStr for LinearSvm {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        let text = without_byte_order_mark(text);
        let mut lines = text.lines().zip(1..);
        let mut next =
            |expected: &str| lines.next().ok_or_else(|| refuse(text.lines().count() + 1, expected));

        let (first, line) = next(FIRST_LINE)?;
        if first != FIRST_LINE {
            return Err(refuse(line, FIRST_LINE));
        }
        let (counted, line) = next("classes COUNT")?;
        let count = match counted.strip_prefix("classes ").map(str::parse) {
            Some(Ok(count)) if count <= MAX_CLASSES => count,
            _ => return Err(refuse(line, "classes COUNT")),
        };
        let mut classes = Vec::new();
        for _ in 0..count {
            classes.push(next("a class name")?.0.to_owned());
        }

        let sizes = "planes COUNT features COUNT";
        let (counted, line) = next(sizes)?;
        let words: Vec<&str> = counted.split(' ').take(5).collect();
        let (planes, features) = match words[..] {
            ["planes", planes, "features", features] => match (planes.parse(), features.parse()) {
                (Ok(planes), Ok(features)) if planes <= MAX_CLASSES && features <= MAX_FEATURES => {
                    (planes, features)
                }
                _ => return Err(refuse(line, sizes)),
            },
            _ => return Err(refuse(line, sizes)),
        };
        let mut biases = Vec::new();
        let mut weights = Vec::new();
        for _ in 0_usize..planes {
            let (numbers, line) = next("a bias and weights")?;
            let expected = || refuse(line, &format!("a bias and {features} weights"));
            let before = weights.len();
            let mut numbers = numbers.split(' ').map(str::parse::<f64>);
            biases.push(numbers.next().ok_or_else(expected)?.map_err(|_| expected())?);
            for number in numbers.take(features + 1) {
                weights.push(number.map_err(|_| expected())?);
            }
            if weights.len() - before != features {
                return Err(expected());
            }
        }
        if let Some((_, line)) = lines.next() {
            return Err(refuse(line, "the end of the file"));
        }
        if !text.ends_with('\n') {
            return Err(refuse(text.lines().count(), "the end of the line: the file is cut off"));
        }
        let weights = Array2::from_shape_vec((planes, features), weights)
            .map_err(|_| refuse(0, "weights for every plane"))?;
        Self::new(classes, weights, Array1::from_vec(biases))
    }
}

/// Returns the error of a line, counted from one.
fn refuse(line: usize, expected: &str) -> Error {
    Error::malformed(&format!("linear SVM file, line {line}"), format!("expected {expected}"))
}
