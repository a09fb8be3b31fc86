//! Errors of this crate.

use thiserror::Error;

/// Errors of this crate.
///
/// Lengths are in metres and positions in the person's frame, unless a variant states otherwise.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum Error {
    /// A number is not finite, or outside its allowed range.
    #[error("{what} is {got}{}{unit}: it must {wanted}", if .unit.is_empty() { "" } else { " " })]
    Value {
        /// The quantity.
        what: &'static str,
        /// Value given.
        got: f64,
        /// The unit of the value, empty for a number that is not finite.
        unit: &'static str,
        /// The allowed range.
        wanted: String,
    },
    /// The hand cannot reach this position.
    #[error("the hand cannot be at ({x:.3}, {y:.3}, {z:.3}) m: {reason}")]
    Unreachable {
        /// x of the requested hand position in the person's frame.
        x: f64,
        /// y of that position.
        y: f64,
        /// z of that position.
        z: f64,
        /// Distance of the closest posture, or the obstacle.
        reason: String,
    },
    /// The hand position is outside the map's domain.
    #[error("({x:.3}, {y:.3}, {z:.3}) m is outside the map's domain: ask `contains` first")]
    OutOfDomain {
        /// x of the requested hand position in the person's frame.
        x: f64,
        /// y of that position.
        y: f64,
        /// z of that position.
        z: f64,
    },
    /// There are too few samples for the computation.
    #[error("{what} needs at least {wanted} samples and got {got}: widen the region or add data")]
    TooFewSamples {
        /// The quantity that was to be computed.
        what: &'static str,
        /// Number of given samples.
        got: usize,
        /// Smallest sufficient number.
        wanted: usize,
    },
    /// The samples do not determine a quadratic, for example because they all lie in one plane.
    #[error(
        "the samples do not determine a quadratic in three dimensions: spread them in x, y and z"
    )]
    DegenerateSamples,
    /// A table of recorded samples is malformed.
    #[error("line {line}, column {column:?}: {problem}")]
    Samples {
        /// Line of the table, where the header is line 1.
        line: usize,
        /// Name of the column.
        column: String,
        /// The fault, and what would be valid.
        problem: String,
    },
    /// A map file cannot be read or written.
    #[error("{path}: {kind}")]
    Io {
        /// The file.
        path: String,
        /// Error of the operating system.
        kind: std::io::ErrorKind,
    },
    /// A file or byte string is not a usable map.
    #[error("not a usable ergonomics map: {problem}")]
    MapFile {
        /// The fault.
        problem: String,
    },
}

/// Result of this crate.
pub(crate) type Result<T> = core::result::Result<T, Error>;

/// Returns the value if it is finite.
pub(crate) fn finite(what: &'static str, got: f64) -> Result<f64> {
    if got.is_finite() {
        Ok(got)
    } else {
        Err(Error::Value { what, got, unit: "", wanted: "be a finite number".into() })
    }
}

/// Returns the value if it is an angle of at most a full turn. A larger one is in degrees by
/// mistake.
pub(crate) fn angle(what: &'static str, got: f64) -> Result<f64> {
    use core::f64::consts::TAU;
    within(what, got, [-TAU, TAU], "rad")
}

/// Returns the value if it is finite and within the interval.
pub(crate) fn within(
    what: &'static str,
    got: f64,
    [min, max]: [f64; 2],
    unit: &'static str,
) -> Result<f64> {
    finite(what, got)?;
    if (min..=max).contains(&got) {
        Ok(got)
    } else {
        Err(Error::Value { what, got, unit, wanted: format!("lie in [{min}, {max}] {unit}") })
    }
}
