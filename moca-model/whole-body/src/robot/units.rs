//! Check that a measured state is in m, rad and s.

use super::joint::JointKind;
use super::model::Model;
use crate::error::{Error, check_size};

/// Distance that a joint may be beyond its limits \[m or rad\]: people push arms beyond them, and zeros are inexact.
const BEYOND: f64 = 1.0;
/// Ratio by which a measured speed may exceed its limit, because of noise or a push.
const FASTER: f64 = 3.0;
/// Largest position of a joint without limits \[m or rad\]: 160 turns, or a place a kilometre away.
const FARTHEST: f64 = 1e3;

const UNITS: [[&str; 2]; 2] = [
    ["metres, not millimetres", "metres a second, not millimetres a second"],
    ["radians, not degrees", "radians a second, not degrees a second"],
];

impl Model {
    /// Checks that a measured state, q and q̇, is not far beyond the robot's limits, as joints in degrees or odometry
    /// in millimetres would be.
    ///
    /// Positions may be 1 rad or 1 m beyond their limits, or 1 km from zero without limits. Speeds may be three times
    /// their limits. A state near zero is near zero in every unit, so that a state which passes may still be in a wrong
    /// unit.
    ///
    /// ```
    /// # use whole_body::{Description, Model};
    /// # let urdf = r#"<robot name="arm"><link name="base"/><link name="arm"/>
    /// #   <joint name="elbow" type="revolute"><parent link="base"/><child link="arm"/>
    /// #     <axis xyz="0 1 0"/><limit lower="-2.9" upper="2.9" velocity="2" effort="20"/></joint></robot>"#;
    /// let model = Model::from_urdf(urdf, &Description::default())?;
    /// assert!(model.check_units(&[-1.57], &[0.0]).is_ok());
    /// let error = model.check_units(&[-90.0], &[0.0]).unwrap_err().to_string();
    /// assert!(error.contains("elbow") && error.contains("radians, not degrees"));
    /// # Ok::<(), whole_body::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Value`] for the first number that is too large; [`Error::Size`].
    pub fn check_units(&self, position: &[f64], velocity: &[f64]) -> Result<(), Error> {
        check_size("q", position.len(), self.position_count())?;
        check_size("q̇", velocity.len(), self.velocity_count())?;
        for joint in self.joints() {
            if joint.kind == JointKind::Floating {
                for value in position.iter().skip(joint.position_index).take(3) {
                    check("position", &joint.name, *value, -FARTHEST, FARTHEST, UNITS[0][0])?;
                }
                continue;
            }
            let [of_position, of_velocity] = UNITS[usize::from(joint.kind != JointKind::Prismatic)];
            let Some(limits) = self.limits().get(joint.velocity_index) else { continue };
            if let Some(value) = position.get(joint.position_index) {
                let (lower, upper) = (
                    if limits.lower.is_finite() { limits.lower - BEYOND } else { -FARTHEST },
                    if limits.upper.is_finite() { limits.upper + BEYOND } else { FARTHEST },
                );
                check("position", &joint.name, *value, lower, upper, of_position)?;
            }
            if let Some(value) = velocity.get(joint.velocity_index) {
                let most = FASTER * limits.velocity;
                check("velocity", &joint.name, *value, -most, most, of_velocity)?;
            }
        }
        Ok(())
    }
}

fn check(
    what: &'static str,
    joint: &str,
    value: f64,
    lower: f64,
    upper: f64,
    unit: &'static str,
) -> Result<(), Error> {
    // NaN is another fault.
    let beyond = (value < lower).then_some(lower).or_else(|| (value > upper).then_some(upper));
    beyond.map_or(Ok(()), |limit| {
        let side = if value < limit { "least" } else { "most" };
        let wanted = format!("at {side} {limit:.3}; give {unit}");
        Err(Error::value(format!("the {what} of {joint}"), value, wanted))
    })
}
