//! Record of a run for pictures: samples of the poses of robot, person and workspace, of the scores, and of all states.
//!
//! ```
//! use ergo_map::{ErgonomicsMap, MapOptions, Person};
//! use moca_replay::recorded::Recorder;
//! use moca_model::{ControllerSettings, MOCA_URDF, moca};
//!
//! let options = MapOptions { spacing: 0.3, ..MapOptions::default() };
//! let map = ErgonomicsMap::build(&Person::average(), &options, None)?;
//! let settings = ControllerSettings::default();
//! let recorder = Recorder::new("Ergonomics on", &moca()?, MOCA_URDF, &settings, &map)?;
//! // In the run: recorder.observe(…) at each camera frame, recorder.tick(…) at each tick.
//! let replay = recorder.finish();
//! assert!(replay.samples.is_empty());
//! assert!(replay.stage.solids().iter().any(|solid| solid.name == "base_link"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod body;
mod error;
mod lanes;
mod limit_use;
mod map_grid;
mod nearest;
mod others_track;
mod person_track;
mod recorder;
mod replay;
mod robot;
mod sampler;
mod stage;
mod table;

pub(crate) use body::{BODY_POINTS, BodyPart, LIMBS, POINT_COUNT};
pub use error::ReplayError;
pub use lanes::{Lane, Span, Tone};
pub use lanes::{
    base as base_label, intention as intention_label, phase as phase_label, safety as safety_label,
    solver as solver_label,
};
pub use map_grid::MapGrid;
pub use others_track::row as others_row;
pub use person_track::row as person_row;
pub use recorder::Recorder;
pub use replay::Replay;
pub use sampler::{FrameSlot, Sampler};
pub use stage::{Role, Shape, Solid, Stage};
pub use table::{Encoding, Group, Table};
