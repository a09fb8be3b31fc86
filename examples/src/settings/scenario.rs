//! Scenarios with the settings of a file.

use moca_simulation::run::Scenario;

use super::error::SettingsError;
use super::file::SettingsFile;
use super::robot::RobotSettings;

/// The scenario with the values of a settings file. The goal stays that of each run.
///
/// # Errors
/// Values that are out of range or do not fit together, and another robot than MOCA.
pub fn with_settings(scenario: Scenario, file: &SettingsFile) -> Result<Scenario, SettingsError> {
    let (controller, torque) = (scenario.settings, scenario.torques);
    let base = RobotSettings { controller, torque, ..RobotSettings::default() };
    let RobotSettings { controller, torque, robot, .. } = file.over(&base)?;
    if robot.urdf.is_some() {
        let reason =
            "robot.urdf names another robot: this program moves MOCA alone, and drive moves others"
                .into();
        return Err(SettingsError::Range { line: None, reason });
    }
    Ok(Scenario { settings: controller, torques: torque, ..scenario })
}
