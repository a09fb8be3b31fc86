//! Scenarios with the settings of a file.

use moca_simulation::run::Scenario;

use super::error::SettingsError;
use super::file::SettingsFile;
use super::robot::RobotSettings;

/// The scenario with the values of a settings file. The goal stays that of each run.
///
/// # Errors
/// Values that are out of range or do not fit together.
pub fn with_settings(scenario: Scenario, file: &SettingsFile) -> Result<Scenario, SettingsError> {
    let (controller, torque) = (scenario.settings, scenario.torques);
    let base = RobotSettings { controller, torque, ..RobotSettings::default() };
    let RobotSettings { controller, torque, .. } = file.over(&base)?;
    Ok(Scenario { settings: controller, torques: torque, ..scenario })
}
