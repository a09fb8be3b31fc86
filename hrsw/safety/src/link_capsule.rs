//! Capsules fixed to the robot's links.

use hrsw::Capsule;

/// A capsule fixed to a link of the robot.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct LinkCapsule {
    /// Name of the link in the URDF.
    pub link: String,
    /// Capsule in the link's frame \[m\].
    pub capsule: Capsule,
}
