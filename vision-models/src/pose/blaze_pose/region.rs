//! The rotated square of an image in which a network looks for one person.

use nalgebra::{Point2, Rotation2, Vector2};
use ndarray::{ArrayView3, ArrayViewMut3};

use crate::error::Error;

/// The square in which landmarks are searched, in pixels. The centre of the pixel at the top left
/// is at 0, 0.
///
/// ```
/// use vision_models::{PoseRegion, nalgebra::Point2};
///
/// // Who stands upright, the hips at 320, 240, within 150 pixels.
/// let upright = PoseRegion::around(&[Point2::new(320.0, 240.0), Point2::new(320.0, 90.0)]);
/// assert_eq!((upright.side, upright.angle), (375.0, 0.0));
/// assert!(upright.validate().is_ok());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseRegion {
    /// Centre, between the hips.
    pub centre: Point2<f64>,
    /// Length of the sides.
    pub side: f64,
    /// Rotation from the image's rows to the square's, from x towards y (rad). It is π/2 for a
    /// person who lies with the head to the right.
    pub angle: f64,
}

/// Ratio of the region's size to the circle around the person.
const WIDENING: f64 = 1.25;

impl PoseRegion {
    /// Largest size and distance of a region (pixels).
    const MAX_PIXELS: f64 = 1e6;

    /// Creates the region around a person from two points: the middle of the hips, and a point on
    /// the circle around the body in the direction of the head.
    pub fn around([hips, edge]: &[Point2<f64>; 2]) -> Self {
        let up = edge - hips;
        let angle = if up == Vector2::zeros() { 0.0 } else { up.x.atan2(-up.y) };
        Self { centre: *hips, side: WIDENING * 2.0 * up.norm(), angle }
    }

    /// Checks the numbers.
    ///
    /// # Errors
    /// [`Error::Value`] if a number is not finite or above a million, or the region has no area.
    pub fn validate(&self) -> Result<(), Error> {
        let Self { centre, side, angle } = *self;
        let near = [centre.x, centre.y, side].into_iter().all(|x| x.abs() <= Self::MAX_PIXELS);
        if near && side > 0.0 && angle.is_finite() {
            return Ok(());
        }
        let got = format!("at {}, {} of {side} pixels, turned by {angle}", centre.x, centre.y);
        Err(Error::value("a person's region", got, "finite numbers of at most a million pixels"))
    }

    /// Returns a position of the region in the image. The region's corners are at 0, 0 and 1, 1.
    pub(super) fn place(&self, [u, v]: [f64; 2]) -> Point2<f64> {
        self.centre + self.turn(Vector2::new(u - 0.5, v - 0.5) * self.side)
    }

    /// Returns a direction of the region in the image.
    pub(super) fn turn(&self, direction: Vector2<f64>) -> Vector2<f64> {
        Rotation2::new(self.angle) * direction
    }

    /// Converts this region from coordinates of `whole` to coordinates of the image.
    pub(super) fn within(&self, whole: &Self) -> Self {
        let centre = whole.place([self.centre.x, self.centre.y]);
        Self { centre, side: self.side * whole.side, angle: self.angle + whole.angle }
    }

    /// Returns the share of their joint area that two regions have in common, ignoring their
    /// rotation.
    pub(super) fn overlap(&self, other: &Self) -> f64 {
        let apart = (self.centre - other.centre).abs();
        let along = |apart: f64| {
            (0.5 * (self.side + other.side) - apart).min(self.side.min(other.side)).max(0.0)
        };
        let shared = along(apart.x) * along(apart.y);
        shared / (self.side.powi(2) + other.side.powi(2) - shared)
    }

    /// Fills channels × rows × columns with the colours of the region, interpolated linearly
    /// between integer levels. Positions outside the image take the colour of its edge, or black.
    pub(super) fn sample(
        &self,
        image: &ArrayView3<'_, u8>,
        edge: Edge,
        value: impl Fn(f32) -> f32,
        mut target: ArrayViewMut3<'_, f32>,
    ) {
        let (_, rows, columns) = target.dim();
        let right = self.turn(Vector2::new(self.side / columns as f64, 0.0));
        let down = self.turn(Vector2::new(0.0, self.side / rows as f64));
        let corner = self.place([0.0, 0.0]);
        let sampled = Sampled::new(image, edge);
        for row in 0..rows {
            let start = corner + down * row as f64;
            for column in 0..columns {
                let at = start + right * column as f64;
                for (channel, level) in sampled.colours(&at).into_iter().enumerate() {
                    target[[channel, row, column]] = value(f32::from(level));
                }
            }
        }
    }
}

/// The colour outside an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Edge {
    /// The nearest pixel.
    Nearest,
    /// Black.
    Black,
}

/// Steps of the interpolation from one pixel to the next. OpenCV has this number, and MediaPipe's
/// networks get their images from OpenCV.
const STEPS: i64 = 32;

/// An image that can be read between its pixels.
struct Sampled<'a> {
    image: &'a ArrayView3<'a, u8>,
    edge: Edge,
    /// The last column and row.
    last: [i64; 2],
}

impl<'a> Sampled<'a> {
    fn new(image: &'a ArrayView3<'a, u8>, edge: Edge) -> Self {
        let (rows, columns, _) = image.dim();
        let last = [columns, rows].map(|side| i64::try_from(side).unwrap_or(i64::MAX) - 1);
        Self { image, edge, last }
    }

    /// Returns the colours at a position between the pixels, in integer levels.
    #[expect(clippy::cast_possible_truncation, reason = "regions are near the image")]
    fn colours(&self, at: &Point2<f64>) -> [u8; 3] {
        let [x, y] = [at.x, at.y].map(|place| (place * STEPS as f64).round_ties_even() as i64);
        let (left, top) = (x.div_euclid(STEPS), y.div_euclid(STEPS));
        let (right, down) = (x.rem_euclid(STEPS), y.rem_euclid(STEPS));
        let [a, b] = [left, left + 1].map(|x| self.pixel(x, top));
        let [c, d] = [left, left + 1].map(|x| self.pixel(x, top + 1));
        std::array::from_fn(|channel| {
            let mix = |one: [u8; 3], other: [u8; 3]| {
                i64::from(one[channel]) * (STEPS - right) + i64::from(other[channel]) * right
            };
            let sum = mix(a, b) * (STEPS - down) + mix(c, d) * down;
            let whole = STEPS * STEPS;
            u8::try_from((sum + whole / 2) / whole).unwrap_or(u8::MAX)
        })
    }

    fn pixel(&self, x: i64, y: i64) -> [u8; 3] {
        let inside = [x.clamp(0, self.last[0]), y.clamp(0, self.last[1])];
        if self.edge == Edge::Black && inside != [x, y] {
            return [0; 3];
        }
        let [column, row] = inside.map(|place| usize::try_from(place).unwrap_or(0));
        std::array::from_fn(|channel| {
            self.image.get([row, column, channel]).copied().unwrap_or_default()
        })
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use ndarray::Array3;

    use super::*;

    #[test]
    fn the_head_is_up_in_the_region() {
        // A person who lies with the head to the right.
        let lying = PoseRegion::around(&[Point2::new(50.0, 60.0), Point2::new(90.0, 60.0)]);
        assert!((lying.angle - FRAC_PI_2).abs() < 1e-12 && (lying.side - 100.0).abs() < 1e-12);
        let above = lying.place([0.5, 0.0]);
        assert!((above - Point2::new(100.0, 60.0)).norm() < 1e-9);
        let within = lying.within(&PoseRegion { centre: Point2::origin(), side: 2.0, angle: 0.0 });
        assert!((within.centre - Point2::new(99.0, 119.0)).norm() < 1e-9);
        assert!((lying.overlap(&lying) - 1.0).abs() < 1e-12);
        assert_eq!(lying.overlap(&PoseRegion { centre: Point2::new(151.0, 60.0), ..lying }), 0.0);
        assert!(PoseRegion { side: f64::NAN, ..lying }.validate().is_err());
    }

    #[test]
    fn the_whole_image_as_region_is_the_image() {
        let image = Array3::from_shape_fn((4, 4, 3), |(row, column, channel)| {
            u8::try_from(10 * row + 50 * column + channel).unwrap_or(0)
        });
        let whole = PoseRegion { centre: Point2::new(2.0, 2.0), side: 4.0, angle: 0.0 };
        let mut seen = Array3::zeros((3, 4, 4));
        whole.sample(&image.view(), Edge::Black, |level| level, seen.view_mut());
        assert_eq!(seen.permuted_axes([1, 2, 0]), image.mapv(f32::from));
        let beside = PoseRegion { centre: Point2::new(-8.0, 2.0), ..whole };
        for (edge, level) in [(Edge::Black, 0.0), (Edge::Nearest, 10.0)] {
            let mut seen = Array3::zeros((3, 4, 4));
            beside.sample(&image.view(), edge, |level| level, seen.view_mut());
            assert_eq!(seen[[0, 1, 2]], level);
        }
    }
}
