//! The surfaces of the object that the robot holds.

use std::{fmt, str::FromStr};

use serde::{Deserialize, Serialize};

use crate::error::Error;

/// A surface of the object, one of the paper's two classes (Sec. "Surface Classification Model").
/// The drilled surface is for drilling, the smooth one for polishing.
///
/// ```
/// use vision_models::{Surface, Tool};
///
/// let surface: Surface = "drilled".parse()?;
/// assert_eq!(surface.tool(), Tool::Drill);
/// assert_eq!(surface.to_string(), "drilled");
/// # Ok::<(), vision_models::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Surface {
    /// The surface that has no holes, for polishing.
    Smooth,
    /// The perforated surface, for drilling.
    Drilled,
}

impl Surface {
    /// Returns `"smooth"` or `"drilled"`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Smooth => "smooth",
            Self::Drilled => "drilled",
        }
    }
}

impl fmt::Display for Surface {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.name())
    }
}

impl FromStr for Surface {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self, Error> {
        match name {
            "smooth" => Ok(Self::Smooth),
            "drilled" => Ok(Self::Drilled),
            _ => Err(Error::unknown("surface", name, "\"smooth\" or \"drilled\"")),
        }
    }
}
