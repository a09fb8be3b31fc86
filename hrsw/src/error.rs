//! What can be wrong with a workspace.

/// Misuse of the crate.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A number is NaN or infinite.
    #[error("{what} holds {value}, which is not finite; check where it comes from")]
    NotFinite {
        /// The offending item.
        what: &'static str,
        /// The value.
        value: f64,
    },

    /// A lower bound lies above its upper bound.
    #[error("{what}, axis {axis}: the minimum {min} lies above the maximum {max}; swap them")]
    Empty {
        /// The bounds.
        what: &'static str,
        /// The axis, 0 to 2.
        axis: usize,
        /// The lower bound.
        min: f64,
        /// The upper bound.
        max: f64,
    },

    /// Orientation bounds reach rotations by half a turn, where rotation vectors jump.
    #[error(
        "the orientation bounds reach an angle of {angle:.3} rad; keep their corners within {limit:.3} rad and turn the reference frame instead"
    )]
    AngleTooLarge {
        /// The angle of the farthest corner \[rad\].
        angle: f64,
        /// The largest angle allowed \[rad\].
        limit: f64,
    },

    /// A parameter is out of its range.
    #[error("{name} is {value}; it must be {expected}")]
    Parameter {
        /// The parameter.
        name: &'static str,
        /// Its value.
        value: f64,
        /// The range it must lie in.
        expected: &'static str,
    },

    /// The augmented state has no room for the slack, or no 6-dimensional task.
    #[error("the augmented state has {found} {what}; the softened workspace needs {expected}")]
    State {
        /// The part of the state.
        what: &'static str,
        /// How many it has.
        found: usize,
        /// How many are needed.
        expected: usize,
    },

    /// The solver's crate refused the rows.
    #[error(transparent)]
    Hierarchy(#[from] ahqp_core::Error),
}

pub(crate) fn positive(name: &'static str, value: f64) -> Result<f64, Error> {
    if value > 0.0 && value.is_finite() {
        Ok(value)
    } else {
        Err(Error::Parameter { name, value, expected: "positive and finite" })
    }
}
