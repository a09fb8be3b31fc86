//! People other than the person who works with the robot, as the camera saw them.

use vision_models::Body;

use super::body::{self, BODY_POINTS, POINT_COUNT, Points};
use super::person_track::write_points;
use super::table::{Encoding, Group, Table};

/// Names: one more than the number of people that the robot can keep away from.
const NAMES: [&str; 5] = ["other 1", "other 2", "other 3", "other 4", "other 5"];

/// Bodies of each frame, from the first frame that shows anybody.
#[derive(Clone, Debug)]
pub(super) struct OthersTrack {
    table: Table,
    stature: f64,
}

impl OthersTrack {
    /// Creates a track. The stature of these people is unknown; `stature` is that of the person \[m\].
    pub(super) fn new(stature: f64) -> Self {
        Self { table: Table::new(groups()), stature }
    }

    /// Adds a camera frame.
    pub(super) fn observe(&mut self, time: f64, bodies: &[Body]) {
        if self.table.is_empty() && bodies.is_empty() {
            return;
        }
        self.table.push(time, &row(bodies, self.stature));
    }

    /// Returns all frames; `None` if there was never anybody.
    pub(super) fn finish(self) -> Option<Table> {
        (!self.table.is_empty()).then_some(self.table)
    }
}

/// The columns of other people.
pub(super) fn groups() -> Vec<Group> {
    NAMES.map(|name| Group::new(name, &BODY_POINTS, 3, Encoding::Steps)).into()
}

/// People of a stature \[m\] as a row of numbers.
pub fn row(bodies: &[Body], stature: f64) -> Vec<f32> {
    let unseen: Points = [None; POINT_COUNT];
    let mut row = Vec::with_capacity(NAMES.len() * 3 * POINT_COUNT);
    for place in 0..NAMES.len() {
        let points = bodies.get(place).map_or(unseen, |body| body::seen(body, stature));
        write_points(&points, &mut row);
    }
    row
}
