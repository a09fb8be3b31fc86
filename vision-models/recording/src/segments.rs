//! Lengths of the person's segments.

use serde::{Deserialize, Serialize};

/// Height of the ankle, as a fraction of stature (Drillis & Contini 1966).
const ANKLE: f64 = 0.039;

/// Lengths of a person's segments between the centres of joints (m), if they were measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct MeasuredSegments {
    /// Length from hip to knee.
    pub thigh: Option<f64>,
    /// Length from knee to ankle.
    pub shank: Option<f64>,
    /// Length from the middle of the hips to the neck.
    pub trunk: Option<f64>,
    /// Length from shoulder to elbow.
    pub upper_arm: Option<f64>,
    /// Length from elbow to wrist.
    pub forearm: Option<f64>,
    /// Distance between the shoulders.
    pub shoulders: Option<f64>,
}

impl MeasuredSegments {
    pub(super) fn to_array(self) -> [(&'static str, Option<f64>); 6] {
        let Self { thigh, shank, trunk, upper_arm, forearm, shoulders } = self;
        [
            ("thigh", thigh),
            ("shank", shank),
            ("trunk", trunk),
            ("upper_arm", upper_arm),
            ("forearm", forearm),
            ("shoulders", shoulders),
        ]
    }

    /// Returns true if no length was measured.
    pub(super) fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Returns the segments of a body of this stature (m), for [`ergo_map::Person::with_segments`].
    /// Heights are summed from the ankle's. Missing segments keep their average length.
    ///
    /// ```
    /// use percept_recording::MeasuredSegments;
    ///
    /// let measured = MeasuredSegments { shank: Some(0.43), thigh: Some(0.44), ..Default::default() };
    /// let segments = measured.of_stature(1.75);
    /// assert!(segments.hip_height.is_some_and(|hip| (hip - 0.938).abs() < 1e-3));
    /// assert_eq!(segments.shoulder_height, None);
    /// ```
    pub fn of_stature(&self, stature: f64) -> ergo_map::Segments {
        let knee_height = self.shank.map(|shank| ANKLE * stature + shank);
        let hip_height = knee_height.zip(self.thigh).map(|(knee, thigh)| knee + thigh);
        ergo_map::Segments {
            knee_height,
            hip_height,
            shoulder_height: hip_height.zip(self.trunk).map(|(hip, trunk)| hip + trunk),
            upper_arm: self.upper_arm,
            forearm: self.forearm,
            shoulder_half_width: self.shoulders.map(|shoulders| 0.5 * shoulders),
            ..ergo_map::Segments::default()
        }
    }
}
