//! Reasons why a problem of a set has no solution, in the terms of the file.

use ahqp_core::{ConstraintSource, Error, LevelId};

use super::Problem;

/// Largest number of rows of a conflict that are listed.
const MOST_PLACES: usize = 10;

impl Problem {
    /// Describes why the solver returns no solution, with the line of the rows in the file and the
    /// cause.
    pub fn reason(&self, error: &Error) -> String {
        let words = match error {
            Error::EmptyRange { source_of_row, lower, upper, .. } if lower == upper => {
                format!(
                    "{}: both bounds are {lower}, where no number is; give one of them a value",
                    self.place(*source_of_row)
                )
            }
            Error::EmptyRange { source_of_row, lower, upper, .. } => {
                format!(
                    "{}: the lower bound {lower} lies above the upper bound {upper}; order them",
                    self.place(*source_of_row)
                )
            }
            Error::Datum { source_of_row, got, .. } if got.is_finite() => format!(
                "{}: {got:e} is beyond 1e100, where double precision overflows; change units, or \
                 write 1e30 where there is no bound",
                self.place(*source_of_row)
            ),
            Error::Overflow => "the solution overflows double precision; bring rows and bounds to \
                                comparable sizes"
                .to_owned(),
            Error::Infeasible { level, worst, violation, .. } => format!(
                "{}: its hard rows cannot hold together with those above; {} stays violated by \
                 {violation:.3e}",
                self.level(*level),
                self.place(*worst)
            ),
            Error::Unbounded { level, .. } => {
                format!("{}: its objective falls without end", self.level(*level))
            }
            other => other.to_string(),
        };
        format!("problem {} ({}), {words}", self.index, self.name)
    }

    /// Lists the rows that cannot hold together, in the terms of the file.
    pub fn conflict(&self, conflict: &[ConstraintSource]) -> String {
        let places: Vec<String> =
            conflict.iter().take(MOST_PLACES).map(|source| self.place(*source)).collect();
        let rest = conflict.len() - places.len();
        let more = if rest > 0 { format!("; and {rest} more") } else { String::new() };
        format!("what cannot hold together: {}{more}", places.join("; "))
    }

    fn level(&self, level: LevelId) -> String {
        match self.lines.levels.get(level.index()) {
            Some(line) => format!("the level of line {line}"),
            None => level.to_string(),
        }
    }

    fn place(&self, source: ConstraintSource) -> String {
        match source {
            ConstraintSource::Bound { variable } => match self.lines.bounds {
                Some(line) => format!("the bounds of variable {variable}, level of line {line}"),
                None => format!("the bounds of variable {variable}"),
            },
            ConstraintSource::Constraint { level, row }
            | ConstraintSource::Objective { level, row } => {
                format!("row {row} of {}", self.level(level))
            }
            other => other.to_string(),
        }
    }
}
