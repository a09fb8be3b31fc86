//! Head that a page gets before the first picture.

use std::fmt;

use moca_model::{Levels, MOCA_URDF};
use moca_replay::page::{Results, data};
use moca_replay::recorded::Sampler;
use moca_simulation::plant::PlantSettings;
use moca_simulation::workcell::{Setup, Workcell};
use serde::Serialize;
use serde_json::value::RawValue;

use crate::error::Error;
use crate::request::Restart;

/// Settings as the text of a file, and back.
#[derive(Clone, Copy)]
pub struct SettingsText {
    /// The text of a file with these settings.
    pub write: fn(&PlantSettings) -> Result<String, String>,
    /// Reads the text of a file over these settings; what it leaves out stays.
    pub read: fn(&str, &PlantSettings) -> Result<PlantSettings, String>,
}

impl fmt::Debug for SettingsText {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("SettingsText")
    }
}

/// Robot, person and settings of a workcell, for its pages.
#[derive(Clone, Debug)]
pub struct Head {
    /// Counts workcells: pictures of another are not of this one.
    pub(crate) number: u64,
    pub(crate) setup: Setup,
    text: SettingsText,
    /// The text of the settings.
    pub(crate) settings: String,
    json: String,
}

#[derive(Serialize)]
struct Hello<'a> {
    kind: &'static str,
    number: u64,
    stature: f64,
    hands_over: bool,
    levels: Levels,
    settings: &'a str,
    page: &'a RawValue,
}

impl Head {
    /// Describes the first workcell.
    ///
    /// # Errors
    /// Settings that no file holds.
    pub fn new(setup: &Setup, sampler: &Sampler, text: SettingsText) -> Result<Self, Error> {
        Self::numbered(1, setup, sampler, text)
    }

    fn numbered(
        number: u64,
        setup: &Setup,
        sampler: &Sampler,
        text: SettingsText,
    ) -> Result<Self, Error> {
        let settings = (text.write)(&setup.robot).map_err(Error::Settings)?;
        let page =
            RawValue::from_string(data(&[&sampler.empty_run("live")], &Results::default())?)?;
        let hello = Hello {
            kind: "hello",
            number,
            stature: setup.map.stature(),
            hands_over: setup.hands_over,
            levels: setup.robot.controller.levels,
            settings: &settings,
            page: &page,
        };
        let json = serde_json::to_string(&hello)?;
        Ok(Self { number, setup: setup.clone(), text, settings, json })
    }

    /// Describes the workcell that comes after this one.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub(crate) fn next(&self, setup: &Setup, sampler: &Sampler) -> Result<Self, Error> {
        Self::numbered(self.number + 1, setup, sampler, self.text)
    }

    /// The setup that the next workcell begins with.
    ///
    /// # Errors
    /// A stature or settings that cannot be used.
    pub(crate) fn restarted(&self, restart: &Restart) -> Result<Setup, Error> {
        let mut setup = match restart.stature {
            Some(stature) => self.setup.for_stature(stature)?,
            None => self.setup.clone(),
        };
        if let Some(text) = &restart.settings {
            setup.robot = (self.text.read)(text, &setup.robot).map_err(Error::Settings)?;
        }
        if let Some(levels) = restart.levels {
            setup.robot.controller.levels = levels;
        }
        setup.hands_over = restart.hands_over.unwrap_or(setup.hands_over);
        Ok(setup)
    }

    /// The first message to a page.
    pub(crate) fn json(&self) -> &str {
        &self.json
    }
}

/// Makes the sampler of a workcell's pictures.
///
/// # Errors
/// A robot that cannot be shown.
pub(crate) fn sampler(cell: &Workcell) -> Result<Sampler, Error> {
    let (controller, map) = (cell.plant().controller(), &cell.setup().map);
    let mut sampler =
        Sampler::new(controller.robot().model(), MOCA_URDF, controller.settings(), map)?;
    sampler.grasping(cell.object());
    Ok(sampler)
}
