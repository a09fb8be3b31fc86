//! The depth of a joint in a part of the body that is wider than deep.

use crate::error::Error;

/// A horizontal section of the trunk or the head: an ellipse whose width is seen from the front and
/// whose depth is seen from the side (m).
///
/// ```
/// use vision_models::CrossSection;
///
/// let hips = CrossSection { half_width: 0.18, half_depth: 0.10 };
/// // The middle, seen from the front and from the left.
/// assert_eq!(hips.depth(0.0, 0.0), 0.10);
/// assert!((hips.depth(0.0, std::f64::consts::FRAC_PI_2) - 0.18).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrossSection {
    /// Distance from the middle to either side (m).
    pub half_width: f64,
    /// Distance from the middle to the front and to the back (m).
    pub half_depth: f64,
}

impl CrossSection {
    /// Returns the distance from the outline to a point behind it (m).
    ///
    /// `aside` is the point's distance to the left of the middle (m). `bearing` is the direction to
    /// the camera relative to the person's forward direction, positive to the left (rad). A point
    /// outside lies on the outline.
    pub fn depth(&self, aside: f64, bearing: f64) -> f64 {
        // The positive root t of (t cos/b)² + ((aside + t sin)/a)² = 1.
        let (sin, cos) = bearing.sin_cos();
        let (across, along) = (sin / self.half_width, cos / self.half_depth);
        let place = aside / self.half_width;
        let square = across * across + along * along;
        let half = place * across;
        let rest = (1.0 - place * place).max(0.0);
        (((half * half + square * rest).sqrt() - half) / square).max(0.0)
    }

    pub(super) fn validate(&self, name: &'static str) -> Result<(), Error> {
        for value in [self.half_width, self.half_depth] {
            if !(0.01..=0.5).contains(&value) {
                return Err(Error::value(name, value, "lengths in [0.01, 0.5] m"));
            }
        }
        Ok(())
    }
}
