//! Recorded postures as a table.

use std::io::BufRead;

use nalgebra::Vector3;

use crate::error::{Error, Result};
use crate::joints::{DOF, JointAngles};

/// A recorded hand position and the posture taken there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredSample {
    /// Hand position in the person's frame \[m\].
    pub hand: Vector3<f64>,
    /// The posture.
    pub angles: JointAngles,
}

/// What a column of the table holds.
#[derive(Clone, Copy)]
enum Column {
    Hand(usize),
    Joint(usize),
}

/// Reads samples from a comma-separated table.
///
/// The first line names the columns, in any order: `hand_x_m`, `hand_y_m`, `hand_z_m` (all three
/// needed) and `<joint>_deg` for the joints of [`JointAngles::NAMES`] (at least one; a joint
/// without a column is zero). Blank lines are skipped.
///
/// ```
/// let table = "hand_x_m,hand_y_m,hand_z_m,elbow_deg\n0.4,-0.2,1.1,80\n";
/// let samples = ergo_map::read_samples(table.as_bytes())?;
/// assert_eq!(samples[0].angles.elbow, 80_f64.to_radians());
/// # Ok::<(), ergo_map::Error>(())
/// ```
///
/// # Errors
/// [`Error::Samples`] with line and column for an unknown, repeated or missing column, a missing or
/// surplus cell, or a cell that is no finite number; [`Error::TooFewSamples`] for an empty table.
pub fn read_samples(table: impl BufRead) -> Result<Vec<MeasuredSample>> {
    let mut header: Option<Vec<(String, Column)>> = None;
    let mut samples = Vec::new();
    for (line, text) in (1..).zip(table.lines()) {
        let text = text.map_err(|error| problem(line, "", format!("cannot be read: {error}")))?;
        let text = text.trim_start_matches('\u{feff}').trim();
        if text.is_empty() {
            continue;
        }
        match &header {
            None => header = Some(columns(line, text)?),
            Some(columns) => samples.push(sample(line, text, columns)?),
        }
    }
    if samples.is_empty() {
        return Err(Error::TooFewSamples { what: "a table of postures", needed: 1, found: 0 });
    }
    Ok(samples)
}

fn columns(line: usize, text: &str) -> Result<Vec<(String, Column)>> {
    const HAND: [&str; 3] = ["hand_x_m", "hand_y_m", "hand_z_m"];
    let mut columns: Vec<(String, Column)> = Vec::new();
    for name in text.split(',').map(str::trim) {
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

fn sample(line: usize, text: &str, columns: &[(String, Column)]) -> Result<MeasuredSample> {
    let cells: Vec<&str> = text.split(',').map(str::trim).collect();
    if cells.len() > columns.len() {
        let hint = format!("{} cells where the header names {}", cells.len(), columns.len());
        return Err(problem(line, "", hint));
    }
    let (mut hand, mut angles) = (Vector3::zeros(), [0.0; DOF]);
    for (index, (name, column)) in columns.iter().enumerate() {
        let cell = cells.get(index).copied().unwrap_or_default();
        let number: f64 = cell
            .parse()
            .ok()
            .filter(|number: &f64| number.is_finite())
            .ok_or_else(|| problem(line, name, format!("{cell:?} is no finite number")))?;
        match *column {
            Column::Hand(axis) => hand[axis] = number,
            Column::Joint(joint) => angles[joint] = number.to_radians(),
        }
    }
    Ok(MeasuredSample { hand, angles: JointAngles::from_array(angles) })
}

fn problem(line: usize, column: &str, problem: String) -> Error {
    Error::Samples { line, column: column.into(), problem }
}
