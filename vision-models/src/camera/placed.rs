//! A camera in the world.

use nalgebra::{Isometry3, Matrix3, Point2, Point3, Vector3};

use super::{depth_noise::DepthNoise, intrinsics::Intrinsics};
use crate::error::Error;

/// Largest angle by which the image's downward direction may point above the horizon (rad).
const STEEPEST: f64 = 0.17;

/// Largest angle between measured gravity and the extrinsics (rad).
const GRAVITY_TOLERANCE: f64 = 0.26;

/// A camera with its pose in the world, its intrinsics and its noise.
///
/// ```
/// use nalgebra::{Isometry3, Point3, Vector3};
/// use vision_models::{Camera, DepthNoise, Intrinsics};
///
/// let intrinsics = Intrinsics::new([640, 480], [615.0, 615.0], [319.5, 239.5])?;
/// let eye = Point3::new(0.0, 0.0, 1.5);
/// let camera = Camera::looking_at(intrinsics, eye, Point3::new(3.0, 0.0, 1.5), DepthNoise::D435I)?;
/// // Three metres ahead, in the middle of the image.
/// let pixel = camera.project(&Point3::new(3.0, 0.0, 1.5)).expect("in front of the camera");
/// assert!((pixel.x - 319.5).abs() < 1e-9 && (pixel.y - 239.5).abs() < 1e-9);
/// // Gravity as the camera's accelerometer measures it, y being down in the image.
/// assert!(camera.check_gravity(&Vector3::new(0.0, 9.8, 0.1)).is_ok());
/// assert!(camera.check_gravity(&Vector3::new(0.0, -9.8, 0.1)).is_err());
/// # Ok::<(), vision_models::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    intrinsics: Intrinsics,
    pose: Isometry3<f64>,
    noise: DepthNoise,
}

impl Camera {
    /// Creates a camera whose optical frame (x right, y down, z forwards) has this pose in the
    /// world.
    ///
    /// # Errors
    /// [`Error::Value`] if the pose is not finite or turns the image upside down, or if the noise
    /// is negative or above 1.
    pub fn new(
        intrinsics: Intrinsics,
        world_from_camera: Isometry3<f64>,
        noise: DepthNoise,
    ) -> Result<Self, Error> {
        noise.validate()?;
        let rotation = world_from_camera.rotation;
        let of_rotation = rotation.coords.iter();
        let mut values = world_from_camera.translation.vector.iter().chain(of_rotation);
        let unit = (rotation.norm() - 1.0).abs() < 1e-6;
        if !(unit && values.all(|value| value.is_finite())) {
            return Err(no_pose());
        }
        let down = rotation * Vector3::y();
        if down.z > STEEPEST.sin() {
            let got = format!(
                "upside down: the bottom of its image points {:.0}° away from the floor",
                angle_to_down(&down).to_degrees()
            );
            let wanted = "images that are turned, or another pose of the camera";
            return Err(Error::value("the camera", got, wanted));
        }
        Ok(Self { intrinsics, pose: world_from_camera, noise })
    }

    /// Creates a camera at `eye` that looks at `target` (world, m), with the image's top upwards.
    ///
    /// # Errors
    /// [`Error::Value`] if one point is above the other, or a point is not finite.
    pub fn looking_at(
        intrinsics: Intrinsics,
        eye: Point3<f64>,
        target: Point3<f64>,
        noise: DepthNoise,
    ) -> Result<Self, Error> {
        let forwards = (target - eye).try_normalize(1e-9).ok_or_else(no_pose)?;
        let right = forwards.cross(&Vector3::z()).try_normalize(1e-6).ok_or_else(no_pose)?;
        let axes = Matrix3::from_columns(&[right, forwards.cross(&right), forwards]);
        let rotation = nalgebra::Rotation3::from_matrix_unchecked(axes);
        let world_from_camera = Isometry3::from_parts(eye.coords.into(), rotation.into());
        Self::new(intrinsics, world_from_camera, noise)
    }

    /// Checks that gravity points in the direction that the pose calls down. `gravity` is in the
    /// optical frame, in any unit: along +y for a level camera.
    ///
    /// # Errors
    /// [`Error::Value`] if they differ by more than 15°, or if the vector has no direction.
    pub fn check_gravity(&self, gravity: &Vector3<f64>) -> Result<(), Error> {
        let limit = GRAVITY_TOLERANCE;
        let direction = gravity.try_normalize(1e-9).unwrap_or(Vector3::repeat(f64::NAN));
        let angle = angle_to_down(&(self.pose.rotation * direction));
        if angle <= limit {
            return Ok(());
        }
        let got = format!("{:.0}° away from down as its pose has it", angle.to_degrees());
        let wanted = format!("a pose of the camera within {:.0}°", limit.to_degrees());
        Err(Error::value("gravity as the camera measures it", got, &wanted))
    }

    /// Returns the pinhole model.
    pub fn intrinsics(&self) -> &Intrinsics {
        &self.intrinsics
    }

    /// Returns the pose of the optical frame in the world.
    pub fn world_from_camera(&self) -> &Isometry3<f64> {
        &self.pose
    }

    /// Returns the noise of the camera's depths.
    pub fn noise(&self) -> &DepthNoise {
        &self.noise
    }

    /// Returns the pixel at which a point of the world (m) is seen. It may lie outside the image.
    /// `None` if the point is not in front of the camera.
    pub fn project(&self, point: &Point3<f64>) -> Option<Point2<f64>> {
        self.intrinsics.project(&self.pose.inverse_transform_point(point))
    }
}

fn angle_to_down(direction: &Vector3<f64>) -> f64 {
    (-direction.z).clamp(-1.0, 1.0).acos()
}

fn no_pose() -> Error {
    Error::value("the camera's pose", "not finite or has no direction", "a rigid motion")
}
