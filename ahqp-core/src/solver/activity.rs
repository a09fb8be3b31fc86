//! What an active set says of a row.

/// Whether a row is active, and at which bound.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Activity {
    /// The row may take any value within its range.
    Inactive,
    /// A hard row is held at its lower bound; a row of an objective is pulled towards it.
    Lower,
    /// The same with the upper bound.
    Upper,
    /// The same for an equality, whose bounds are one.
    Equal,
}

impl Activity {
    pub(crate) fn is_active(self) -> bool {
        self != Self::Inactive
    }

    /// Returns true if a row that is active in this way should not be, given its multiplier and the
    /// rounding in it.
    pub(crate) fn has_wrong_sign(self, multiplier: f64, rounding: f64) -> bool {
        match self {
            Self::Upper => -multiplier > rounding,
            Self::Lower => multiplier > rounding,
            Self::Equal | Self::Inactive => false,
        }
    }
}
