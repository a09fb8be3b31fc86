//! Activity of rows.

/// Activity of a row, and the bound at which it is active.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Activity {
    /// The row may take any value within its range.
    Inactive,
    /// The row is at its lower bound. A hard row is held there, and a row of an objective is pulled
    /// towards it.
    Lower,
    /// The row is at its upper bound, in the same sense.
    Upper,
    /// The row is an equality, whose bounds are equal.
    Equal,
}

impl Activity {
    pub(crate) fn is_active(self) -> bool {
        self != Self::Inactive
    }

    /// Returns true if a row with this activity should be inactive, given its multiplier and the
    /// multiplier's rounding.
    pub(crate) fn has_wrong_sign(self, multiplier: f64, rounding: f64) -> bool {
        match self {
            Self::Upper => -multiplier > rounding,
            Self::Lower => multiplier > rounding,
            Self::Equal | Self::Inactive => false,
        }
    }
}
