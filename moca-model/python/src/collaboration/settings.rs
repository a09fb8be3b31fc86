//! Settings of the controller and of its torque law.

use moca_model::whole_body::torque::Compensation;
use moca_model::{ControllerSettings, TorqueLoopSettings};
use pyo3::prelude::*;
use serde::{Deserialize, Serialize};
use toml::{Table, Value};

use super::tables;
use crate::ergo::keywords::word;
use crate::failure::{Failure, Result};

/// Settings, by the tables of the programs' settings file.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Settings {
    pub(super) controller: ControllerSettings,
    pub(super) torque: TorqueLoopSettings,
}

/// Tables and entries of a settings file that do not concern a controller.
const OF_PROGRAMS: [&str; 4] = ["version", "topics", "robot", "camera"];

impl Settings {
    /// Returns the settings with the values of tables of the caller.
    pub(super) fn with(self, tables: Option<&Bound<'_, PyAny>>) -> Result<Self> {
        let Some(tables) = tables else { return Ok(self) };
        let mut over = tables::read(tables)?;
        for name in OF_PROGRAMS {
            over.remove(name);
        }
        let other = over.keys().find(|name| !["controller", "torque"].contains(&name.as_str()));
        if let Some(other) = other {
            return Err(Failure::value(format!(
                "settings has a table \"{other}\"; its tables are \"controller\" and \"torque\""
            )));
        }
        let mut all = self.table()?;
        tables::overlay(&mut all, over);
        let wrong = |error: toml::de::Error| {
            Failure::value(format!("settings: {}", error.to_string().trim_end()))
        };
        Value::Table(all).try_into().map_err(wrong)
    }

    /// Returns the tables.
    pub(super) fn table(&self) -> Result<Table> {
        let fail = |error: toml::ser::Error| Failure::runtime(error.to_string());
        Table::try_from(self).map_err(fail)
    }
}

/// Reads the torques that a robot adds by itself.
pub(super) fn compensation(value: &str) -> Result<Compensation> {
    let known = [("nothing", Compensation::BARE), ("franka", Compensation::FRANKA)];
    word("compensation", value, &known)
}
