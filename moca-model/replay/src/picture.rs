//! Runs as pictures of SVG: a still with the plots beside, and a short animation that needs no script.
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
