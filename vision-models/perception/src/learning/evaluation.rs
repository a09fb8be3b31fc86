//! Quality of a classifier.

use std::{
    fmt::Write as _,
    io::{self, Write},
};

use serde::Serialize;
use vision_models::{ConfusionMatrix, top_k};

use crate::error::Error;

/// Quality of a classifier.
///
/// ```
/// use human_perception::learning::evaluation::Evaluation;
///
/// let samples = [(0, [0.9, 0.1].as_slice()), (1, &[0.6, 0.4])];
/// let evaluation = Evaluation::of(2, samples)?;
/// assert_eq!(evaluation.accuracy, Some(0.5));
/// assert_eq!(evaluation.confusion, [[1, 0], [1, 0]]);
/// # Ok::<(), human_perception::Error>(())
/// ```
#[derive(Clone, Debug, Serialize)]
pub struct Evaluation {
    /// Number of samples that were classified.
    pub samples: usize,
    /// Share of samples that were given their class.
    pub accuracy: Option<f64>,
    /// Share of samples whose class is among the five with the highest scores.
    pub top5: Option<f64>,
    /// Counts: a row for each true class, a column for each given class.
    pub confusion: Vec<Vec<u64>>,
}

impl Evaluation {
    /// Evaluates samples, given their classes and the scores of all classes.
    ///
    /// # Errors
    /// None if all classes are below `classes`.
    pub fn of<'a>(
        classes: usize,
        samples: impl IntoIterator<Item = (usize, &'a [f32])>,
    ) -> Result<Self, Error> {
        let mut matrix = ConfusionMatrix::new(classes);
        let (mut count, mut among_five) = (0, 0);
        for (truth, scores) in samples {
            let best = top_k(scores, 5);
            matrix.add(truth, best.first().copied().unwrap_or_default())?;
            among_five += usize::from(best.contains(&truth));
            count += 1;
        }
        let row = |truth| (0..classes).map(|given| matrix.count(truth, given)).collect();
        Ok(Self {
            samples: count,
            accuracy: matrix.accuracy(),
            top5: (count > 0).then(|| among_five as f64 / count as f64),
            confusion: (0..classes).map(row).collect(),
        })
    }

    /// Writes the confusion matrix in percent of each row.
    ///
    /// # Errors
    /// The system's error.
    pub fn write_confusion(&self, out: &mut dyn Write, classes: &[String]) -> io::Result<()> {
        writeln!(out, "rows: the class, columns: what it was taken for, in percent of the row")?;
        let width = classes.iter().map(|name| name.chars().count()).max().unwrap_or(0);
        for (name, row) in classes.iter().zip(&self.confusion) {
            write!(out, "{name:>width$}")?;
            for percent in percents(row) {
                write!(out, " {percent:6.2}")?;
            }
            writeln!(out)?;
        }
        Ok(())
    }
}

/// Returns counts in percent of their sum, or zeros if the sum is zero.
pub(crate) fn percents(row: &[u64]) -> impl Iterator<Item = f64> {
    let sum = row.iter().sum::<u64>().max(1);
    row.iter().map(move |&count| 100.0 * count as f64 / sum as f64)
}

/// Returns a comma-separated table of scores. Each sample has a line with its name, its class, the
/// given class, and the score of each class.
pub fn score_table<'a>(
    heading: &str,
    classes: &[String],
    samples: impl IntoIterator<Item = (String, usize, &'a [f32])>,
) -> String {
    let name = |class: usize| field(classes.get(class).map_or("", String::as_str));
    let mut table = format!("{heading},class,given");
    for class in 0..classes.len() {
        // Writing to a string cannot fail.
        let _ = write!(table, ",score_{}", name(class));
    }
    for (sample, label, scores) in samples {
        let given = top_k(scores, 1).first().copied().unwrap_or_default();
        let _ = write!(table, "\n{},{},{}", field(&sample), name(label), name(given));
        for score in scores {
            let _ = write!(table, ",{score}");
        }
    }
    table.push('\n');
    table
}

/// Returns a comma-separated field, in quotes if necessary.
fn field(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}
