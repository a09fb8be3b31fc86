//! A point in the images of several cameras.

use nalgebra::{Matrix2x3, Matrix3, Point2, Point3, Vector2};

use crate::camera::CalibratedCamera;
use crate::confidence::Confidence;

/// Steps of Gauss and Newton, and when they end (m).
const STEPS: usize = 12;
const CLOSE: f64 = 1e-9;

/// Place at which a camera sees a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sight<'a> {
    pub(super) camera: &'a CalibratedCamera,
    /// Point as a pinhole sees it (pixels).
    pub(super) at: Point2<f64>,
    /// Standard deviation, each axis (pixels).
    pub(super) sigma: f64,
    pub(super) confidence: Confidence,
}

/// A point that some views agree on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Agreed {
    pub(super) point: Point3<f64>,
    pub(super) covariance: Matrix3<f64>,
    /// Squares of the errors in the images, each in its standard deviation.
    pub(super) cost: f64,
}

impl Sight<'_> {
    /// The error of a point in the image in standard deviations, and its derivative; `None` if it is behind the camera.
    fn error(&self, point: &Point3<f64>) -> Option<(Vector2<f64>, Matrix2x3<f64>)> {
        let pose = self.camera.world_from_camera?;
        let seen = pose.inverse_transform_point(point);
        let at = self.camera.intrinsics.project(&seen)?;
        let [fx, fy] = self.camera.intrinsics.focal();
        let depth = seen.z;
        let slope = Matrix2x3::new(
            fx / depth,
            0.0,
            -fx * seen.x / (depth * depth),
            0.0,
            fy / depth,
            -fy * seen.y / (depth * depth),
        );
        let camera_from_world = pose.rotation.inverse().to_rotation_matrix();
        Some(((at - self.at) / self.sigma, slope * camera_from_world.matrix() / self.sigma))
    }

    /// The square of the error of a point (standard deviations²); infinite behind the camera.
    pub(super) fn square(&self, point: &Point3<f64>) -> f64 {
        self.error(point).map_or(f64::INFINITY, |(error, _)| error.norm_squared())
    }
}

/// The point nearest to the rays of some views.
pub(super) fn nearest(sights: &[&Sight<'_>]) -> Option<Point3<f64>> {
    let (mut matrix, mut vector) = (Matrix3::zeros(), nalgebra::Vector3::zeros());
    for sight in sights {
        let pose = sight.camera.world_from_camera?;
        let ray = (pose.rotation * sight.camera.intrinsics.ray(&sight.at)).normalize();
        let across = Matrix3::identity() - ray * ray.transpose();
        matrix += across;
        vector += across * pose.translation.vector;
    }
    let point = matrix.cholesky()?.solve(&vector);
    point.iter().all(|value| value.is_finite()).then(|| point.into())
}

/// Minimises the squares of the errors in the images, from a point near by (Gauss and Newton). Rays that are parallel
/// give nothing.
pub(super) fn refine(sights: &[&Sight<'_>], from: Point3<f64>) -> Option<Agreed> {
    let mut point = from;
    for _ in 0..STEPS {
        let (mut matrix, mut vector) = (Matrix3::zeros(), nalgebra::Vector3::zeros());
        let mut cost = 0.0;
        for sight in sights {
            let (error, slope) = sight.error(&point)?;
            matrix += slope.transpose() * slope;
            vector += slope.transpose() * error;
            cost += error.norm_squared();
        }
        let factor = matrix.cholesky()?;
        let step = factor.solve(&vector);
        if step.norm() < CLOSE {
            return Some(Agreed { point, covariance: factor.inverse(), cost });
        }
        point -= step;
    }
    None
}
