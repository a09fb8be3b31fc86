//! The twenty-five keypoints of `OpenPose`'s `BODY_25` model.

use nalgebra::{Isometry3, Matrix3, Point3, center};

use super::body_25::Body25;
use super::middle::Middle;
use super::person_id::PersonId;
use crate::confidence::Confidence;

/// A joint as the camera measured it.
///
/// ```
/// use nalgebra::Point3;
/// use vision_models::{Confidence, Keypoint};
///
/// let wrist = Keypoint { position: Point3::new(1.2, 0.1, 1.0), confidence: Confidence::new(0.8)? };
/// assert_eq!(wrist.position.z, 1.0);
/// # Ok::<(), vision_models::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Keypoint {
    /// Position in the world frame (m).
    pub position: Point3<f64>,
    /// The detector's confidence.
    pub confidence: Confidence,
}

/// A person in one camera frame: the position of each of the twenty-five joints that was seen, in
/// the world frame. A measured joint also has the covariance of its position. A tracked person has
/// an id, which stays the same from frame to frame. The default has neither joints nor an id.
///
/// ```
/// use nalgebra::{Matrix3, Point3};
/// use vision_models::{Body, Body25, Confidence, Keypoint, PersonId};
///
/// let mut body = Body::default();
/// let nose = Keypoint { position: Point3::new(2.0, 0.0, 1.6), confidence: Confidence::ONE };
/// body.set(Body25::Nose, Some(nose));
/// assert_eq!(body.get(Body25::Nose), Some(nose));
/// assert_eq!(body.get(Body25::Neck), None);
/// assert_eq!(body.iter().count(), 1);
/// // Known to 2 cm, each axis.
/// body.set_measured(Body25::Nose, nose, Matrix3::identity() * 0.02_f64.powi(2));
/// assert!(body.covariance(Body25::Nose).is_some());
/// assert_eq!(body.with_id(PersonId::new(3)).id(), Some(PersonId::new(3)));
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Body {
    id: Option<PersonId>,
    keypoints: [Option<Keypoint>; Body25::COUNT],
    covariances: [Option<Matrix3<f64>>; Body25::COUNT],
}

impl Body {
    /// Creates a body from its keypoints in the order of [`Body25::ALL`], without covariances.
    pub fn new(keypoints: [Option<Keypoint>; Body25::COUNT]) -> Self {
        Self { keypoints, ..Self::default() }
    }

    /// Returns the body with the id of its person, or without one.
    #[must_use]
    pub fn with_id(self, id: impl Into<Option<PersonId>>) -> Self {
        Self { id: id.into(), ..self }
    }

    /// Returns the id of the person, if the source tracks people.
    pub fn id(&self) -> Option<PersonId> {
        self.id
    }

    /// Returns the joint if it was seen.
    pub fn get(&self, joint: Body25) -> Option<Keypoint> {
        self.keypoints[joint.index()]
    }

    /// Returns the covariance of the joint's position in the world frame (m²), if it is known.
    pub fn covariance(&self, joint: Body25) -> Option<Matrix3<f64>> {
        self.covariances[joint.index()]
    }

    /// Sets a joint without a covariance, or removes it.
    pub fn set(&mut self, joint: Body25, keypoint: Option<Keypoint>) {
        self.keypoints[joint.index()] = keypoint;
        self.covariances[joint.index()] = None;
    }

    /// Sets a joint and the covariance of its position (m²). A covariance is left out if it is not
    /// finite or has a variance that is not positive.
    pub fn set_measured(&mut self, joint: Body25, keypoint: Keypoint, covariance: Matrix3<f64>) {
        let sound = covariance.iter().all(|value| value.is_finite())
            && covariance.diagonal().iter().all(|&variance| variance > 0.0);
        self.keypoints[joint.index()] = Some(keypoint);
        self.covariances[joint.index()] = sound.then_some(covariance);
    }

    /// Sets the joint in the middle of two others whose errors are independent, with its covariance.
    pub(crate) fn set_middle(&mut self, Middle { joint, sides: [one, other] }: Middle) {
        let Some((a, b)) = self.get(one).zip(self.get(other)) else { return };
        let confidence = if a.confidence < b.confidence { a } else { b }.confidence;
        let keypoint = Keypoint { position: center(&a.position, &b.position), confidence };
        match self.covariance(one).zip(self.covariance(other)) {
            Some((one, other)) => self.set_measured(joint, keypoint, (one + other) * 0.25),
            None => self.set(joint, Some(keypoint)),
        }
    }

    /// The keypoints in the order of [`Body25::ALL`].
    pub fn keypoints(&self) -> &[Option<Keypoint>; Body25::COUNT] {
        &self.keypoints
    }

    /// Returns the joints that were seen.
    pub fn iter(&self) -> impl Iterator<Item = (Body25, Keypoint)> + '_ {
        Body25::ALL
            .into_iter()
            .zip(&self.keypoints)
            .filter_map(|(joint, keypoint)| keypoint.map(|keypoint| (joint, keypoint)))
    }

    /// Returns the body moved by a rigid motion. `world_from_camera` moves keypoints from the
    /// camera's frame to the world's.
    #[must_use]
    pub fn transformed(&self, motion: &Isometry3<f64>) -> Self {
        let rotation = *motion.rotation.to_rotation_matrix().matrix();
        Self {
            id: self.id,
            keypoints: self.keypoints.map(|keypoint| {
                keypoint
                    .map(|keypoint| Keypoint { position: motion * keypoint.position, ..keypoint })
            }),
            covariances: self.covariances.map(|covariance| {
                covariance.map(|covariance| rotation * covariance * rotation.transpose())
            }),
        }
    }
}
