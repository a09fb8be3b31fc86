//! Distortion of rays by a lens.

use nalgebra::{Matrix2, Point2, Vector2};

/// Distortion of a lens in OpenCV's models. It maps the place of a ray in a pinhole camera to its
/// place behind the lens, both on the plane z = 1.
///
/// ```
/// use nalgebra::Point2;
/// use vision_models::Distortion;
///
/// let lens = Distortion::Radial([-0.1, 0.02, 1e-3, 0.0, 0.0, 0.0, 0.0, 0.0]);
/// let ray = Point2::new(0.4, -0.3);
/// let seen = lens.distort(&ray);
/// assert!((lens.undistort(&seen).expect("within the lens") - ray).norm() < 1e-9);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Distortion {
    /// Rectified images, without distortion.
    #[default]
    None,
    /// Radial and tangential (Brown and Conrady): k1, k2, p1, p2, k3, and k4, k5, k6 of the denominator. ROS calls it
    /// `plumb_bob` with five numbers and `rational_polynomial` with eight.
    Radial([f64; 8]),
    /// Fisheye (Kannala and Brandt): k1 to k4 of the angle. ROS calls it `equidistant` or
    /// `fisheye`.
    Fisheye([f64; 4]),
}

/// Steps of Newton's method, and the step of its derivatives.
const STEPS: usize = 30;
const STEP: f64 = 1e-6;
/// Rays are found to within this.
const CLOSE: f64 = 1e-10;

impl Distortion {
    /// Returns the distorted point of a ray, both on the plane z = 1.
    pub fn distort(&self, ray: &Point2<f64>) -> Point2<f64> {
        let squared = ray.coords.norm_squared();
        match self {
            Self::None => *ray,
            Self::Radial([k1, k2, p1, p2, k3, k4, k5, k6]) => {
                let polynomial = |[first, second, third]: [&f64; 3]| {
                    1.0 + squared * (first + squared * (second + squared * third))
                };
                let radial = polynomial([k1, k2, k3]) / polynomial([k4, k5, k6]);
                let (x, y) = (ray.x, ray.y);
                let tangential = Vector2::new(
                    2.0 * p1 * x * y + p2 * (squared + 2.0 * x * x),
                    p1 * (squared + 2.0 * y * y) + 2.0 * p2 * x * y,
                );
                Point2::from(ray.coords * radial + tangential)
            }
            Self::Fisheye(factors) => {
                let radius = squared.sqrt();
                if radius < CLOSE {
                    return *ray;
                }
                let angle = radius.atan();
                let square = angle * angle;
                let power = |sum: f64, factor: &f64| square * (factor + sum);
                let bent = angle * (1.0 + factors.iter().rev().fold(0.0, power));
                Point2::from(ray.coords * (bent / radius))
            }
        }
    }

    /// Returns the ray of a distorted point, both on the plane z = 1. `None` where there is none,
    /// as beyond the edge of what the model describes.
    pub fn undistort(&self, seen: &Point2<f64>) -> Option<Point2<f64>> {
        let mut ray = *seen;
        for _ in 0..STEPS {
            let error = seen - self.distort(&ray);
            if error.norm() <= CLOSE {
                return Some(ray);
            }
            let column = |along: Vector2<f64>| {
                let moved = [1.0, -1.0].map(|sign| self.distort(&(ray + along * (sign * STEP))));
                (moved[0] - moved[1]) / (2.0 * STEP)
            };
            let slope = Matrix2::from_columns(&[column(Vector2::x()), column(Vector2::y())]);
            ray += slope.try_inverse()? * error;
        }
        None
    }
}
