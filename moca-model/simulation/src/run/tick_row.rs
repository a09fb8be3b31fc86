//! Values of a tick in a row, but for the person.

use moca_replay::report::TickRow;

use crate::plant::Plant;

/// The row of the plant's last step, at a time \[s\]; how long the controller took \[µs\].
pub(crate) fn tick_row(plant: &Plant, now: f64, tick_us: f64) -> TickRow {
    let mut row = TickRow::default();
    let hand = plant.hand().translation.vector;
    row.write(now, plant.controller(), (&hand, plant.configuration()), tick_us);
    row
}
