//! Recorded postures as a table.

use std::io::{BufRead, Read};

use nalgebra::Vector3;

use crate::error::{Error, Result};
use crate::joints::{DOF, JointAngles};

/// A recorded hand position with its posture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredSample {
    /// Hand position in the person's frame \[m\].
    pub hand: Vector3<f64>,
    /// The posture.
    pub angles: JointAngles,
}

/// Largest size of a table (bytes), and largest number of samples: an hour at 200 a second.
const MAX_BYTES: u64 = 64 << 20;
/// Longest line (bytes). Its cells take eight times as much memory.
const MAX_LINE: usize = 64 << 10;
const MAX_SAMPLES: usize = 1_000_000;
/// Largest number of characters of a cell or a column's name in an error.
const LONGEST: usize = 120;

/// Content of a column of the table.
#[derive(Clone, Copy)]
enum Column {
    Hand(usize),
    Joint(usize),
}

/// Reads samples from a comma-separated table.
///
/// The first line names the columns, in any order. `hand_x_m`, `hand_y_m` and `hand_z_m` are all
/// required. There must be at least one column `<joint>_deg` for a joint of [`JointAngles::NAMES`].
/// A joint without a column is zero.
///
/// Blank lines are skipped, and cells may be quoted. At most a million samples and 64 MiB are read.
///
/// ```
/// let table = "hand_x_m,hand_y_m,hand_z_m,elbow_deg\n0.4,-0.2,1.1,80\n";
/// let samples = ergo_map::read_samples(table.as_bytes())?;
/// assert_eq!(samples[0].angles.elbow, 80_f64.to_radians());
/// # Ok::<(), ergo_map::Error>(())
/// ```
///
/// # Errors
/// [`Error::Samples`] with line and column if a column is unknown, repeated or missing. The same
/// error if a cell is missing, surplus, or not a finite number. [`Error::TooFewSamples`] if the
/// table is empty.
pub fn read_samples(table: impl BufRead) -> Result<Vec<MeasuredSample>> {
    let text = read_text(table)?;
    if let Some(line) = text.lines().position(|line| line.len() > MAX_LINE) {
        return Err(problem(line + 1, "", format!("longer than {MAX_LINE} bytes")));
    }
    let mut rows = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let mut header: Option<Vec<(String, Column)>> = None;
    let mut samples = Vec::new();
    for row in rows.records() {
        let row = row.map_err(|error| problem(1, "", format!("cannot be read: {error}")))?;
        if row.iter().all(str::is_empty) && row.len() < 2 {
            continue;
        }
        let line = || line_of(&text, row.position());
        match &header {
            None => header = Some(columns(line(), &row)?),
            Some(_) if samples.len() == MAX_SAMPLES => {
                return Err(problem(line(), "", format!("more than {MAX_SAMPLES} samples")));
            }
            Some(columns) => samples.push(sample(line, &row, columns)?),
        }
    }
    if samples.is_empty() {
        return Err(Error::TooFewSamples { what: "a table of postures", got: 0, wanted: 1 });
    }
    Ok(samples)
}

/// Returns the table without a byte-order mark.
fn read_text(table: impl BufRead) -> Result<String> {
    let mut bytes = Vec::new();
    let read = table.take(MAX_BYTES + 1).read_to_end(&mut bytes);
    read.map_err(|error| problem(1, "", format!("cannot be read: {error}")))?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err(problem(1, "", format!("the table has more than {MAX_BYTES} bytes")));
    }
    let text = String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        let before = error.as_bytes().iter().take(valid);
        let line = 1 + before.filter(|byte| **byte == b'\n').count();
        problem(line, "", "no UTF-8 text".into())
    })?;
    Ok(text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text))
}

/// Returns the line of a row. The row begins after the line ends that the reader has still to skip.
fn line_of(text: &str, position: Option<&csv::Position>) -> usize {
    let start = position.map_or(0, |at| usize::try_from(at.byte()).unwrap_or(usize::MAX));
    let (before, rest) = text.split_at_checked(start).unwrap_or((text, ""));
    let skipped = rest.len() - rest.trim_start_matches(['\r', '\n']).len();
    let ends = |text: &str| text.bytes().filter(|byte| *byte == b'\n').count();
    1 + ends(before) + ends(rest.get(..skipped).unwrap_or_default())
}

fn columns(line: usize, names: &csv::StringRecord) -> Result<Vec<(String, Column)>> {
    const HAND: [&str; 3] = ["hand_x_m", "hand_y_m", "hand_z_m"];
    let mut columns: Vec<(String, Column)> = Vec::new();
    for name in names {
        let joint = name.strip_suffix("_deg");
        let column = if let Some(axis) = HAND.iter().position(|hand| *hand == name) {
            Column::Hand(axis)
        } else if let Some(joint) =
            JointAngles::NAMES.iter().position(|known| joint == Some(*known))
        {
            Column::Joint(joint)
        } else {
            let known = JointAngles::NAMES.join("_deg, ");
            let hint = format!("unknown; known are {}, {known}_deg", HAND.join(", "));
            return Err(problem(line, name, hint));
        };
        if columns.iter().any(|(other, _)| other == name) {
            return Err(problem(line, name, "appears twice: keep one".into()));
        }
        columns.push((name.into(), column));
    }
    for name in HAND {
        if !columns.iter().any(|(other, _)| other == name) {
            return Err(problem(line, name, "missing: the hand's position is needed".into()));
        }
    }
    if columns.len() == HAND.len() {
        return Err(problem(line, "", "no joint column: add one, such as elbow_deg".into()));
    }
    Ok(columns)
}

fn sample(
    line: impl Fn() -> usize,
    cells: &csv::StringRecord,
    columns: &[(String, Column)],
) -> Result<MeasuredSample> {
    if cells.len() > columns.len() {
        let hint = format!("{} cells where the header names {}", cells.len(), columns.len());
        return Err(problem(line(), "", hint));
    }
    let (mut hand, mut angles) = (Vector3::zeros(), [0.0; DOF]);
    for (index, (name, column)) in columns.iter().enumerate() {
        let cell = cells.get(index).unwrap_or_default();
        let number: f64 =
            cell.parse().ok().filter(|number: &f64| number.is_finite()).ok_or_else(|| {
                let shown: String = cell.chars().take(LONGEST).collect();
                problem(line(), name, format!("{shown:?} is no finite number"))
            })?;
        match *column {
            Column::Hand(axis) => hand[axis] = number,
            Column::Joint(joint) => angles[joint] = number.to_radians(),
        }
    }
    Ok(MeasuredSample { hand, angles: JointAngles::from_array(angles) })
}

fn problem(line: usize, column: &str, problem: String) -> Error {
    let column: String = column.chars().take(LONGEST).collect();
    Error::Samples { line, column, problem }
}
