//! The tools of HRI30.

use serde::{Deserialize, Serialize};

use crate::surface::Surface;

/// A tool that the person works with.
///
/// ```
/// use vision_models::{Surface, Tool};
///
/// assert_eq!(Tool::Polisher.surface(), Surface::Smooth);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Tool {
    /// The tool for the drilled surface.
    Drill,
    /// The tool for the smooth surface.
    Polisher,
}

impl Tool {
    /// Returns the surface that this tool works on. This surface must face the person (paper,
    /// Experiment 3).
    pub fn surface(self) -> Surface {
        match self {
            Self::Drill => Surface::Drilled,
            Self::Polisher => Surface::Smooth,
        }
    }
}

impl Surface {
    /// Returns the tool that works on this surface.
    pub fn tool(self) -> Tool {
        match self {
            Self::Smooth => Tool::Polisher,
            Self::Drilled => Tool::Drill,
        }
    }
}
