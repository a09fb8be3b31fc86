//! How deep a joint lies in a part of the body that is wider than deep.

use crate::error::Error;

/// A horizontal section of the trunk or the head: an ellipse, as wide as the person seen from the front
/// and as deep as seen from the side (m).
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
    /// From the middle to either side.
    pub half_width: f64,
    /// From the middle to the front and to the back.
    pub half_depth: f64,
}

impl CrossSection {
    /// How far a point lies behind the outline (m). `aside` is its place to the left of the middle (m), and
    /// `bearing` the direction to the camera from the person's forward direction, to the left positive
    /// (rad). A point outside lies on the outline.
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
