//! The robot's bodies, capsules fixed to its links.

use hrsw::Capsule;

/// A capsule fixed to a link of the robot.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct LinkCapsule {
    /// The link's name in the URDF.
    pub link: String,
    /// In the link's frame \[m\].
    pub capsule: Capsule,
}
