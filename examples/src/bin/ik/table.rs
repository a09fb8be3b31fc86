//! The table of a run.

use anyhow::Result;

use crate::record::Record;

/// Writes a line for each tick: time, target and place of the frame, errors, number of joints that a limit stopped, and
/// time of the step. The joints' positions with their distances to the nearer end of their ranges follow.
///
/// # Errors
/// None except for lack of memory.
pub(crate) fn table(record: &Record) -> Result<Vec<u8>> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let fixed = [
        "time_s",
        "target_x_m",
        "target_y_m",
        "target_z_m",
        "x_m",
        "y_m",
        "z_m",
        "position_error_m",
        "orientation_error_rad",
        "limited_joints",
        "step_us",
    ];
    let margins = record.joints.iter().map(|name| format!("{name}_margin"));
    writer.write_record(
        fixed.map(String::from).into_iter().chain(record.joints.iter().cloned()).chain(margins),
    )?;
    for tick in &record.ticks {
        let numbers = [tick.time].into_iter();
        let numbers = numbers.chain(tick.target.iter().copied()).chain(tick.actual.iter().copied());
        let numbers = numbers.chain([tick.position_error, tick.orientation_error]);
        let counts = [tick.limited.to_string(), format!("{:.2}", tick.duration)];
        let margins = tick.positions.iter().zip(&record.ranges);
        let margins = margins.map(|(q, (lower, upper))| (q - lower).min(upper - q));
        let joints = tick.positions.iter().copied().chain(margins);
        let numbers = numbers.map(|number| number.to_string()).chain(counts);
        writer.write_record(numbers.chain(joints.map(|number| number.to_string())))?;
    }
    Ok(writer.into_inner()?)
}
