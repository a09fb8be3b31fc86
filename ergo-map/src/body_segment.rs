use crate::kinematics::mass;
use crate::person::Person;

/// A segment of the body, one of two where the body has two.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum BodySegment {
    /// One hand.
    Hand,
    /// One forearm.
    Forearm,
    /// One upper arm.
    UpperArm,
    /// One foot.
    Foot,
    /// One shank.
    Shank,
    /// One thigh.
    Thigh,
    /// Head and neck.
    HeadAndNeck,
    /// Thorax and abdomen.
    ThoraxAndAbdomen,
    /// Pelvis.
    Pelvis,
}

impl BodySegment {
    /// Every segment.
    pub const ALL: [Self; 9] = [
        Self::Hand,
        Self::Forearm,
        Self::UpperArm,
        Self::Foot,
        Self::Shank,
        Self::Thigh,
        Self::HeadAndNeck,
        Self::ThoraxAndAbdomen,
        Self::Pelvis,
    ];

    /// How many of it a body has.
    pub const fn count(self) -> u8 {
        match self {
            Self::HeadAndNeck | Self::ThoraxAndAbdomen | Self::Pelvis => 1,
            _ => 2,
        }
    }

    /// Mass of one as a fraction of the body's (Dempster, in Winter's table).
    pub const fn mass_fraction(self) -> f64 {
        match self {
            Self::Hand => mass::HAND,
            Self::Forearm => mass::FOREARM,
            Self::UpperArm => mass::UPPER_ARM,
            Self::Foot => mass::FOOT,
            Self::Shank => mass::SHANK,
            Self::Thigh => mass::THIGH,
            Self::HeadAndNeck => mass::HEAD,
            Self::ThoraxAndAbdomen => mass::THORAX,
            Self::Pelvis => mass::PELVIS,
        }
    }

    /// Centre of mass from the proximal end, as a fraction of the segment's length (Dempster, in
    /// Winter's table). For the hand the model uses the grip instead.
    pub const fn centre_of_mass(self) -> f64 {
        match self {
            Self::Hand => 0.506,
            Self::Forearm => mass::FOREARM_COM,
            Self::UpperArm => mass::UPPER_ARM_COM,
            Self::Foot => 0.5,
            Self::Shank => 1.0 - mass::SHANK_COM,
            Self::Thigh => 1.0 - mass::THIGH_COM,
            Self::HeadAndNeck => 1.0,
            Self::ThoraxAndAbdomen => 1.0 - mass::THORAX_COM,
            Self::Pelvis => 1.0 - mass::PELVIS_COM,
        }
    }
}

impl Person {
    /// Mass of one segment \[kg\].
    pub fn segment_mass(&self, segment: BodySegment) -> f64 {
        self.mass() * segment.mass_fraction()
    }
}
