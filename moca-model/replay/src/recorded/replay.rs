//! Record of a run.

use ergo_map::Side;

use super::MapGrid;
use super::lanes::Lane;
use super::stage::Stage;
use super::table::Table;

/// A run, recorded.
#[derive(Clone, Debug)]
pub struct Replay {
    /// The name of the run.
    pub title: String,
    /// Solids, and the frames that carry them.
    pub stage: Stage,
    /// Sample by sample: poses of the frames, the predicted body, series, limits, and where robot and
    /// person are nearest.
    pub samples: Table,
    /// Camera frame by camera frame: the body that was seen and its scores.
    pub person: Table,
    /// The bodies of other people, frame by frame; none if there was never anybody.
    pub others: Option<Table>,
    /// States.
    pub lanes: Vec<Lane>,
    /// The person's stature \[m\].
    pub stature: f64,
    /// The working hand.
    pub side: Side,
    /// The person's map.
    pub map: MapGrid,
}
