//! Conversion of REBA's printed classes to continuous scores.

use crate::error::{Result, within};

/// Conversion of the printed classes to continuous scores.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Mode {
    /// Piecewise linear, half-way between two classes at the threshold between them. Rounding
    /// returns the class, and there is no plateau away from the neutral posture. Use it to compare
    /// similar postures and to build maps.
    #[default]
    Graded,
    /// A smooth step around each threshold, and the printed class elsewhere. It is close to the
    /// integer score, including its plateaus. The steps are steep at their centre. Rounding nearly
    /// always gives the integer score, for steps over ±2° (`faithful_rounds_to_the_integer_score`).
    Faithful {
        /// Half the width of each step \[rad\], positive.
        half_width: f64,
    },
}

impl Mode {
    /// [`Mode::Faithful`] with steps over ±2°.
    pub const FAITHFUL: Self = Self::Faithful { half_width: 2.0 * core::f64::consts::PI / 180.0 };

    pub(super) fn validate(self) -> Result<()> {
        match self {
            Self::Graded => Ok(()),
            Self::Faithful { half_width } => {
                within("half_width", half_width, [1e-6, 0.5], "rad").map(drop)
            }
        }
    }
}
