use crate::error::{Result, within};

/// Quality of the grip on the load (added to table B).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, PartialOrd, Ord)]
pub enum Coupling {
    /// A well-fitting handle and a mid-range power grip.
    #[default]
    Good,
    /// An acceptable grip, not ideal.
    Fair,
    /// A grip that is possible but not acceptable.
    Poor,
    /// Grip that is unsafe.
    Unacceptable,
}

impl Coupling {
    /// Returns the addition to table B: 0 to 3.
    pub const fn score(self) -> u8 {
        match self {
            Self::Good => 0,
            Self::Fair => 1,
            Self::Poor => 2,
            Self::Unacceptable => 3,
        }
    }

    /// Returns the coupling that adds `score` to table B, if there is one.
    pub const fn from_score(score: u8) -> Option<Self> {
        match score {
            0 => Some(Self::Good),
            1 => Some(Self::Fair),
            2 => Some(Self::Poor),
            3 => Some(Self::Unacceptable),
            _ => None,
        }
    }
}

/// Support of the body's weight.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum LegSupport {
    /// Both feet.
    #[default]
    Bilateral,
    /// Walking feet. The knees' flexion does not count.
    Walking,
    /// Single foot, or an unstable posture.
    Unilateral,
    /// A seat. The knees' flexion does not count.
    Sitting,
}

/// Inputs of REBA except joint angles. The default is an easy task: no load, good coupling,
/// both feet on the floor, nothing held for long or repeated.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[allow(clippy::struct_excessive_bools)] // the tick boxes of the printed sheet
pub struct Conditions {
    /// Load or force \[kg\].
    pub load: f64,
    /// The load is applied with shock or builds up rapidly.
    pub shock: bool,
    /// Quality of the grip.
    pub coupling: Coupling,
    /// Support of the body.
    pub support: LegSupport,
    /// The shoulder is raised.
    pub shoulder_raised: bool,
    /// The arm is supported, or gravity assists it.
    pub arm_supported: bool,
    /// A body part is held still for more than a minute.
    pub held_static: bool,
    /// Small-range actions repeat more than four times a minute.
    pub repeated: bool,
    /// Rapid large changes of posture, or an unstable base.
    pub rapid_or_unstable: bool,
}

impl Conditions {
    /// Checks the load: finite, from 0 to 1000 kg.
    ///
    /// # Errors
    /// [`crate::Error::Value`] if the load is invalid.
    pub fn validate(&self) -> Result<()> {
        within("load", self.load, [0.0, 1000.0], "kg").map(drop)
    }

    /// Returns the addition of the load to table A: below 5 kg 0, 5 to 10 kg 1, above 2. Shock adds
    /// 1.
    pub(super) fn load_score(&self) -> u8 {
        let weight = match self.load {
            load if load < 5.0 => 0,
            load if load <= 10.0 => 1,
            _ => 2,
        };
        weight + u8::from(self.shock)
    }

    /// Returns the addition of the activity to table C.
    pub(super) fn activity_score(&self) -> u8 {
        u8::from(self.held_static) + u8::from(self.repeated) + u8::from(self.rapid_or_unstable)
    }

    /// Returns the addition of raising (+1) and support (-1) to the upper arm.
    pub(super) fn arm_adjustment(&self) -> i8 {
        i8::from(self.shoulder_raised) - i8::from(self.arm_supported)
    }
}
