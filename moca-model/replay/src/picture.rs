//! Runs as SVG pictures: a still with plots beside it, and a short animation without a script.
//!
//! ```
//! use moca_replay::picture::{animation, still};
//! use moca_replay::recorded::ReplayError;
//!
//! assert!(matches!(still(&[]), Err(ReplayError::Nothing)));
//! assert!(matches!(animation(&[]), Err(ReplayError::Nothing)));
//! ```

mod colours;
mod curves;
mod figures;
mod moments;
mod moving;
mod sheet;
mod view;

pub use moving::animation;
pub use sheet::still;
