//! Rules that derive a joint's limits from URDF and description.

use super::description::Description;
use super::limits::{
    JointLimits, LimitOverride, MissingAcceleration, UnusableLimits, empty_range, not_positive,
};
use super::warning::Warning;
use crate::error::{Error, urdf::UrdfError};
use crate::urdf::document::{Joint, Kind};

/// The limits, and whether the acceleration is the description's default.
pub(super) struct Resolved {
    pub(super) limits: JointLimits,
    pub(super) default_acceleration: bool,
}

/// The limits of a joint of the URDF.
pub(super) fn of_joint(
    joint: &Joint,
    description: &Description,
    warnings: &mut Vec<Warning>,
) -> Result<Resolved, Error> {
    let known = known(&joint.name, description);
    let stated = joint.limit.unwrap_or_default();
    let mut rule = Rule { joint, policy: description.unusable_limits, warnings };
    let (lower, upper) = match known.position {
        Some(range) => range,
        None if joint.kind == Kind::Continuous => (f64::NEG_INFINITY, f64::INFINITY),
        None => rule.range(stated.lower, stated.upper)?,
    };
    let limits = JointLimits {
        lower,
        upper,
        velocity: rule.speed("velocity", known.velocity, stated.velocity)?,
        effort: rule.effort(known.effort, stated.effort)?,
        acceleration: known.acceleration.or(stated.acceleration).unwrap_or(f64::INFINITY),
        jerk: known.jerk.or(stated.jerk).unwrap_or(f64::INFINITY),
    };
    complete(limits, &joint.name, Some(joint.line), description)
}

/// The limits of a mimic joint from URDF and description. Limits that are missing in the URDF or cannot be meant count
/// as unlimited, since many files state no limits of such joints.
pub(super) fn of_follower(joint: &Joint, description: &Description) -> Result<JointLimits, Error> {
    let (known, stated) = (known(&joint.name, description), joint.limit.unwrap_or_default());
    let ends = (stated.lower.unwrap_or(0.0), stated.upper.unwrap_or(0.0));
    let is_free = joint.kind == Kind::Continuous || ends.0.is_nan() || ends.0 >= ends.1;
    let free = (f64::NEG_INFINITY, f64::INFINITY);
    let (lower, upper) = known.position.unwrap_or(if is_free { free } else { ends });
    let usable = |known: Option<f64>, stated: Option<f64>| {
        known.or(stated.filter(|value| *value > 0.0)).unwrap_or(f64::INFINITY)
    };
    let limits = JointLimits {
        lower,
        upper,
        velocity: usable(known.velocity, stated.velocity),
        acceleration: usable(known.acceleration, stated.acceleration),
        jerk: usable(known.jerk, stated.jerk),
        effort: f64::INFINITY,
    };
    limits.validate(&joint.name, Some(joint.line))?;
    Ok(limits)
}

/// The limits of a joint of the base, which only the description states.
pub(super) fn of_base(name: &str, description: &Description) -> Result<Resolved, Error> {
    let known = known(name, description);
    let (lower, upper) = known.position.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
    let limits = JointLimits {
        lower,
        upper,
        velocity: known.velocity.unwrap_or(f64::INFINITY),
        effort: known.effort.unwrap_or(f64::INFINITY),
        acceleration: known.acceleration.unwrap_or(f64::INFINITY),
        jerk: known.jerk.unwrap_or(f64::INFINITY),
    };
    complete(limits, name, None, description)
}

fn known(name: &str, description: &Description) -> LimitOverride {
    let named = description.limits.iter().find(|(joint, _)| joint == name);
    named.map_or_else(LimitOverride::default, |(_, known)| *known)
}

fn complete(
    mut limits: JointLimits,
    joint: &str,
    line: Option<usize>,
    description: &Description,
) -> Result<Resolved, Error> {
    let stated =
        limits.acceleration != f64::INFINITY || known(joint, description).acceleration.is_some();
    let default_acceleration = match description.missing_acceleration {
        MissingAcceleration::TimeToFullSpeed(time) if !stated && limits.velocity.is_finite() => {
            limits.acceleration = limits.velocity / time;
            true
        }
        _ => false,
    };
    limits.validate(joint, line)?;
    Ok(Resolved { limits, default_acceleration })
}

struct Rule<'a> {
    joint: &'a Joint,
    policy: UnusableLimits,
    warnings: &'a mut Vec<Warning>,
}

impl Rule<'_> {
    fn range(&mut self, lower: Option<f64>, upper: Option<f64>) -> Result<(f64, f64), Error> {
        let (line, name) = (self.joint.line, self.joint.name.clone());
        let fault = if lower.is_none() && upper.is_none() {
            Error::from(UrdfError::LimitsMissing { line, joint: name, missing: "position limits" })
        } else {
            // The specification of URDF says that a missing limit is zero.
            let (lower, upper) = (lower.unwrap_or(0.0), upper.unwrap_or(0.0));
            if lower < upper {
                return Ok((lower, upper));
            }
            empty_range(name, Some(line), lower, upper)
        };
        self.ignore("range of positions", fault)?;
        Ok((f64::NEG_INFINITY, f64::INFINITY))
    }

    fn speed(
        &mut self,
        limit: &'static str,
        known: Option<f64>,
        stated: Option<f64>,
    ) -> Result<f64, Error> {
        if let Some(known) = known {
            return Ok(known);
        }
        let (line, joint) = (self.joint.line, self.joint.name.clone());
        let fault = match stated {
            Some(value) if value > 0.0 => return Ok(value),
            Some(value) => not_positive(joint, Some(line), limit, value),
            None if self.joint.kind == Kind::Continuous && self.joint.limit.is_none() => {
                return Ok(f64::INFINITY);
            }
            None => {
                let missing = if limit == "velocity" { "velocity limit" } else { "effort limit" };
                Error::from(UrdfError::LimitsMissing { line, joint, missing })
            }
        };
        self.ignore(limit, fault)?;
        Ok(f64::INFINITY)
    }

    /// Returns the effort limit. A stated zero, as in files of ROS-Industrial, counts as none.
    fn effort(&mut self, known: Option<f64>, stated: Option<f64>) -> Result<f64, Error> {
        let says_nothing = stated.is_none_or(|value| value == 0.0);
        match known {
            Some(0.0) => Err(not_positive(self.joint.name.clone(), None, "effort", 0.0)),
            None if says_nothing && self.policy == UnusableLimits::Refuse => {
                let is_free = self.joint.kind == Kind::Continuous && self.joint.limit.is_none();
                Ok(if is_free { f64::INFINITY } else { JointLimits::UNKNOWN_EFFORT })
            }
            known => self.speed("effort", known, stated),
        }
    }

    fn ignore(&mut self, limit: &'static str, fault: Error) -> Result<(), Error> {
        if self.policy == UnusableLimits::Refuse {
            return Err(fault);
        }
        let (joint, line) = (self.joint.name.clone(), self.joint.line);
        self.warnings.push(Warning::LimitIgnored { joint, line, limit });
        Ok(())
    }
}
