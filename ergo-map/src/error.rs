//! What can be wrong with a request to this crate.

use thiserror::Error;

/// What can be wrong with a request to this crate.
///
/// Lengths are in metres and positions in the person's frame unless a variant says otherwise.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum Error {
    /// A number is not finite, or lies outside what makes sense for it.
    #[error("{what} is {got}{}{unit}: it must {wanted}", if .unit.is_empty() { "" } else { " " })]
    Value {
        /// The quantity.
        what: &'static str,
        /// Its value.
        got: f64,
        /// The unit of the value, empty for a number that is not finite.
        unit: &'static str,
        /// What would be right.
        wanted: String,
    },
    /// The hand cannot be there.
    #[error("the hand cannot be at ({x:.3}, {y:.3}, {z:.3}) m: {reason}")]
    Unreachable {
        /// Requested hand position, person's frame.
        x: f64,
        /// See `x`.
        y: f64,
        /// See `x`.
        z: f64,
        /// How far the closest posture stays away, or what is in the way.
        reason: String,
    },
    /// The map knows nothing about this hand position.
    #[error("({x:.3}, {y:.3}, {z:.3}) m is outside the map's domain: ask `contains` first")]
    OutOfDomain {
        /// Requested hand position, person's frame.
        x: f64,
        /// See `x`.
        y: f64,
        /// See `x`.
        z: f64,
    },
    /// Too few samples for what is asked of them.
    #[error("{what} needs at least {wanted} samples and got {got}: widen the region or add data")]
    TooFewSamples {
        /// What was to be computed.
        what: &'static str,
        /// Number given.
        got: usize,
        /// Smallest workable number.
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
        /// Line of the table, the header being 1.
        line: usize,
        /// Name of the column.
        column: String,
        /// What is wrong and what would be right.
        problem: String,
    },
    /// A map file cannot be read or written.
    #[error("{path}: {kind}")]
    Io {
        /// The file.
        path: String,
        /// What the operating system says.
        kind: std::io::ErrorKind,
    },
    /// A file or byte string is not a usable map.
    #[error("not a usable ergonomics map: {problem}")]
    MapFile {
        /// What is wrong with it.
        problem: String,
    },
}

/// The crate's result.
pub(crate) type Result<T> = core::result::Result<T, Error>;

/// The value itself if it is finite.
pub(crate) fn finite(what: &'static str, got: f64) -> Result<f64> {
    if got.is_finite() {
        Ok(got)
    } else {
        Err(Error::Value { what, got, unit: "", wanted: "be a finite number".into() })
    }
}

/// The value itself if it is an angle of at most a full turn: more is degrees by mistake.
pub(crate) fn angle(what: &'static str, got: f64) -> Result<f64> {
    use core::f64::consts::TAU;
    within(what, got, [-TAU, TAU], "rad")
}

/// The value itself if it is finite and within the interval.
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
