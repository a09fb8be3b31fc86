//! The place of a camera, found from points that it sees.

use nalgebra::{Isometry3, Matrix3, Point3, Rotation3, Translation3, UnitQuaternion, Vector3};

use crate::error::Error;

/// Least spread of the points across the line that fits them best, root mean square (m). On a line
/// they would leave the turn about it open.
const LEAST_SPREAD: f64 = 0.05;

/// The place of a camera, found from points that are known in its optical frame and in the world.
/// Such points are where a robot holds its tool up to the camera.
///
/// ```
/// use nalgebra::{Isometry3, Point3, Vector3};
/// use vision_models::CameraPlacement;
///
/// let truth = Isometry3::new(Vector3::new(1.0, 0.5, 2.0), Vector3::new(-1.8, 0.2, 0.1));
/// let tool = [[0.5, 0.0, 0.4], [0.4, 0.4, 0.6], [0.6, -0.3, 0.9], [0.3, 0.1, 1.0]].map(Point3::from);
/// let pairs = tool.map(|point| [truth.inverse_transform_point(&point), point]);
/// let found = CameraPlacement::fit(&pairs)?;
/// assert!((found.world_from_camera.translation.vector - truth.translation.vector).norm() < 1e-9);
/// assert!(found.deviation() < 1e-9);
/// # Ok::<(), vision_models::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct CameraPlacement {
    /// Pose of the optical frame in the world.
    pub world_from_camera: Isometry3<f64>,
    /// Distance of each point, moved to the world, from its place there (m).
    pub residuals: Vec<f64>,
}

impl CameraPlacement {
    /// Finds the pose with the least sum of squared residuals (Umeyama, IEEE Transactions on
    /// Pattern Analysis and Machine Intelligence 13(4), 1991). Each pair has a point in the optical
    /// frame, then in the world (m).
    ///
    /// # Errors
    /// [`Error::Size`] for fewer than three pairs. [`Error::Value`] for coordinates that are not
    /// finite, and for points closer than 5 cm (root mean square) to a line.
    pub fn fit(pairs: &[[Point3<f64>; 2]]) -> Result<Self, Error> {
        if pairs.len() < 3 {
            let wanted = "three or more, which are not on a line";
            return Err(Error::size("the camera's placement", &[pairs.len()], "points", wanted));
        }
        let coordinates = pairs.iter().flatten().flat_map(|point| point.iter());
        if let Some(bad) = coordinates.clone().find(|value| !value.is_finite()) {
            return Err(Error::value("a coordinate of a point", bad, "a finite number (m)"));
        }
        let count = pairs.len() as f64;
        let sum = |which: fn(&[Point3<f64>; 2]) -> Vector3<f64>| -> Vector3<f64> {
            pairs.iter().map(which).sum()
        };
        let seen = sum(|[seen, _]| seen.coords) / count;
        let world = sum(|[_, world]| world.coords) / count;
        let mut moments = Matrix3::zeros();
        let mut spread = Matrix3::zeros();
        for [one, other] in pairs {
            let [one, other] = [one.coords - seen, other.coords - world];
            moments += other * one.transpose();
            spread += other * other.transpose() / count;
        }
        // Across the line, two of three variances are left.
        let mut variances = spread.symmetric_eigenvalues();
        variances.as_mut_slice().sort_by(f64::total_cmp);
        let across = (variances[0] + variances[1]).max(0.0).sqrt();
        if across < LEAST_SPREAD {
            let wanted = format!("points {LEAST_SPREAD} m or more away from a common line");
            return Err(Error::value(
                "the spread of the points across a line (m)",
                across,
                &wanted,
            ));
        }
        let parts = moments.svd(true, true);
        let (Some(left), Some(right)) = (parts.u, parts.v_t) else {
            return Err(Error::value("a coordinate of a point", "too large", "metres"));
        };
        let mut sign = Matrix3::identity();
        sign[(2, 2)] = (left * right).determinant().signum();
        let rotation = Rotation3::from_matrix_unchecked(left * sign * right);
        let rotation = UnitQuaternion::from_rotation_matrix(&rotation);
        let translation = Translation3::from(world - rotation * seen);
        let pose = Isometry3::from_parts(translation, rotation);
        let residuals = pairs.iter().map(|[seen, world]| (pose * seen - world).norm()).collect();
        Ok(Self { world_from_camera: pose, residuals })
    }

    /// Returns the root mean square of the residuals (m).
    pub fn deviation(&self) -> f64 {
        let squares: f64 = self.residuals.iter().map(|residual| residual * residual).sum();
        (squares / self.residuals.len().max(1) as f64).sqrt()
    }
}
