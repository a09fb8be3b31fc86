//! The robot of a settings file.

use std::path::{Path, PathBuf};

use moca_model::whole_body::{Description, Error, Model};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Another robot than MOCA, by its URDF. Tool, posture, bodies and torque drives are settings of controller and torque
/// law.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OwnRobot {
    /// URDF, from the folder of this file. Default "none", which is MOCA.
    pub urdf: Option<PathBuf>,
    /// Link to start from. Default "none", which is the URDF's root.
    pub root: Option<String>,
    /// Names of all joints that move, in the order of q, as a check. Default empty, for the joints that move the tool.
    pub joints: Vec<String>,
}

impl OwnRobot {
    /// Reads the robot with this tool, by a path that begins in `folder`. `None` for MOCA.
    ///
    /// # Errors
    /// A URDF that cannot be used, and a tool or joints that it does not have.
    pub fn read(&self, folder: &Path, tool: &str) -> Result<Option<Model>, Error> {
        let Some(urdf) = &self.urdf else { return Ok(None) };
        let tips = if self.joints.is_empty() { vec![tool.to_owned()] } else { Vec::new() };
        let (root, joints) = (self.root.clone(), self.joints.clone());
        let description = Description { root, tips, joints, ..Description::default() };
        Model::from_urdf_file(folder.join(urdf), &description).map(Some)
    }
}
