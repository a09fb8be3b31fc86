//! Conversion between pixels and rays.

use nalgebra::{Point2, Point3, Vector3};

use crate::error::Error;

/// Longest side of an image (pixels).
const MAX_SIDE: usize = 16_384;

/// Pinhole model of a camera without distortion.
///
/// Points are in the optical frame: x to the right, y downwards, z forwards (m). The centres of
/// pixels are at whole numbers, (0, 0) at the top left.
///
/// ```
/// use nalgebra::{Point2, Point3};
/// use vision_models::Intrinsics;
///
/// let intrinsics = Intrinsics::new([640, 480], [615.0, 615.0], [319.5, 239.5])?;
/// let point = Point3::new(0.2, -0.1, 2.0);
/// let pixel = intrinsics.project(&point).expect("in front of the camera");
/// assert_eq!(pixel, Point2::new(381.0, 208.75));
/// assert!((intrinsics.back_project(&pixel, 2.0) - point).norm() < 1e-12);
/// # Ok::<(), vision_models::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Intrinsics {
    size: [usize; 2],
    focal: [f64; 2],
    centre: [f64; 2],
}

impl Intrinsics {
    /// Creates the intrinsics for images of width × height `size`, with the focal lengths fx, fy
    /// and the principal point cx, cy (pixels).
    ///
    /// # Errors
    /// [`Error::Value`] if one of these is wrong:
    /// - A side has no pixels or more than 16,384.
    /// - A focal length is not positive and finite.
    /// - The principal point is outside the image.
    pub fn new(size: [usize; 2], focal: [f64; 2], centre: [f64; 2]) -> Result<Self, Error> {
        for (axis, side) in ["width", "height"].into_iter().zip(size) {
            if side == 0 || side > MAX_SIDE {
                let expected = "1 to 16384 pixels";
                return Err(Error::value(axis, side, expected));
            }
        }
        for (name, value) in ["fx", "fy"].into_iter().zip(focal) {
            if !(value > 0.0 && value <= 1e6) {
                return Err(Error::value(name, value, "0 to 1e6 pixels"));
            }
        }
        for ((name, value), side) in ["cx", "cy"].into_iter().zip(centre).zip(size) {
            if !(value >= -0.5 && value <= side as f64 - 0.5) {
                return Err(Error::value(name, value, "a pixel of the image"));
            }
        }
        Ok(Self { size, focal, centre })
    }

    /// Returns width and height (pixels).
    pub fn size(&self) -> [usize; 2] {
        self.size
    }

    /// Returns the focal lengths fx and fy (pixels).
    pub fn focal(&self) -> [f64; 2] {
        self.focal
    }

    /// Returns the principal point cx, cy (pixels).
    pub fn centre(&self) -> [f64; 2] {
        self.centre
    }

    /// Returns the ray through a pixel, in the optical frame, with z = 1.
    pub fn ray(&self, pixel: &Point2<f64>) -> Vector3<f64> {
        let ([fx, fy], [cx, cy]) = (self.focal, self.centre);
        Vector3::new((pixel.x - cx) / fx, (pixel.y - cy) / fy, 1.0)
    }

    /// Returns the point at `depth` (its z, m) that is seen at a pixel.
    pub fn back_project(&self, pixel: &Point2<f64>, depth: f64) -> Point3<f64> {
        Point3::from(self.ray(pixel) * depth)
    }

    /// Returns the pixel at which a point is seen. It may lie outside the image. `None` if the
    /// point is not in front of the camera.
    pub fn project(&self, point: &Point3<f64>) -> Option<Point2<f64>> {
        let ([fx, fy], [cx, cy]) = (self.focal, self.centre);
        let pixel = Point2::new(cx + fx * point.x / point.z, cy + fy * point.y / point.z);
        (point.z > 0.0 && pixel.iter().all(|value| value.is_finite())).then_some(pixel)
    }
}
