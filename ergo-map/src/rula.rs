//! Rapid Upper Limb Assessment (McAtamney & Corlett, Applied Ergonomics 24, 1993).

mod score;
mod tables;
mod worksheet;

pub use score::{Rula, RulaActionLevel, RulaSubScores};
pub use worksheet::{LoadPattern, RulaWorksheet};
