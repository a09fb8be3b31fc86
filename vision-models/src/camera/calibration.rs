//! Cameras by their calibration.

#[cfg(feature = "inference")]
mod files;
#[cfg(feature = "inference")]
mod pose;
#[cfg(feature = "inference")]
mod qualisys;
#[cfg(feature = "inference")]
mod yaml;

use nalgebra::{Isometry3, Point2, Point3};

use super::{distortion::Distortion, intrinsics::Intrinsics};

/// Calibrated camera: intrinsics, distortion, and the pose in the world if it was calibrated.
///
/// ```
/// use nalgebra::{Isometry3, Point2, Point3};
/// use vision_models::{CalibratedCamera, Distortion, Intrinsics};
///
/// let camera = CalibratedCamera {
///     name: "left".to_owned(),
///     intrinsics: Intrinsics::new([640, 480], [600.0, 600.0], [319.5, 239.5])?,
///     distortion: Distortion::Radial([-0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
///     world_from_camera: Some(Isometry3::translation(1.0, 0.0, 0.0)),
/// };
/// let seen = camera.project(&Point3::new(1.5, 0.2, 2.0)).expect("in front of the camera");
/// assert_ne!(seen, Point2::new(469.5, 299.5));
/// assert!((camera.pinhole(&seen).expect("within the lens") - Point2::new(469.5, 299.5)).norm() < 1e-6);
/// # Ok::<(), vision_models::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct CalibratedCamera {
    /// Name of the camera in the calibration.
    pub name: String,
    /// The pinhole model of images without distortion.
    pub intrinsics: Intrinsics,
    /// Distortion of the images by the lens.
    pub distortion: Distortion,
    /// The pose of the optical frame (x right, y down, z forwards) in the world, if it was calibrated.
    pub world_from_camera: Option<Isometry3<f64>>,
}

impl CalibratedCamera {
    /// Returns the pixel without distortion for a pixel of the image. `None` where the lens shows
    /// nothing.
    pub fn pinhole(&self, seen: &Point2<f64>) -> Option<Point2<f64>> {
        if self.distortion == Distortion::None {
            return Some(*seen);
        }
        let ray = self.distortion.undistort(&self.intrinsics.ray(seen).xy().into())?;
        self.intrinsics.project(&Point3::new(ray.x, ray.y, 1.0))
    }

    /// Returns the pixel, with distortion, at which a point of the world (m) is seen. `None` for a
    /// point that is not in front of the camera, or if the camera's pose is not known.
    pub fn project(&self, point: &Point3<f64>) -> Option<Point2<f64>> {
        let point = self.world_from_camera?.inverse_transform_point(point);
        if point.z <= 0.0 {
            return None;
        }
        let seen = self.distortion.distort(&Point2::from(point.xy().coords / point.z));
        self.intrinsics.project(&Point3::new(seen.x, seen.y, 1.0))
    }
}
