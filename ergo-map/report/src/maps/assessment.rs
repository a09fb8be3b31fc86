//! One posture of a map with all its scores.

use ergo_map::{
    Conditions, ContinuousReba, Contributions, ErgonomicsMap, JointAngles, Landmarks, Person, Reba,
    Rula, RulaWorksheet, Skeleton, Worksheet,
};
use nalgebra::Vector3;

use crate::error::Error;

/// The posture of a map for a hand position, with its scores for an easy task. The task has no
/// load, a good grip, and nothing that is held for long or repeated.
#[derive(Debug, Clone)]
pub struct Assessment {
    /// Target of the hand, in the person's frame \[m\].
    pub hand: Vector3<f64>,
    /// `e_s` of the map at this position.
    pub map_score: f64,
    /// The posture.
    pub angles: JointAngles,
    /// Landmarks of the person's body in this posture.
    pub landmarks: Landmarks,
    /// The REBA score with all sub-scores.
    pub reba: Reba,
    /// The RULA score with all sub-scores.
    pub rula: Rula,
    /// Contribution of each part to `e_s` of the posture.
    pub contributions: Contributions,
}

impl Assessment {
    /// Assesses the posture at a hand position \[m\].
    ///
    /// # Errors
    /// [`Error::Map`] outside the map's domain.
    pub fn new(map: &ErgonomicsMap, person: &Person, hand: &Vector3<f64>) -> Result<Self, Error> {
        let map_score = map.sample(hand)?.score;
        let angles = map.posture(hand)?;
        let posture = angles.posture();
        let easy = Conditions::default();
        let continuous = ContinuousReba::of_posture(&posture, &easy, map.mode())?;
        Ok(Self {
            hand: *hand,
            map_score,
            angles,
            landmarks: Skeleton::new(person, map.side()).landmarks(&angles)?,
            reba: Worksheet::from_posture(&posture, easy).score()?,
            rula: RulaWorksheet::from_posture(&posture).score()?,
            contributions: continuous.contributions(),
        })
    }
}
