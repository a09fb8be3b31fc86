//! Freshness of a person's place.

/// Freshness of a person's place, by the time since they were last measured. Everything that
/// depends on this time uses these thresholds.
///
/// ```
/// use vision_models::Freshness;
///
/// assert_eq!(Freshness::at(0.05), Freshness::Tracked);
/// assert!(Freshness::at(0.4).is_usable() && !Freshness::at(0.6).is_usable());
/// assert_eq!(Freshness::at(f64::INFINITY), Freshness::Lost);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Freshness {
    /// Measured in the latest frames.
    Tracked,
    /// Not measured for a moment. The pose is predicted with the last velocity.
    Coasting,
    /// Not measured for so long that the motion is not known. The pose is the last prediction.
    Uncertain,
    /// Not measured for so long that the person may be anywhere.
    Lost,
}

impl Freshness {
    /// Largest age at which a person is tracked (s): a little more than two frames.
    pub const TRACKED: f64 = 0.12;
    /// Largest age at which a person coasts (s). Within it a walking person seldom changes their speed, and ten frames
    /// may be lost.
    pub const COASTING: f64 = 0.5;
    /// Largest age at which a person is uncertain (s). The motion has then not been known for a second.
    pub const UNCERTAIN: f64 = 1.5;

    /// Returns the freshness at an age (s). An age that is not a number counts as lost.
    pub fn at(age: f64) -> Self {
        if age <= Self::TRACKED {
            Self::Tracked
        } else if age <= Self::COASTING {
            Self::Coasting
        } else if age <= Self::UNCERTAIN {
            Self::Uncertain
        } else {
            Self::Lost
        }
    }

    /// Returns true while the motion is known, so that the controller may use the pose.
    pub fn is_usable(self) -> bool {
        self <= Self::Coasting
    }
}
