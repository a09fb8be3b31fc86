//! Checks for bodies that no person can have.

use nalgebra::Point3;

use super::body_25::Body25;
use super::keypoints::Body;
use super::lengths::is_possible;
use super::segment::ENDS;

/// Smallest number of segments for a decision.
const ENOUGH: usize = 4;

/// Reason why no person can have a body.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ImpossibleBody {
    /// A joint is farther away than anything in a room, or not a number.
    #[error(
        "the {} has a coordinate {value} m from the origin of the check, beyond {} m; give metres, not millimetres",
        joint.name(),
        Body::FARTHEST
    )]
    Far {
        /// The joint.
        joint: Body25,
        /// The joint's first such coordinate, relative to the origin of the check (m).
        value: f64,
    },
    /// Most segments are too long or too short, by half or more, for any person of 1.2 to 2.3 m.
    #[error("{impossible} of {measured} segments have lengths that no person's have; give metres")]
    Segments {
        /// Number of segments with such lengths.
        impossible: usize,
        /// Number of measured segments.
        measured: usize,
    },
}

impl Body {
    /// Largest distance along an axis within a room (m). Joints in millimetres exceed it.
    pub const FARTHEST: f64 = 100.0;

    /// Returns the first coordinate that is not within [`FARTHEST`](Self::FARTHEST) of `origin`,
    /// relative to it (m).
    pub fn far_coordinate(place: &Point3<f64>, origin: &Point3<f64>) -> Option<f64> {
        let within = |value: &f64| (-Self::FARTHEST..=Self::FARTHEST).contains(value);
        (place - origin).iter().copied().find(|value| !within(value))
    }

    /// Checks that a person can have this body.
    ///
    /// A body is rejected if any joint is too far from `origin`, whatever its confidence.
    ///
    /// The lengths of segments are checked between joints of at least the confidence `least`. A
    /// body of four or more segments is rejected if more than half of them have impossible lengths.
    /// One misplaced joint therefore rejects no body.
    ///
    /// ```
    /// use nalgebra::Point3;
    /// use vision_models::{Body, Body25, Confidence, ImpossibleBody, Keypoint};
    ///
    /// let mut body = Body::default();
    /// let millimetres = Keypoint { position: Point3::new(2500.0, 0.0, 1450.0), confidence: Confidence::ONE };
    /// body.set(Body25::Neck, Some(millimetres));
    /// let error = body.check_possible(&Point3::origin(), 0.5).unwrap_err();
    /// assert!(matches!(error, ImpossibleBody::Far { joint: Body25::Neck, .. }));
    /// ```
    ///
    /// # Errors
    /// [`ImpossibleBody`]
    pub fn check_possible(&self, origin: &Point3<f64>, least: f64) -> Result<(), ImpossibleBody> {
        for (joint, keypoint) in self.iter() {
            if let Some(value) = Self::far_coordinate(&keypoint.position, origin) {
                return Err(ImpossibleBody::Far { joint, value });
            }
        }
        let seen = |joint: Body25| {
            let keypoint = self.get(joint)?;
            (keypoint.confidence.value() >= least).then_some(keypoint.position)
        };
        let (mut measured, mut impossible) = (0, 0);
        for (segment, from, to) in ENDS {
            let Some((from, to)) = seen(from).zip(seen(to)) else { continue };
            measured += 1;
            impossible += usize::from(!is_possible(segment, (to - from).norm()));
        }
        if measured >= ENOUGH && 2 * impossible > measured {
            return Err(ImpossibleBody::Segments { impossible, measured });
        }
        Ok(())
    }
}
