//! The files of a folder of frames.

use std::path::{Path, PathBuf};

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};
use vision_models::{Camera, DepthNoise, Error, Intrinsics};

pub(super) const FORMAT: &str = "moca-frames";
pub(super) const VERSION: u32 = 1;
pub(super) const CAMERA: &str = "camera.json";
pub(super) const INDEX: &str = "frames.jsonl";

/// One frame of the index.
///
/// ```
/// use human_perception::frames::FrameEntry;
///
/// let entry = FrameEntry { frame: 12, time: 0.6, arrived: Some(0.64) };
/// assert_eq!(entry.file("depth".as_ref(), "png").to_str(), Some("depth/000012.png"));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrameEntry {
    /// Number counted by the camera. A missing number is a lost frame.
    pub frame: u64,
    /// Time at which the camera took it (s).
    pub time: f64,
    /// Time at which it was available for processing, on the same clock (s).
    pub arrived: Option<f64>,
}

impl FrameEntry {
    /// Returns the path of an image of the frame.
    pub fn file(&self, folder: &Path, extension: &str) -> PathBuf {
        folder.join(format!("{:06}.{extension}", self.frame))
    }
}

/// The last line of the index.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct EndLine {
    pub(super) end: End,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct End {
    pub(super) frames: u64,
}

/// The camera's file.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CameraFile {
    format: String,
    version: u32,
    width: usize,
    height: usize,
    fx: f64,
    fy: f64,
    cx: f64,
    cy: f64,
    /// Size of a unit of the depth images (m).
    pub(super) depth_scale: f64,
    /// Position of the optical frame in the world (m).
    position: [f64; 3],
    /// Orientation of the optical frame in the world: x, y, z, w.
    quaternion: [f64; 4],
    noise: Noise,
    /// Gravity in the optical frame, if the camera measures it.
    gravity: Option<[f64; 3]>,
    /// The person's stature, if it is known (m).
    pub(super) stature: Option<f64>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Noise {
    constant: f64,
    quadratic: f64,
}

impl CameraFile {
    pub(super) fn new(camera: &Camera, depth_scale: f64) -> Self {
        let intrinsics = camera.intrinsics();
        let ([width, height], [fx, fy], [cx, cy]) =
            (intrinsics.size(), intrinsics.focal(), intrinsics.centre());
        let pose = camera.world_from_camera();
        let gravity = pose.rotation.inverse() * -Vector3::z();
        let DepthNoise { constant, quadratic } = *camera.noise();
        Self {
            format: FORMAT.to_owned(),
            version: VERSION,
            width,
            height,
            fx,
            fy,
            cx,
            cy,
            depth_scale,
            position: pose.translation.vector.into(),
            quaternion: pose.rotation.coords.into(),
            noise: Noise { constant, quadratic },
            gravity: Some(gravity.into()),
            stature: None,
        }
    }

    /// Returns true if format and version are known.
    pub(super) fn is_known(&self) -> bool {
        self.format == FORMAT && self.version == VERSION
    }

    pub(super) fn intrinsics(&self) -> Result<Intrinsics, Error> {
        let [fx, fy, cx, cy] = [self.fx, self.fy, self.cx, self.cy];
        Intrinsics::new([self.width, self.height], [fx, fy], [cx, cy])
    }

    /// Places the camera in the world.
    pub(super) fn place(&mut self, world_from_camera: &Isometry3<f64>) {
        self.position = world_from_camera.translation.vector.into();
        self.quaternion = world_from_camera.rotation.coords.into();
    }

    pub(super) fn camera(&self) -> Result<Camera, Error> {
        let intrinsics = self.intrinsics()?;
        let quaternion = Quaternion::from_vector(self.quaternion.into());
        // The length of quaternions that are written by hand is one only to some digits.
        if (quaternion.norm() - 1.0).abs() > 1e-3 {
            return Err(Error::Value {
                what: "the length of the camera's quaternion".into(),
                got: quaternion.norm().to_string(),
                wanted: "one of length one".into(),
            });
        }
        let rotation = UnitQuaternion::from_quaternion(quaternion);
        let pose =
            Isometry3::from_parts(Translation3::from(Vector3::from(self.position)), rotation);
        let Noise { constant, quadratic } = self.noise;
        let camera = Camera::new(intrinsics, pose, DepthNoise { constant, quadratic })?;
        if let Some(gravity) = self.gravity {
            camera.check_gravity(&gravity.into())?;
        }
        Ok(camera)
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Point3;
    use serde_json::Value;

    use super::*;

    #[test]
    fn uncalibrated_cameras_are_refused_with_a_reason() {
        let intrinsics = Intrinsics::new([640, 480], [615.0, 615.0], [319.5, 239.5]).unwrap();
        let (eye, target) = (Point3::new(0.3, 1.8, 2.3), Point3::new(3.0, 0.0, 1.0));
        let camera = Camera::looking_at(intrinsics, eye, target, DepthNoise::D435I).unwrap();
        let whole = serde_json::to_value(CameraFile::new(&camera, 1e-3)).unwrap();
        let read = |file: &Value| serde_json::from_value::<CameraFile>(file.clone());
        assert!(read(&whole).unwrap().camera().is_ok());
        for field in ["width", "height", "fx", "fy", "cx", "cy", "position", "quaternion"] {
            let mut file = whole.clone();
            file.as_object_mut().unwrap().remove(field);
            let error = read(&file).err().unwrap().to_string();
            assert!(error.contains(&format!("missing field `{field}`")), "{error}");
        }
        for (field, none) in [("fx", 0.0.into()), ("quaternion", vec![0.0; 4].into())] {
            let mut file = whole.clone();
            file[field] = none;
            assert!(read(&file).unwrap().camera().is_err(), "{field}");
        }
    }
}
