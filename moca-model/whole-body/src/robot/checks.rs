//! Checks of a description.

use nalgebra::Isometry3;

use super::description::{Base, Description};
use super::limits::MissingAcceleration;
use crate::error::{Error, check_finite};
use crate::urdf::tree::Tree;

/// Returns an error unless every number in the description, except limits, is finite.
pub(super) fn check_numbers(description: &Description) -> Result<(), Error> {
    for value in &description.gravity {
        check_finite(*value, || "a component of gravity".to_owned())?;
    }
    for (joint, position) in &description.locked {
        check_finite(*position, || format!("the position that locks joint `{joint}`"))?;
    }
    for (joint, pose) in &description.origins {
        check_pose(pose, || format!("the description's origin of joint `{joint}`"))?;
    }
    for (joint, friction) in &description.friction {
        for value in [friction.range, friction.steepness, friction.shift] {
            check_finite(value, || format!("the friction of joint `{joint}`"))?;
        }
    }
    match description.missing_acceleration {
        MissingAcceleration::TimeToFullSpeed(time) if !(time > 0.0 && time.is_finite()) => {
            Err(Error::not_positive("the time to full speed", time))
        }
        _ => Ok(()),
    }
}

pub(super) fn check_pose(pose: &Isometry3<f64>, what: impl Fn() -> String) -> Result<(), Error> {
    let values = pose.translation.vector.iter().chain(&pose.rotation.coords);
    values.into_iter().try_for_each(|value| check_finite(*value, &what))
}

/// Returns an error unless every joint that the description names exists.
pub(super) fn check_names(tree: &Tree, description: &Description) -> Result<(), Error> {
    let is_base = |name: &str| {
        description.base == Base::Planar && ["base_x", "base_y", "base_yaw"].contains(&name)
    };
    for (name, _) in &description.origins {
        tree.joint(None, name, "the joint with another origin,")?;
    }
    for (name, _) in description.limits.iter().filter(|(name, _)| !is_base(name)) {
        tree.joint(None, name, "the joint with other limits,")?;
    }
    for (name, _) in description.friction.iter().filter(|(name, _)| !is_base(name)) {
        tree.joint(None, name, "the joint with friction,")?;
    }
    Ok(())
}
