//! Keyword arguments that select the robot's part of a URDF.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use whole_body::robot::{AddedFrame, LimitOverride, MissingAcceleration, UnusableLimits};
use whole_body::{Base, Description};

use crate::arrays::{numbers, pose};
use crate::failure::{Failure, Result};

/// Keyword arguments of `Model`; None selects the default.
#[derive(Debug)]
pub(crate) struct Keywords<'py> {
    pub(crate) base: String,
    pub(crate) root: Option<String>,
    pub(crate) tips: Vec<String>,
    pub(crate) joints: Vec<String>,
    pub(crate) locked: Option<Bound<'py, PyDict>>,
    pub(crate) origins: Option<Bound<'py, PyDict>>,
    pub(crate) limits: Option<Bound<'py, PyDict>>,
    pub(crate) frames: Option<Bound<'py, PyDict>>,
    pub(crate) gravity: Option<Bound<'py, PyAny>>,
    pub(crate) time_to_full_speed: Option<f64>,
    pub(crate) ignore_unusable_limits: bool,
}

impl Keywords<'_> {
    pub(crate) fn description(self) -> Result<Description> {
        let default = Description::default();
        let base = match self.base.as_str() {
            "fixed" => Base::Fixed,
            "planar" => Base::Planar,
            "floating" => Base::Floating,
            other => {
                let text =
                    format!(r#"base is "{other}"; it must be "fixed", "planar" or "floating""#);
                return Err(Failure::value(text));
            }
        };
        Ok(Description {
            base,
            root: self.root,
            tips: self.tips,
            joints: self.joints,
            locked: entries(self.locked, |_, value| Ok(value.extract::<f64>()?))?,
            origins: entries(self.origins, |name, value| pose(name, value))?,
            limits: entries(self.limits, |_, value| limit(value))?,
            frames: entries(self.frames, |name, value| {
                let (on, at): (String, Bound<'_, PyAny>) = value.extract()?;
                Ok((on, pose(name, &at)?))
            })?
            .into_iter()
            .map(|(name, (on, pose))| AddedFrame { name, on, pose })
            .collect(),
            gravity: match self.gravity {
                Some(gravity) => numbers::<3>("gravity", &gravity)?.into(),
                None => default.gravity,
            },
            missing_acceleration: match self.time_to_full_speed {
                Some(time) if time.is_infinite() => MissingAcceleration::Unlimited,
                Some(time) => MissingAcceleration::TimeToFullSpeed(time),
                None => default.missing_acceleration,
            },
            unusable_limits: if self.ignore_unusable_limits {
                UnusableLimits::Ignore
            } else {
                UnusableLimits::Refuse
            },
            ..default
        })
    }
}

/// Returns the items of a dict in their order.
fn entries<'py, T>(
    dict: Option<Bound<'py, PyDict>>,
    read: impl Fn(&str, &Bound<'py, PyAny>) -> Result<T>,
) -> Result<Vec<(String, T)>> {
    let items = dict.into_iter().flatten();
    let read = |(key, value): (Bound<'py, PyAny>, Bound<'py, PyAny>)| {
        let name: String = key.extract()?;
        let value = read(&name, &value)?;
        Ok((name, value))
    };
    items.map(read).collect()
}

/// Reads a limit from a dict of position, velocity, acceleration, jerk and effort.
fn limit(value: &Bound<'_, PyAny>) -> Result<LimitOverride> {
    let mut limit = LimitOverride::default();
    for (key, value) in value.cast::<PyDict>().map_err(PyErr::from)? {
        let slot = match key.extract::<String>()?.as_str() {
            "position" => {
                limit.position = Some(value.extract()?);
                continue;
            }
            "velocity" => &mut limit.velocity,
            "acceleration" => &mut limit.acceleration,
            "jerk" => &mut limit.jerk,
            "effort" => &mut limit.effort,
            other => {
                return Err(Failure::value(format!(
                    r#""{other}" is no limit; give position, velocity, acceleration, jerk or effort"#
                )));
            }
        };
        *slot = Some(value.extract()?);
    }
    Ok(limit)
}
