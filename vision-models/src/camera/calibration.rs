//! Cameras by their calibration.

#[cfg(feature = "inference")]
mod files;
#[cfg(feature = "inference")]
mod qualisys;
#[cfg(feature = "inference")]
mod yaml;

use nalgebra::{Isometry3, Point2, Point3};

use super::{distortion::Distortion, intrinsics::Intrinsics};

/// A camera as a calibration tells it: its lens, and where it is if that was calibrated.
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
    /// Name that the calibration gives it.
    pub name: String,
    /// The pinhole model of images without distortion.
    pub intrinsics: Intrinsics,
    /// Distortion of the images by the lens.
    pub distortion: Distortion,
    /// The pose of the optical frame (x right, y down, z forwards) in the world, if it was calibrated.
    pub world_from_camera: Option<Isometry3<f64>>,
}

impl CalibratedCamera {
    /// The pixel at which a pinhole would see what the lens shows at a pixel; `None` where the lens shows nothing.
    pub fn pinhole(&self, seen: &Point2<f64>) -> Option<Point2<f64>> {
        if self.distortion == Distortion::None {
            return Some(*seen);
        }
        let ray = self.distortion.undistort(&self.intrinsics.ray(seen).xy().into())?;
        self.intrinsics.project(&Point3::new(ray.x, ray.y, 1.0))
    }

    /// The pixel at which the lens shows a point of the world (m); `None` for one that is not in front of the camera, or
    /// if nobody knows where the camera is.
    pub fn project(&self, point: &Point3<f64>) -> Option<Point2<f64>> {
        let point = self.world_from_camera?.inverse_transform_point(point);
        if point.z <= 0.0 {
            return None;
        }
        let seen = self.distortion.distort(&Point2::from(point.xy().coords / point.z));
        self.intrinsics.project(&Point3::new(seen.x, seen.y, 1.0))
    }
}
