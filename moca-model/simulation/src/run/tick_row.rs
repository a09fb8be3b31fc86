//! What a row says of a tick, but for the person.

use hrsw::Workspace;
use moca_replay::report::TickRow;

use crate::plant::Plant;

/// The row of the plant's last step, at a time \[s\]; how long the controller took \[µs\].
pub(crate) fn tick_row(plant: &Plant, now: f64, tick_us: f64) -> TickRow {
    let command = plant.command();
    let (workspace_min, workspace_max) = extent(plant.controller().space().workspace());
    TickRow {
        time: now,
        desired: command.desired.translation.vector.into(),
        actual: plant.hand().translation.vector.into(),
        workspace_min,
        workspace_max,
        slack: command.slack.into(),
        solve_time_us: tick_us,
        q: plant.configuration().to_vec(),
        qdot: command.joint_velocity.clone(),
        ..TickRow::default()
    }
}

/// The box along world axes around the workspace.
fn extent(workspace: &Workspace) -> ([f64; 3], [f64; 3]) {
    let bounds = workspace.position();
    let centre = (bounds.min() + bounds.max()) * 0.5;
    let half = (bounds.max() - bounds.min()) * 0.5;
    let frame = workspace.world_from_workspace();
    let middle = frame.transform_point(&centre.into()).coords;
    let reach = frame.rotation.to_rotation_matrix().matrix().abs() * half;
    ((middle - reach).into(), (middle + reach).into())
}
