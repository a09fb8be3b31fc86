//! Error messages, and lines on standard error.

use std::{
    fmt::Display,
    io::{Write, stderr},
};

use super::shown::escaped;

/// Writes a line to standard error. A failure is ignored.
pub(super) fn line(text: impl Display) {
    let line = format!("{text}\n").into_bytes();
    // A single call keeps the lines of several threads apart.
    let _ = stderr().lock().write_all(&escaped(&line).unwrap_or(line));
}

/// Prints a warning on standard error where there is no [`Session`](super::Session).
pub fn warn(text: impl Display) {
    line(text);
}

/// An error with its causes in one line, without a backtrace. A cause that its error has already told is not repeated.
pub(super) fn with_causes(error: &anyhow::Error) -> String {
    let mut text = String::new();
    for cause in error.chain() {
        let cause = cause.to_string();
        if cause.contains(&text) {
            text = cause;
        } else if !text.ends_with(&cause) {
            text.push_str(": ");
            text.push_str(&cause);
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use std::{io, path::Path};

    use super::super::ProgramError;
    use super::with_causes;

    #[test]
    fn causes_are_told_once() {
        let full = io::Error::other("the disk is full");
        let error = anyhow::Error::from(ProgramError::write(Path::new("a.csv"), full));
        assert_eq!(with_causes(&error), "cannot write a.csv: the disk is full");
        let error = error.context("the report");
        assert_eq!(with_causes(&error), "the report: cannot write a.csv: the disk is full");
        let full = io::Error::other("the disk is full");
        let error = anyhow::Error::from(ProgramError::write(Path::new("a.csv"), full));
        let error = error.context("a.csv");
        assert_eq!(with_causes(&error), "cannot write a.csv: the disk is full");
    }
}
