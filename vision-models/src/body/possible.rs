//! What no person's body can be, in metres.

use nalgebra::Point3;

use super::keypoints::{Body, Body25};
use super::lengths::is_possible;
use super::segment::ENDS;

/// Fewer segments than these say nothing.
const ENOUGH: usize = 4;

/// Why a body is nobody's.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ImpossibleBody {
    /// A joint is farther away than anything in a room, or no number.
    #[error(
        "the {} has a coordinate {value} m from the origin of the check, beyond {} m; give metres, not millimetres",
        joint.name(),
        Body::FARTHEST
    )]
    Far {
        /// The joint.
        joint: Body25,
        /// Its first such coordinate, from the origin of the check (m).
        value: f64,
    },
    /// Most of its segments are too long or too short for anybody of 1.2 to 2.3 m, by half and more.
    #[error("{impossible} of {measured} segments have lengths that no person's have; give metres")]
    Segments {
        /// How many have such lengths.
        impossible: usize,
        /// How many were measured.
        measured: usize,
    },
}

impl Body {
    /// Nothing in a room is farther away along an axis (m): joints in millimetres are.
    pub const FARTHEST: f64 = 100.0;

    /// The first coordinate of a place that is not within [`FARTHEST`](Self::FARTHEST) of `origin`, from there (m).
    pub fn far_coordinate(place: &Point3<f64>, origin: &Point3<f64>) -> Option<f64> {
        let within = |value: &f64| (-Self::FARTHEST..=Self::FARTHEST).contains(value);
        (place - origin).iter().copied().find(|value| !within(value))
    }

    /// Checks that a person can have this body.
    ///
    /// Any joint that is too far from `origin` condemns the body, whatever its confidence. Lengths are judged
    /// between joints of at least the confidence `least`: the body is condemned if there are four segments or more,
    /// and more than half of them have lengths that nobody's have. So a single joint that a detector misplaces
    /// condemns no body.
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
