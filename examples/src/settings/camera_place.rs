//! The place of the camera that sees the people.

use moca_drivers::{MAP_FRAME, WORLD_FRAME};
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Largest deviation of the norm of an orientation from 1, since numbers written by hand have few digits.
const TOLERANCE: f64 = 1e-3;

/// The frame of a camera's place.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum CameraFrame {
    /// Frame of the odometry, for a camera on the robot's own map.
    #[default]
    Odom,
    /// Frame of a localisation, which does not drift, for a camera that stands in the building.
    Map,
}

impl CameraFrame {
    /// The frame's name on the ROS 2 graph.
    pub fn name(self) -> &'static str {
        match self {
            Self::Odom => WORLD_FRAME,
            Self::Map => MAP_FRAME,
        }
    }
}

/// The place of the camera that sees the people.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CameraPlace {
    /// Frame of its place. Default odom.
    pub frame: CameraFrame,
    /// Place \[m\] and orientation, x, y, z, then the unit quaternion x, y, z, w: z along the view, x to the right.
    /// Default "none", which is that of the folder's camera.json.
    pub pose: Option<[f64; 7]>,
    /// True if its place is that of the frame of its images, by the transforms on /tf_static, read once. Default false.
    pub from_tf: bool,
}

impl CameraPlace {
    /// The pose of the camera in its frame, if the settings have it.
    ///
    /// # Errors
    /// The norm of a quaternion that is none, and a pose although it is read from the graph.
    pub fn isometry(&self) -> Result<Option<Isometry3<f64>>, moca_model::Error> {
        let Some([x, y, z, i, j, k, w]) = self.pose else { return Ok(None) };
        if self.from_tf {
            return Err(wrong(x, "none, since camera.from_tf is true"));
        }
        let quaternion = Quaternion::new(w, i, j, k);
        let norm = quaternion.norm();
        if (norm - 1.0).abs() > TOLERANCE {
            let wanted = "a place and a unit quaternion: the norm of its last four numbers is 1";
            return Err(wrong(norm, wanted));
        }
        let rotation = UnitQuaternion::from_quaternion(quaternion);
        Ok(Some(Isometry3::from_parts(Translation3::new(x, y, z), rotation)))
    }
}

fn wrong(got: f64, wanted: &'static str) -> moca_model::Error {
    moca_model::Error::Value { what: "camera.pose".to_owned(), got, wanted }
}
